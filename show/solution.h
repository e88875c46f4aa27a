// The modes and the mesh of a study: text, JSON, tables and files.
#pragma once

#include "io/csv.h"
#include "io/json.h"
#include "show/run.h"
#include "stage/solution.h"

namespace chladni::app {

/// One line per mode: number, frequency, its error, damping, residual.
[[nodiscard]] std::vector<io::CsvColumn> modes_columns(const Solution& solution);

[[nodiscard]] io::JsonObject modes_json(const Study& study, const Solution& solution);

[[nodiscard]] std::string modes_table(const Solution& solution);

/// The JSON, tables and fields of the modes, then their pictures.
void leave_modes(const Study& study, const Solution& solution, Run& run);

/// mesh.png: the patches with their names
void paint_patches(const Study& study, const mesh::TetMesh& body, Run& run);

/// mesh.vtu, mesh.json
void leave_mesh(const mesh::TetMesh& body, Run& run, bool main_result);

[[nodiscard]] io::JsonObject mesh_json(const mesh::TetMesh& body);

[[nodiscard]] std::string mesh_text(const mesh::TetMesh& body);

/// study.json: the study in SI units with its estimates.
[[nodiscard]] io::JsonObject study_json(const Study& study, const Introduction& introduction);

}  // namespace chladni::app
