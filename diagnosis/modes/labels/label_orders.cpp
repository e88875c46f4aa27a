#include "diagnosis/modes/labels/label_orders.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "base/draw.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/partner.h"
#include "host/parallel.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kTurns = 24;            // of sizes and assignment, at most
constexpr std::size_t kStarts = 400;  // signs at random
constexpr std::size_t kOrders = 16;   // that are returned, at most
constexpr auto kNever = 1e6;          // misfit of what must not be
// Shifts of all frequencies, in ln, under which modes are paired before their shapes are known.
constexpr std::array kShifts = {0.0, -0.05, 0.05, -0.1, 0.1};
// The same under which labels that stay may explain the shapes: every modulus that a calibration
// seeks, in steps well below what pairs modes.
constexpr std::array kFarShifts = {-0.1, 0.1,  -0.2, 0.2,  -0.3, 0.3,  -0.4,
                                   0.4,  -0.5, 0.5,  -0.6, 0.6,  -0.7, 0.7};

// The measured shapes without their phases, each of root mean square 1; NaN: no value.
MatrixXd real_shapes(const Eigen::MatrixXcd& measured) {
  MatrixXd real = MatrixXd::Constant(measured.rows(), measured.cols(), std::nan(""));
  for (Index k = 0; k < measured.cols(); ++k) {
    const auto rows = rows_with_values(measured, k);
    const Eigen::VectorXcd values = measured.col(k)(rows);
    const double size =
        values.norm() / std::sqrt(std::max(1.0, static_cast<double>(values.size())));
    if (!(size > 0.0)) continue;
    real.col(k)(rows) = (values * std::conj(phase_of(values))).real() / size;
  }
  return real;
}

// One column for each measured mode: its mode of the model, −1: none.
using Pairs = std::vector<Index>;

// What each pair of a measured mode and one of the model costs by its frequencies.
// @param shift  of all measured frequencies, in ln
MatrixXd frequency_cost(const LabelScene& scene, double shift) {
  MatrixXd cost(scene.measured_hz.size(), scene.model_hz.size());
  for (Index i = 0; i < cost.rows(); ++i) {
    for (Index k = 0; k < cost.cols(); ++k) {
      const double apart =
          (std::log(scene.measured_hz(i) / scene.model_hz(k)) + shift) / kConstants.apart;
      cost(i, k) = apart * apart;
    }
  }
  return cost;
}

Pairs cheapest_pairs(const MatrixXd& cost) {
  Pairs pairs(at(cost.rows()), -1);
  for (const auto& [i, k] : modal::assigned(cost, 1.0 - kConstants.least_mac)) pairs[at(i)] = k;
  return pairs;
}

// Pairs by frequency alone, all measured frequencies times e^shift.
Pairs pairs_at(const LabelScene& scene, double shift) {
  return cheapest_pairs(frequency_cost(scene, shift));
}

double root_mean_square(const VectorXd& vector) {
  return vector.norm() / std::sqrt(static_cast<double>(std::max<Index>(vector.size(), 1)));
}

// The records against the modes that they are paired with.
class Turns {
 public:
  Turns(const LabelScene& scene, const MatrixXd& records, const Pairs& pairs)
      : scene_(scene), records_(records), pairs_(pairs) {
    for (const Index k : pairs) {
      basis_.push_back(k < 0 ? MatrixXd() : basis_of(k));
      ridge_.push_back(k < 0 ? VectorXd() : ridge_of(k));
    }
  }

