#include "recordings/excitation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "base/error.h"
#include "base/turn.h"
#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

void check(const MultisinePlan& plan) {
  require(plan.period >= 4,
          "multisine: a period of " + fmt::to_string(plan.period) + " samples; expected 4 or more");
  require(std::isfinite(plan.sample_time_s) && plan.sample_time_s > 0.0,
          "multisine: the sample time is not positive");
  require(std::isfinite(plan.rms) && plan.rms > 0.0, "multisine: the rms is not positive");
  const double half = 0.5 / plan.sample_time_s;
  require(plan.low_hz >= 0.0 && plan.low_hz <= plan.high_hz && plan.high_hz <= half,
          "multisine: the band is " + fmt::format("{:.6g}", plan.low_hz) + " to " +
              fmt::format("{:.6g}", plan.high_hz) + " Hz; expected it ascending and below " +
              fmt::format("{:.6g}", half) + " Hz, half the sampling frequency");
  require(plan.shape.size() == plan.shape_hz.size(),
          "multisine: the shape has other sizes of frequencies and amplitudes");
  for (Eigen::Index i = 0; i < plan.shape.size(); ++i) {
    require(std::isfinite(plan.shape(i)) && plan.shape(i) > 0.0,
            "multisine: an amplitude of the shape is not positive");
    require(i == 0 || plan.shape_hz(i) > plan.shape_hz(i - 1),
            "multisine: the frequencies of the shape are not ascending");
  }
}

double amplitude_at(const MultisinePlan& plan, double hz) {
  const auto n = plan.shape.size();
  if (n == 0) return 1.0;
  const double* begin = plan.shape_hz.data();
  const Eigen::Index i = std::lower_bound(begin, begin + n, hz) - begin;
  if (i == 0) return plan.shape(0);
  if (i == n) return plan.shape(n - 1);
  const double t = (hz - plan.shape_hz(i - 1)) / (plan.shape_hz(i) - plan.shape_hz(i - 1));
  return std::exp((1.0 - t) * std::log(plan.shape(i - 1)) + t * std::log(plan.shape(i)));
}

struct Choice {
  std::vector<Eigen::Index> excited, left_out;
};

Choice lines_of(const MultisinePlan& plan) {
  Draw draw(plan.detection_seed);
  const double lines_per_hz = static_cast<double>(plan.period) * plan.sample_time_s;
  const double rounding = 1e-9 * static_cast<double>(plan.period);
  const auto first = std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(std::ceil(plan.low_hz * lines_per_hz - rounding)));
  const auto last = std::min<Eigen::Index>(
      (plan.period - 1) / 2,
      static_cast<Eigen::Index>(std::floor(plan.high_hz * lines_per_hz + rounding)));
  Choice choice;
  Eigen::Index odd_count = 0;
  Eigen::Index silent = 0;
  for (auto k = first; k <= last; ++k) {
    bool excite = plan.lines == ExcitedLines::all || k % 2 == 1;
    if (plan.lines == ExcitedLines::odd_with_detection && k % 2 == 1) {
      if (odd_count % 4 == 0) silent = static_cast<Eigen::Index>(std::floor(4.0 * draw.uniform()));
      excite = odd_count % 4 != silent;
      ++odd_count;
    }
    (excite ? choice.excited : choice.left_out).push_back(k);
  }
  require(!choice.excited.empty(), "multisine: no line between " +
                                       fmt::format("{:.6g}", plan.low_hz) + " and " +
                                       fmt::format("{:.6g}", plan.high_hz) + " Hz; the lines lie " +
                                       fmt::format("{:.6g}", 1.0 / lines_per_hz) + " Hz apart");
  return choice;
}

// Coefficients of the excited lines for the wanted rms: Σ 2|X|² = (N rms)².
Eigen::VectorXcd random_phases(const MultisinePlan& plan, const std::vector<Eigen::Index>& lines,
                               Draw& draw) {
  Eigen::VectorXcd result(static_cast<Eigen::Index>(lines.size()));
  const double step_hz = 1.0 / (static_cast<double>(plan.period) * plan.sample_time_s);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const double hz = static_cast<double>(lines[static_cast<std::size_t>(i)]) * step_hz;
    result(i) = std::polar(amplitude_at(plan, hz), kTwoPi * draw.uniform());
  }
  return result * (static_cast<double>(plan.period) * plan.rms / std::sqrt(2.0) / result.norm());
}

Eigen::VectorXd signal_of(const std::vector<Eigen::Index>& lines,
                          const Eigen::VectorXcd& coefficient, Eigen::Index period) {
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Zero(period / 2 + 1, 1);
  all(lines, 0) = coefficient;
  return inverse_fourier(all, period);
}

