// A designed experiment on a rig that shares no code with the design: the virtual laboratory moves
// states sample by sample.
#include <gtest/gtest.h>

#include <cmath>

#include "base/turn.h"
#include "identification/delay.h"
#include "identification/experiment/design_lines.h"
#include "identification/experiment/expected_fit.h"
#include "identification/experiment_design.h"
#include "recordings/fft.h"
#include "recordings/frf_estimate.h"
#include "recordings/virtual_experiment.h"
#include "tests/refusal.h"

namespace chladni::identification {
namespace {

// Two sensors, two actuators, three modes.
modal::ReducedModel three_modes() {
  modal::ReducedModel model;
  model.frequency_hz = Eigen::Vector3d(21.0, 48.0, 77.0);
  model.damping_ratio = Eigen::Vector3d(0.02, 0.012, 0.015);
  model.output_shapes.resize(2, 3);
  model.output_shapes << 1.0, 0.7, -0.9, 0.5, -1.1, 0.8;
  model.input_shapes.resize(3, 2);
  model.input_shapes << 1.0, -0.6, 0.7, 0.9, -0.9, 1.0;
  model.residual = Eigen::MatrixXd::Constant(2, 2, 2e-6);
  return model;
}

DesignModel model_of(modal::ReducedModel model) {
  DesignModel result{.model = std::move(model), .kinds = {}, .largest = {}};
  result.kinds.assign(static_cast<std::size_t>(result.model.output_count()),
                      modal::FrfKind::receptance);
  result.largest = Eigen::VectorXd::Constant(result.model.mode_count(), 1.5);
  return result;
}

DesignPlan small_plan() {
  return {.sample_time_s = 1.0 / 512.0,
          .low_hz = 5.0,
          .high_hz = 100.0,
          .scheme = recordings::InputScheme::orthogonal,
          .sensor_noise = Eigen::Vector2d(2e-5, 3e-5),
          .force_limit_n = 2.0,
          .stroke_limit_m = 3e-3,
          .damping_std = 0.02,
          .realisations = 4};
}

recordings::VirtualRig rig_of(const modal::ReducedModel& model, const DesignPlan& plan,
                              bool noisy) {
  recordings::VirtualRig rig;
  rig.plant = recordings::plant(model);
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    rig.outputs.emplace_back().name = "y" + std::to_string(i);
  }
  for (Eigen::Index j = 0; j < model.input_count(); ++j) {
    rig.inputs.emplace_back().name = "u" + std::to_string(j);
  }
  rig.sample_time_s = plan.sample_time_s;
  if (noisy) rig.sensor_noise = plan.sensor_noise;
  return rig;
}

/// What the rig records while the design is played, from the first settled sample on.
recordings::TimeData played(const recordings::VirtualRig& rig, const ExperimentDesign& design,
                            double* stroke, double* force) {
  recordings::TimeData data{.outputs = rig.outputs,
                            .inputs = rig.inputs,
                            .references = {},
                            .sample_time_s = rig.sample_time_s,
                            .period = design.period,
                            .records = {}};
  Draw quiet(1);
  for (std::size_t r = 0; r < design.realisations.size(); ++r) {
    for (std::size_t e = 0; e < design.realisations[r].inputs.size(); ++e) {
      const auto signal = sequence(design, design.realisations[r].inputs[e]);
      recordings::Record record = recorded(rig, signal, quiet);
      *stroke = std::max(*stroke, record.outputs.cwiseAbs().maxCoeff());
      *force = std::max(*force, signal.cwiseAbs().maxCoeff());
      const auto rows = Eigen::seqN(first_recorded(design), design.periods * design.period);
      record.outputs = Eigen::MatrixXd(record.outputs(rows, Eigen::all));
      record.inputs = Eigen::MatrixXd(record.inputs(rows, Eigen::all));
      record.references.resize(record.outputs.rows(), 0);
      record.experiment = static_cast<int>(e);
      record.realisation = static_cast<int>(r);
      data.records.push_back(std::move(record));
    }
  }
  return data;
}

recordings::TimeData with_noise(recordings::TimeData data, const Eigen::VectorXd& rms,
                                unsigned seed) {
  Draw draw(seed);
  for (auto& record : data.records) {
    for (Eigen::Index n = 0; n < record.outputs.rows(); ++n) {
      for (Eigen::Index i = 0; i < rms.size(); ++i) record.outputs(n, i) += rms(i) * draw.normal();
    }
  }
  return data;
}

ModalFit fit_of(const recordings::TimeData& data, const modal::ReducedModel& model) {
  recordings::FrfEstimateOptions options;
  options.drop = 0;
  options.low_hz = 5.0;
  options.high_hz = 100.0;
  const auto set = without_delay(frf_estimate(data, options).set, 0.0, data.sample_time_s);
  return modal_fit(fit_data(set), start_at(model), {.residual = true, .delay = true});
}

// Lines between which nothing changes count as one: of 24 000 lines the fit sees some hundreds.
TEST(ExpectedFit, KnowsAsMuchAsAFitOfAllLines) {
  const auto model = three_modes();
  const Eigen::VectorXd hz = Eigen::VectorXd::LinSpaced(24000, 5.0, 100.0);
  Eigen::MatrixXd variance(hz.size(), 4);
  for (Eigen::Index c = 0; c < 4; ++c) {
    variance.col(c) = 1e-12 * (1.0 + static_cast<double>(c)) * (1.0 + hz.array() / 50.0);
  }
  const auto few = expected_fit(model, hz, variance);
  const auto exact = modal::frf(model, hz);
  FitData data{.outputs = 2, .inputs = 2, .frequency_hz = hz, .value = {}, .weight = {}};
  data.value.resize(hz.size(), 4);
  for (Eigen::Index k = 0; k < hz.size(); ++k) {
    data.value.row(k) = exact.value[static_cast<std::size_t>(k)].reshaped().transpose();
  }
  data.weight = variance.cwiseSqrt().cwiseInverse();
  const auto all = modal_fit(data, start_at(model), {.residual = true, .delay = true});
  for (Eigen::Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(few.frequency_std_hz(k), all.frequency_std_hz(k), 1e-3 * all.frequency_std_hz(k));
    EXPECT_NEAR(few.damping_std(k), all.damping_std(k), 1e-3 * all.damping_std(k));
  }
}

// Such a period has hundreds of thousands of lines, and phases are not lowered on trial.
TEST(ExperimentDesign, OfLittleDampingHasALongPeriod) {
  auto model = three_modes();
  model.damping_ratio.setConstant(1e-5);
  auto plan = small_plan();
  plan.realisations = 1;
  plan.longest_period_s = 1024.0;
  const auto design = experiment_design(model_of(model), plan, 3);
  EXPECT_GE(design.period, 1 << 19);
  EXPECT_EQ(design.low_crest_factor, 0.0);
  for (const auto& mode : design.modes) EXPECT_GT(mode.frequency_std_hz, 0.0);
}

// The law of the design: the scatter over seeds is what was promised before any measurement.
TEST(ExperimentDesign, TheScatterIsTheExpectedDeviation) {
  const auto model = three_modes();
  const auto plan = small_plan();
  const auto design = experiment_design(model_of(model), plan, 3);
  ASSERT_EQ(design.modes.size(), 3U);
  double stroke = 0.0;
  double force = 0.0;
  const auto exact = played(rig_of(model, plan, false), design, &stroke, &force);
  constexpr int kSeeds = 120;
  Eigen::Matrix3Xd hz(3, kSeeds), ratio(3, kSeeds);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto fit =
        fit_of(with_noise(exact, plan.sensor_noise, 100 + static_cast<unsigned>(seed)), model);
    hz.col(seed) = fit.model.frequency_hz;
    ratio.col(seed) = fit.model.damping_ratio;
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto& expected = design.modes[static_cast<std::size_t>(k)];
    EXPECT_TRUE(expected.reached);
    EXPECT_LE(expected.damping_std, plan.damping_std);
    const double of_hz = std::sqrt((hz.row(k).array() - model.frequency_hz(k)).square().mean());
    const double of_ratio =
        std::sqrt((ratio.row(k).array() - model.damping_ratio(k)).square().mean());
    EXPECT_NEAR(of_hz / expected.frequency_std_hz, 1.0, 0.25) << k;
    EXPECT_NEAR(of_ratio / (expected.damping_std * expected.damping_ratio), 1.0, 0.25) << k;
  }
}

