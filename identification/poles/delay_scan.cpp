#include "identification/delay_scan.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/interrupt.h"
#include "base/search.h"
#include "base/turn.h"
#include "identification/constants.h"
#include "identification/likelihood/normal_equations.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {
namespace {

// Step of the scans [periods of the highest line].
constexpr double kScanStep =
    (Constants::delay_high - Constants::delay_low) / Constants::delay_intervals;

double highest_period(const FitData& data) {
  return 1.0 / data.frequency_hz(data.line_count() - 1);
}

// Responses of each delay.
std::vector<std::vector<Eigen::Index>> responses_of_delays(const FitData& data, DelayOf of) {
  const Fitted which{.delay = true, .delay_of = of};
  std::vector<std::vector<Eigen::Index>> all(
      static_cast<std::size_t>(which.delay_count(data.outputs, data.inputs)));
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    all[static_cast<std::size_t>(which.delay_index(e, data.outputs))].push_back(e);
  }
  return all;
}

// K: the sum of G² / |G|² of some responses, where they were measured.
Eigen::ArrayXcd squared_phases(const FitData& data, const std::vector<Eigen::Index>& responses) {
  Eigen::ArrayXcd sum = Eigen::ArrayXcd::Zero(data.line_count());
  for (const auto e : responses) {
    for (Eigen::Index k = 0; k < data.line_count(); ++k) {
      const double size = std::abs(data.value(k, e));
      if (!(data.weight(k, e) > 0.0) || !(size > 0.0)) continue;
      const std::complex<double> z = data.value(k, e) / size;
      sum(k) += z * z;
    }
  }
  return sum;
}

// The delay [s] under which Re Σ G² e^{2jωτ} / |G|² is largest.
double agreeing_delay(const FitData& data, const Eigen::ArrayXcd& squared) {
  const double period = highest_period(data);
  const double spacing = (data.frequency_hz(data.line_count() - 1) - data.frequency_hz(0)) /
                         static_cast<double>(data.line_count() - 1);
  const double range = std::min(0.5 / spacing, Constants::delay_reach * period);
  const double step = kScanStep * period;
  const Eigen::ArrayXd angle = 2.0 * kTwoPi * data.frequency_hz.array();
  const auto turns = [&](double delay) {
    return Eigen::ArrayXcd(
        angle.unaryExpr([delay](double a) { return std::polar(1.0, a * delay); }));
  };
  const Eigen::ArrayXcd further = turns(step);
  double best = Constants::delay_low * period;
  Eigen::ArrayXcd turned = squared * turns(best);
  double most = turned.real().sum();
  for (Eigen::Index n = 1; static_cast<double>(n) * step < range; ++n) {
    throw_if_interrupted();
    turned *= further;
    const double here = turned.real().sum();
    if (here <= most) continue;
    most = here;
    best = Constants::delay_low * period + static_cast<double>(n) * step;
  }
  return best;
}

}  // namespace

FitData undelayed(const FitData& data, double delay_s) {
  FitData result = data;
  const Eigen::VectorXd angle = 2.0 * std::numbers::pi * delay_s * data.frequency_hz;
  for (Eigen::Index k = 0; k < data.line_count(); ++k) {
    result.value.row(k) *= std::polar(1.0, angle(k));
  }
  return result;
}

FitData undelayed(const FitData& data, const Eigen::VectorXd& delay_s) {
  FitData result = data;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    for (Eigen::Index k = 0; k < data.line_count(); ++k) {
      result.value(k, e) *=
          std::polar(1.0, 2.0 * std::numbers::pi * delay_s(e) * data.frequency_hz(k));
    }
  }
  return result;
}

double scanned_delay(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  const double period = highest_period(data);
  const auto cost = [&](double periods) {
    return ResidueProblem(undelayed(data, periods * period), poles, rigid).residues().cost;
  };
  const auto best =
      lowest_of_scan(cost, Constants::delay_low, Constants::delay_high, Constants::delay_intervals);
  // The parabola through the least cost and its neighbours is enough: a fit refines the delay.
  const double before = cost(best.at - kScanStep);
  const double after = cost(best.at + kScanStep);
  const double curvature = before - 2.0 * best.value + after;
  const double shift = curvature > 0.0 ? 0.5 * kScanStep * (before - after) / curvature : 0.0;
  return (best.at + shift) * period;
}

Eigen::VectorXd scanned_delays(const FitData& data, const Eigen::VectorXcd& poles, bool rigid,
                               DelayOf of) {
  const auto responses = data.response_count();
  if (of == DelayOf::all) {
    return Eigen::VectorXd::Constant(responses, scanned_delay(data, poles, rigid));
  }
  Eigen::VectorXd result = Eigen::VectorXd::Zero(responses);
  for (const auto& own : responses_of_delays(data, of)) {
    FitData channel = data;
    channel.outputs = of == DelayOf::outputs ? 1 : data.outputs;
    channel.inputs = of == DelayOf::inputs ? 1 : data.inputs;
    channel.value = data.value(Eigen::all, own);
    channel.weight = data.weight(Eigen::all, own);
    if (channel.measured_count() > 0) result(own).setConstant(scanned_delay(channel, poles, rigid));
  }
  return result;
}

Eigen::VectorXd phase_delays(const FitData& data, DelayOf of, const Progress& progress) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(data.response_count());
  const auto delays = responses_of_delays(data, of);
  for (std::size_t n = 0; n < delays.size(); ++n) {
    tell(progress, "delays", static_cast<double>(n) / static_cast<double>(delays.size()));
    const auto squared = squared_phases(data, delays[n]);
    if ((squared != 0.0).any()) result(delays[n]).setConstant(agreeing_delay(data, squared));
  }
  return result;
}

void put_back(const Eigen::VectorXd& delay_s, DelayOf of, ModalFit& fit) {
  if (of == DelayOf::all) {
    fit.delay_s += delay_s(0);
    return;
  }
  const auto p = fit.model.output_count();
  const Fitted which{.delay = true, .delay_of = of};
  const auto count = which.delay_count(p, fit.model.input_count());
  if (fit.channel_delay_s.size() == 0) fit.channel_delay_s.setZero(count);
  fit.delay_of = of;
  Eigen::ArrayXd measured = Eigen::ArrayXd::Ones(count);
  if (fit.channel_delay_std_s.size() == count) {
    measured = fit.channel_delay_std_s.array().isFinite().cast<double>();
  }
  for (Eigen::Index e = 0; e < delay_s.size(); ++e) {
    const auto n = which.delay_index(e, p);
    if (e == (of == DelayOf::outputs ? n : n * p)) fit.channel_delay_s(n) += delay_s(e);
  }
  const double mean =
      (measured * fit.channel_delay_s.array()).sum() / std::max(1.0, measured.sum());
  fit.channel_delay_s.array() -= mean;
  fit.delay_s += mean;
}

}  // namespace chladni::identification
