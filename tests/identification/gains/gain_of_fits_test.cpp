// From noisy responses to rows of sensors that are not there: fit, match, predict.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "gain_case.h"
#include "identification/fit_data.h"
#include "identification/gain_match.h"
#include "identification/gains/matched_sides.h"
#include "identification/gains/pair_evidence.h"
#include "identification/identified.h"
#include "modal/frf.h"

namespace chladni::identification {
namespace {

struct Extended {
  ModalFit fit;
  GainMatch match;
};

Extended extended(const simulators::FrfCase& made, const GainMatchOptions& options) {
  IdentificationOptions how;
  how.modes = made.truth.mode_count() - made.truth.rigid_count;
  how.rigid_count = made.truth.rigid_count;
  auto fit = identified(fit_data(made.measured), how).fit;
  auto match = matched(made, fit, options);
  return {std::move(fit), std::move(match)};
}

// Errors of the shapes over their deviations, each mode's sign set right.
Eigen::ArrayXXd errors_in_deviations(const Extended& found, const modal::ReducedModel& truth) {
  Eigen::MatrixXd known = truth_at(found.match, truth);
  for (Eigen::Index m = 0; m < known.cols(); ++m) {
    if (known.col(m).dot(found.match.shapes.col(m)) < 0.0) known.col(m) *= -1.0;
  }
  return (found.match.shapes - known).array() / found.match.deviation.array();
}

// Thesis 5.2.4 to 5.2.6 without a detour: from a fit that has converged the actuators' rows of the
// suspension modes are straight by themselves.
TEST(GainOfFits, TwoSensorsAndFourActuatorsMakeFiveRows) {
  double square = 0.0;
  double count = 0.0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    const auto made = two_by_four(faults);
    const auto found = extended(made, with_pairs(made));
    ASSERT_EQ(found.match.rows.size(), 5U);
    const auto errors = errors_in_deviations(found, made.truth);
    EXPECT_LT(errors.abs().maxCoeff(), 5.0) << seed;
    square += errors.square().sum();
    count += static_cast<double>(errors.size());
    const auto truth = truth_at(found.match, made.truth);
    const Eigen::MatrixXd off = found.match.shapes.cwiseAbs() - truth.cwiseAbs();
    EXPECT_LT((off.colwise().norm().array() / truth.colwise().norm().array()).maxCoeff(), 1.5e-3);
  }
  EXPECT_NEAR(std::sqrt(square / count), 1.0, 0.25);  // modes share their α: about 8 by 5 by 2
}

// The last row's responses, K×q.
Eigen::MatrixXcd last_row(const simulators::FrfCase& made, const ModalFit& fit) {
  const auto match = matched(made, fit, with_pairs(made));
  const auto frf = modal::frf(extended_model(fit, match), made.measured.frequency_hz);
  Eigen::MatrixXcd row(made.measured.line_count(), made.measured.input_count());
  for (Eigen::Index k = 0; k < row.rows(); ++k) {
    row.row(k) = frf.value[static_cast<std::size_t>(k)].row(match.rows.size() - 1);
  }
  return row;
}

// Expected norm of the error of the last row: the fit moved along all it is not certain of.
double expected_error(const simulators::FrfCase& made, const ModalFit& fit) {
  const Eigen::MatrixXcd middle = last_row(made, fit);
  const auto p = fit.model.output_count();
  double square = 0.0;
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
    const Eigen::MatrixXd factor =
        covariance_factor(fit.mode_covariance[static_cast<std::size_t>(m)]);
    for (Eigen::Index d = 0; d < factor.cols(); ++d) {
      auto moved = fit;
      moved.model.frequency_hz(m) += factor(0, d) / (2.0 * std::numbers::pi);
      moved.model.damping_ratio(m) += factor(1, d);
      moved.model.output_shapes.col(m) += factor.col(d).segment(2, p);
      moved.model.input_shapes.row(m) += factor.col(d).tail(factor.rows() - 2 - p).transpose();
      square += (last_row(made, moved) - middle).squaredNorm();
    }
  }
  return std::sqrt(square);
}

