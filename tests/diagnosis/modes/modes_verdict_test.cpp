#include "diagnosis/modes/modes_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/calibration/coordinates.h"
#include "diagnosis/modes/proposals/outlook.h"
#include "diagnosis/modes/significance.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

TEST(PriorOfAPlace, IsAsWideAsTheSurfaceAlongEachAxis) {
  const Supposed mass{&effect("point_mass"), 0, Vector3d(0.1, 0.0, 0.0)};
  const auto prior = prior_of(small_plate(), {}, {mass});
  const auto parameters = mass.effect->parameters(small_plate());
  for (const Index i : {1, 2}) {
    const double precision = std::pow(prior_width(small_plate(), parameters[std::size_t(i)]), -2);
    EXPECT_NEAR(prior.precision(i), precision, 1e-9 * precision) << i;
  }
}

// A plate with a mass whose fourth mode has the shape of no other.
MeasuredModes with_a_strange_mode(double mass) {
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Vector3d(mass, 0.21, 0.08));
  auto measured = measured_of(modes_of(state), 0.02);
  simulators::Dice dice(9);
  const double size = measured.output_shapes.col(3).norm() /
                      std::sqrt(static_cast<double>(measured.output_shapes.rows()));
  const VectorXd strange = size * dice.normal(measured.output_shapes.rows(), 1);
  measured.output_shapes.col(3) = measured.output_shapes.col(3) + 1.2 * strange;
  return measured;
}

// One mode of a wrong shape is left without a partner, and hides nothing of the others.
TEST(ModesProblem, LeavesAModeAloneThatBelongsToNone) {
  const auto measured = with_a_strange_mode(1.2);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  ModesFit start;
  start.causes.push_back({&effect("point_mass"), 0, Vector3d(1.0, 0.2, 0.1)});
  const auto fit = problem.fitted(start);
  EXPECT_EQ(fit.matching.model[3], -1);
  for (std::size_t i = 0; i < fit.matching.model.size(); ++i) {
    if (i == 3) continue;
    EXPECT_GE(fit.matching.model[i], 0) << i;
  }
  ModesFit paired = fit;
  paired.matching = problem.matchings(fit.model).front();
  ASSERT_GE(paired.matching.model[3], 0);
  EXPECT_LT(problem.fitted(paired, 1).log_evidence, fit.log_evidence);
}

// The plate with a light thing that hangs on it and splits its sixth mode in two.
MeasuredModes with_a_split_mode(double& hz) {
  const auto& plate = small_plate();
  hz = 1.01 * modes_of(state_of(plate)).frequency_hz(5);
  VectorXd x(5);
  x << std::log(3e-4 * plate.mass_kg), std::log(hz), std::log(8e-3), 0.21, 0.08;
  State state = state_of(plate);
  effect("resonator").apply(state, plate, 0, x);
  return measured_of(modes_of(state), 0.02);
}

// Its own grid of frequencies is coarser than the split mode is wide.
TEST(Searched, FindsALightResonatorByTheModeThatItSplits) {
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  const auto found = searched(problem, catalogue_of(DiagnosisOptions{}), 1, 8.0);
  ASSERT_FALSE(found.fits.empty());
  const auto& cause = found.fits.front().causes.front();
  ASSERT_EQ(cause.effect->name, "resonator");
  EXPECT_NEAR(std::exp(cause.x(1)), hz, 0.02 * hz);
  EXPECT_NEAR(cause.x(0), std::log(3e-4 * small_plate().mass_kg), 1.0);
}

// A spring gives a rigid body a mode whose frequency goes with its root. Equal shapes are a pair up
// to e^+-0.25 in frequency: of starts farther from each other than 1 in ln k none may reach it.
TEST(GridOf, HasASpringNearEachStiffness) {
  const auto& spring = effect("ground_spring");
  const VectorXd hz = modes_of(state_of(small_plate())).frequency_hz.head(6);
  std::vector<double> sizes;
  for (const auto& start : grid_of(small_plate(), spring, hz, StartSizes::near)) {
    sizes.push_back(start.x(0));
  }
  std::ranges::sort(sizes);
  const auto parameter = spring.parameters(small_plate()).front();
  EXPECT_LT(sizes.front(), parameter.centre - parameter.width);
  EXPECT_GT(sizes.back(), parameter.centre + 3.0 * parameter.width);
  for (std::size_t i = 1; i < sizes.size(); ++i) EXPECT_LT(sizes[i] - sizes[i - 1], 1.0) << i;
}

