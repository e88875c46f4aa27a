#include "identification/delay_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/search.h"
#include "identification/constants.h"
#include "identification/likelihood/normal_equations.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {
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
  const double period = 1.0 / data.frequency_hz(data.line_count() - 1);
  const auto cost = [&](double periods) {
    return ResidueProblem(undelayed(data, periods * period), poles, rigid).residues().cost;
  };
  const auto best =
      lowest_of_scan(cost, Constants::delay_low, Constants::delay_high, Constants::delay_intervals);
  // The parabola through the least cost and its neighbours is enough: a fit refines the delay.
  constexpr double kStep =
      (Constants::delay_high - Constants::delay_low) / Constants::delay_intervals;
  const double before = cost(best.at - kStep);
  const double after = cost(best.at + kStep);
  const double curvature = before - 2.0 * best.value + after;
  const double shift = curvature > 0.0 ? 0.5 * kStep * (before - after) / curvature : 0.0;
  return (best.at + shift) * period;
}

Eigen::VectorXd scanned_delays(const FitData& data, const Eigen::VectorXcd& poles, bool rigid,
                               DelayOf of) {
  const auto responses = data.response_count();
  if (of == DelayOf::all) {
    return Eigen::VectorXd::Constant(responses, scanned_delay(data, poles, rigid));
  }
  const Fitted which{.delay = true, .delay_of = of};
  Eigen::VectorXd result = Eigen::VectorXd::Zero(responses);
  for (Eigen::Index n = 0; n < which.delay_count(data.outputs, data.inputs); ++n) {
    std::vector<Eigen::Index> own;
    for (Eigen::Index e = 0; e < responses; ++e) {
      if (which.delay_index(e, data.outputs) == n) own.push_back(e);
    }
    FitData channel = data;
    channel.outputs = of == DelayOf::outputs ? 1 : data.outputs;
    channel.inputs = of == DelayOf::inputs ? 1 : data.inputs;
    channel.value = data.value(Eigen::all, own);
    channel.weight = data.weight(Eigen::all, own);
    if (channel.measured_count() > 0) result(own).setConstant(scanned_delay(channel, poles, rigid));
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
