// Whether a fit says how far it is to be trusted: a sound one always, a failed one never.
#include "identification/trust.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <random>
#include <string>

#include "base/error.h"
#include "identification/constants.h"
#include "rotation/turn.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;

modal::FrfSet trusted_beam(const FrfFaults& faults) {
  return part(simulators::beam5x3(faults), {0, 1, 4}, {0, 1}).measured;
}

Judgement judgement_of(const modal::FrfSet& set, bool stated, Damping damping = Damping::modal,
                       Eigen::Index modes = 0) {
  auto used = set;
  FitDataOptions how;
  if (!stated) {
    used.variance.clear();
    how.model_error = 0.01;
  }
  IdentificationOptions options;
  options.rigid_count = 0;
  options.modes = modes;
  options.fit.damping = damping;
  auto data = fit_data(used, how);
  auto found = identified(data, options);
  if (!stated) {  // as the program does
    data = reweighted(data, responses(found.fit, data.frequency_hz), how);
    found = identified(data, options);
  }
  if (found.drift) data = without_drift(data, found.fit, found.drift->shift);
  return judged(found, data, options);
}

std::string told(const Judgement& judgement) {
  std::string text = word(judgement.trust);
  for (const auto& reason : judgement.reasons) text += "; " + reason;
  return text;
}

// No sound record of many is refused, none has an outlying value.
TEST(Trust, NeverDoubtsASoundFit) {
  EVERY_FOURTH_LANDING();
  for (unsigned seed = 1; seed <= 40; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    faults.relative_noise = seed % 2 == 0 ? 0.01 : 0.1;
    faults.floor_noise = seed % 3 == 0 ? 0.3 : 0.0;
    const auto set = trusted_beam(faults);
    const auto known = judgement_of(set, true);
    EXPECT_EQ(known.trust, Trust::to_noise) << seed << ": " << told(known);
    EXPECT_TRUE(known.outlying.empty()) << seed;
    if (seed > 15) continue;
    const auto estimated = judgement_of(set, false);
    EXPECT_NE(estimated.trust, Trust::none) << seed << ": " << told(estimated);
    EXPECT_TRUE(estimated.outlying.empty()) << seed;
  }
}

// The responses of one sensor times a factor, as in another unit.
modal::FrfSet in_unit(modal::FrfSet set, Eigen::Index sensor, double factor) {
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k].row(sensor) *= factor;
    set.variance[k].row(sensor) *= factor * factor;
  }
  return set;
}

ModalFit in_unit(ModalFit fit, Eigen::Index sensor, double factor) {
  fit.model.output_shapes.row(sensor) *= factor;
  fit.model.residual.row(sensor) *= factor;
  fit.output_std.row(sensor) *= factor;
  for (auto& covariance : fit.mode_covariance) {
    covariance.row(2 + sensor) *= factor;
    covariance.col(2 + sensor) *= factor;
  }
  return fit;
}

// A sensor that is noise alone, or is measured far from most resonances, counts the same in any
// unit: what is unexplained was that of the largest numbers, 33 % or nothing.
TEST(Trust, DoesNotTurnOnTheUnitOfASensor) {
  for (const bool noise : {true, false}) {
    const auto made = part(simulators::beam5x3({}), {0, 1, 4}, {0, 1});
    auto set = made.measured;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (Eigen::Index k = 0; k < set.line_count(); ++k) {
      auto row = set.value[static_cast<std::size_t>(k)].row(2);
      const double size = row.cwiseAbs().mean();
      for (auto& value : row) {
        if (noise) value = size * std::complex<double>(normal(random), normal(random));
      }
      if (!noise && set.frequency_hz(k) < 150.0) row.setConstant(std::nan(""));
    }
    Identified found;
    found.fit = modal_fit(fit_data(set), start_at(made.truth));
    const auto own = judged(found, fit_data(set), std::nullopt);
    EXPECT_EQ(own.trust == Trust::none, noise) << told(own);
    for (const double factor : {1e-6, 1e6}) {
      Identified scaled;
      scaled.fit = in_unit(found.fit, 2, factor);
      const auto other = judged(scaled, fit_data(in_unit(set, 2, factor)), std::nullopt);
      EXPECT_EQ(other.trust, own.trust) << factor << ": " << told(other) << " / " << told(own);
      EXPECT_EQ(other.doubtful.size(), own.doubtful.size()) << factor;
      EXPECT_NEAR(other.unexplained, own.unexplained, 1e-9) << factor;
    }
  }
}

