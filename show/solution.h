// The modes and the mesh of a study: text, JSON, tables and files.
#pragma once

#include "io/csv.h"
#include "io/json.h"
#include "show/run.h"
#include "stage/solution.h"
#include "steps/expectations.h"

namespace chladni::show {

/// One line per mode: number, frequency, its error, damping, residual.
[[nodiscard]] std::vector<io::CsvColumn> modes_columns(const stage::Solution& solution);

[[nodiscard]] io::JsonObject modes_json(const study::Study& study, const stage::Solution& solution);

[[nodiscard]] std::string modes_table(const stage::Solution& solution);

/// The JSON, tables and fields of the modes, then their pictures.
void leave_modes(const study::Study& study, const stage::Solution& solution, Run& run);

/// mesh.png: the patches with their names
void paint_patches(const study::Study& study, const mesh::TetMesh& body, Run& run);

/// mesh.vtu, mesh.json
void leave_mesh(const mesh::TetMesh& body, Run& run, bool main_result);

[[nodiscard]] io::JsonObject mesh_json(const mesh::TetMesh& body);

[[nodiscard]] std::string mesh_text(const mesh::TetMesh& body);

/// study.json: the study in SI units with its estimates.
[[nodiscard]] io::JsonObject study_json(const study::Study& study,
                                        const stage::Introduction& introduction);
/// What was found, and whether that is met, in `expect` of a study.json.
void add_judged(const std::vector<steps::JudgedExpectation>& judged, io::JsonObject& study_json);

}  // namespace chladni::show
