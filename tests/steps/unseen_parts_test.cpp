// Cross-validation comes after the fit, and takes nothing of it where a part cannot be fitted.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.h"
#include "simulators/frf_cases.h"
#include "steps/identification/unseen.h"

namespace chladni::steps {
namespace {

// Keeps what it is told.
class Listener : public stage::Work {
 public:
  void note(std::string_view line) override { notes.emplace_back(line); }
  std::vector<std::string> notes;
};

// Two realisations of the beam, each predicted by the other.
IdentifiedModel fitted_beam() {
  IdentifiedModel model;
  model.measured.outputs = {0, 1, 2, 3, 4};
  model.measured.inputs = {0, 1, 2};
  const auto record = [](unsigned seed) {
    simulators::FrfFaults faults;
    faults.seed = seed;
    return simulators::beam5x3(faults).measured;
  };
  model.seen = record(1);
  model.data = identification::fit_data(model.seen);
  identification::IdentificationOptions options;
  options.modes = 5;
  model.found = identification::identified(model.data, options);
  model.measured.folds.by = "realisations";
  for (unsigned seed : {1U, 2U}) {
    model.measured.folds.folds.push_back(
        {"realisation " + std::to_string(seed), record(seed), record(3 - seed), 1.0});
  }
  return model;
}

study::Study beam_study() {
  study::Study study;
  study.identification.emplace().modes = 5;
  return study;
}

TEST(UnseenParts, ArePredictedByTheFitWithoutThem) {
  const auto model = fitted_beam();
  const auto study = beam_study();
  Listener work;
  const auto result = cross_validated(
      study, model,
      [&](const auto& data) { return identification::refitted(data, model.found.fit, {}); }, work);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->by, "realisations");
  EXPECT_TRUE(work.notes.empty());
}

// A failure of one part was one of the verb, and the finished fit was lost.
TEST(UnseenParts, LoseNoFitWhereOneCannotBeFitted) {
  const auto model = fitted_beam();
  const auto study = beam_study();
  const std::vector<Refit> refits{
      [](const auto&) -> identification::ModalFit { throw NumericalFailure("no step descends"); },
      [](const auto&) -> identification::ModalFit { throw InvalidInput("too few numbers"); }};
  for (const auto& refit : refits) {
    Listener work;
    EXPECT_FALSE(cross_validated(study, model, refit, work));
    ASSERT_EQ(work.notes.size(), 1U);
    EXPECT_EQ(work.notes[0].find("nothing is left out in turn: a fit without one part fails: "), 0U)
        << work.notes[0];
  }
  Listener work;
  const Refit stopped = [](const auto&) -> identification::ModalFit {
    throw Interrupted("stopped");
  };
  EXPECT_THROW((void)cross_validated(study, model, stopped, work), Interrupted);
}

}  // namespace
}  // namespace chladni::steps
