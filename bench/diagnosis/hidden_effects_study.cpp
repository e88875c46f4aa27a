// hidden_effects_study [--fe [--answer] [--rigs a,b] [--edge METRES]] [--list] [--cases FILE]
//   [--kinds a,b|all|pairs|outside|none] [--seeds N] [--first S] [--every N] [--lines K]
//   [--severity X] [--tolerance] [--deviation X]
//   [--law normal|uniform|student] [--correlation C] [--own-delay S] [--fixtures X]
//   [--write FILE] [--changed-damping] [--degree D] [--modes M] [--fine N] [--coarser C]
//   [--detectable [--check N]]
// hides effects in measurements of Ritz rigs, diagnoses them, and prints what was found, as
// bench/README.md has it. --fe: from the structure that the program itself makes of a study of the
// rig (tetrahedra, app::structure_of), with default tolerances; --answer: by all steps of
// `chladni diagnose` from a file of the responses, their modes included; else from one by the
// truth's own code. --tolerance: rigs that deviate by X (1) default tolerances by the law,
// diagnosed with these, from a structure of C (2) degrees less; else the exact model. --every: a
// part of `all` and `outside`, another for each seed. --cases: a line of JSON for each case.
// --detectable: the smallest sizes that would be found instead; --check: N masses of 0.5, 1 and 1.5
// times theirs are hidden and sought.
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <map>

#include "base/error.h"
#include "detectable_tables.h"
#include "diagnosis/diagnosed.h"
#include "hidden_effects/shipped_answer.h"
#include "hidden_effects/shipped_structure.h"
#include "hidden_effects_tables.h"
#include "io/frf_file.h"
#include "simulators/twins.h"
#include "study_arguments.h"

namespace chladni {
namespace {

using hidden_effects::Shipped;

// The lines and modes as a diagnosis of this rig has them.
simulators::HiddenOptions options_of(const Arguments& wanted, const std::string& rig) {
  auto options = wanted.hidden;
  options.rig = rig;
  // structure_of takes the modes up to three times the band.
  options.on_face = wanted.fe || wanted.answer;
  if (wanted.fe) options.above_hz = 3.0 * simulators::rig_named(rig, options.degree).high_hz;
  return options;
}

// Each rig is made once.
const Shipped& structure_of(const Arguments& wanted, const std::string& rig) {
  static std::map<std::string, Shipped> kept;
  if (const auto found = kept.find(rig); found != kept.end()) return found->second;
  if (wanted.fe) {
    const auto believed = simulators::rig_named(rig, wanted.hidden.degree);
    return kept.emplace(rig, hidden_effects::shipped(believed, wanted.edge_length)).first->second;
  }
  const int degree = wanted.hidden.degree - (wanted.tolerance ? wanted.coarser : 0);
  Shipped made{simulators::ritz_structure(simulators::believed_table(degree),
                                          simulators::table_channels(), wanted.structure),
               {}};
  if (!wanted.tolerance) made.options.tolerances = diagnosis::exact_model();
  return kept.emplace(rig, std::move(made)).first->second;
}

diagnosis::Diagnosis told_of(const Trial& trial, const simulators::HiddenCase& hidden,
                             const Arguments& wanted) {
  if (wanted.answer) {
    return hidden_effects::shipped_answer(simulators::rig_named(trial.rig, wanted.hidden.degree),
                                          hidden.measured, wanted.edge_length)
        .result;
  }
  const auto& nominal = structure_of(wanted, trial.rig);
  return diagnosis::diagnosed(nominal.structure, hidden.measured, nominal.options);
}

Done diagnosed(const Trial& trial, const Arguments& wanted, std::ostream* cases) {
  const auto hidden =
      simulators::hidden_case(trial.kinds, trial.seed, options_of(wanted, trial.rig));
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  Done done;
  done.trial = trial;
  done.evidence_there = hidden.evidence_there;
  done.evidence_apart = simulators::evidence_apart(hidden);
  try {
    const auto told = told_of(trial, hidden, wanted);
    done.score = scored(hidden, told);
    done.excess_before = told.excess_before;
    done.excess_after = told.best.excess;
  } catch (const std::exception& error) {
    done.score.outcome = simulators::Outcome::wrong;
    done.score.told = fmt::format("failed: {}", error.what());
  }
  done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  done.cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  if (wanted.list) print_case(done, hidden);
  if (cases != nullptr) *cases << json_line(done, hidden) << std::endl;
  return done;
}

// The first case as a file of measured responses; what is true of it on standard output.
void write_first(const Arguments& wanted) {
  const auto trial = trials(wanted).front();
  const auto hidden =
      simulators::hidden_case(trial.kinds, trial.seed, options_of(wanted, trial.rig));
  for (const auto& truth : hidden.truth) {
    fmt::print("{}", truth.kind);
    if (truth.place) fmt::print(" at ({:.6g}, {:.6g}) m", truth.place->x(), truth.place->y());
    for (const auto& [name, value] : truth.size) fmt::print(" {} {:.6g}", name, value);
    fmt::print("\n");
  }
  for (const auto& lost : io::write_frf(wanted.write, hidden.measured)) fmt::print("{}\n", lost);
}

// What this experiment would find, and whether it does.
void print_smallest(const Arguments& wanted) {
  const std::string rig = trials(wanted).front().rig;
  const auto& [structure, options] = structure_of(wanted, rig);
  const auto hidden = options_of(wanted, rig);
  const auto measured = simulators::hidden_case({}, wanted.first, hidden).measured;
  if (wanted.check == 0) print_detectable(structure, measured, options);
  if (wanted.check == 0 && wanted.tolerance) print_bounds(structure, measured, options);
  if (wanted.check > 0) print_check(structure, options, hidden, wanted.first, wanted.check);
}

int studied(int count, char** values) {
  const auto wanted = arguments(count, values);
  if (!wanted.write.empty()) {
    write_first(wanted);
    return 0;
  }
  if (wanted.detectable) {
    print_smallest(wanted);
    return 0;
  }
  std::ofstream cases;
  if (!wanted.cases.empty()) {
    cases.open(wanted.cases);
    require(cases.good(), fmt::format("{}: cannot be written", wanted.cases));
  }
  std::vector<Done> all;
  for (const auto& trial : trials(wanted)) {
    all.push_back(diagnosed(trial, wanted, cases.is_open() ? &cases : nullptr));
  }
  require(!all.empty(), "no case is left of these kinds, rigs and --every");
  print_tables(all);
  print_calibration(all);
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
