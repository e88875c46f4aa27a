#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/turn.h"
#include "fem/eigen/found_modes.h"
#include "fem/eigen/mode_checks.h"
#include "fem/eigen/residual.h"
#include "fem/eigen/symmetric_product.h"
#include "fem/factor/factorization.h"
#include "fem/symmetry/symmetry_class.h"
#include "host/memory.h"
#include "modal/repeated.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr int kSpare = 3;             // modes of a class beyond its share
constexpr double kCopies = 6.0;       // of a class' shapes while they are expanded and judged
constexpr double kShareToKeep = 0.2;  // of the memory, for a factor beside the count

// The modes of one class, on the whole system.
struct Part {
  const SymmetryClass* symmetry = nullptr;
  int wanted = 0;
  Eigen::Index rigid = 0;
  Found found;         // below the bound, all of them
  double bound = 0.0;  // [s^-2]; infinite where the class has no more modes
  ModesSummary summary;
};

double matrix_bytes(const System& system) {
  const auto entries = system.stiffness.nonZeros() + system.mass.nonZeros();
  return static_cast<double>(entries) * (sizeof(double) + sizeof(int));
}

// What the last class needs beside the whole K and M, with the shapes of the others: its own K and
// M, and what finds its modes or judges them. Or, at the end, the shapes in ascending order, as
// they are returned, and their products with M.
MemoryForecast needed(const System& system, const System& block, const ModesOptions& of_class,
                      int shapes) {
  auto forecast = memory_forecast(block, of_class);
  const auto n = static_cast<double>(system.mass.rows());
  const double all = 8.0 * n * (shapes + static_cast<double>(system.rigid.cols()));
  const double judged = forecast.factor_bytes + 8.0 * n * kCopies * of_class.count;
  forecast.total_bytes =
      all + std::max(matrix_bytes(block) + std::max(forecast.total_bytes, judged), 3.0 * all);
  return forecast;
}

// Rayleigh-Ritz on the whole system, and the residuals there. The whole residual of a motion of the
// class lies in the class, so that the block's factor gives (K + sM)⁻¹ of it.
void judge(const System& system, const System& block, double shift_hz, double keep_bytes,
           Part& part) {
  const double s = inverted_shift(block, shift_hz);
  auto& [lambda, residual, shapes] = part.found;
  Matrix product = stiffness_times(system, shapes);
  static_cast<void>(ritz(system, lambda, shapes, product));
  SymmetricProduct mass(system.mass);
  product -= (mass * shapes) * lambda.asDiagonal();
  const auto factor = block.kept_factor->factor(block.stiffness, s, block.mass, keep_bytes);
  Matrix correction = factor->solve(gathered(*part.symmetry, product));
  if (block.rigid.cols() > 0) {
    correction -=
        block.rigid * (block.rigid.transpose() * (SymmetricProduct(block.mass) * correction));
  }
  correction = expanded(*part.symmetry, correction);
  const Matrix inertia = mass * correction;
  const Eigen::ArrayXd norm =
      correction.cwiseProduct(inertia).colwise().sum().transpose().cwiseMax(0.0).cwiseSqrt();
  residual = (norm * (lambda.array() + s) / lambda.array()).abs();
}

void add_cost(const ModesSummary& own, ModesSummary& total) {
  total.block_steps += own.block_steps;
  total.solves += own.solves;
  total.restarts += own.restarts;
  total.count_attempts += own.count_attempts;
  total.forecast_bytes = std::max(total.forecast_bytes, own.forecast_bytes);
  total.factor_bytes = std::max(total.factor_bytes, own.factor_bytes);
  total.factor_seconds += own.factor_seconds;
  total.iterate_seconds += own.iterate_seconds;
  total.certify_seconds += own.certify_seconds;
}