TEST(ExperimentDesign, KeepsTheLimitsOnTheRig) {
  const auto model = three_modes();
  for (const bool together : {false, true}) {
    for (const auto& [force_limit, stroke_limit] :
         {std::pair(2.0, kNoLimit), std::pair(kNoLimit, 1e-4), std::pair(1.0, 2e-4)}) {
      auto plan = small_plan();
      plan.scheme =
          together ? recordings::InputScheme::orthogonal : recordings::InputScheme::one_at_a_time;
      plan.force_limit_n = force_limit;
      plan.stroke_limit_m = stroke_limit;
      const auto design = experiment_design(model_of(model), plan, 1);
      double stroke = 0.0;
      double force = 0.0;
      (void)played(rig_of(model, plan, false), design, &stroke, &force);
      EXPECT_LE(force, force_limit);
      EXPECT_LE(stroke, stroke_limit);
      // One of them is used up to the margin.
      EXPECT_GT(std::max(force / force_limit, stroke / stroke_limit), 0.95 * plan.margin);
      // The steady state is foretold by a Fourier transform, the rig is stepped.
      EXPECT_NEAR(stroke / design.stroke_m.maxCoeff(), 1.0, 0.05);
    }
  }
}

// A mode at the frequency of its force, without noise: its envelope is off by no more than told
// when recording begins, though the force rises for a part of the time that settles.
TEST(ExperimentDesign, RecordsFromWhereTheStartHasSettled) {
  for (const double lines : {2.0, 2.95, 3.2, 4.0, 6.0}) {
    auto plan = small_plan();
    plan.lines_per_bandwidth = lines;
    const auto design = experiment_design(model_of(three_modes()), plan, 1);
    const double decay = std::numbers::pi * 0.84;  // of the slowest mode, 2 ζ f = 0.84 Hz
    const Eigen::MatrixXd rise =
        sequence(design, Eigen::MatrixXd::Ones(design.period, 1)).topRows(first_recorded(design));
    double left = 1.0;
    for (Eigen::Index n = 0; n < rise.rows(); ++n) {
      left = 1.0 - rise(n, 0) + (left - 1.0 + rise(n, 0)) * std::exp(-decay * plan.sample_time_s);
    }
    EXPECT_LT(left, 1.05e-4) << lines;
    EXPECT_TRUE(design.notes.empty()) << lines;
  }
}

