// The modes of a study's body, and their output.
#pragma once

#include "app/command.h"
#include "app/stage/estimate.h"
#include "app/stage/model.h"
#include "fem/modes.h"
#include "io/csv.h"

namespace chladni::app {

/// A study before its long step.
struct Introduction {
  Outline outline;
  Understood body;
  Cost cost;
  std::vector<std::string> warnings;
};

struct Solution {
  Introduction introduction;
  Model model;
  modal::Modes modes;               ///< on all nodes: 3·nodes rows
  Eigen::MatrixXd extra_shapes;     ///< for the degrees of freedom that attachments add
  Eigen::VectorXd frequency_error;  ///< per mode, relative; 0 for rigid-body modes
  fem::ModesSummary summary;
  Eigen::Index degrees_of_freedom = 0;  ///< free ones
};

/// Geometry, mesh, assembly and modes. Prints the first line, the forecast and the progress.
/// @throws as its steps
[[nodiscard]] Solution solved(const Study& study, Run& run);
/// The same for a study that was introduced before.
[[nodiscard]] Solution solved(const Study& study, Introduction introduction, Run& run);

/// Prints the first line, the notes and the warnings.
[[nodiscard]] Introduction introduced(const Study& study, Run& run);

/// Values of the shapes at sites along `directions`, n×3: n×modes [kg^-1/2].
[[nodiscard]] Eigen::MatrixXd shapes_at(const std::vector<mesh::Site>& sites,
                                        const Points& directions, const modal::Modes& modes);

/// Values of the shapes at the channels: channels×modes [kg^-1/2].
[[nodiscard]] Eigen::MatrixXd shapes_at(const std::vector<Channel>& channels,
                                        const std::vector<mesh::Site>& sites,
                                        const modal::Modes& modes);

[[nodiscard]] std::string modes_table(const Solution& solution);
[[nodiscard]] io::JsonObject modes_json(const Study& study, const Solution& solution);
/// One line per mode: number, frequency, its error, damping, residual.
[[nodiscard]] std::vector<io::CsvColumn> modes_columns(const Solution& solution);

/// The JSON, tables and fields of the modes, then their pictures.
void leave_modes(const Study& study, const Solution& solution, Run& run);

/// mesh.vtu, mesh.json
void leave_mesh(const mesh::TetMesh& body, Run& run, bool main_result);
/// mesh.png: the patches with their names
void paint_patches(const Study& study, const mesh::TetMesh& body, Run& run);
[[nodiscard]] io::JsonObject mesh_json(const mesh::TetMesh& body);
[[nodiscard]] std::string mesh_text(const mesh::TetMesh& body);

/// study.json: the study in SI units with its estimates.
[[nodiscard]] io::JsonObject study_json(const Study& study, const Introduction& introduction);

/// Compares each expectation with the result.
/// @throws NumericalFailure  some are not met (their number), after all were shown
void judge(const Study& study, const Solution& solution, Run& run);

}  // namespace chladni::app
