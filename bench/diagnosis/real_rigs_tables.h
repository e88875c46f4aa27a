// What real_rigs_study is asked for, and what it tells.
#pragma once

#include <string>
#include <vector>

#include "simulators/rigs/real_rig.h"
#include "simulators/rigs/rig_score.h"

namespace chladni {

struct RealArguments {
  std::string bodies = "table,strip", kinds = "none,all";
  unsigned first = 1, last = 2;  ///< seeds
  bool modes = true;             ///< else responses
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
/// The explanations with their probabilities and ln evidence, and the levels that the best leaves.
void print_rivals(const diagnosis::Diagnosis& told);
/// The ln evidence of the truth over that of nothing hidden, fitted from its true sizes.
void print_truth_fit(const diagnosis::Structure& structure, const simulators::RealRigCase& rig,
                     const diagnosis::DiagnosisOptions& options);
/// Totals by body and kind, and the truth of statements by their probability.
void print_totals(const std::vector<RealDone>& all);

}  // namespace chladni
