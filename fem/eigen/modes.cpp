#include "fem/modes.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/turn.h"
#include "fem/eigen/certificate.h"
#include "fem/eigen/found_modes.h"
#include "fem/eigen/lanczos.h"
#include "fem/eigen/mode_checks.h"
#include "fem/eigen/residual.h"
#include "fem/factor/factorization.h"
#include "host/memory.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

// A residual above this value leads to a step of iterative refinement. The cause is rounding in a
// slender body.
constexpr double kWorthPolishing = 1e-9;
constexpr int kPolishingSteps = 3;
// A factor that takes more of the memory than this share is not kept for `reduced`.
constexpr double kShareToKeep = 0.2;
constexpr int kRestarts = 4;  // new start blocks at most, where the count says modes are missing

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_input(const System& system, const ModesOptions& options) {
  const auto n = system.mass.rows();
  require(n > 0 && system.mass.cols() == n && system.stiffness.rows() == n &&
              system.stiffness.cols() == n,
          "modes: K and M must be square and of one size, found " +
              fmt::to_string(system.stiffness.rows()) + " and " + fmt::to_string(n));
  require(system.rigid.cols() == 0 || system.rigid.rows() == n,
          "modes: the rigid-body motions have " + fmt::to_string(system.rigid.rows()) +
              " rows, expected " + fmt::to_string(n));
  const auto most = n - system.rigid.cols();
  require(0 < options.count && options.count <= most,
          "modes: " + fmt::to_string(options.count) +
              " flexible modes were asked for, expected 1 to " + fmt::to_string(most));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double m = system.mass.coeff(i, i);
    if (!(m > 0.0)) {
      throw NumericalFailure("modes: the mass matrix is not positive definite (its diagonal is " +
                             fmt::to_string(m) + " kg at degree of freedom " + fmt::to_string(i) +
                             ")");
    }
  }
}

// Bytes beside K and M: the analysis; the factor with what makes it, then with the vectors of the
// iteration; then the count beside the shapes, and beside the factor where it is kept.
struct Need {
  double analysis = 0.0, factor = 0.0, work = 0.0, vectors = 0.0, count = 0.0;
  bool kept = true;
  [[nodiscard]] double total() const {
    return analysis + std::max(factor + std::max(work, vectors), count + (kept ? factor : 0.0));
  }
};

Need memory_needed(const Symbolic& symbolic, const System& system, const ModesOptions& options,
                   double keep_bytes) {
  const auto forecast = symbolic.forecast();
  const auto n = static_cast<double>(system.mass.rows());
  // The basis, the current block with its images, the work space of a solve, three copies of the
  // shapes, and what each thread sums of a product.
  const double columns = lanczos_basis_size(options.count, options.block) + 8.0 * options.block +
                         3.0 * (options.count + static_cast<double>(system.rigid.cols())) +
                         8.0 * thread_count();
  const double shapes = options.count + static_cast<double>(system.rigid.cols());
  return {.analysis = forecast.analysis_bytes,
          .factor = forecast.factor_bytes,
          .work = forecast.work_bytes,
          .vectors = 8.0 * n * columns,
          .count = options.certificate ? forecast.count_bytes + 8.0 * n * shapes : 0.0,
          .kept = forecast.factor_bytes <= keep_bytes};
}

double memory_there(const ModesOptions& options) {
  return static_cast<double>(options.memory_limit_bytes > 0 ? options.memory_limit_bytes
                                                            : available_memory());
}

void refuse_what_does_not_fit(const Need& needed, const System& system, double have) {
  const double need = needed.total();
  if (need <= have) return;
  const auto gib = [](double bytes) { return fmt::format("{:.3g} GiB", bytes / (1 << 30)); };
  throw FactorTooLarge(
      fmt::format("modes: {} degrees of freedom need {} (factor {}, and work {} or vectors {}; "
                  "count {}) and there is {}; use a coarser mesh: edge_length times {:.2f}",
                  system.mass.rows(), gib(need), gib(needed.factor), gib(needed.work),
                  gib(needed.vectors), gib(needed.count), gib(have), std::sqrt(need / have)),
      {.total_bytes = need, .factor_bytes = needed.factor}, have);
}

struct Search {
  const System& system;
  const ModesOptions& options;
  const Progress& progress;
  ModesSummary& summary;
  double keep_bytes = 0.0;
  std::shared_ptr<const Factorization> factor = {};  // serves the restarts too where it is kept

