// How well noise that nobody states is estimated: against records whose noise is known.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "identification/fit_data.h"
#include "identification/identified.h"
#include "simulators/frf_cases.h"
#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

// White noise of accelerometers: of receptances it falls with the square of the frequency.
void whiten_as_acceleration(FrfCase& made, double part, unsigned seed) {
  simulators::Dice dice(seed);
  auto& set = made.measured;
  for (Eigen::Index j = 0; j < set.input_count(); ++j) {
    for (Eigen::Index i = 0; i < set.output_count(); ++i) {
      double square = 0.0;
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        const double w = set.frequency_hz(static_cast<Eigen::Index>(k));
        square += std::norm(made.exact[k](i, j) * w * w) / static_cast<double>(set.value.size());
      }
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        const double w = set.frequency_hz(static_cast<Eigen::Index>(k));
        const double deviation = part * std::sqrt(square) / (w * w);
        set.value[k](i, j) =
            made.exact[k](i, j) +
            deviation * std::sqrt(0.5) * std::complex<double>(dice.normal(), dice.normal());
        set.variance[k](i, j) = deviation * deviation;
      }
    }
  }
}

// Geometric mean over all lines and responses of the estimated deviation over the true one, to
// which the error that a model may have is added.
double deviation_ratio(const FitData& data, const FrfCase& made, double model_error) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < data.line_count(); ++k) {
    const auto line = static_cast<std::size_t>(k);
    for (Eigen::Index e = 0; e < data.response_count(); ++e) {
      const auto i = e % data.outputs;
      const auto j = e / data.outputs;
      const double truth = std::hypot(std::sqrt(made.measured.variance[line](i, j)),
                                      model_error * std::abs(made.exact[line](i, j)));
      sum -= std::log(data.weight(k, e) * truth);
    }
  }
  return std::exp(sum / static_cast<double>(data.weight.size()));
}

struct Estimate {
  double deviation = 0.0;  // over the true one
  double cost = 0.0;       // over what noise alone is expected to leave
};

// As the program does: from the data, then from what the first fit leaves.
Estimate noise_estimated(const FrfCase& made, double model_error) {
  auto set = made.measured;
  set.variance.clear();
  FitDataOptions options;
  options.model_error = model_error;
  auto data = fit_data(set, options);
  data = reweighted(data, responses(identified(data).fit, data.frequency_hz), options);
  const auto fit = identified(data).fit;
  return {deviation_ratio(data, made, model_error), fit.cost / fit.expected_cost};
}

FrfCase relative(double part) {
  FrfFaults faults;
  faults.relative_noise = part;
  return simulators::beam5x3(faults);
}

FrfCase of_accelerometers(double part) {
  auto made = relative(part);
  whiten_as_acceleration(made, part, 5);
  return made;
}

// A record of 5 % noise leaves what its noise leaves: estimates are 8 % low at most (a median of
// squares, and what a fit takes), never a third too high.
TEST(NoiseEstimate, IsThatOfTheRecord) {
  for (const auto& made :
       {relative(0.01), relative(0.05), of_accelerometers(0.01), of_accelerometers(0.05)}) {
    const auto found = noise_estimated(made, 0.0);
    EXPECT_NEAR(found.deviation, 0.99, 0.06);
    EXPECT_GT(found.cost, 1.0);
    EXPECT_LT(found.cost, 1.25);
  }
}

// What a study without variances assumes that a model is off by (1 %) is a part of the deviations,
// and no noise: where the noise is as small the cost is half of what is expected.
TEST(NoiseEstimate, HoldsTheErrorThatTheModelMayHave) {
  const auto found = noise_estimated(relative(0.01), 0.01);
  EXPECT_NEAR(found.deviation, 1.0, 0.06);
  EXPECT_NEAR(found.cost, 0.5, 0.05);
  const auto noisy = noise_estimated(of_accelerometers(0.05), 0.01);
  EXPECT_NEAR(noisy.deviation, 0.97, 0.06);
  EXPECT_GT(noisy.cost, 1.0);
}

// One response with noise of variance 1 and a mode whose half-power bandwidth is `width` lines.
struct NarrowRecord {
  modal::FrfSet set;
  Eigen::MatrixXcd exact;
};

NarrowRecord narrow_record(double width, double peak, unsigned seed) {
  constexpr Eigen::Index kLines = 121;
  simulators::Dice dice(seed);
  NarrowRecord made;
  made.set.outputs.resize(1);
  made.set.inputs.resize(1);
  made.set.outputs[0].name = "y";
  made.set.inputs[0].name = "u";
  made.set.frequency_hz = Eigen::VectorXd::LinSpaced(kLines, 100.0, 100.0 + kLines - 1.0);
  made.exact.resize(kLines, 1);
  for (Eigen::Index k = 0; k < kLines; ++k) {
    const double off = (static_cast<double>(k) - 60.3) / (0.5 * width);
    made.exact(k, 0) = peak / std::complex<double>(1.0, off);
    const std::complex<double> noise(dice.normal(), dice.normal());
    made.set.value.push_back(
        Eigen::MatrixXcd::Constant(1, 1, made.exact(k, 0) + std::sqrt(0.5) * noise));
  }
  return made;
}

// Mean over records of the estimated variance on each line; it is 1.
struct NarrowVariances {
  Eigen::VectorXd of_data, of_remainder;
};

NarrowVariances narrow_variances(double width, double peak) {
  constexpr unsigned kDraws = 100;
  NarrowVariances found;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const auto made = narrow_record(width, peak, seed);
    const auto data = fit_data(made.set);
    const auto again = reweighted(data, made.exact, {});
    if (seed == 1) found.of_data = found.of_remainder = Eigen::VectorXd::Zero(data.line_count());
    found.of_data += data.weight.col(0).cwiseAbs2().cwiseInverse() / kDraws;
    found.of_remainder += again.weight.col(0).cwiseAbs2().cwiseInverse() / kDraws;
  }
  return found;
}

// A resonance of one or two lines is no noise: not after a fit, however high it is, and before it
// not beyond a window of lines, nor by more than 2.5 times where it is 40 dB above the noise.
TEST(NoiseEstimate, IsNotBlownUpByAResonanceOfOneLine) {
  for (const double width : {1.0, 2.0}) {
    for (const double peak : {1e2, 1e4}) {
      const auto found = narrow_variances(width, peak);
      EXPECT_NEAR(found.of_remainder.minCoeff(), 1.0, 0.15) << width << " " << peak;
      EXPECT_NEAR(found.of_remainder.maxCoeff(), 1.0, 0.15) << width << " " << peak;
      EXPECT_LT(found.of_data.head(35).maxCoeff(), 1.3) << width << " " << peak;
      EXPECT_LT(found.of_data.tail(35).maxCoeff(), 1.3) << width << " " << peak;
      if (peak < 1e3) {
        EXPECT_LT(found.of_data.maxCoeff(), 2.5) << width;
      }
    }
  }
}

}  // namespace
}  // namespace chladni::identification
