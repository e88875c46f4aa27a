#include "fem/modes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "base/error.h"
#include "base/memory.h"
#include "fem/canonical.h"
#include "fem/factorization.h"
#include "fem/lanczos.h"
#include "fem/residual.h"
#include "fem/symmetric_product.h"

namespace chladni::fem {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
// A residual above which a step of iterative refinement is taken: rounding in a slender body.
constexpr double kWorthPolishing = 1e-9;
constexpr int kPolishingSteps = 3;
constexpr double kNotTrusted = 1e-4;  // a residual that is refused
constexpr int kRestarts = 4;  // with new start blocks, where the count says that some are missing

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_input(const System& system, const ModesOptions& options) {
  const auto n = system.mass.rows();
  require(n > 0 && system.mass.cols() == n && system.stiffness.rows() == n &&
              system.stiffness.cols() == n,
          "modes: K and M must be square and of one size, found " +
              std::to_string(system.stiffness.rows()) + " and " + std::to_string(n));
  require(system.rigid.cols() == 0 || system.rigid.rows() == n,
          "modes: the rigid-body motions have " + std::to_string(system.rigid.rows()) +
              " rows, expected " + std::to_string(n));
  const auto most = n - system.rigid.cols();
  require(0 < options.count && options.count <= most,
          "modes: " + std::to_string(options.count) +
              " flexible modes were asked for, expected 1 to " + std::to_string(most));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double m = system.mass.coeff(i, i);
    if (!(m > 0.0)) {
      throw NumericalFailure("modes: the mass matrix is not positive definite (its diagonal is " +
                             std::to_string(m) + " at degree of freedom " + std::to_string(i) +
                             ")");
    }
  }
}

// s of K + s M: (2π shift)², or a square of about twice the first flexible frequency, which
// conditions the factor well; any value from a tenth to a hundred times that does.
double shift(const System& system, const ModesOptions& options) {
  double hz = options.shift_hz > 0.0 ? options.shift_hz : 2.0 * system.frequency_scale_hz;
  if (hz > 0.0) return std::pow(kTwoPi * hz, 2);
  return 1e-5 * system.stiffness.diagonal().sum() / system.mass.diagonal().sum();
}

// Bytes beside K and M: the factor with the fronts or, later, with the vectors of the iteration,
// whichever is more.
struct Need {
  double factor = 0.0, fronts = 0.0, vectors = 0.0;
  [[nodiscard]] double total() const { return factor + std::max(fronts, vectors); }
};

Need memory_needed(const Symbolic& symbolic, const System& system, const ModesOptions& options) {
  const auto forecast = symbolic.forecast();
  const auto n = static_cast<double>(system.mass.rows());
  // The basis, the block in work and its images, and what a solve keeps; then the shapes three
  // times.
  const double columns = lanczos_basis_size(options.count, options.block) + 8.0 * options.block +
                         3.0 * (options.count + static_cast<double>(system.rigid.cols()));
  return {forecast.factor_bytes, forecast.work_bytes, 8.0 * n * columns};
}

void refuse_what_does_not_fit(const Need& needed, const System& system,
                              const ModesOptions& options) {
  const double need = needed.total();
  const double have = options.memory_limit_bytes > 0
                          ? static_cast<double>(options.memory_limit_bytes)
                          : static_cast<double>(available_memory());
  if (need <= have) return;
  const auto gib = [](double bytes) {
    return std::to_string(bytes / (1 << 30)).substr(0, 5) + " GiB";
  };
  throw OutOfResources("modes: " + std::to_string(system.mass.rows()) +
                       " degrees of freedom need " + gib(need) + " (factor " + gib(needed.factor) +
                       ", and work " + gib(needed.fronts) + " or vectors " + gib(needed.vectors) +
                       ") and there is " + gib(have) + "; use a coarser mesh: edge_length times " +
                       std::to_string(std::sqrt(need / have)).substr(0, 4));
}

// The first `count` and all that belong to the cluster of the last of them.
Eigen::Index uncut(const Eigen::VectorXd& lambda, Eigen::Index count) {
  while (count < lambda.size() &&
         lambda(count) - lambda(count - 1) < 2.0 * kClusterTolerance * lambda(count)) {
    ++count;
  }
  return count;
}

