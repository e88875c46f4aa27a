// What hidden_effects_study tells: a line of each case, tables of all.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "simulators/hidden/hidden_effect.h"
#include "simulators/hidden/hidden_score.h"
#include "study_arguments.h"

namespace chladni {

struct Done {
  Trial trial;
  simulators::CaseScore score;
  double seconds = 0.0, cpu_seconds = 0.0;
  double evidence_there = 0.0, evidence_apart = HUGE_VAL;
  double excess_before = 0.0, excess_after = 0.0;  ///< z
};

/// For a person.
void print_case(const Done& done, const simulators::HiddenCase& hidden);
/// For a program: one JSON object.
[[nodiscard]] std::string json_line(const Done& done, const simulators::HiddenCase& hidden);

/// By kind, and by rig where there are several.
void print_tables(const std::vector<Done>& all);
/// z of the sizes where the name is right (0.68, 0.95, 0.997 are expected), how sure wrong names
/// are, seconds.
void print_calibration(const std::vector<Done>& all);

}  // namespace chladni
