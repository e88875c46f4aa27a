#include "diagnosis/search/scales.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/interrupt.h"
#include "diagnosis/constants.h"
#include "diagnosis/search/simpler.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

bool is_of_all(const Effect& effect) { return effect.is_scale || effect.is_of_body; }

// The effects of one number that can stand for such causes.
std::vector<const Effect*> scales_of(const std::vector<const Effect*>& catalogue,
                                     const Structure& structure) {
  std::vector<const Effect*> scales;
  for (const auto* effect : catalogue) {
    if (!is_of_all(*effect) || effect->options(structure) != 1) continue;
    if (effect->parameters(structure).size() == 1) scales.push_back(effect);
  }
  return scales;
}

}  // namespace

bool add_scales(const Problem& problem, const std::vector<const Effect*>& catalogue, Found& found) {
  Fit start;
  start.causes = found.fits.front().causes;
  const auto removed =
      std::erase_if(start.causes, [](const Supposed& c) { return is_of_all(*c.effect); });
  if (removed == 0) return false;
  start.eta = found.nothing.eta;
  const double before = found.fits.front().log_evidence;
  const FitLimits limits{.bar = found.fits.front().objective + kConstants.occam_margin};
  const auto scales = scales_of(catalogue, problem.structure);
  std::vector<std::optional<Fit>> fits(scales.size());
  parallel_tasks(fits.size(), [&](std::size_t i) {
    throw_if_interrupted();
    Fit one = start;
    one.causes.push_back({scales[i], 0, Eigen::VectorXd::Zero(1)});
    fits[i] = possible_fit(problem, one, limits);
  });
  for (auto& fit : fits) {
    if (fit) keep_if_new(problem.structure, found.fits, *std::move(fit));
  }
  return found.fits.front().log_evidence > before;
}

}  // namespace chladni::diagnosis
