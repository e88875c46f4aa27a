#include "diagnosis/search/without_causes.h"

#include <algorithm>
#include <utility>

#include "diagnosis/constants.h"
#include "diagnosis/search/simpler.h"

namespace chladni::diagnosis {

Found fitted_without_causes(const Problem& problem, const Eigen::VectorXd& start) {
  const FitLimits limits{.iterations = kConstants.nothing_iterations};
  Fit rest;
  rest.eta = Eigen::VectorXd::Zero(std::ssize(problem.deviations));
  Found found{fitted(problem, rest, limits), {}};
  if (start.size() > 0) {
    rest.eta = start;
    Fit other = fitted(problem, rest, limits);
    found.by_start = found.nothing.objective - other.objective;
    if (found.by_start > 0.0) found.nothing = std::move(other);
  }
  found.fits = {found.nothing};
  return found;
}

void fit_nothing_again(const Problem& problem, Found& found) {
  const Fit again = nothing_beside(problem, found.nothing, found.fits.front());
  if (again.objective >= found.nothing.objective) return;
  found.nothing = again;
  std::erase_if(found.fits, [](const Fit& fit) { return fit.causes.empty(); });
  keep(found.fits, again);
}

}  // namespace chladni::diagnosis