TEST(GainOfFits, PredictsEverySensorThatHasAnActuator) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    const auto whole = simulators::beam5x3(faults);
    for (const Eigen::Index left_out : {0, 2, 4}) {
      std::vector<Eigen::Index> kept;
      for (Eigen::Index i = 0; i < 5; ++i) {
        if (i != left_out) kept.push_back(i);
      }
      const auto made = part(whole, kept, {0, 1, 2});
      const auto found = extended(made, with_pairs(made));
      ASSERT_EQ(found.match.rows.size(), 5U);
      ASSERT_TRUE(found.match.rows[4].actuator);
      const Eigen::MatrixXcd row = last_row(made, found.fit);
      Eigen::MatrixXcd known(row.rows(), row.cols());
      for (Eigen::Index k = 0; k < row.rows(); ++k) {
        known.row(k) = whole.exact[static_cast<std::size_t>(k)].row(left_out);
      }
      const double expected = expected_error(made, found.fit);
      EXPECT_LT((row - known).norm(), 3.0 * expected) << left_out << " " << seed;
      EXPECT_LT(expected, 5e-3 * known.norm()) << left_out;
    }
  }
}

TEST(GainOfFits, FindGainsWithinTheirDeviations) {
  FrfFaults faults;
  faults.output_gain = Eigen::VectorXd{{1.0, 1.0, 0.905, 1.0, 1.1}};
  double square = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    faults.seed = seed;
    const auto made = simulators::beam5x3(faults);
    const auto found = extended(made, with_pairs(made));
    const double middle = std::cbrt(0.905 * 1.1);
    const Eigen::Vector3d known = Eigen::Vector3d(1.0, 0.905, 1.1) / middle;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto& gain = found.match.pairs[static_cast<std::size_t>(c)];
      EXPECT_LT(gain.ratio_std, 1e-3);
      EXPECT_LT(std::abs(gain.ratio - known(c)), 4.5 * gain.ratio_std);
      square += std::pow((gain.ratio - known(c)) / gain.ratio_std, 2) / 30.0;
    }
  }
  EXPECT_NEAR(std::sqrt(square), 1.0, 0.5);
}

TEST(GainOfFits, WeighTheTableByItsModesAtZero) {
  const auto made = simulators::oat4x13();
  GainMatchOptions options;
  options.geometry = geometry_of(made, RigidMotion::plate);
  const auto found = extended(made, options);
  ASSERT_TRUE(found.match.rigid.has_value());
  const double mass = 0.6 * 0.5988 * 2700.0 * 0.0149;
  const auto& body = *found.match.rigid;
  EXPECT_LT(std::abs(body.mass(0, 0) - mass), 4.0 * body.mass_std(0, 0));
  EXPECT_LT(body.mass_std(0, 0), 1e-3 * mass);
  EXPECT_LT(body.asymmetry, 1e-2);
  const Eigen::MatrixXd shapes = found.match.shapes.leftCols(3);
  const Eigen::MatrixXd known = truth_at(found.match, made.truth).leftCols(3);
  const Eigen::MatrixXd wanted = known * known.transpose();
  EXPECT_LT((shapes * shapes.transpose() - wanted).norm(), 1e-3 * wanted.norm());
}

// One mode that is blended at a pair is warned of, and pulls the gains of that pair no longer.
TEST(GainOfFits, LeavesOutOfTheGainsWhatTheOtherModesContradict) {
  const auto made = simulators::beam5x3();
  const auto options = with_pairs(made);
  const auto plain = extended(made, options);
  auto fit = plain.fit;
  fit.model.output_shapes(0, 3) *= 2.0;
  const auto match = matched(made, fit, options);
  for (std::size_t c = 0; c < match.pairs.size(); ++c) {
    const auto& gain = match.pairs[c];
    EXPECT_NEAR(gain.ratio, 1.0, 4.0 * gain.ratio_std) << c;
    EXPECT_NEAR(gain.ratio, plain.match.pairs[c].ratio, 2.0 * gain.ratio_std) << c;
    EXPECT_LT(gain.ratio_std, 2.0 * plain.match.pairs[c].ratio_std) << c;
  }
  const auto named = [](const std::string& text) {
    return text.find("y1/u1") != std::string::npos && text.find("disagrees") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(match.warnings, named));
}