// Where two modes turn into each other a step that lowers the misfit may raise the objective.
TEST(ModesProblem, ASecondFitLosesNothing) {
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  const auto fitted_from = [&](double part, double at_hz, double damping, double u, double v) {
    ModesFit start;
    VectorXd x(5);
    x << std::log(part * small_plate().mass_kg), std::log(at_hz), std::log(damping), u, v;
    start.causes.push_back({&effect("resonator"), 0, x});
    return problem.fitted(start);
  };
  const double truth = fitted_from(3e-4, hz, 8e-3, 0.21, 0.08).log_evidence;
  EXPECT_GT(truth, problem.nothing().log_evidence + 8.0);
  double best = -HUGE_VAL;
  for (const double off : {0.97, 0.99, 1.0, 1.01, 1.03}) {
    const auto first = fitted_from(1e-3, off * hz, 0.02, 0.18, 0.06);
    EXPECT_GT(problem.fitted(first).log_evidence, first.log_evidence - 0.3) << off;
    best = std::max(best, first.log_evidence);
  }
  EXPECT_GT(best, truth - 1.0);
}

// The covariance changes at once where a mode is split: steps that count the misfit alone creep
// there, and starts near the truth ended up to 19 below it.
TEST(ModesProblem, NearStartsEndAtOneMaximum) {
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  for (const double part : {1e-4, 3e-4, 1e-3}) {
    for (const double off : {-0.02, 0.0, 0.02}) {
      ModesFit start;
      VectorXd x(5);
      x << std::log(part * small_plate().mass_kg), std::log(hz) + 0.3 * off, std::log(8e-3),
          0.21 + off, 0.08 - off;
      start.causes.push_back({&effect("resonator"), 0, x});
      const double found = problem.fitted(start).log_evidence;
      least = std::min(least, found);
      most = std::max(most, found);
    }
  }
  EXPECT_LT(most - least, 1.5);
}

// A pair is no better than its own parts allow: each cause of it stands by itself among the fits.
TEST(Searched, KeepsThePartsOfItsPairs) {
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Vector3d(0.6, 0.21, 0.08));
  effect("sensor_gain").apply(state, small_plate(), 2, VectorXd::Constant(1, 0.4));
  const auto measured = measured_of(modes_of(state), 0.02);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  DiagnosisOptions options;
  options.only = {"point_mass", "sensor_gain", "youngs_modulus"};
  const auto found = searched(problem, catalogue_of(options), 2, 8.0);
  const auto pair =
      std::ranges::find_if(found.fits, [](const ModesFit& fit) { return fit.causes.size() == 2; });
  ASSERT_NE(pair, found.fits.end());
  for (const auto& cause : pair->causes) {
    const bool is_alone = std::ranges::any_of(found.fits, [&](const ModesFit& fit) {
      return fit.causes.size() == 1 && alike(small_plate(), fit.causes.front(), cause);
    });
    EXPECT_TRUE(is_alone) << cause.effect->name;
  }
}

// What takes more stiffness than there is foretells nothing, and stops nothing.
TEST(Explained, LeavesOutWhatNoBodyIsLike) {
  const auto measured = measured_of(modes_of(state_of(small_plate())), 0.02);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, false);
  const auto nothing = problem.nothing();
  Effect impossible = effect("density");
  impossible.apply = [](State&, const Structure&, Index, const VectorXd&) {
    throw NumericalFailure("a place of the body loses more stiffness than it has");
  };
  ModesFit fit = nothing;
  fit.causes = {{&impossible, 0, VectorXd::Constant(1, 0.1)}};
  const auto question = question_of(problem, nothing);
  EXPECT_EQ(explained(question, {{&nothing, 0.5}, {&fit, 0.5}}).size(), 1U);
}

// Fits of the plate with made-up evidence.
class Answer : public testing::Test {
 protected:
  Answer() : problem_(small_plate(), measured_, Tolerances{}, false) {
    found_.nothing = problem_.nothing();
    found_.effects = 20.0;
  }
  [[nodiscard]] Supposed mass(double u = 0.2) const {
    return {&effect("point_mass"), 0, Vector3d(0.3, u, 0.1)};
  }
  [[nodiscard]] Supposed general() const {
    return {&effect("mass_with_inertia"), 0, Eigen::Vector4d(0.3, std::log(0.01), 0.2, 0.1)};
  }
  [[nodiscard]] static Supposed gain(Index of) {
    return {&effect("sensor_gain"), of, VectorXd::Constant(1, 0.2)};
  }
  void add(const std::vector<Supposed>& causes, double gain) {
    ModesFit fit = found_.nothing;
    fit.causes = causes;
    Index n = 0;
    for (const auto& cause : causes) n += cause.x.size();
    fit.covariance = 1e-4 * MatrixXd::Identity(n, n);
    fit.log_evidence = found_.nothing.log_evidence + gain;
    found_.fits.push_back(std::move(fit));
  }
  [[nodiscard]] Diagnosis told() {
    std::ranges::stable_sort(found_.fits, std::ranges::greater{}, &ModesFit::log_evidence);
    return answer(problem_, found_, DiagnosisOptions{});
  }
  MeasuredModes measured_ = measured_of(modes_of(state_of(small_plate())), 0.02);
  ModesProblem problem_;
  ModesFound found_;
};

