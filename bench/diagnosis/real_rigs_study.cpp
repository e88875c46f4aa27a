// real_rigs_study [--body table,strip,disc,ell|all] [--kinds a,b|all|outside|none|pairs]
//   [--seeds A..B] [--data modes|frf|study] [--edge METRES] [--nature X] [--frequency-error X]
//   [--shape-error X] [--severity X] [--frequency-noise X] [--shape-noise X] [--mass X]
//   [--unscaled] [--reference] [--rivals] [--truth-fit] [--truth]
#include <fmt/format.h>

#include <chrono>
#include <map>

#include "base/error.h"
#include "diagnosis/diagnosed.h"
#include "hidden_effects/shipped_structure.h"
#include "real_rigs_tables.h"
#include "simulators/rigs/real_rig.h"
#include "simulators/rigs/rig_score.h"
#ifdef CHLADNI_HAS_MODES
#include "diagnosis/diagnosed_modes.h"
#endif

namespace chladni {
namespace {

constexpr const char* kHelp =
    R"(real_rigs_study [--body table,strip,disc,ell|all] [--kinds a,b|all|outside|none|pairs]
  [--seeds A..B] [--data modes|frf|study] [--edge METRES] [--nature X] [--frequency-error X]
  [--shape-error X] [--severity X] [--frequency-noise X] [--shape-noise X] [--mass X] [--unscaled]
  [--reference] [--rivals] [--truth-fit] [--truth]

Hides effects in measurements of real rigs, which deviate from every model by what is not announced,
and diagnoses them from the structure that the program makes of a study (tetrahedra). Two kinds
joined with '+' act together; "pairs" draws them.

Seeds 1 to 99 are for tuning. Seeds from 1000 on are for reports: do not tune on them.

One line for each case: seed, body, kind, what was scored, the cause found (or the surest one that
is false), its probability, error of the place, error of the sizes in stated deviations, clearness
(log10 of the ln evidence of an ideal judge; "clear" from 1.857, three times what can be detected),
seconds. Then totals by body and kind: right, told as one of several scales of the body ("class"),
right or so of those clear, sizes and places within two stated deviations; and how many statements of
each probability are true.

--data: modes; responses by the engine of responses alone; or a study with a file of responses, by
all that `chladni diagnose` does.
--mass: of a point mass, over that of the body.
--reference: the modes are compared with those of the same rig, measured before anything was hidden.
--rivals: also the explanations of each case.
--truth-fit: also the ln evidence of the truth, fitted from its true sizes.
--truth: no diagnosis; what is hidden, and how clear it is.
)";

const hidden_effects::Shipped& structure_of(const simulators::RealBody& body, double edge) {
  static std::map<std::string, hidden_effects::Shipped> kept;
  const auto found = kept.find(body.rig.name);
  if (found != kept.end()) return found->second;
  return kept.emplace(body.rig.name, hidden_effects::shipped(body.rig, edge)).first->second;
}

diagnosis::Diagnosis told_of(const RealTrial& trial, const simulators::RealRigCase& rig,
                             const RealArguments& wanted) {
  const auto& [structure, diagnosis_options] = structure_of(rig.body, wanted.edge_length);
  if (wanted.data == RealData::responses) {
    return diagnosis::diagnosed(structure, rig.measured, diagnosis_options);
  }
#ifdef CHLADNI_HAS_MODES
  if (wanted.reference) {
    auto options = wanted.options;
    options.repetition = 1;
    const auto before = simulators::real_rig_case(trial.body, "none", trial.seed, options);
    return diagnosis::diagnosed(structure, rig.modes, before.modes, diagnosis_options);
  }
  return diagnosis::diagnosed(structure, rig.modes, diagnosis_options);
#else
  throw InvalidInput("this build has no diagnosis of modes");
#endif
}

// A diagnosis and its wall time, without that of the solution of the study.
diagnosis::Diagnosis timed(const RealTrial& trial, const simulators::RealRigCase& rig,
                           const RealArguments& wanted, double& seconds) {
  if (wanted.data == RealData::study) {
    auto told = hidden_effects::shipped_answer(rig, wanted.edge_length);
    seconds = told.seconds;
    if (wanted.rivals) print_steps(told);
    return std::move(told.result);
  }
  static_cast<void>(structure_of(rig.body, wanted.edge_length));
  const auto start = std::chrono::steady_clock::now();
  auto told = told_of(trial, rig, wanted);
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return told;
}

RealDone done(const RealTrial& trial, const RealArguments& wanted) {
  const auto rig = simulators::real_rig_case(trial.body, trial.kind, trial.seed, wanted.options);
  RealDone one{trial, {}, rig.clear, 0.0, ""};
  if (wanted.truth) {
    print_truth(trial, rig);
    return one;
  }
  diagnosis::Diagnosis told;
  try {
    told = timed(trial, rig, wanted, one.seconds);
    one.score = simulators::scored(rig, told);
  } catch (const std::exception& error) {
    one.failure = error.what();
  }
  print_case(one);
  if (wanted.rivals) print_rivals(told);
  if (wanted.truth_fit) {
    const auto& [structure, diagnosis_options] = structure_of(rig.body, wanted.edge_length);
    print_truth_fit(structure, rig, diagnosis_options);
  }
  return one;
}

int studied(int count, char** values) {
  for (int i = 1; i < count; ++i) {
    if (std::string_view(values[i]) != "--help") continue;
    fmt::print("{}", kHelp);
    return 0;
  }
  const auto wanted = real_arguments(count, values);
  std::vector<RealDone> all;
  for (const auto& trial : real_trials(wanted)) all.push_back(done(trial, wanted));
  if (!wanted.truth) print_totals(all);
  return 0;
}

}  // namespace
}  // namespace chladni

int main(int count, char** values) {
  try {
    return chladni::studied(count, values);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
