#include "diagnosis/modes/calibration/calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/index.h"
#include "base/upper_median.h"
#include "diagnosis/constants.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kQuickRounds = 2;
constexpr std::size_t kScales = 3;  // factors of all frequencies that are tried
constexpr std::size_t kInFull = 4;  // starts that are fitted in full

VectorXd widths(const std::vector<HeldConstant>& constants) {
  VectorXd all(static_cast<Index>(constants.size()));
  for (Index i = 0; i < all.size(); ++i) all(i) = constants[at(i)].width;
  return all;
}

std::optional<RecordedModes> modes_at(const ModesProblem& problem, const ModesFit& base,
                                      const VectorXd& x) {
  ModesFit there;
  there.causes = base.causes;
  there.constants = x;
  return problem.modes(problem.with(there), false);
}

// d ln f / dx of the model's modes, n×c.
MatrixXd frequency_slopes(const ModesProblem& problem, const ModesFit& start,
                          const RecordedModes& model) {
  const auto c = static_cast<Index>(problem.constants().size());
  MatrixXd slopes = MatrixXd::Zero(model.count(), c);
  constexpr double kStep = 1e-4;
  for (Index i = 0; i < c; ++i) {
    const auto there = modes_at(problem, start, kStep * VectorXd::Unit(c, i));
    if (!there || there->count() != model.count()) continue;
    slopes.col(i) = (there->frequency_hz.array() / model.frequency_hz.array()).log() / kStep;
  }
  return slopes;
}

// The most probable constants that multiply all frequencies by e^1, to first order; zero where no
// constants do.
VectorXd scaling(const MatrixXd& slopes, const VectorXd& width) {
  if (slopes.rows() == 0) return VectorXd::Zero(width.size());
  const MatrixXd spread = width.cwiseAbs2().asDiagonal();
  MatrixXd covariance = slopes * spread * slopes.transpose();
  const double size = covariance.diagonal().mean();
  if (!(size > 0.0)) return VectorXd::Zero(width.size());
  covariance.diagonal().array() += 1e-4 * size;
  const VectorXd by = spread * slopes.transpose() *
                      covariance.ldlt().solve(VectorXd(VectorXd::Ones(slopes.rows())));
  const double reached = (slopes * by).mean();
  if (!(reached > 0.5)) return VectorXd::Zero(width.size());
  return by / reached;
}

struct Scale {
  double shift = 0.0;  // ln of the factor
  double cost = 0.0;
};

// How badly the measured frequencies fit the model's times e^shift; its best shift nearby.
Scale scale_at(const ModesProblem& problem, RecordedModes model, double shift) {
  model.frequency_hz *= std::exp(shift);
  const auto matching = matched(problem.measured(), model, problem.units());
  std::vector<double> apart;
  double cost = 0.0;
  for (std::size_t i = 0; i < matching.model.size(); ++i) {
    const Index k = matching.model[i];
    if (k < 0) {
      cost += kConstants.alone;
      continue;
    }
    const double off =
        std::log(problem.measured().frequency_hz(static_cast<Index>(i)) / model.frequency_hz(k));
    apart.push_back(off);
    cost += std::log1p(std::pow(off / kConstants.far_off, 2));
  }
  if (apart.empty()) return {shift, cost};
  return {shift + upper_median(apart), cost};
}

// The most promising factors of all frequencies, each the best one nearby.
std::vector<Scale> scales(const ModesProblem& problem, const RecordedModes& model,
                          double deviation) {
  const double most = std::min(3.0 * deviation, std::numbers::ln2);
  const int count = static_cast<int>(most / kConstants.scale_step);
  std::vector<Scale> all(at(2 * count + 1));
  parallel_tasks(all.size(), [&](std::size_t i) {
    const double shift = kConstants.scale_step * (static_cast<double>(i) - count);
    all[i] = scale_at(problem, model, shift);
    all[i].cost += 0.5 * std::pow(shift / deviation, 2);
  });
  std::ranges::stable_sort(all, {}, &Scale::cost);
  std::vector<Scale> best;
  for (const auto& one : all) {
    const bool is_new = std::ranges::none_of(best, [&](const Scale& other) {
      return std::abs(other.shift - one.shift) < kConstants.far_off;
    });
    if (is_new && best.size() < kScales) best.push_back(one);
  }
  return best;
}