TEST_F(Answer, GivesTheWeightOfAGeneralCauseToItsSimplerCase) {
  add({mass()}, 30.0);
  add({gain(1)}, 30.0);
  const auto even = told();
  EXPECT_NEAR(even.best.probability, 0.5, 1e-6);
  add({general()}, 31.0);
  add({general()}, 31.0);  // the same maximum from another start
  const auto more = told();
  ASSERT_EQ(more.best.causes.size(), 1U);
  EXPECT_EQ(more.best.causes.front().effect, "point_mass");
  EXPECT_NEAR(more.best.probability, (1.0 + std::exp(1.0)) / (2.0 + std::exp(1.0)), 1e-6);
}

// Neither is named, and which comes first is a matter of rounding errors.
TEST_F(Answer, SaysWhereTheOrderOfTheCausesIsNotCertain) {
  add({mass()}, 30.0);
  add({gain(1)}, 20.0);
  const auto says_so = [&](const Diagnosis& diagnosis) {
    return std::ranges::any_of(diagnosis.notes, [](const std::string& note) {
      return note.find("order of the causes is not certain") != std::string::npos;
    });
  };
  EXPECT_EQ(told().verdict, Verdict::named);
  EXPECT_FALSE(says_so(told()));
  add({gain(1)}, 29.5);
  EXPECT_EQ(told().verdict, Verdict::ambiguous);
  EXPECT_TRUE(says_so(told()));
}

TEST_F(Answer, CountsAPairThatIsNotSupportedAmongTheRivals) {
  add({mass()}, 30.0);
  EXPECT_EQ(told().verdict, Verdict::named);
  // The pair explains more than the mass, without it.
  add({gain(1), gain(2)}, 37.0);
  const auto doubt = told();
  EXPECT_EQ(doubt.verdict, Verdict::ambiguous);
  for (const auto& explanation : doubt.rivals) {
    for (const auto& cause : explanation.causes) {
      if (cause.effect != "point_mass") continue;
      EXPECT_LT(cause.probability, 0.2);
    }
  }
}

// A mass near a node beside a gain: where it is its size is certain, and wherever it may be it is
// not.
TEST_F(Answer, NamesNoCauseOfAnUnclearSizeBesideAnother) {
  add({gain(1)}, 30.0);
  add({gain(1), mass()}, 50.0);
  auto found = told();
  EXPECT_EQ(found.best.causes.size(), 2U);
  EXPECT_EQ(found.verdict, Verdict::named);
  auto& pair = found_.fits.front();
  ASSERT_EQ(pair.causes.size(), 2U);
  pair.covariance(1, 1) = 0.04;                                       // the mass, 0.3 +- 0.2
  pair.covariance(1, 2) = pair.covariance(2, 1) = 0.99 * 0.2 * 0.01;  // with its place
  EXPECT_TRUE(is_significant(problem_, pair, 1, SizeDeviation::in_place));
  EXPECT_FALSE(is_significant(problem_, pair, 1, SizeDeviation::anywhere));
  pair.has_clear_sizes = have_clear_sizes(problem_, pair);
  EXPECT_FALSE(pair.has_clear_sizes);
  found = told();
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "sensor_gain");
  EXPECT_EQ(found.verdict, Verdict::partial) << "something more is there";
  ASSERT_FALSE(found.rivals.empty());
  ASSERT_EQ(found.rivals.front().causes.size(), 2U);
  EXPECT_LE(found.rivals.front().causes.back().probability, kConstants.beside_unnamed);
}

// It is told, since it explains more than another cause would.
TEST_F(Answer, NamesNoSingleCauseOfAnUnclearSize) {
  add({mass()}, 30.0);
  add({gain(1)}, 20.0);
  EXPECT_EQ(told().verdict, Verdict::named);
  auto& fit = found_.fits.front();
  fit.covariance(0, 0) = 0.04;                                      // the mass, 0.3 +- 0.2
  fit.covariance(0, 1) = fit.covariance(1, 0) = 0.99 * 0.2 * 0.01;  // with its place
  fit.has_clear_sizes = have_clear_sizes(problem_, fit);
  EXPECT_FALSE(fit.has_clear_sizes);
  const auto found = told();
  EXPECT_EQ(found.verdict, Verdict::ambiguous);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "point_mass");
  EXPECT_LE(found.best.causes.front().probability, kConstants.beside_unnamed);
  ASSERT_FALSE(found.rivals.empty());
  EXPECT_LT(found.rivals.front().causes.front().probability, 0.1);
}