TEST(ExperimentDesign, SaysWhatNeverSettles) {
  auto model = three_modes();
  model.frequency_hz(0) = 1.0;  // below the band
  model.damping_ratio(0) = 0.0;
  const auto design = experiment_design(model_of(model), small_plan(), 1);
  ASSERT_EQ(design.notes.size(), 1U);
  EXPECT_NE(design.notes.front().find("1 Hz has no damping"), std::string::npos);
}

TEST(ExperimentDesign, ResolvesTheNarrowestMode) {
  const auto design = experiment_design(model_of(three_modes()), small_plan(), 1);
  // 2 ζ f is 0.84, 1.15 and 2.31 Hz.
  EXPECT_NEAR(1.0 / design.period_s(), 0.84 / 4.0, 0.01);
  EXPECT_LE(1.0 / design.period_s(), 0.84 / 4.0);
  EXPECT_EQ(design.settle, 1);
  EXPECT_EQ(design.line_hz.size(), design.amplitude.rows());
}

// Odd lines lie two lines of the period apart.
TEST(ExperimentDesign, ResolvesTheNarrowestModeByOddLines) {
  const auto all = experiment_design(model_of(three_modes()), small_plan(), 1);
  EXPECT_EQ(all.spacing_hz, 1.0 / all.period_s());
  for (const auto lines :
       {recordings::ExcitedLines::odd, recordings::ExcitedLines::odd_with_detection}) {
    auto plan = small_plan();
    plan.lines = lines;
    const auto design = experiment_design(model_of(three_modes()), plan, 1);
    EXPECT_NEAR(design.spacing_hz, 0.84 / 4.0, 0.01);
    EXPECT_LE(design.spacing_hz, 0.84 / 4.0);
    const auto n = design.line_hz.size() - 1;
    EXPECT_NEAR((design.line_hz.tail(n) - design.line_hz.head(n)).minCoeff(), design.spacing_hz,
                1e-9);
  }
}

// A period that is too short is told by the lines that are excited.
TEST(ExperimentDesign, CountsTheLinesThatAreExcited) {
  auto plan = small_plan();
  plan.longest_period_s = 3.0;  // 0.84 Hz: 2.5 lines, of which every second one is odd
  EXPECT_TRUE(experiment_design(model_of(three_modes()), plan, 1).notes.empty());
  plan.lines = recordings::ExcitedLines::odd;
  const auto design = experiment_design(model_of(three_modes()), plan, 1);
  ASSERT_FALSE(design.notes.empty());
  const auto& note = design.notes.front();
  EXPECT_NE(note.find("has 1.3 lines in its half-power bandwidth: a period of 9.524 s"),
            std::string::npos)
      << note;
}

// Twice the noise needs four times the recording; deviations after one average are proportional.
// What the narrowest mode asks for has more samples than any integer.
TEST(ExperimentDesign, ItsPeriodHasAnEnd) {
  auto model = three_modes();
  model.damping_ratio(1) = 1e-25;
  auto plan = small_plan();
  plan.longest_period_s = 1e30;
  EXPECT_EQ(period_for(model, plan), 1 << 24);
}

TEST(ExperimentDesign, TimeGoesAsTheSquareOfTheNoise) {
  auto plan = small_plan();
  const auto quiet = experiment_design(model_of(three_modes()), plan, 1);
  plan.sensor_noise *= 2.0;
  const auto loud = experiment_design(model_of(three_modes()), plan, 1);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(loud.modes[k].seconds_needed / quiet.modes[k].seconds_needed, 4.0, 1e-3);
  }
}