  // From the signs of each mode; of modes that are near, parts at random.
  [[nodiscard]] LabelOrder from_draw(Draw& draw) const {
    MatrixXd predicted = MatrixXd::Zero(records_.rows(), records_.cols());
    for (std::size_t k = 0; k < basis_.size(); ++k) {
      if (basis_[k].size() == 0) continue;
      VectorXd parts(basis_[k].cols());
      for (double& part : parts) part = draw.normal();
      parts(0) = std::copysign(1.0, parts(0));
      parts.tail(parts.size() - 1).array() /= 1.0 + ridge_[k].tail(parts.size() - 1).array();
      const VectorXd shape = basis_[k] * parts;
      predicted.col(static_cast<Index>(k)) = shape / std::max(root_mean_square(shape), 1e-300);
    }
    return from(assigned(predicted, widths().front(), Values::signed_));
  }
  // From the sizes of the values.
  [[nodiscard]] LabelOrder from_sizes() const {
    MatrixXd predicted = MatrixXd::Zero(records_.rows(), records_.cols());
    for (std::size_t k = 0; k < basis_.size(); ++k) {
      if (basis_[k].size() > 0) predicted.col(static_cast<Index>(k)) = basis_[k].col(0);
    }
    return from(assigned(predicted, widths().front(), Values::sizes));
  }
  // Until nothing moves, beside ever smaller errors.
  // @param may_move  false: signs alone change
  [[nodiscard]] LabelOrder from(LabelOrder order, bool may_move = true) const {
    for (int turn = 0; turn < kTurns; ++turn) {
      const auto step = std::min(static_cast<std::size_t>(turn), widths().size() - 1);
      const auto predicted = predicted_by(order, widths()[step]);
      auto next = assigned(predicted, widths()[step], may_move ? Values::signed_ : Values::kept);
      const bool is_still = next.channel_of == order.channel_of && next.sign == order.sign;
      order = std::move(next);
      if (is_still && step + 1 == widths().size()) break;
    }
    return order;
  }

  // The modes of the model paired anew, by the shapes under an order.
  // @param shift  of all measured frequencies, in ln
  [[nodiscard]] Pairs paired_by(const LabelOrder& order, double shift) const {
    MatrixXd cost = frequency_cost(scene_, shift);
    for (Index i = 0; i < cost.rows(); ++i) {
      for (Index k = 0; k < cost.cols(); ++k) cost(i, k) = cost(i, k) + 1.0 - mac(order, i, k);
    }
    return cheapest_pairs(cost);
  }

 private:
  // Errors of a shape value beside which records are assigned, one after the other.
  static const std::vector<double>& widths() {
    static const std::vector<double> all{8.0 * kConstants.label_error, 4.0 * kConstants.label_error,
                                         4.0 * kConstants.label_error, 2.0 * kConstants.label_error,
                                         kConstants.label_error};
    return all;
  }

  // Mode k, then its neighbours; each of root mean square 1.
  [[nodiscard]] std::vector<Index> span_of(Index k) const {
    std::vector<Index> span{k};
    for (Index l = 0; l < scene_.model_hz.size(); ++l) {
      if (l != k && apart(l, k) < kConstants.neighbours) span.push_back(l);
    }
    const auto most = at(std::max<Index>(1, records_.rows() - 2));
    if (span.size() > most) span.resize(most);
    return span;
  }
  [[nodiscard]] double apart(Index l, Index k) const {
    return std::abs(std::log(scene_.model_hz(l) / scene_.model_hz(k)));
  }
  [[nodiscard]] MatrixXd basis_of(Index k) const {
    MatrixXd basis = scene_.model(Eigen::all, span_of(k));
    for (auto column : basis.colwise()) {
      column /= std::max(root_mean_square(column), 1e-300);
    }
    return basis;
  }
  // Over the squared error of a value: the farther a neighbour, the smaller its part.
  [[nodiscard]] VectorXd ridge_of(Index k) const {
    const auto span = span_of(k);
    VectorXd ridge = VectorXd::Zero(std::ssize(span));
    for (std::size_t l = 1; l < span.size(); ++l) {
      const double deviation = part_deviation(apart(span[l], k));
      ridge(static_cast<Index>(l)) =
          std::pow(kConstants.shape_error / std::max(deviation, 1e-9), 2);
    }
    return ridge;
  }

  [[nodiscard]] double mac(const LabelOrder& order, Index i, Index k) const {
    double product = 0.0;
    double a = 0.0;
    double b = 0.0;
    for (Index row = 0; row < records_.rows(); ++row) {
      const double value = order.sign[at(row)] * records_(row, i);
      if (!std::isfinite(value)) continue;
      const double model = scene_.model(order.channel_of[at(row)], k);
      product += value * model;
      a += value * value;
      b += model * model;
    }
    return product * product / std::max(a * b, 1e-300);
  }

