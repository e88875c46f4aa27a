// The answer of a diagnosis of modes to fits whose evidence is given.
#include "diagnosis/modes/modes_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/loaded_plate.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

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
  // Mode 2 is not believed.
  [[nodiscard]] ModesFit doubted(double gain) const {
    ModesFit fit = found_.nothing;
    fit.disturbed = {Disturbed::What::mode, 2};
    fit.log_evidence += gain;
    return fit;
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
  found_.disturbed.push_back(doubted(13.0));
  const auto found = told();
  EXPECT_NE(found.verdict, Verdict::unexplained);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "point_mass");
}

// A mode that a string splits explained 8 in ln evidence if it is not believed, at 0.50.
TEST_F(Answer, IsNotUnexplainedByAModeThatIsDoubtedALittle) {
  found_.disturbed.assign(15, doubted(-5.0));  // each mode and each channel was doubted
  found_.disturbed.push_back(doubted(8.0));
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
  found_.disturbed.push_back(doubted(30.0));
  const auto found = told();
  ASSERT_TRUE(found.superclass);
  EXPECT_EQ(found.superclass->name, mode_name(measured_, 2));
  EXPECT_TRUE(std::isnan(found.superclass->explained)) << found.superclass->explained;
}

}  // namespace
}  // namespace chladni::diagnosis