class Classes {
 public:
  Classes(const System& system, const std::vector<Mirror>& mirrors, const ModesOptions& options,
          const Progress& progress)
      : system_(system),
        options_(options),
        progress_(progress),
        symmetry_(symmetry_classes(mirrors)),
        shift_hz_(std::sqrt(inverted_shift(system, options.shift_hz)) / kTwoPi) {
    const int share = options.count / static_cast<int>(symmetry_.size()) + kSpare;
    for (const auto& symmetry : symmetry_) {
      parts_.push_back({.symmetry = &symmetry, .wanted = share, .found = {}, .summary = {}});
    }
  }

  ModesResult modes() {
    for (auto& part : parts_) solve(part);
    Found found = together();
    while (!suffice(found)) {
      const double least = bound();
      for (auto& part : parts_) {
        if (part.bound > least) continue;
        part.wanted += part.wanted / 2 + kSpare;
        solve(part);
      }
      found = together();
    }
    settle(system_, found);
    const auto wanted = std::min<Eigen::Index>(options_.count, found.lambda.size());
    auto total = summary(found);
    return assembled(system_, found, uncut(found.lambda, wanted), std::move(total));
  }

  [[nodiscard]] MemoryForecast memory() const {
    const auto largest = std::max_element(
        parts_.begin(), parts_.end(),
        [](const Part& a, const Part& b) { return a.symmetry->size() < b.symmetry->size(); });
    const auto block = block_of(system_, *largest->symmetry);
    return needed(system_, block, options_of(*largest, block), shapes());
  }

 private:
  [[nodiscard]] int shapes() const {
    return std::accumulate(parts_.begin(), parts_.end(), 0,
                           [](int sum, const Part& part) { return sum + part.wanted; });
  }

  [[nodiscard]] ModesOptions options_of(const Part& part, const System& block) const {
    auto options = options_;
    options.shift_hz = shift_hz_;
    options.count =
        std::min(part.wanted, static_cast<int>(part.symmetry->size() - block.rigid.cols()));
    return options;
  }

  void solve(Part& part) {
    const auto which = static_cast<std::size_t>(&part - parts_.data()) + 1;
    const auto told = fmt::format("class {} of {}", which, parts_.size());
    const Progress progress = [&](std::string_view step, double done) {
      if (progress_) progress_(fmt::format("{}: {}", told, step), done);
    };
    part.found = {};  // frees it
    const auto block = block_of(system_, *part.symmetry);
    part.rigid = block.rigid.cols();
    auto options = options_of(part, block);
    const double have = static_cast<double>(
        options_.memory_limit_bytes > 0 ? options_.memory_limit_bytes : available_memory());
    const auto need = needed(system_, block, options, shapes());
    if (need.total_bytes > have) {
      throw FactorTooLarge(
          fmt::format("modes: {} of {} degrees of freedom in a class of symmetry need {:.3g} GB "
                      "and there is {:.3g} GB; use a coarser mesh",
                      block.mass.rows(), system_.mass.rows(), 1e-9 * need.total_bytes, 1e-9 * have),
          need, have);
    }
    options.memory_limit_bytes = static_cast<std::size_t>(have);
    part.summary = {};
    part.bound = std::numeric_limits<double>::infinity();
    if (options.count > 0) take(fem::modes(block, options, progress), block, have, part);
    part.summary.forecast_bytes = need.total_bytes;
  }

  void take(ModesResult result, const System& block, double have, Part& part) const {
    const auto count = result.modes.mode_count() - part.rigid;
    part.found.lambda = (kTwoPi * result.modes.frequency_hz.tail(count)).array().square();
    part.found.shapes = expanded(*part.symmetry, result.modes.shapes.rightCols(count));
    result.modes.shapes.resize(0, 0);
    part.summary = std::move(result.summary);
    judge(system_, block, shift_hz_, kShareToKeep * have, part);
    if (count == part.symmetry->size() - part.rigid) return;  // there are no more
    const double last = part.found.lambda.tail<1>()(0);
    const bool counts_these = part.summary.complete && part.summary.found == part.rigid + count;
    part.bound = counts_these ? std::pow(kTwoPi * part.summary.counted_below_hz, 2)
                              : last * (1.0 + modal::kEqualToTheSolver);
  }