// Weights of 1/|G| are no deviations: nothing of what such a fit leaves is noise.
TEST(Trust, TakesNoWeightsForNoise) {
  FrfFaults faults;
  faults.relative_noise = 2e-3;
  const auto set = trusted_beam(faults);
  FitDataOptions how;
  how.weighting = Weighting::inverse_magnitude;
  const auto data = fit_data(set, how);
  for (const Eigen::Index modes : {1, 0}) {
    IdentificationOptions options;
    options.rigid_count = 0;
    options.modes = modes;
    const auto found = identified(data, options);
    const auto judgement = judged(found, data, options);
    const Eigen::ArrayXXd left = (data.value - responses(found.fit, data.frequency_hz)).cwiseAbs2();
    const Eigen::ArrayXXd all = data.value.cwiseAbs2();
    EXPECT_NEAR(judgement.unexplained, (left.colwise().sum() / all.colwise().sum()).mean(), 1e-12);
    EXPECT_EQ(judgement.trust == Trust::none, modes == 1) << told(judgement);
  }
}

// Nor do they say what noise is: an error of a tenth that neighbouring lines share is none, noise
// of a tenth is.
TEST(Trust, TellsASmoothErrorFromNoiseWithoutVariances) {
  FitDataOptions how;
  how.weighting = Weighting::inverse_magnitude;
  IdentificationOptions options;
  options.modes = 5;
  for (const bool smooth : {true, false}) {
    FrfFaults faults;
    faults.relative_noise = smooth ? 1e-3 : 0.1;
    auto set = trusted_beam(faults);
    for (std::size_t k = 0; smooth && k < set.value.size(); ++k) {
      const double hz = set.frequency_hz(static_cast<Eigen::Index>(k));
      set.value[k] *= 1.0 + 0.15 * std::sin(hz / 0.7);
    }
    const auto data = fit_data(set, how);
    const auto found = identified(data, options);
    const auto judgement = judged(found, data, std::nullopt);
    EXPECT_GT(judgement.relative_error, 0.03);
    EXPECT_LT(judgement.relative_error, 0.3);
    EXPECT_LT(judgement.level, Constants::good_level);  // of 1/|G|: no multiple of a noise
    EXPECT_EQ(judgement.trust, smooth ? Trust::systematic : Trust::good) << told(judgement);
  }
}

TEST(Trust, SaysThatWhatIsLeftIsMoreThanNoise) {
  FrfFaults faults;
  faults.dashpot =
      0.03;  // complex modes; from 0.07 on the kernel of the BLAS decides how bad it is
  faults.relative_noise = 2e-3;
  const auto real = judgement_of(trusted_beam(faults), true);
  EXPECT_EQ(real.trust, Trust::systematic) << told(real);
  EXPECT_GT(real.level, 2.0);
  const auto complex = judgement_of(trusted_beam(faults), true, Damping::general);
  EXPECT_EQ(complex.trust, Trust::to_noise) << told(complex);
}

// Where a dashpot couples the modes real shapes invent some; a fit with complex ones says how many
// there are. Where nothing couples them they are not proposed.
TEST(Trust, ProposesComplexShapesWhereADashpotCouplesTheModes) {
  EVERY_FOURTH_LANDING();
  // Real shapes leave twice the noise beside the least, complex ones the noise.
  for (const double dashpot : {0.008, 0.03, 0.1, 0.3}) {
    FrfFaults faults;
    faults.dashpot = dashpot;
    faults.relative_noise = 2e-3;
    const auto set = trusted_beam(faults);
    const auto real = judgement_of(set, true);
    ASSERT_TRUE(real.with_complex_shapes.has_value()) << dashpot << ": " << told(real);
    EXPECT_EQ(real.with_complex_shapes->modes, 5) << dashpot;
    EXPECT_LT(real.with_complex_shapes->level, 1.1) << dashpot;
    EXPECT_FALSE(judgement_of(set, true, Damping::general).with_complex_shapes) << dashpot;
  }
}

// The modes that real shapes invent stay near the lines. One that ran to 0.00065 Hz had residues
// that no line determines, and the identification failed with infinite ones.
TEST(Trust, InventedModesStayNearTheLines) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    FrfFaults faults;
    faults.dashpot = 0.3;
    faults.relative_noise = 1e-3;
    faults.seed = seed;
    const auto data = fit_data(trusted_beam(faults), {});
    IdentificationOptions options;
    options.rigid_count = 0;
    const auto found = identified(data, options);
    EXPECT_GT(10.0 * found.fit.model.frequency_hz.minCoeff(), data.frequency_hz(0)) << seed;
    EXPECT_LT(found.fit.model.frequency_hz.maxCoeff(),
              10.0 * data.frequency_hz(data.line_count() - 1))
        << seed;
  }
}

TEST(Trust, ProposesNoComplexShapesForWhatTheyDoNotExplain) {
  FrfFaults faults;
  EXPECT_FALSE(judgement_of(trusted_beam(faults), true).with_complex_shapes);
  faults.relative_noise = 2e-3;
  const auto few = judgement_of(trusted_beam(faults), true, Damping::modal, 3);
  EXPECT_FALSE(few.with_complex_shapes) << told(few);
}