// The last pair alone sees the last mode, and no other: nothing compares its gain with the others'.
// It is not known to be 1, and the mode's scale is as uncertain as the known gains scatter.
TEST(GainOfFits, IsNotKnownOfAPairThatNoModeComparesWithOthers) {
  const auto made = simulators::beam5x3(quiet());
  auto fit = true_fit(made);
  auto& model = fit.model;
  const auto last = model.mode_count() - 1;
  for (Eigen::Index m = 0; m <= last; ++m) {
    if (m < last) {
      model.output_shapes(4, m) = model.input_shapes(m, 2) = 0.0;
    } else {
      model.output_shapes(0, m) = model.output_shapes(2, m) = 0.0;
      model.input_shapes(m, 0) = model.input_shapes(m, 1) = 0.0;
    }
  }
  model.output_shapes.row(0) *= 1.2;
  model.output_shapes.row(2) /= 1.2;
  auto options = with_pairs(made);
  options.fault = GainFault::outputs;
  const auto match = matched(made, fit, options);
  ASSERT_EQ(match.pairs.size(), 3U);
  EXPECT_GE(match.pairs[0].modes, 2);
  EXPECT_NEAR(match.pairs[0].ratio, 1.2, 1e-6);
  EXPECT_NEAR(match.pairs[1].ratio, 1.0 / 1.2, 1e-6);
  EXPECT_EQ(match.pairs[2].modes, 0);
  EXPECT_EQ(match.pairs[2].ratio, 1.0);
  EXPECT_EQ(match.pairs[2].ratio_std, std::numeric_limits<double>::infinity());
  const double scatter = std::sqrt(2.0) * std::log(1.2);
  const auto& mode = match.modes[static_cast<std::size_t>(last)];
  EXPECT_EQ(mode.by, MatchedBy::pairs);
  EXPECT_NEAR(mode.alpha_std / mode.alpha, 0.5 * scatter, 0.05 * scatter);
  // The gain of one pair over that of all pairs is 1.
  options.pairs.resize(1);
  EXPECT_EQ(matched(made, fit, options).pairs[0].ratio_std, 0.0);
}

// Two pairs that some modes see, and two that the other modes see: nothing compares the gains of
// the ones with those of the others.
TEST(GainOfFits, IsNotKnownBetweenPairsThatNoModeCompares) {
  const auto made = part(simulators::beam5x5(quiet()), {0, 1, 3, 4}, {0, 1, 3, 4});
  const auto in_parts = [&](double gain_of_second) {
    auto fit = true_fit(made);
    for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
      const Eigen::Index unseen = m < 3 ? 2 : 0;
      fit.model.output_shapes.col(m).segment(unseen, 2).setZero();
      fit.model.input_shapes.row(m).segment(unseen, 2).setZero();
    }
    fit.model.output_shapes.row(0) *= 1.2;
    fit.model.output_shapes.row(1) /= 1.2;
    fit.model.output_shapes.middleRows(2, 2) *= gain_of_second;
    auto options = with_pairs(made);
    options.fault = GainFault::outputs;
    return matched(made, fit, options);
  };
  const auto match = in_parts(1.0);
  const auto other = in_parts(1.5);
  ASSERT_EQ(match.pairs.size(), 4U);
  const std::vector<double> ratios{1.2, 1.0 / 1.2, 1.0, 1.0};
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_GE(match.pairs[c].modes, 2) << c;
    EXPECT_EQ(match.pairs[c].part, c < 2 ? 0 : 1) << c;
    EXPECT_NEAR(match.pairs[c].ratio, ratios[c], 1e-6) << c;
    EXPECT_NEAR(other.pairs[c].ratio, ratios[c], 1e-6) << c;  // the data do not tell the 1.5
    EXPECT_EQ(match.pairs[c].ratio_std, std::numeric_limits<double>::infinity()) << c;
    EXPECT_LT(match.pairs[c].part_std, 0.01) << c;
  }
  const auto tells_parts = [](const std::string& text) {
    return text.find("between the parts is not known (y1/u1, y2/u2; y4/u4, y5/u5)") !=
           std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(match.warnings, tells_parts)) << match.warnings.back();
  // Each part has one freedom; the mean of two gains is off by the scatter over √2.
  const double scatter = std::log(1.2);
  const auto& mode = match.modes[0];
  EXPECT_NEAR(mode.alpha_std / mode.alpha, 0.5 * scatter / std::sqrt(2.0), 0.05 * scatter);
  EXPECT_NEAR(gain_scatter(match.pairs), scatter, 1e-6);
}

}  // namespace
}  // namespace chladni::identification