  [[nodiscard]] double bound() const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& part : parts_) least = std::min(least, part.bound);
    return least;
  }

  // The modes of all classes below the lowest of their bounds, in ascending order.
  [[nodiscard]] Found together() const {
    struct Place {
      double lambda;
      const Part* part;
      Eigen::Index column;
    };
    std::vector<Place> places;
    for (const auto& part : parts_) {
      for (Eigen::Index i = 0; i < part.found.lambda.size(); ++i) {
        if (part.found.lambda(i) < bound()) places.push_back({part.found.lambda(i), &part, i});
      }
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& a, const Place& b) { return a.lambda < b.lambda; });
    const auto m = static_cast<Eigen::Index>(places.size());
    Found found{Eigen::VectorXd(m), Eigen::VectorXd(m), Matrix(system_.mass.rows(), m)};
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto& [lambda, part, column] = places[static_cast<std::size_t>(i)];
      found.lambda(i) = lambda;
      found.residual(i) = part->found.residual(column);
      found.shapes.col(i) = part->found.shapes.col(column);
    }
    return found;
  }

  // As many as are wanted, and no cluster that might be cut by the bound.
  [[nodiscard]] bool suffice(const Found& found) const {
    const double limit = bound();
    if (std::isinf(limit)) return true;
    if (found.lambda.size() < options_.count) return false;
    const auto kept = uncut(found.lambda, options_.count);
    return kept < found.lambda.size() ||
           (1.0 + 2.0 * modal::kSplitByMesh) * found.lambda(kept - 1) < limit;
  }

  // Costs of all classes, and the sum of their certificates at the lowest of their bounds.
  [[nodiscard]] ModesSummary summary(const Found& found) const {
    const double limit =
        std::isinf(bound()) ? 1.02 * found.lambda.maxCoeff() : bound();  // there are no more
    ModesSummary total;
    std::string counts;
    for (const auto& part : parts_) {
      add_cost(part.summary, total);
      const auto below = static_cast<int>((part.found.lambda.array() < limit).count());
      const int counted =
          part.summary.counted - part.summary.found + static_cast<int>(part.rigid) + below;
      total.counted += counted;
      counts += fmt::format("{}{}", counts.empty() ? "" : " + ", counted);
    }
    total.found = static_cast<int>(system_.rigid.cols() + found.lambda.size());
    if (!options_.certificate) {
      total.counted = 0;
      total.text = fmt::format("modes: {} found in {} classes of symmetry, not counted",
                               total.found, parts_.size());
      return total;
    }
    total.counted_below_hz = std::sqrt(limit) / kTwoPi;
    total.complete = total.counted == total.found;
    if (!total.complete) {
      throw NumericalFailure(
          fmt::format("modes: below {:.2f} Hz {} modes were counted in classes of symmetry but {} "
                      "found",
                      total.counted_below_hz, total.counted, total.found));
    }
    total.text =
        fmt::format("modes below {:.2f} Hz: {} found, {} counted ({} in {} classes of symmetry)",
                    total.counted_below_hz, total.found, total.counted, counts, parts_.size());
    return total;
  }

  const System& system_;
  const ModesOptions& options_;
  const Progress& progress_;
  std::vector<SymmetryClass> symmetry_;
  double shift_hz_;
  std::vector<Part> parts_;
};

}  // namespace

ModesResult modes_by_mirrors(const System& system, const std::vector<Mirror>& mirrors,
                             const ModesOptions& options, const Progress& progress) {
  const auto most = system.mass.rows() - system.rigid.cols();
  require(0 < options.count && options.count <= most,
          fmt::format("modes: {} flexible modes were asked for, expected 1 to {}", options.count,
                      most));
  return Classes(system, mirrors, options, progress).modes();
}

MemoryForecast memory_forecast(const System& system, const std::vector<Mirror>& mirrors,
                               const ModesOptions& options) {
  return Classes(system, mirrors, options, {}).memory();
}

}  // namespace chladni::fem