// Where the fits start: coordinates of all constants.
std::vector<VectorXd> starts(const ModesProblem& problem, const ModesFit& start) {
  const VectorXd width = widths(problem.constants());
  const VectorXd centre = VectorXd::Zero(width.size());
  std::vector<VectorXd> all{centre};
  const auto model = modes_at(problem, start, centre);
  if (!model) return all;
  const VectorXd unit = scaling(frequency_slopes(problem, start, *model), width);
  if (!unit.isZero(0.0)) {
    const double deviation = 1.0 / unit.cwiseQuotient(width).norm();
    for (const auto& scale : scales(problem, *model, deviation)) {
      if (std::abs(scale.shift) > 1e-6) all.emplace_back(scale.shift * unit);
    }
  }
  const std::size_t scaled = all.size();
  for (Index c = 0; c < width.size(); ++c) {
    const auto& one = problem.constants()[at(c)];
    const bool is_wide = width(c) > kConstants.far_off && !one.effect->is_scale &&
                         one.effect->name != "modal_damping";
    for (std::size_t s = 0; is_wide && s < scaled; ++s) {
      for (const double sign : {-1.0, 1.0}) {
        all.emplace_back(all[s] + sign * width(c) * VectorXd::Unit(width.size(), c));
      }
    }
  }
  return all;
}

std::vector<ModesFit> fitted_from(const ModesProblem& problem, std::vector<ModesFit> fits,
                                  int rounds) {
  parallel_tasks(fits.size(), [&](std::size_t i) { fits[i] = problem.fitted(fits[i], rounds); });
  std::ranges::stable_sort(fits, std::ranges::greater{}, &ModesFit::log_evidence);
  return fits;
}

// The largest distance of two fits' constants, in the deviations of the first one.
double apart(const ModesFit& a, const ModesFit& b) {
  if (a.covariance.rows() != a.constants.size()) return HUGE_VAL;
  const VectorXd deviation = a.covariance.diagonal().cwiseSqrt();
  return (a.constants - b.constants).cwiseQuotient(deviation).cwiseAbs().maxCoeff();
}

// The best of fits that went to the same maximum.
std::vector<ModesFit> distinct(const std::vector<ModesFit>& fits) {
  std::vector<ModesFit> best;
  for (const auto& fit : fits) {
    const bool is_new = std::ranges::none_of(
        best, [&](const ModesFit& other) { return apart(other, fit) < kConstants.significant; });
    if (is_new && best.size() < kInFull) best.push_back(fit);
  }
  return best;
}

}  // namespace

ModesFit calibrated(const ModesProblem& problem, const ModesFit& start) {
  std::vector<ModesFit> fits;
  for (auto& x : starts(problem, start)) {
    fits.push_back(start);
    fits.back().constants = std::move(x);
  }
  fits = distinct(fitted_from(problem, std::move(fits), kQuickRounds));
  fits = fitted_from(problem, std::move(fits), ModesProblem::kRounds);
  ModesFit best = fits.front();
  for (const auto& other : fits) {
    const bool is_near = best.log_evidence - other.log_evidence < kConstants.rival_within;
    if (is_near && apart(best, other) > kConstants.significant) {
      best.other_constants.push_back(other.constants);
      break;
    }
  }
  return best;
}

ConstantColumns::ConstantColumns(const ModesProblem& problem, const ModesFit& base)
    : width_(widths(problem.constants())), at_(base.constants) {
  const Index c = width_.size();
  if (c == 0) return;
  if (at_.size() == 0) at_ = VectorXd::Zero(c);
  const auto errors = [&](const RecordedModes& model) {
    return problem.errors(base, model, base.matching, false).blocks;
  };
  const auto here = errors(base.model);
  for (const auto& block : here) slope_.emplace_back(MatrixXd::Zero(block.count(), c));
  constexpr double kStep = 1e-5;
  for (Index i = 0; i < c; ++i) {
    const auto model = modes_at(problem, base, at_ + kStep * VectorXd::Unit(c, i));
    if (!model || model->count() != base.model.count()) continue;
    const auto there = errors(*model);
    for (std::size_t b = 0; b < here.size(); ++b) {
      if (there[b].count() != here[b].count()) continue;
      slope_[b].col(i) = (there[b].error - here[b].error) / kStep;
    }
  }
}

ModeErrors ConstantColumns::added(ModeErrors errors) const {
  const Index c = width_.size();
  if (c == 0) return errors;
  for (Index i = 0; i < c; ++i) errors.shared_of.push_back(-1);
  for (std::size_t b = 0; b < errors.blocks.size(); ++b) {
    auto& block = errors.blocks[b];
    const Index k = block.shared.cols();
    block.shared.conservativeResize(block.count(), k + c);
    const bool is_same = slope_[b].rows() == block.count();
    block.shared.rightCols(c).setZero();
    if (!is_same) continue;
    block.error -= slope_[b] * at_;
    block.shared.rightCols(c) = slope_[b] * width_.asDiagonal();
  }
  return errors;
}

}  // namespace chladni::diagnosis