std::string hz_text(double hz) {
  std::string text = std::to_string(hz);
  return text.substr(0, text.find('.') + 3);
}

// Where to count: in the gap above the last mode kept, away from the next one that was seen.
double count_at(const Eigen::VectorXd& lambda, Eigen::Index kept) {
  const double last = lambda(kept - 1);
  const double next = kept < lambda.size() ? lambda(kept) : 1.02 * last;
  return std::min(0.5 * (last + next), 1.01 * last);
}

// Flexible modes with their residuals, in canonical orientation.
struct Found {
  Eigen::VectorXd lambda, residual;
  Eigen::MatrixXd shapes;
};

// Orients what is repeated; each of its members then carries the residuals of all.
void settle(const System& system, Found& found) {
  const Eigen::VectorXd before = found.lambda;
  for (const auto& cluster : orient(system, found.lambda, found.shapes, 0)) {
    auto part = found.residual.segment(cluster.first, cluster.size);
    const double turned = found.lambda(cluster.first);
    const double off =
        (before.segment(cluster.first, cluster.size).array() / turned - 1.0).abs().maxCoeff();
    part.setConstant(part.norm() + off);
  }
}

struct Search {
  const System& system;
  const ModesOptions& options;
  const Progress& progress;
  ModesSummary& summary;

  Found find(const Symbolic& symbolic, double s, const Eigen::MatrixXd& known, int wanted,
             unsigned seed) {
    auto start = Clock::now();
    tell(progress, "factorise");
    const Factorization factor(symbolic, system.stiffness, s, system.mass);
    summary.factor_seconds += seconds_since(start);
    start = Clock::now();
    auto found = lanczos(
        system, factor, s, known,
        {.wanted = wanted, .block = options.block, .tolerance = options.tolerance, .seed = seed},
        progress);
    summary.block_steps += found.block_steps;
    summary.solves += found.solves;
    Found result{std::move(found.lambda), {}, std::move(found.shapes)};
    result.residual = residuals(system, factor, s, known, result.lambda, result.shapes);
    const int least = system.suspended.cols() > 0 ? 1 : 0;
    for (int step = 0;
         step < least || (step < kPolishingSteps && result.residual.maxCoeff() > kWorthPolishing);
         ++step) {
      result.residual = polished(system, factor, s, known, result.lambda, result.shapes);
    }
    settle(system, result);
    summary.iterate_seconds += seconds_since(start);
    return result;
  }

  // Eigenvalues below `lambda`, by the signs of the pivots of K − λM.
  int counted_below(const Symbolic& symbolic, double lambda) {
    const auto start = Clock::now();
    tell(progress, "certify");
    Inertia result;
    for (int attempt = 0; attempt < 3; ++attempt) {
      result = inertia(symbolic, system.stiffness, -lambda * (1.0 + 1e-5 * attempt), system.mass);
      if (result.smallest_pivot > 1e-11) break;
    }
    summary.certify_seconds += seconds_since(start);
    if (result.smallest_pivot <= 1e-13) {
      throw NumericalFailure("modes: the inertia count at " + hz_text(std::sqrt(lambda) / kTwoPi) +
                             " Hz met a pivot of relative size " +
                             std::to_string(result.smallest_pivot) +
                             "; ask for another count of modes, or no certificate");
    }
    return static_cast<int>(result.negative);
  }
};

// Both lists in one, ascending in λ.
void merge(const System& system, Found& into, const Found& more) {
  const auto size = into.lambda.size() + more.lambda.size();
  Eigen::VectorXd lambda(size), residual(size);
  lambda << into.lambda, more.lambda;
  residual << into.residual, more.residual;
  Eigen::MatrixXd shapes(into.shapes.rows(), size);
  shapes << into.shapes, more.shapes;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return lambda(a) < lambda(b); });
  into = {lambda(order), residual(order), shapes(Eigen::all, order)};
  settle(system, into);
}

