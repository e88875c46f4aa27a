#include "diagnosis/diagnosed_modes.h"

#include <utility>

#include "dense/blas.h"
#include "diagnosis/modes/given.h"
#include "diagnosis/modes/labels/labels.h"
#include "diagnosis/modes/modes_verdict.h"
#include "diagnosis/modes/reference/reference.h"
#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// The answer to a problem, with the notes so far.
Diagnosis answered(const ModesProblem& problem, const std::vector<const Effect*>& sought,
                   const DiagnosisOptions& options, const std::vector<std::string>& notes) {
  const auto found =
      searched(problem, sought, options.most_causes, options.least_evidence, options.progress);
  tell(options.progress, "the last word");
  Diagnosis diagnosis = answer(problem, found, options);
  diagnosis.notes.insert(diagnosis.notes.begin(), notes.begin(), notes.end());
  return diagnosis;
}

}  // namespace

Diagnosis diagnosed(const Structure& structure, const MeasuredModes& measured,
                    const DiagnosisOptions& options) {
  const dense::OneBlasThread one_thread;  // the tasks of the search run in parallel instead
  auto own = given(structure, measured);
  const auto labels = labels_of(own.structure, own.measured, options);
  const bool learned = options.levels == Levels::learned;
  const auto constants = held_constants(own.structure, options.constants,
                                        believable(options.tolerances, learned), own.notes);
  const ModesProblem problem(own.structure, labels.measured, options.tolerances, learned,
                             constants);
  const auto sought = sought_beside(constants, catalogue_of(options), own.structure);
  auto diagnosis = answered(problem, sought, options, own.notes);
  add(labels, diagnosis);
  return diagnosis;
}

void check_reference(const MeasuredModes& measured, const MeasuredModes& reference) {
  static_cast<void>(common(measured, reference));
}

Diagnosis diagnosed(const Structure& structure, const MeasuredModes& measured,
                    const MeasuredModes& reference, const DiagnosisOptions& options) {
  const dense::OneBlasThread one_thread;
  const auto both = common(measured, reference);
  const auto before = given(structure, both.reference);
  const auto after = given(structure, both.later);
  const auto own = referred(after.structure, after.measured, before.measured, options.tolerances);
  const ModesProblem problem(own.structure, own.measured, repeatable(options.tolerances),
                             repeatability(options.tolerances, options.levels == Levels::learned));
  auto notes = both.notes;
  for (const auto* more : {&after.notes, &own.notes}) {
    notes.insert(notes.end(), more->begin(), more->end());
  }
  if (!options.constants.empty()) {
    notes.emplace_back("constants are not calibrated beside a reference, which has the same ones");
  }
  auto diagnosis = answered(problem, catalogue_of(options), options, notes);
  for (std::size_t k = 0; k < diagnosis.modes.size(); ++k) {
    diagnosis.modes[k].reference_hz = own.reference_hz(static_cast<Index>(k));
  }
  return diagnosis;
}

}  // namespace chladni::diagnosis