TEST(Trust, RefusesWhatOneCellDecides) {
  int judged_at_all = 0;
  int named = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const double size : {1e3, 1e12}) {
      for (const bool stated : {true, false}) {
        FrfFaults faults;
        faults.seed = seed;
        auto set = trusted_beam(faults);
        const std::size_t line = 150 + 100 * seed;
        set.value[line](1, 1) = size;
        try {
          const auto found = judgement_of(set, stated);
          EXPECT_EQ(found.trust, Trust::none)
              << seed << " " << size << " " << stated << told(found);
          ++judged_at_all;
          for (const auto& one : found.outlying) {
            EXPECT_EQ(one.line, static_cast<Eigen::Index>(line));
            EXPECT_EQ(one.response, 4);
            ++named;
          }
        } catch (const InvalidInput& e) {  // nothing stands out beside it: said, too
          EXPECT_NE(std::string(e.what()).find("no resonance"), std::string::npos) << e.what();
        }
      }
    }
  }
  EXPECT_GE(judged_at_all, 4);
  EXPECT_GE(2 * named, judged_at_all);
}

// Where the number of modes is not given thirty deviations are a mode of their own.
TEST(Trust, RefusesAModeThatOneValueIs) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    auto set = trusted_beam(faults);
    set.value[600](2, 0) *= 1.3;
    const auto found = judgement_of(set, true);
    EXPECT_EQ(found.trust, Trust::none) << seed << ": " << told(found);
    ASSERT_EQ(found.outlying.size(), 1U) << seed;
    EXPECT_EQ(found.outlying[0].line, 600);
    EXPECT_EQ(found.outlying[0].response, 2);
  }
}

TEST(Trust, NamesAValueThatIsOffAndKeepsTheFit) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    auto set = trusted_beam(faults);
    set.value[600](2, 0) *= 1.3;  // thirty deviations, between two resonances
    const auto found = judgement_of(set, true, Damping::modal, 5);
    EXPECT_NE(found.trust, Trust::none) << seed << ": " << told(found);
    ASSERT_EQ(found.outlying.size(), 1U) << seed;
    EXPECT_EQ(found.outlying[0].line, 600);
    EXPECT_EQ(found.outlying[0].response, 2);
    EXPECT_NEAR(found.outlying[0].residual, 30.0, 6.0);
  }
}

// A line whose values stand one column further on.
TEST(Trust, NamesALineThatIsShifted) {
  EVERY_FOURTH_LANDING();
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const bool stated : {true, false}) {
      FrfFaults faults;
      faults.seed = seed;
      auto set = trusted_beam(faults);
      const std::size_t line = 200 + 90 * seed;
      auto& value = set.value[line];
      const Eigen::MatrixXcd before = value;
      for (Eigen::Index e = 0; e < value.size(); ++e) {
        value.reshaped()(e) = before.reshaped()((e + 1) % value.size());
      }
      const auto found = judgement_of(set, stated);
      const auto there = std::count_if(
          found.outlying.begin(), found.outlying.end(),
          [&](const OutlyingValue& one) { return one.line == static_cast<Eigen::Index>(line); });
      EXPECT_GE(there, 2) << seed << " " << stated << ": " << told(found);
      EXPECT_EQ(there, std::ssize(found.outlying)) << seed << " " << stated;
    }
  }
}

TEST(Trust, RefusesResponsesThatAreAllOne) {
  auto set = trusted_beam({});
  for (auto& line : set.value) line.setOnes();
  for (auto& output : set.outputs) output.kind = modal::FrfKind::accelerance;
  try {
    const auto found = judgement_of(set, false);
    EXPECT_EQ(found.trust, Trust::none) << told(found);
  } catch (const NumericalFailure& e) {  // the same exit code
    EXPECT_NE(std::string(e.what()).find("constant"), std::string::npos) << e.what();
  } catch (const InvalidInput& e) {  // rounding is all that is left for a pole to explain
    EXPECT_NE(std::string(e.what()).find("no resonance"), std::string::npos) << e.what();
  }
}

// Constants of other sizes, and a plain slope: what a fit makes of them is its own error.
TEST(Trust, RefusesResponsesWithoutAPeak) {
  for (const double size : {1e-9, 1.0, 1e6}) {
    for (const double slope : {0.0, 0.3}) {
      auto set = trusted_beam({});
      const auto lines = static_cast<double>(set.line_count());
      for (auto& line : set.value) {
        const auto k = static_cast<double>(&line - set.value.data());
        line.setConstant(size * (1.0 + slope * k / lines));
      }
      for (auto& output : set.outputs) output.kind = modal::FrfKind::accelerance;
      try {
        EXPECT_EQ(judgement_of(set, false).trust, Trust::none) << size << ", " << slope;
      } catch (const NumericalFailure& e) {
        EXPECT_NE(std::string(e.what()).find("constant"), std::string::npos) << e.what();
      } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("no resonance"), std::string::npos) << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace chladni::identification
