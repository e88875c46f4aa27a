// The sections of a report about modes, each from the data that the rooms return.
#pragma once

#include "fem/modes.h"
#include "fem/system.h"
#include "io/report.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

/// Table of the modes beside a viewer of them, the certificate below.
/// @param modes            shapes on all nodes: 3·nodes rows
/// @param frequency_error  per mode, relative; empty where none was estimated
/// @param markers          channels and attachments on the body
/// @param from_above       the mesh fills the body exactly: no frequency of it is too low
/// @throws InvalidInput    the arrays do not fit together
[[nodiscard]] Section modes_section(const mesh::TetMesh& mesh, const modal::Modes& modes,
                                    const fem::ModesSummary& summary,
                                    const Eigen::VectorXd& frequency_error,
                                    const std::vector<Marker>& markers = {},
                                    bool from_above = false);

/// The shapes of the flexible modes on a skin of at most 20 000 vertices, and few enough that it
/// takes about `bytes` in the page; the largest 64 modes at most.
[[nodiscard]] Viewer modes_viewer(const mesh::TetMesh& mesh, const modal::Modes& modes,
                                  const std::vector<Marker>& markers = {},
                                  std::size_t bytes = 240'000);

/// A picture that was written before, such as modes.png.
/// @throws InvalidInput  as read_whole
[[nodiscard]] Section picture_section(const std::string& title, const std::filesystem::path& png,
                                      const std::string& caption);

/// Mass, centre and inertia beside the mesh and its quality.
[[nodiscard]] Section body_section(const fem::MassProperties& mass, const mesh::TetMesh& mesh,
                                   const mesh::Quality& quality, Eigen::Index degrees_of_freedom);

/// Where the channels are and what the flexible modes are worth there.
/// @param shapes  markers×modes [kg^-1/2]; empty where there are no modes
[[nodiscard]] Section channels_section(const std::vector<Marker>& channels,
                                       const modal::Modes& modes, const Eigen::MatrixXd& shapes);

/// Where the results come from: version, sha256 of the study, kernel, threads, seed, seconds.
[[nodiscard]] Section provenance_section(
    const std::vector<std::pair<std::string, std::string>>& lines);

}  // namespace chladni::io