// Repeats: clip the signal, keep its new phases, restore the amplitudes. The best result is kept.
void lower_crest(const MultisinePlan& plan, Multisine& result) {
  Eigen::VectorXcd coefficient = result.coefficient;
  Eigen::VectorXd signal = result.signal;
  for (int i = 0; i < plan.crest_iterations; ++i) {
    const double clip = 0.85 * signal.cwiseAbs().maxCoeff();
    const Eigen::VectorXcd clipped =
        fourier(signal.cwiseMax(-clip).cwiseMin(clip))(result.lines, 0);
    for (Eigen::Index k = 0; k < coefficient.size(); ++k) {
      coefficient(k) = std::polar(std::abs(coefficient(k)), std::arg(clipped(k)));
    }
    signal = signal_of(result.lines, coefficient, plan.period);
    const double crest = crest_factor(signal);
    if (crest < result.crest_factor) {
      result.crest_factor = crest;
      result.coefficient = coefficient;
      result.signal = signal;
    }
  }
}

// ±1 (Sylvester) for a power of 2, else the roots of unity; W Wᴴ = q.
std::complex<double> orthogonal_entry(Eigen::Index row, Eigen::Index column, Eigen::Index q) {
  if (differ_in_sign_only(q)) {
    int bits = 0;
    for (auto both = row & column; both != 0; both >>= 1) bits += static_cast<int>(both & 1);
    return bits % 2 == 0 ? 1.0 : -1.0;
  }
  const auto turn = static_cast<double>((row * column) % q) / static_cast<double>(q);
  return std::polar(1.0, kTwoPi * turn);
}

}  // namespace

double crest_factor(const Eigen::Ref<const Eigen::VectorXd>& signal) {
  const double rms = signal.norm() / std::sqrt(static_cast<double>(signal.size()));
  return rms > 0.0 ? signal.cwiseAbs().maxCoeff() / rms : 0.0;
}

Multisine multisine(const MultisinePlan& plan, Draw& draw) {
  check(plan);
  auto choice = lines_of(plan);
  Multisine result;
  result.lines = std::move(choice.excited);
  result.detection = std::move(choice.left_out);
  result.coefficient = random_phases(plan, result.lines, draw);
  result.signal = signal_of(result.lines, result.coefficient, plan.period);
  result.crest_factor = crest_factor(result.signal);
  lower_crest(plan, result);
  return result;
}

bool differ_in_sign_only(Eigen::Index inputs) { return (inputs & (inputs - 1)) == 0; }

ExperimentSet experiments(const std::vector<MultisinePlan>& plans, InputScheme scheme, Draw& draw) {
  require(!plans.empty(), "multisine: no inputs to excite");
  const auto q = static_cast<Eigen::Index>(plans.size());
  const auto& first = plans.front();
  for (const auto& plan : plans) {
    check(plan);
    require(plan.period == first.period && plan.sample_time_s == first.sample_time_s &&
                plan.low_hz == first.low_hz && plan.high_hz == first.high_hz &&
                plan.lines == first.lines,
            "multisine: the inputs have different lines; expected one period, one band");
    require(scheme == InputScheme::one_at_a_time || plan.crest_iterations == 0 ||
                differ_in_sign_only(q),
            "multisine: the crest factor of orthogonal multisines of " + fmt::to_string(q) +
                " inputs cannot be lowered; expected 2, 4, 8, ... inputs, or one at a time");
  }
  const auto choice = lines_of(first);
  ExperimentSet result{.inputs = {}, .lines = choice.excited, .detection = choice.left_out};
  result.inputs.assign(plans.size(), Eigen::MatrixXd::Zero(first.period, q));
  for (Eigen::Index j = 0; j < q; ++j) {
    const auto& plan = plans[static_cast<std::size_t>(j)];
    Multisine own{.signal = {}, .lines = choice.excited, .detection = {}, .coefficient = {}};
    own.coefficient = random_phases(plan, choice.excited, draw);
    own.signal = signal_of(choice.excited, own.coefficient, plan.period);
    own.crest_factor = crest_factor(own.signal);
    lower_crest(plan, own);
    for (Eigen::Index e = 0; e < q; ++e) {
      if (scheme == InputScheme::one_at_a_time && e != j) continue;
      Eigen::VectorXd signal = own.signal;
      if (scheme == InputScheme::orthogonal) {
        signal =
            signal_of(choice.excited, own.coefficient * orthogonal_entry(j, e, q), plan.period);
      }
      result.crest_factor = std::max(result.crest_factor, crest_factor(signal));
      result.inputs[static_cast<std::size_t>(e)].col(j) = signal;
    }
  }
  return result;
}

ExperimentSet experiments(const MultisinePlan& plan, Eigen::Index inputs, InputScheme scheme,
                          Draw& draw) {
  require(inputs >= 1, "multisine: no inputs to excite");
  return experiments(std::vector<MultisinePlan>(static_cast<std::size_t>(inputs), plan), scheme,
                     draw);
}

}  // namespace chladni::recordings
