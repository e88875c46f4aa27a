#include "priors/gaussian_process/optimum.h"

#include <cmath>
#include <exception>
#include <nlopt.hpp>

#include "base/error.h"

namespace chladni::priors {
namespace {

// Data of NLopt's callback, and the first exception of the objective.
struct Call {
  const Objective& objective;
  Optimum best;
  std::exception_ptr failure;
};

double value_of(unsigned size, const double* at, double* gradient, void* data) {
  auto& call = *static_cast<Call*>(data);
  try {
    const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(at, size);
    Eigen::VectorXd slopes = Eigen::VectorXd::Zero(size);
    const double value = call.objective(point, slopes);
    ++call.best.evaluations;
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, size) = slopes;
    if (call.best.at.size() == 0 || value < call.best.value) {
      call.best.at = point;
      call.best.value = value;
    }
    return value;
  } catch (...) {
    call.failure = std::current_exception();
    throw nlopt::forced_stop();
  }
}

std::vector<double> list(const Eigen::VectorXd& vector) { return {vector.begin(), vector.end()}; }

}  // namespace

Optimum minimum(const Objective& objective, const Eigen::VectorXd& start,
                const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                const OptimumOptions& options) {
  require(start.size() > 0 && lower.size() == start.size() && upper.size() == start.size() &&
              (lower.array() <= start.array()).all() && (start.array() <= upper.array()).all(),
          "optimum: the start must lie between bounds of its own size");
  Call call{objective, {}, nullptr};
  nlopt::opt search(nlopt::LD_LBFGS, static_cast<unsigned>(start.size()));
  search.set_min_objective(value_of, &call);
  search.set_lower_bounds(list(lower));
  search.set_upper_bounds(list(upper));
  search.set_xtol_abs(options.tolerance);
  search.set_ftol_abs(1e-7);
  search.set_maxeval(options.evaluations);
  auto point = list(start);
  double value = 0.0;
  try {
    const auto how = search.optimize(point, value);
    call.best.converged = how != nlopt::MAXEVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    call.best.converged = true;  // no lower point within rounding
  } catch (const nlopt::forced_stop&) {
  } catch (const std::runtime_error& failure) {  // the line search failed: keep the best point
    if (call.best.at.size() == 0) throw NumericalFailure(failure.what());
  }
  if (call.failure) std::rethrow_exception(call.failure);
  const double near = 1e-6;
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    const double margin = near * (upper(i) - lower(i));
    call.best.at_bound.push_back(call.best.at(i) <= lower(i) + margin ||
                                 call.best.at(i) >= upper(i) - margin);
  }
  return call.best;
}

}  // namespace chladni::priors
