// What real_rigs_study is asked for, and what it tells.
#pragma once

#include <string>
#include <vector>

#include "hidden_effects/shipped_answer.h"
#include "simulators/rigs/real_rig.h"
#include "simulators/rigs/rig_score.h"

namespace chladni {

/// What a rig is diagnosed from.
enum class RealData {
  modes,      ///< as an experimental modal analysis gives them
  responses,  ///< by the engine of responses alone
  study,      ///< responses in a file, by all that `chladni diagnose` does
};

struct RealArguments {
  std::string bodies = "table,strip", kinds = "none,all";
  unsigned first = 1, last = 2;  ///< seeds
  RealData data = RealData::modes;
  bool truth = false;            ///< without a diagnosis
  bool rivals = false;           ///< also print the explanations and levels of each case
  bool truth_fit = false;        ///< also the evidence of the truth
  bool reference = false;        ///< beside the modes of the rig with nothing hidden
  double edge_length = 0.0;      ///< of the mesh [m]; 0: left to the program
  simulators::RealRigOptions options;
};

struct RealTrial {
  std::string body, group, kind;  ///< `group`: a row of the totals
  unsigned seed = 0;
};

struct RealDone {
  RealTrial trial;
  simulators::RigScore score;
  double clear = 0.0, seconds = 0.0;
  std::string failure;  ///< what the diagnosis threw; or empty
};

/// @throws InvalidInput  a word that is not known, or one without its value
[[nodiscard]] RealArguments real_arguments(int count, char** values);
/// Bodies one after the other, within them kinds, within them seeds.
[[nodiscard]] std::vector<RealTrial> real_trials(const RealArguments& wanted);

void print_truth(const RealTrial& trial, const simulators::RealRigCase& rig);
void print_case(const RealDone& done);
/// The errors of the responses before and after, and the seconds of the steps.
void print_steps(const hidden_effects::ShippedAnswer& told);
/// The explanations with their probabilities and ln evidence, and the levels that the best leaves.
void print_rivals(const diagnosis::Diagnosis& told);
/// The ln evidence of the truth over that of nothing hidden, fitted from its true sizes.
void print_truth_fit(const diagnosis::Structure& structure, const simulators::RealRigCase& rig,
                     const diagnosis::DiagnosisOptions& options);
/// Totals by body and kind, and the truth of statements by their probability.
void print_totals(const std::vector<RealDone>& all);

}  // namespace chladni