Eigen::MatrixXd beside(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
  Eigen::MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

void require_small(const ModesResult& result) {
  for (Eigen::Index i = result.modes.rigid_count; i < result.modes.mode_count(); ++i) {
    if (result.summary.residual(i) < kNotTrusted) continue;
    std::ostringstream text;
    text << "modes: the mode at " << result.modes.frequency_hz(i)
         << " Hz solves its equation only to " << result.summary.residual(i)
         << "; stiffnesses this far apart are beyond double precision: leave out the softest "
            "springs, or hold what is stiff";
    throw NumericalFailure(text.str());
  }
}

ModesResult assembled(const System& system, const Found& found, Eigen::Index kept,
                      ModesSummary summary) {
  const auto rigid = system.rigid.cols();
  ModesResult result;
  result.summary = std::move(summary);
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(rigid + kept);
  lambda.tail(kept) = found.lambda.head(kept);
  result.modes.rigid_count = rigid;
  result.modes.shapes = beside(rigid > 0 ? system.rigid : Eigen::MatrixXd(found.shapes.rows(), 0),
                               found.shapes.leftCols(kept));
  result.summary.clusters = clusters(lambda, rigid);
  result.modes.frequency_hz = lambda.cwiseMax(0.0).cwiseSqrt() / kTwoPi;
  result.modes.damping_ratio = Eigen::VectorXd::Zero(lambda.size());
  result.summary.residual.resize(rigid + kept);
  result.summary.residual << rigid_residuals(system, result.modes.shapes.leftCols(rigid)),
      found.residual.head(kept);
  require_small(result);
  const Eigen::MatrixXd gram =
      result.modes.shapes.transpose() * (SymmetricProduct(system.mass) * result.modes.shapes);
  result.summary.orthogonality =
      (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
  if (!(result.summary.orthogonality < 1e-8)) {
    throw NumericalFailure("modes: the shapes lost their orthogonality: max |ΦᵀMΦ − I| = " +
                           std::to_string(result.summary.orthogonality));
  }
  return result;
}

}  // namespace

ModesResult modes(const System& system, const ModesOptions& options, const Progress& progress) {
  check_input(system, options);
  ModesSummary summary;
  const auto start = Clock::now();
  tell(progress, "order");
  const Symbolic symbolic(system.stiffness, system.mass);
  const auto needed = memory_needed(symbolic, system, options);
  refuse_what_does_not_fit(needed, system, options);
  summary.forecast_bytes = needed.total();
  summary.factor_bytes = symbolic.forecast().factor_bytes;
  summary.factor_seconds = seconds_since(start);

  Search search{system, options, progress, summary};
  const double s = shift(system, options);
  const auto rigid = static_cast<int>(system.rigid.cols());
  auto found = search.find(symbolic, s, system.rigid, options.count, options.seed);
  auto kept = uncut(found.lambda, std::min<Eigen::Index>(options.count, found.lambda.size()));
  for (int attempt = 0; options.certificate; ++attempt) {
    const double lambda = count_at(found.lambda, kept);
    summary.counted = search.counted_below(symbolic, lambda);
    summary.found = rigid + static_cast<int>((found.lambda.array() < lambda).count());
    summary.counted_below_hz = std::sqrt(lambda) / kTwoPi;
    summary.complete = summary.counted == summary.found;
    if (summary.complete || attempt == kRestarts) break;
    const int missing = summary.counted - summary.found;
    merge(system, found,
          search.find(symbolic, s, beside(system.rigid, found.shapes), std::max(missing, 1),
                      options.seed + 1U + static_cast<unsigned>(attempt)));
    kept = uncut(found.lambda, std::min<Eigen::Index>(options.count, found.lambda.size()));
  }
  if (options.certificate && !summary.complete) {
    throw NumericalFailure("modes: below " + hz_text(summary.counted_below_hz) + " Hz " +
                           std::to_string(summary.counted) + " modes were counted but " +
                           std::to_string(summary.found) + " found");
  }
  summary.text = options.certificate
                     ? "modes below " + hz_text(summary.counted_below_hz) +
                           " Hz: " + std::to_string(summary.found) + " found, " +
                           std::to_string(summary.counted) + " counted"
                     : "modes: " + std::to_string(rigid + kept) + " found, not counted";
  return assembled(system, found, kept, std::move(summary));
}

}  // namespace chladni::fem