// The stiffness that a patch adds is known, and so is its factor at any one radius.
TEST_F(Answer, NamesAPatchOfUnknownRadiusBesideAnotherCause) {
  const Supposed patch{&effect("local_stiffness"), 0,
                       Eigen::Vector4d(0.5, 0.1, 0.05, std::log(0.05))};
  add({gain(1)}, 30.0);
  add({gain(1), patch}, 50.0);
  auto& pair = found_.fits.back();
  pair.covariance(1, 1) = 0.09;  // 0.5 +- 0.3
  pair.covariance(4, 4) = 0.09;
  pair.covariance(1, 4) = pair.covariance(4, 1) = -0.99 * 0.09;
  EXPECT_TRUE(have_clear_sizes(problem_, pair));
}

TEST_F(Answer, NamesACauseBesideOneThatIsNotSupported) {
  add({mass()}, 30.0);
  add({mass(), gain(1)}, 37.0);
  const auto found = told();
  EXPECT_EQ(found.verdict, Verdict::named);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "point_mass");
  EXPECT_GT(found.best.causes.front().probability, 0.99);
  ASSERT_FALSE(found.rivals.empty());
  EXPECT_EQ(found.rivals.front().causes.size(), 2U);
}

// That a mode is not believed is no part of a pair.
TEST_F(Answer, DoesNotPutADisturbanceBeforeAPairThatIsNotSupported) {
  add({mass()}, 12.0);
  add({mass(), gain(1)}, 19.0);
  ModesFit disturbed = found_.nothing;
  disturbed.disturbed = {Disturbed::What::mode, 2};
  disturbed.log_evidence += 13.0;
  found_.disturbed.push_back(std::move(disturbed));
  const auto found = told();
  EXPECT_NE(found.verdict, Verdict::unexplained);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "point_mass");
}

// A mode that a string splits explained 8 in ln evidence if it is not believed, at 0.50.
TEST_F(Answer, IsNotUnexplainedByAModeThatIsDoubtedALittle) {
  ModesFit disturbed = found_.nothing;
  disturbed.disturbed = {Disturbed::What::mode, 2};
  disturbed.log_evidence -= 5.0;
  found_.disturbed.assign(16, disturbed);  // each mode and each channel was doubted
  found_.disturbed.back().log_evidence += 13.0;
  found_.evidence_power = 0.6;
  EXPECT_EQ(told().verdict, Verdict::no_discrepancy);
  found_.disturbed.back().log_evidence += 22.0;
  EXPECT_EQ(told().verdict, Verdict::unexplained);
}

// The sign of one channel is no simpler case of the gain of another.
TEST_F(Answer, NamesTheChannelThatItIs) {
  add({gain(2)}, 30.0);
  add({{&effect("sensor_sign"), 0, VectorXd(0)}}, 27.0);
  const auto found = told();
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "sensor_gain");
}

// A cause and a more general one beside it: the fit is not simpler than itself.
TEST_F(Answer, TellsAPairOfACauseAndAMoreGeneralOne) {
  const Supposed sign{&effect("sensor_sign"), 0, VectorXd(0)};
  add({sign}, 20.0);
  add({sign, gain(2)}, 40.0);
  const auto channels = told();
  EXPECT_EQ(channels.verdict, Verdict::named);
  EXPECT_EQ(channels.best.causes.size(), 2U);
  found_.fits.clear();
  add({mass()}, 20.0);
  add({mass(), general()}, 40.0);
  EXPECT_EQ(told().best.causes.size(), 2U);
}

TEST_F(Answer, NamesAPairThatIsSupported) {
  add({mass()}, 30.0);
  add({gain(1)}, 12.0);
  add({mass(), gain(1)}, 43.0);
  const auto found = told();
  EXPECT_EQ(found.verdict, Verdict::named);
  EXPECT_EQ(found.best.causes.size(), 2U);
}

// Modes have no misfit over frequency that a bad mode could be a part of.
TEST_F(Answer, TellsNoPartOfAMisfitForAModeThatIsNotBelieved) {
  ModesFit disturbed = found_.nothing;
  disturbed.disturbed = {Disturbed::What::mode, 2};
  disturbed.log_evidence += 30.0;
  found_.disturbed.push_back(std::move(disturbed));
  const auto found = told();
  ASSERT_TRUE(found.superclass);
  EXPECT_EQ(found.superclass->name, mode_name(measured_, 2));
  EXPECT_TRUE(std::isnan(found.superclass->explained)) << found.superclass->explained;
}

}  // namespace
}  // namespace chladni::diagnosis
