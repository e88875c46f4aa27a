// The sections of a report about modes, made from the data that the rooms return.
#pragma once

#include "fem/modes.h"
#include "fem/system.h"
#include "io/report.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

/// The table of the modes beside their viewer, with the certificate below.
/// @param modes            shapes on all nodes: 3·nodes rows
/// @param frequency_error  per mode, relative; empty where it was not estimated
/// @param markers          channels and attachments on the body
/// @param from_above       the mesh fills the body exactly, so no frequency is too low
/// @throws InvalidInput    the arrays do not fit together
[[nodiscard]] Section modes_section(const mesh::TetMesh& mesh, const modal::Modes& modes,
                                    const fem::ModesSummary& summary,
                                    const Eigen::VectorXd& frequency_error,
                                    const std::vector<Marker>& markers = {},
                                    bool from_above = false);

/// The viewer of the first 64 flexible modes at most. Its skin has at most 20 000 vertices, and few
/// enough to take about `bytes` in the page.
[[nodiscard]] Viewer modes_viewer(const mesh::TetMesh& mesh, const modal::Modes& modes,
                                  const std::vector<Marker>& markers = {},
                                  std::size_t bytes = 240'000);

/// A picture from an existing file, such as modes.png.
/// @throws InvalidInput  as read_whole
[[nodiscard]] Section picture_section(const std::string& title, const std::filesystem::path& png,
                                      const std::string& caption);

/// Mass, centre and inertia beside the mesh and its quality.
[[nodiscard]] Section body_section(const fem::MassProperties& mass, const mesh::TetMesh& mesh,
                                   const mesh::Quality& quality, Eigen::Index degrees_of_freedom);

/// The places of the channels, and the values of the flexible modes at these places.
/// @param shapes  markers×modes [kg^-1/2]; empty where there are no modes
[[nodiscard]] Section channels_section(const std::vector<Marker>& channels,
                                       const modal::Modes& modes, const Eigen::MatrixXd& shapes);

/// The origin of the results: version, sha256 of the study, kernel, threads, seed, seconds.
[[nodiscard]] Section provenance_section(
    const std::vector<std::pair<std::string, std::string>>& lines);

}  // namespace chladni::io