  // p×m: what each channel has in each measured mode, by robust least squares under an order.
  [[nodiscard]] MatrixXd predicted_by(const LabelOrder& order, double width) const {
    MatrixXd predicted = MatrixXd::Zero(records_.rows(), records_.cols());
    for (Index k = 0; k < records_.cols(); ++k) {
      const auto& basis = basis_[at(k)];
      if (basis.size() == 0) continue;
      VectorXd weight = VectorXd::Ones(basis.rows());
      VectorXd value(basis.rows());
      for (Index i = 0; i < basis.rows(); ++i) {
        value(i) = order.sign[at(i)] * records_(i, k);
        if (!std::isfinite(value(i))) value(i) = weight(i) = 0.0;
      }
      const VectorXd has_value = weight;
      const MatrixXd shown = basis(order.channel_of, Eigen::all);
      VectorXd parts;
      for (int round = 0; round < 3; ++round) {
        MatrixXd normal = shown.transpose() * weight.asDiagonal() * shown;
        normal.diagonal() += weight.sum() * ridge_[at(k)];
        normal.diagonal().array() += 1e-9;
        parts =
            normal.ldlt().solve(Eigen::VectorXd(shown.transpose() * weight.cwiseProduct(value)));
        const VectorXd off = (value - shown * parts) / width;
        weight = has_value.array() / (1.0 + off.array().square());
      }
      predicted.col(k) = basis * parts;
    }
    return predicted;
  }

  enum class Values { signed_, sizes, kept };

  // The assignment of least misfit. @param values  kept: each record shows its own channel
  [[nodiscard]] LabelOrder assigned(const MatrixXd& predicted, double width, Values values) const {
    const Index p = records_.rows();
    MatrixXd cost(p, p);
    MatrixXd turned = MatrixXd::Constant(p, p, HUGE_VAL);
    for (Index i = 0; i < p; ++i) {
      for (Index j = 0; j < p; ++j) {
        if (values == Values::kept && i != j) {
          cost(i, j) = kNever;
          continue;
        }
        const bool sizes = values == Values::sizes;
        cost(i, j) = misfit(i, predicted.row(j), width, sizes ? 0.0 : 1.0);
        if (sizes) continue;
        turned(i, j) = misfit(i, predicted.row(j), width, -1.0) + kConstants.turned_record;
      }
    }
    const MatrixXd least = cost.cwiseMin(turned);
    LabelOrder order{std::vector<Index>(at(p), 0), std::vector<double>(at(p), 1.0), 0.0};
    for (const auto& [i, j] : modal::assigned(least, 1.0 + least.maxCoeff())) {
      order.channel_of[at(i)] = j;
      order.sign[at(i)] = turned(i, j) < cost(i, j) ? -1.0 : 1.0;
      order.misfit += least(i, j);
    }
    return order;
  }
  // The misfit of record i as a channel. @param sign  0: of sizes alone
  [[nodiscard]] double misfit(Index i, const Eigen::RowVectorXd& channel, double width,
                              double sign) const {
    double sum = 0.0;
    for (Index k = 0; k < records_.cols(); ++k) {
      const double value = records_(i, k);
      if (!std::isfinite(value)) continue;  // a mode that the model lacks counts as an error of 1
      const double off =
          sign == 0.0 ? std::abs(value) - std::abs(channel(k)) : sign * value - channel(k);
      sum += 0.5 * std::log1p((off / width) * (off / width));
    }
    return sum;
  }

  const LabelScene& scene_;
  const MatrixXd& records_;
  Pairs pairs_;
  std::vector<MatrixXd> basis_;
  std::vector<VectorXd> ridge_;
};

LabelOrder as_they_are(Index channels) {
  LabelOrder order{std::vector<Index>(at(channels)), std::vector<double>(at(channels), 1.0), 0.0};
  std::iota(order.channel_of.begin(), order.channel_of.end(), Index{0});
  return order;
}

