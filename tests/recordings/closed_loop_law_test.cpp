// The loop of a wafer table: 4 sensors, 13 actuators of which the loop drives four, on a few lines
// where its sensitivity goes from -32 to +8 dB. Simulated line by line from the equations of the
// loop; nothing of the estimator is used for that.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <complex>
#include <vector>

#include "base/draw.h"
#include "base/turn.h"
#include "recordings/closed_loop.h"
#include "rotation/turn.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index kOutputs = 4, kInputs = 13, kControlled = 4, kLines = 8;
constexpr int kRealisations = 8, kPeriods = 2, kRepeats = 250;

Complex circular(Draw& draw) {
  const double real = draw.normal();
  const double imaginary = draw.normal();
  return std::sqrt(0.5) * Complex(real, imaginary);
}

Eigen::MatrixXcd circular(Eigen::Index rows, Eigen::Index columns, Draw& draw) {
  Eigen::MatrixXcd result(rows, columns);
  for (auto& value : result.reshaped()) value = circular(draw);
  return result;
}

Eigen::MatrixXcd unitary(Draw& draw) {
  return Eigen::HouseholderQR<Eigen::MatrixXcd>(circular(4, 4, draw)).householderQ();
}

// On each line the structure, and the loop as the sensitivity it is wanted to have: singular values
// from -32 dB on the first line to +8 dB on the last, directions of its own.
struct Loop {
  std::vector<Eigen::MatrixXcd> plant;        // 4×13
  std::vector<Eigen::MatrixXcd> sensitivity;  // 4×4: (1 + C G_c)⁻¹
  std::vector<Eigen::MatrixXcd> controller;   // 4×4: C
};

Loop loop() {
  Draw draw(11);
  Loop result;
  for (Eigen::Index k = 0; k < kLines; ++k) {
    result.plant.push_back(circular(kOutputs, kInputs, draw));
    result.plant.back().leftCols(kControlled) =
        unitary(draw) * Eigen::Vector4cd(1.0, 0.8, 0.6, 0.5).asDiagonal() * unitary(draw);
    const double level = -32.0 + 40.0 * static_cast<double>(k) / (kLines - 1);
    Eigen::VectorXcd size(kControlled);
    for (Eigen::Index a = 0; a < kControlled; ++a) {
      size(a) =
          std::pow(10.0, (level + (k == kLines - 1 ? -4.0 * static_cast<double>(a) : 0.0)) / 20.0);
    }
    result.sensitivity.emplace_back(unitary(draw) * size.asDiagonal() * unitary(draw));
    result.controller.emplace_back(
        (result.sensitivity.back().inverse() - Eigen::MatrixXcd::Identity(4, 4)) *
        result.plant.back().leftCols(kControlled).inverse());
  }
  return result;
}

// What one record shows on one line with references r: u_c = S (r_c − C G_n r_n − C v), u_n = r_n,
// y = G u + v, v the disturbance at the outputs.
struct Shown {
  Eigen::VectorXcd inputs, outputs;
};

Shown shown(const Loop& loop, std::size_t k, const Eigen::VectorXcd& r, const Eigen::VectorXcd& v) {
  const auto free = kInputs - kControlled;
  const Eigen::VectorXcd disturbed = loop.plant[k].rightCols(free) * r.tail(free) + v;
  Shown result{r, {}};
  result.inputs.head(kControlled) =
      loop.sensitivity[k] * (r.head(kControlled) - loop.controller[k] * disturbed);
  result.outputs = loop.plant[k] * result.inputs + v;
  return result;
}

// An experiment of one realisation: its phases, turned by a row of the Fourier matrix; a
// disturbance of its own in each period.
Spectra::Record experiment(const Loop& loop, const Eigen::MatrixXd& phase, int number, double noise,
                           Draw& draw) {
  Spectra::Record record{number, 0, {}, {}, {}};
  for (int p = 0; p < kPeriods; ++p) {
    Eigen::MatrixXcd y(kLines, kOutputs);
    Eigen::MatrixXcd u(kLines, kInputs);
    Eigen::MatrixXcd r(kLines, kInputs);
    for (Eigen::Index k = 0; k < kLines; ++k) {
      for (Eigen::Index j = 0; j < kInputs; ++j) {
        r(k, j) = std::polar(1.0, phase(k, j) + kTwoPi * static_cast<double>(number * j) / kInputs);
      }
      const auto one = shown(loop, static_cast<std::size_t>(k), r.row(k).transpose(),
                             noise * circular(kOutputs, 1, draw));
      y.row(k) = one.outputs.transpose();
      u.row(k) = one.inputs.transpose();
    }
    record.outputs.push_back(y);
    record.inputs.push_back(u);
    record.references.push_back(r);
  }
  return record;
}