  Found find(double s, const Eigen::MatrixXd& known, int wanted, unsigned seed) {
    auto start = Clock::now();
    if (!factor) tell(progress, "factorise");
    if (!factor) factor = factorized(s);
    summary.factor_seconds += seconds_since(start);
    start = Clock::now();
    auto found = lanczos(
        system, *factor, s, known,
        {.wanted = wanted, .block = options.block, .tolerance = options.tolerance, .seed = seed},
        progress);
    summary.block_steps += found.block_steps;
    summary.solves += found.solves;
    Found result{std::move(found.lambda), {}, std::move(found.shapes)};
    result.residual = residuals(system, *factor, s, known, result.lambda, result.shapes);
    const int least = system.suspended.cols() > 0 ? 1 : 0;
    const auto rough = [&] { return !(result.residual.array() <= kWorthPolishing).all(); };
    for (int step = 0; step < least || (step < kPolishingSteps && rough()); ++step) {
      result.residual = polished(system, *factor, s, known, result.lambda, result.shapes);
    }
    require_energy(system, result.lambda, result.shapes);
    settle(system, result);
    summary.iterate_seconds += seconds_since(start);
    if (summary.factor_bytes > keep_bytes) factor = {};  // the count then has its memory
    return result;
  }

  // Counts the eigenvalues below a shift in the gap above the first `kept` modes. True where the
  // count equals the number of modes found.
  bool is_complete(const Symbolic& symbolic, const Found& found, Eigen::Index kept) {
    const auto start = Clock::now();
    tell(progress, "certify");
    release_freed_memory();  // of the basis
    const double last = found.lambda(kept - 1);
    const double next = kept < found.lambda.size() ? found.lambda(kept) : 1.02 * last;
    const auto count = counted(symbolic, last, std::min(next, 1.02 * last));
    const auto below = (found.lambda.array() < count.at).count();
    summary.counted = static_cast<int>(count.below);
    summary.found = static_cast<int>(system.rigid.cols() + below);
    summary.count_attempts += count.attempts;
    summary.counted_below_hz = std::sqrt(count.at) / kTwoPi;
    summary.complete = summary.counted == summary.found;
    summary.certify_seconds += seconds_since(start);
    return summary.complete;
  }

 private:
  [[nodiscard]] std::shared_ptr<const Factorization> factorized(double s) const {
    try {
      return system.kept_factor->factor(system.stiffness, s, system.mass, keep_bytes);
    } catch (const NumericalFailure& failure) {
      const auto why = precision_advice(system, s);
      throw NumericalFailure(failure.what() + (why.empty() ? "" : ": " + why));
    }
  }

  [[nodiscard]] Count counted(const Symbolic& symbolic, double low, double high) const {
    try {
      return counted_in_gap(symbolic, system, low, high);
    } catch (const NumericalFailure& failure) {
      const auto why = precision_advice(system, low);
      throw NumericalFailure(failure.what() + (why.empty() ? "" : ": " + why));
    }
  }
};

// Merges both lists into one, ascending in λ.
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

}  // namespace

MemoryForecast memory_forecast(const System& system, const ModesOptions& options) {
  const auto analysis = system.kept_factor->symbolic(system.stiffness, system.mass);
  const auto needed =
      memory_needed(*analysis, system, options, kShareToKeep * memory_there(options));
  return {.total_bytes = needed.total(), .factor_bytes = needed.factor};
}

ModesResult modes(const System& system, const ModesOptions& options, const Progress& progress) {
  check_input(system, options);
  ModesSummary summary;
  const auto start = Clock::now();
  tell(progress, "order");
  const auto analysis = system.kept_factor->symbolic(system.stiffness, system.mass);
  release_freed_memory();  // of the graph and of METIS
  const auto& symbolic = *analysis;
  const double have = memory_there(options);
  const double keep_bytes = kShareToKeep * have;
  const auto needed = memory_needed(symbolic, system, options, keep_bytes);
  refuse_what_does_not_fit(needed, system, have);
  summary.forecast_bytes = needed.total();
  summary.factor_bytes = symbolic.forecast().factor_bytes;
  summary.factor_seconds = seconds_since(start);

  Search search{system, options, progress, summary, keep_bytes};
  const double s = inverted_shift(system, options.shift_hz);
  const auto rigid = static_cast<int>(system.rigid.cols());
  auto found = search.find(s, rigid_motions(system), options.count, options.seed);
  auto kept = uncut(found.lambda, std::min<Eigen::Index>(options.count, found.lambda.size()));
  while (options.certificate && !search.is_complete(symbolic, found, kept) &&
         summary.restarts < kRestarts) {
    const int missing = std::max(summary.counted - summary.found, 1);
    const auto seed = options.seed + 1U + static_cast<unsigned>(summary.restarts++);
    merge(system, found,
          search.find(s, beside(rigid_motions(system), found.shapes), missing, seed));
    kept = uncut(found.lambda, std::min<Eigen::Index>(options.count, found.lambda.size()));
  }
  if (options.certificate && !summary.complete) {
    throw NumericalFailure(fmt::format("modes: below {:.2f} Hz {} modes were counted but {} found",
                                       summary.counted_below_hz, summary.counted, summary.found));
  }
  summary.text = options.certificate
                     ? fmt::format("modes below {:.2f} Hz: {} found, {} counted",
                                   summary.counted_below_hz, summary.found, summary.counted)
                     : fmt::format("modes: {} found, not counted", rigid + kept);
  return assembled(system, found, kept, std::move(summary));
}

}  // namespace chladni::fem