// Labels, then pairs, until both are still.
// @param may_move  false: signs alone change
// @param shift  of all measured frequencies, in ln
LabelOrder settled(const LabelScene& scene, const MatrixXd& records, Pairs pairs, LabelOrder order,
                   bool may_move = true, double shift = 0.0) {
  for (int turn = 0; turn < kTurns; ++turn) {
    const Turns turns(scene, records, pairs);
    order = turns.from(std::move(order), may_move);
    auto next = turns.paired_by(order, shift);
    if (next == pairs) break;
    pairs = std::move(next);
  }
  return order;
}

// Values that the misfit of an order counts, and whether it explains them.
bool explains(const LabelOrder& order, const MatrixXd& records) {
  const auto count = static_cast<double>(records.array().isFinite().count());
  const double error = kConstants.explained_by_labels / kConstants.label_error;
  return order.misfit < 0.5 * count * std::log1p(error * error);
}

// The labels as they are, where they explain the shapes of a model whose frequencies are all far
// off.
std::optional<LabelOrder> stayed_far_off(const LabelScene& scene, const MatrixXd& records) {
  for (const double shift : kFarShifts) {
    auto order =
        settled(scene, records, pairs_at(scene, shift), as_they_are(records.rows()), true, shift);
    if (moved_count(order) == 0 && explains(order, records)) return order;
  }
  return std::nullopt;
}

// ln of the permutations that move each of n: n! / e, rounded.
double log_derangements(double n) {
  constexpr double kNoRounding = 30.0;  // from here on the rounding is below that of doubles
  return n < kNoRounding ? std::log(std::round(std::tgamma(n + 1.0) / std::numbers::e))
                         : std::lgamma(n + 1.0) - 1.0;
}

}  // namespace

Index moved_count(const LabelOrder& order) {
  Index moved = 0;
  for (std::size_t i = 0; i < order.channel_of.size(); ++i) {
    if (order.channel_of[i] != static_cast<Index>(i)) ++moved;
  }
  return moved;
}

double log_prior(const LabelOrder& order) {
  const auto p = static_cast<double>(order.channel_of.size());
  const auto moved = static_cast<double>(moved_count(order));
  if (moved == 0.0) return 0.0;
  // ln of p over moved, times the permutations that move each.
  const double all = std::lgamma(p + 1.0);
  const double chosen = all - std::lgamma(moved + 1.0) - std::lgamma(p - moved + 1.0);
  const double permuted = log_derangements(moved);
  const double few = -std::log(p - 1.0) - chosen - permuted;
  return std::log(0.5 * kConstants.mixed_prior) + few + std::log1p(std::exp(-all - few));
}

std::vector<LabelOrder> label_orders(const LabelScene& scene) {
  const MatrixXd records = real_shapes(scene.measured);
  const auto own = as_they_are(records.rows());
  const auto usual = pairs_at(scene, 0.0);
  const auto moved = settled(scene, records, usual, own);
  if (moved_count(moved) == 0 && explains(moved, records)) return {moved};
  if (auto stayed = stayed_far_off(scene, records)) return {*std::move(stayed)};
  std::vector<Pairs> pairs;
  for (const double shift : kShifts) {
    auto other = pairs_at(scene, shift);
    if (std::ranges::find(pairs, other) == pairs.end()) pairs.push_back(std::move(other));
  }
  std::vector<LabelOrder> found(kStarts);
  parallel_tasks(kStarts, [&](std::size_t s) {
    const auto& start = pairs[s % pairs.size()];
    const Turns turns(scene, records, start);
    Draw draw(static_cast<unsigned>(s + 1));
    const auto first = s < pairs.size() ? turns.from_sizes() : turns.from_draw(draw);
    found[s] = settled(scene, records, start, first);
  });
  std::ranges::stable_sort(found, {},
                           [](const LabelOrder& order) { return order.misfit - log_prior(order); });
  std::vector<LabelOrder> orders{settled(scene, records, usual, own, false)};
  found.insert(found.begin(), moved);
  for (auto& order : found) {
    if (orders.size() == kOrders) break;
    const bool is_new = std::ranges::none_of(
        orders, [&](const LabelOrder& known) { return known.channel_of == order.channel_of; });
    if (is_new) orders.push_back(std::move(order));
  }
  return orders;
}

}  // namespace chladni::diagnosis
