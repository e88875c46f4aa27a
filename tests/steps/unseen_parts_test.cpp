// Cross-validation comes after the fit, and takes nothing of it where a part cannot be fitted.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/time_file.h"
#include "simulators/frf_cases.h"
#include "simulators/portable_random.h"
#include "steps/identification/unseen.h"
#include "steps/measured/recorded_frfs.h"

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

// Eight periods of a spring of 0.5 N/m. The exciter rests in the sixth.
recordings::TimeData with_a_pause() {
  constexpr Eigen::Index kPeriod = 64;
  constexpr Eigen::Index kPeriods = 8;
  simulators::Dice dice(7);
  const Eigen::VectorXd force = dice.normal(kPeriod, 1);
  recordings::Record record;
  record.inputs = force.replicate(kPeriods, 1);
  record.inputs.middleRows(5 * kPeriod, kPeriod).setZero();
  record.outputs = 2.0 * record.inputs + 1e-3 * dice.normal(kPeriod * kPeriods, 1);
  record.references.resize(kPeriod * kPeriods, 0);
  recordings::TimeData data;
  data.outputs.resize(1);
  data.outputs[0].name = "y1";
  data.inputs.resize(1);
  data.inputs[0].name = "u1";
  data.sample_time_s = 1e-3;
  data.period = kPeriod;
  data.records.push_back(std::move(record));
  return data;
}

// One stretch of periods holds the pause, and cannot be estimated: that ended the reading of sound
// recordings.
TEST(UnseenParts, LoseNoEstimateWhereOnePartHasNone) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("chladni_unseen_parts_{}.csv", getpid());
  study::Study study;
  study.sensors.resize(1);
  study.sensors[0].name = "y1";
  study.actuators.resize(1);
  study.actuators[0].name = "u1";
  auto& plan = study.measurement.emplace();
  plan.time = file;
  plan.recording.inputs = "forces";
  plan.recording.transient = "drop";
  (void)io::write_time(plan.time, with_a_pause());
  Listener work;
  const auto found = recorded_frfs(study, work, true);
  std::filesystem::remove(file);
  EXPECT_TRUE(found.folds.folds.empty());
  const auto why = std::ranges::find_if(work.notes, [](const std::string& note) {
    return note.find("nothing is left out in turn: FRF estimate: ") != std::string::npos;
  });
  EXPECT_NE(why, work.notes.end());
  for (const auto& line : found.set.value) EXPECT_NEAR(std::abs(line(0, 0)), 2.0, 0.05);
}

}  // namespace
}  // namespace chladni::steps
