#include "identification/experiment/design_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/turn.h"

namespace chladni::identification {
namespace {

bool has_small_factors(Eigen::Index n) {
  for (const Eigen::Index factor : {2, 3, 5}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

std::vector<Eigen::Index> modes_in_band(const modal::ReducedModel& model, const DesignPlan& plan) {
  std::vector<Eigen::Index> modes;
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    const double hz = model.frequency_hz(k);
    if (hz >= plan.low_hz && hz <= plan.high_hz) modes.push_back(k);
  }
  return modes;
}

Eigen::Index period_for(const modal::ReducedModel& model, const DesignPlan& plan) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const auto k : modes_in_band(model, plan)) {
    require(model.damping_ratio(k) > 0.0,
            fmt::format("experiment design: the mode at {:.6g} Hz has no damping, so no line is "
                        "narrow enough; expected modes.damping_ratio above 0",
                        model.frequency_hz(k)));
    narrowest = std::min(narrowest, 2.0 * model.damping_ratio(k) * model.frequency_hz(k));
  }
  require(std::isfinite(narrowest),
          fmt::format("experiment design: no flexible mode between {:.6g} and {:.6g} Hz; expected "
                      "another band or more modes",
                      plan.low_hz, plan.high_hz));
  const auto step = static_cast<double>(recordings::step_of(plan.lines));
  const double wanted = std::min({step * plan.lines_per_bandwidth / narrowest,
                                  plan.longest_period_s, kMostSamples * plan.sample_time_s});
  auto samples = static_cast<Eigen::Index>(std::ceil(wanted / plan.sample_time_s * (1.0 - 1e-12)));
  samples = std::max<Eigen::Index>(16, samples);
  while (samples % 2 != 0 || !has_small_factors(samples)) ++samples;
  return samples;
}

DesignLines design_lines(const DesignModel& model, const DesignPlan& plan, Eigen::Index period,
                         unsigned seed) {
  Draw draw(seed);
  const auto drawn = recordings::multisine({.period = period,
                                            .sample_time_s = plan.sample_time_s,
                                            .low_hz = plan.low_hz,
                                            .high_hz = plan.high_hz,
                                            .lines = plan.lines,
                                            .rms = 1.0,
                                            .shape_hz = {},
                                            .shape = {}},
                                           draw);
  DesignLines lines{.period = period, .index = drawn.lines, .hz = {}, .hold = {}, .response = {}};
  const auto count = static_cast<Eigen::Index>(lines.index.size());
  lines.hz.resize(count);
  lines.hold.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double turn =
        static_cast<double>(lines.index[static_cast<std::size_t>(k)]) / static_cast<double>(period);
    lines.hz(k) = turn / plan.sample_time_s;
    lines.hold(k) = std::sin(0.5 * kTwoPi * turn) / (0.5 * kTwoPi * turn);
  }
  lines.response = modal::frf(model.model, lines.hz).value;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto half_late =
        std::polar(lines.hold(k), -0.5 * kTwoPi * lines.hz(k) * plan.sample_time_s);
    lines.response[static_cast<std::size_t>(k)] *= half_late;
  }
  return lines;
}

Eigen::MatrixXd kind_power(const std::vector<modal::FrfKind>& kinds, const Eigen::VectorXd& hz) {
  const Eigen::ArrayXd squared = (kTwoPi * hz).array().square();
  Eigen::MatrixXd result(hz.size(), static_cast<Eigen::Index>(kinds.size()));
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    auto column = result.col(static_cast<Eigen::Index>(i)).array();
    if (kinds[i] == modal::FrfKind::receptance) column = 1.0;
    if (kinds[i] == modal::FrfKind::mobility) column = squared;
    if (kinds[i] == modal::FrfKind::accelerance) column = squared.square();
  }
  return result;
}

Eigen::MatrixXd noise_power(const DesignModel& model, const DesignPlan& plan,
                            const DesignLines& lines, const Eigen::VectorXd& sensor_noise) {
  const auto samples = static_cast<double>(lines.period);
  const auto kinds = kind_power(model.kinds, lines.hz);
  Eigen::MatrixXd power = Eigen::MatrixXd::Zero(kinds.rows(), kinds.cols());
  for (Eigen::Index k = 0; k < power.rows(); ++k) {
    const auto& response = lines.response[static_cast<std::size_t>(k)];
    const Eigen::RowVectorXd moved =
        response.topRows(power.cols()).rowwise().squaredNorm().transpose();
    power.row(k) =
        samples * (sensor_noise.cwiseAbs2().transpose() +
                   plan.process_noise_n * plan.process_noise_n * moved.cwiseProduct(kinds.row(k)));
  }
  return power;
}

double excitations(const DesignPlan& plan, Eigen::Index inputs) {
  return plan.scheme == recordings::InputScheme::orthogonal ? static_cast<double>(inputs) : 1.0;
}

}  // namespace chladni::identification