TEST(ExperimentDesign, AShapedSpectrumNeedsLessTimeThanAnEvenOne) {
  auto plan = small_plan();
  plan.stroke_limit_m = kNoLimit;
  const auto design = experiment_design(model_of(three_modes()), plan, 1);
  EXPECT_GT(design.flat_seconds, 1.5 * design.shaped_seconds);
  // More force where modes may lie, some everywhere.
  EXPECT_GT(design.amplitude.minCoeff(), 0.0);
  EXPECT_GT(design.amplitude.maxCoeff(), 2.0 * design.amplitude.minCoeff());
}

TEST(ExperimentDesign, AmplitudesAreThoseOfTheSignals) {
  const auto design = experiment_design(model_of(three_modes()), small_plan(), 1);
  const auto lines = recordings::fourier(design.realisations.front().inputs.front());
  for (Eigen::Index k = 0; k < design.line_hz.size(); ++k) {
    const auto index = std::lround(design.line_hz(k) * design.period_s());
    EXPECT_NEAR(std::abs(lines(index, 0)) * 2.0 / static_cast<double>(design.period),
                design.amplitude(k, 0), 1e-9 * design.amplitude.maxCoeff());
  }
}

TEST(ExperimentDesign, SaysWhichModeNoActuatorMovesAndWhichNoSensorSees) {
  auto model = three_modes();
  model.input_shapes.row(1).setConstant(1e-4);
  model.output_shapes.col(2).setConstant(1e-4);
  const auto design = experiment_design(model_of(model), small_plan(), 1);
  EXPECT_TRUE(design.modes[0].reached);
  EXPECT_FALSE(design.modes[1].reached);
  EXPECT_EQ(design.modes[1].why, "no actuator moves it");
  EXPECT_EQ(design.modes[2].why, "no sensor sees it");
}

TEST(ExperimentDesign, SaysHowLongAModeWouldTake) {
  auto plan = small_plan();
  plan.longest_s = 150.0;
  plan.sensor_noise *= 10.0;
  const auto design = experiment_design(model_of(three_modes()), plan, 1);
  EXPECT_FALSE(design.modes[0].reached && design.modes[1].reached && design.modes[2].reached);
  for (const auto& mode : design.modes) {
    if (mode.reached) continue;
    EXPECT_NE(mode.why.find("of recording"), std::string::npos) << mode.why;
  }
  EXPECT_LE(design.duration_s, plan.longest_s);
}

TEST(ExperimentDesign, LowCrestGivesMoreForceUnderTheSameLimit) {
  auto plan = small_plan();
  plan.stroke_limit_m = kNoLimit;
  const auto random = experiment_design(model_of(three_modes()), plan, 1);
  plan.crest_iterations = 100;
  const auto low = experiment_design(model_of(three_modes()), plan, 1);
  EXPECT_LT(low.crest_factor, 0.75 * random.crest_factor);
  EXPECT_GT(low.forces[0].rms_n, 1.3 * random.forces[0].rms_n);
  EXPECT_NEAR(random.low_crest_factor, low.crest_factor, 0.3);
}

TEST(ExperimentDesign, TheSameSeedGivesTheSameSignals) {
  const auto first = experiment_design(model_of(three_modes()), small_plan(), 5);
  const auto second = experiment_design(model_of(three_modes()), small_plan(), 5);
  EXPECT_EQ(first.realisations[1].inputs[0], second.realisations[1].inputs[0]);
}

TEST(ExperimentDesign, RefusesWhatCannotBeMeant) {
  const auto refusal = [](DesignPlan plan, modal::ReducedModel model = three_modes()) {
    return refusal_of([&] { return experiment_design(model_of(std::move(model)), plan, 1); });
  };
  auto plan = small_plan();
  plan.force_limit_n = plan.stroke_limit_m = kNoLimit;
  EXPECT_NE(refusal(plan).find("nothing limits"), std::string::npos);
  plan = small_plan();
  plan.sensor_noise.setZero();
  EXPECT_NE(refusal(plan).find("no noise"), std::string::npos);
  plan = small_plan();
  plan.low_hz = 30.0;
  plan.high_hz = 40.0;
  EXPECT_NE(refusal(plan).find("no flexible mode between 30 and 40 Hz"), std::string::npos);
  plan.high_hz = 300.0;
  EXPECT_NE(refusal(plan).find("half the sampling frequency"), std::string::npos);
  auto model = three_modes();
  model.damping_ratio(1) = 0.0;
  EXPECT_NE(refusal(small_plan(), model).find("48 Hz has no damping"), std::string::npos);
}

}  // namespace
}  // namespace chladni::identification