// One repeat: some realisations of 13 experiments, phases drawn anew.
Spectra repeat(const Loop& loop, double noise, Draw& draw) {
  Spectra result;
  result.outputs = channels("y", kOutputs);
  result.inputs = channels("u", kInputs);
  result.references = channels("r", kInputs);
  result.sample_time_s = 1e-3;
  result.period = 1000;
  for (Eigen::Index k = 0; k < kLines; ++k) result.line.push_back(20 + k);
  for (int realisation = 0; realisation < kRealisations; ++realisation) {
    Eigen::MatrixXd phase(kLines, kInputs);
    for (double& value : phase.reshaped()) value = kTwoPi * draw.uniform();
    for (int e = 0; e < kInputs; ++e) {
      result.records.push_back(experiment(loop, phase, e, noise, draw));
      result.records.back().realisation = realisation;
    }
  }
  return result;
}

// Errors of an estimator over the repeats, with what it says of them.
struct Tally {
  std::vector<Eigen::MatrixXcd> error;                   // [k] sums
  std::vector<Eigen::MatrixXd> square, total, of_noise;  // [k] sums

  void add(const Loop& loop, const modal::FrfSet& set) {
    if (error.empty()) {
      error.assign(kLines, Eigen::MatrixXcd::Zero(kOutputs, kInputs));
      square.assign(kLines, Eigen::MatrixXd::Zero(kOutputs, kInputs));
      total = of_noise = square;
    }
    for (std::size_t k = 0; k < kLines; ++k) {
      const Eigen::MatrixXcd off = set.value[k] - loop.plant[k];
      error[k] += off;
      square[k] += off.cwiseAbs2();
      total[k] += set.variance[k];
      of_noise[k] += set.noise_variance[k];
    }
  }
  // Root mean square on a line, in deviations of one estimate; what a mean of so many is off by
  // itself is taken away.
  [[nodiscard]] double bias(std::size_t k) const {
    const Eigen::ArrayXXd mean = error[k].cwiseAbs2().array() / (kRepeats * kRepeats);
    const Eigen::ArrayXXd variance = (square[k].array() - kRepeats * mean) / (kRepeats - 1.0);
    return std::sqrt(std::max(0.0, (mean / variance).mean() - 1.0 / kRepeats));
  }
};

FrfEstimateOptions law_periods() {
  FrfEstimateOptions options;
  options.drop = 0;
  options.smooth_lines = 0;
  return options;
}

class ClosedLoopLaw : public testing::Test {
 protected:
  void SetUp() override {
    EVERY_FOURTH_LANDING();
    if (!indirect.error.empty()) return;
    const auto made = loop();
    Draw draw(5);
    for (int n = 0; n < kRepeats; ++n) {
      const auto data = repeat(made, kNoise, draw);
      const auto found = closed_loop_estimate(data, law_periods());
      indirect.add(made, found.estimate.set);
    }
  }
  static constexpr double kNoise = 0.02;
  static inline Tally indirect;
};

TEST(ClosedLoopOfATable, HasASensitivityOfFortyDecibels) {
  const auto made = loop();
  const auto first = made.sensitivity.front().norm();
  const auto largest = made.sensitivity.back().operatorNorm();
  EXPECT_NEAR(20.0 * std::log10(2.0 * largest / first), 40.0, 0.1);
}

TEST_F(ClosedLoopLaw, TheBiasIsBelowATenthOfADeviation) {
  for (std::size_t k = 0; k < kLines; ++k) EXPECT_LT(indirect.bias(k), 0.1) << k;
}

// Stated over found, on the mean of each line and of each input.
void expect_true(const std::vector<Eigen::MatrixXd>& stated,
                 const std::vector<Eigen::MatrixXd>& square, const char* what) {
  Eigen::ArrayXXd all = Eigen::ArrayXXd::Zero(kOutputs, kInputs);
  for (std::size_t k = 0; k < kLines; ++k) {
    const Eigen::ArrayXXd ratio = stated[k].array() / square[k].array();
    EXPECT_NEAR(ratio.mean(), 1.0, 0.1) << what << ", line " << k;
    all += ratio / static_cast<double>(kLines);
  }
  for (Eigen::Index j = 0; j < kInputs; ++j) {
    EXPECT_NEAR(all.col(j).mean(), 1.0, 0.1) << what << ", input " << j;
  }
}

TEST_F(ClosedLoopLaw, TheVarianceIsThatOfTheErrors) {
  expect_true(indirect.total, indirect.square, "of all");
  expect_true(indirect.of_noise, indirect.square, "of noise");
}

}  // namespace
}  // namespace chladni::recordings
