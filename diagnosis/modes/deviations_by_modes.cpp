#include "diagnosis/modes/deviations_by_modes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/matching.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 1e-3;  // of a deviation, for its slope
constexpr int kRounds = 8;

// ln f and ln ζ of a motion, as Rayleigh's quotients of a state: exact to first order for a mode of
// a state nearby.
struct Quotients {
  double frequency = 0.0, damping = 0.0;
};

Quotients quotients(const State& state, const VectorXd& motion) {
  const auto along = [&](const MatrixXd& matrix) {
    return matrix.size() == 0 ? 0.0 : motion.dot(matrix * motion);
  };
  const double mass = along(state.mass);
  const double omega = std::sqrt(along(state.stiffness) / mass);
  const double loss = (along(state.damping) + along(state.loss) / omega) / mass;
  return {std::log(omega), std::log(loss / (2.0 * omega))};
}

// Measured minus predicted numbers, in units of their deviations, and their slopes.
struct Linear {
  VectorXd error;
  MatrixXd slope;
};

class Rows {
 public:
  Rows(const MeasuredModes& measured, const RecordedModes& model, const Matching& matching)
      : measured_(measured), model_(model) {
    for (Index i = 0; i < measured.count(); ++i) {
      if (matching.model[at(i)] >= 0) pairs_.emplace_back(i, matching.model[at(i)]);
    }
  }

  [[nodiscard]] Linear about(const Structure& structure, const std::vector<Deviation>& deviations,
                             const VectorXd& eta) const {
    Linear linear{error(), MatrixXd::Zero(2 * std::ssize(pairs_), eta.size())};
    for (Index d = 0; d < eta.size(); ++d) {
      const VectorXd by = kStep * VectorXd::Unit(eta.size(), d);
      linear.slope.col(d) = (numbers(deviating(structure, deviations, eta + by)) -
                             numbers(deviating(structure, deviations, eta - by))) /
                            (2.0 * kStep);
    }
    return linear;
  }

 private:
  // Deviation of ln f: a part of the half-power bandwidth, or that of the measurement.
  [[nodiscard]] double frequency_deviation(Index i, Index k) const {
    const double stated = measured_.damping_ratio(i);
    const double damping = std::isfinite(stated) ? stated : model_.damping_ratio(k);
    const double part =
        2.0 * kConstants.start_bandwidth * std::max(damping, kConstants.least_damping);
    const double own = measured_.frequency_std(i);
    return std::isfinite(own) ? std::max(own, part) : part;
  }
  [[nodiscard]] double damping_deviation(Index i) const {
    const double own = measured_.damping_std(i);
    return std::isfinite(own) ? std::max(own, kConstants.start_damping) : kConstants.start_damping;
  }
  [[nodiscard]] bool has_damping(Index i, Index k) const {
    return measured_.damping_ratio(i) > 0.0 && model_.damping_ratio(k) > 0.0;
  }
  [[nodiscard]] VectorXd error() const {
    VectorXd values = VectorXd::Zero(2 * std::ssize(pairs_));
    Index row = 0;
    for (const auto& [i, k] : pairs_) {
      values(row++) =
          std::log(measured_.frequency_hz(i) / model_.frequency_hz(k)) / frequency_deviation(i, k);
      values(row++) = has_damping(i, k)
                          ? std::log(measured_.damping_ratio(i) / model_.damping_ratio(k)) /
                                damping_deviation(i)
                          : 0.0;
    }
    return values;
  }
  [[nodiscard]] VectorXd numbers(const State& state) const {
    VectorXd values = VectorXd::Zero(2 * std::ssize(pairs_));
    Index row = 0;
    for (const auto& [i, k] : pairs_) {
      const auto now = quotients(state, model_.motion.col(k));
      values(row++) = now.frequency / frequency_deviation(i, k);
      values(row++) = has_damping(i, k) ? now.damping / damping_deviation(i) : 0.0;
    }
    return values;
  }

  const MeasuredModes& measured_;
  const RecordedModes& model_;
  std::vector<std::pair<Index, Index>> pairs_;  // measured, model
};

}  // namespace

VectorXd deviations_by_modes(const Structure& structure, const std::vector<Deviation>& deviations,
                             const MeasuredModes& measured) {
  VectorXd eta = VectorXd::Zero(std::ssize(deviations));
  if (measured.count() == 0 || eta.size() == 0) return eta;
  const ShapeUnits units = shape_units(structure);
  const double low_hz = kConstants.modes_below * measured.frequency_hz.minCoeff();
  const double high_hz = kConstants.modes_above_band * measured.frequency_hz.maxCoeff();
  for (int round = 0; round < kRounds; ++round) {
    const State state = deviating(structure, deviations, eta);
    const auto model = ModeSolver(state, structure.mode_count()).modes(state, low_hz, high_hz);
    const Rows rows(measured, model, matched(measured, model, units));
    const auto [error, slope] = rows.about(structure, deviations, eta);
    MatrixXd curvature = slope.transpose() * slope;
    curvature.diagonal().array() += 1.0;
    const VectorXd next =
        curvature.llt().solve(VectorXd(slope.transpose() * (error + slope * eta)));
    const double moved = (next - eta).cwiseAbs().maxCoeff();
    eta = next;
    if (moved < 100.0 * kStep) break;  // a tenth of a deviation
  }
  return eta;
}

}  // namespace chladni::diagnosis
