#include "diagnosis/search/starts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "diagnosis/constants.h"
#include "diagnosis/search/quadratic.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Quadratic model of ½ misfit − ln prior in the coordinates of one cause.
Quadratic quadratic_at(const Scene& scene, const Supposed& cause,
                       const std::vector<Parameter>& parameters) {
  const auto moved = [&](const VectorXd& x) {
    State state = scene.state();
    cause.effect->apply(state, scene.structure(), cause.option, x);
    return state;
  };
  const State here = moved(cause.x);
  const Solved now = scene.solved_at(here);
  const VectorXd error = residual(scene.observed(), now.value);
  const auto count = static_cast<Index>(parameters.size());
  MatrixXd jacobian(error.size(), count);
  for (Index i = 0; i < count; ++i) {
    const VectorXd by = parameters[static_cast<std::size_t>(i)].step * VectorXd::Unit(count, i);
    jacobian.col(i) = weighted(
        scene.observed(), slope(here, now, moved(cause.x - by), moved(cause.x + by), 2.0 * by(i)));
  }
  Quadratic result{-jacobian.transpose() * error, jacobian.transpose() * jacobian};
  for (Index i = 0; i < count; ++i) {
    const auto& parameter = parameters[static_cast<std::size_t>(i)];
    if (!parameter.is_place()) result.add_prior(i, cause.x(i), parameter.centre, parameter.width);
  }
  return result;
}

// Makes a step that lowers the misfit. Returns the fall; 0: none was found.
double improve_once(const Scene& scene, const Quadratic& quadratic, Start& candidate,
                    double& lambda) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    Supposed next = candidate.cause;
    next.x += quadratic.step(lambda);
    keep_on_surface(scene.structure(), candidate.cause, next);
    const bool possible = std::isfinite(log_prior(next, scene.structure()));
    const double misfit =
        possible ? scene.misfits(*next.effect, {{next.option, next.x}})(0) : candidate.misfit;
    if (misfit < candidate.misfit) {
      lambda *= 0.2;
      candidate.cause = std::move(next);
      return candidate.misfit - std::exchange(candidate.misfit, misfit);
    }
    lambda *= 10.0;
  }
  return 0.0;
}

// Improves a start in the scene by Gauss-Newton steps.
Start improved(const Scene& scene, Start candidate) {
  const auto parameters = candidate.cause.effect->parameters(scene.structure());
  if (parameters.empty()) return candidate;
  double lambda = 1e-2;
  for (int iteration = 0; iteration < kConstants.start_iterations; ++iteration) {
    const auto quadratic = quadratic_at(scene, candidate.cause, parameters);
    const double fall = improve_once(scene, quadratic, candidate, lambda);
    const double part = kConstants.start_fall_part * candidate.misfit;
    if (fall < kConstants.start_fall + part) break;
  }
  return candidate;
}

// First step length of each coordinate.
VectorXd strides(const Scene& scene, const Supposed& cause) {
  const auto& structure = scene.structure();
  const auto parameters = cause.effect->parameters(structure);
  const double apart = std::sqrt(structure.surface.area.mean());
  VectorXd by(cause.x.size());
  for (Index i = 0; i < by.size(); ++i) {
    const auto& parameter = parameters[static_cast<std::size_t>(i)];
    const bool linear = parameter.scale == Parameter::Scale::linear;
    by(i) = parameter.is_place() ? kConstants.stride_of_place * apart
            : linear             ? kConstants.stride_of_difference * std::abs(cause.x(i))
                                 : kConstants.stride_of_logarithm;
  }
  return by;
}

// Direct search of Hooke and Jeeves (J. ACM 8, 1961): a step in each coordinate, then further along
// the sum of these steps. The steps are halved when they no longer help.
class DirectSearch {
 public:
  DirectSearch(const Scene& scene, const Start& start)
      : scene_(&scene), by_(strides(scene, start.cause)) {}

  /// Continues from `best` with at most about this many misfits.
  [[nodiscard]] Start from(Start best, int misfits) {
    left_ = misfits;
    for (int halved = 0; halved < kConstants.halvings && left_ > 0;) {
      Start next = explored(best);
      if (!(next.misfit < best.misfit)) {
        by_ *= 0.5;
        ++halved;
        continue;
      }
      while (next.misfit < best.misfit && left_ > 0) {
        Supposed on = next.cause;
        on.x += next.cause.x - best.cause.x;
        best = std::move(next);
        next = explored({on, misfit(on)});
      }
    }
    return best;
  }

 private:
  [[nodiscard]] double misfit(const Supposed& cause) {
    --left_;
    if (!std::isfinite(log_prior(cause, scene_->structure()))) return HUGE_VAL;
    return scene_->misfits(*cause.effect, {{cause.option, cause.x}})(0);
  }
  [[nodiscard]] Start explored(Start here) {
    for (Index i = 0; i < by_.size(); ++i) {
      for (const double side : {1.0, -1.0}) {
        Supposed next = here.cause;
        next.x(i) += side * by_(i);
        const double moved = misfit(next);
        if (!(moved < here.misfit)) continue;
        here = {std::move(next), moved};
        break;
      }
    }
    return here;
  }

  const Scene* scene_;
  VectorXd by_;
  int left_ = 0;
};

bool is_far(const Scene& scene, const Start& start) {
  const bool hangs = place_of(start.cause, scene.structure()).has_value();
  return hangs && start.misfit > kConstants.far_misfit * scene.observed().number_count() &&
         scene.is_cheap(start.cause);
}

// True for the same choice and the same place.
bool alike(const std::vector<Parameter>& parameters, const Supposed& cause,
           const EffectStart& other) {
  if (cause.option != other.option) return false;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    const auto c = static_cast<Index>(n);
    if (parameters[n].is_place() && cause.x(c) != other.x(c)) return false;
  }
  return true;
}

// The best starts that the effect offers, of different choices or places.
std::vector<Start> likeliest(const Scene& scene, const Effect& effect, std::size_t most) {
  const auto offered = effect.starts(scene);
  if (offered.empty()) return {};
  const VectorXd misfits = scene.misfits(effect, offered);
  std::vector<Index> order;
  for (Index i = 0; i < misfits.size(); ++i) {
    if (std::isfinite(misfits(i))) order.push_back(i);
  }
  std::ranges::stable_sort(order, [&](Index a, Index b) { return misfits(a) < misfits(b); });
  const auto parameters = effect.parameters(scene.structure());
  std::vector<Start> best;
  for (const auto i : order) {
    const auto& start = offered[static_cast<std::size_t>(i)];
    const bool again = std::ranges::any_of(
        best, [&](const Start& other) { return alike(parameters, other.cause, start); });
    if (again) continue;
    best.push_back({{&effect, start.option, start.x}, misfits(i)});
    if (best.size() == most) break;
  }
  return best;
}

// Keeps the best `most` starts. Those far from any fit are moved first: all a little, then the best
// ones further.
void move_far(const Scene& scene, std::vector<Start>& starts, std::size_t most) {
  std::vector<std::pair<Start, std::optional<DirectSearch>>> searches;
  for (auto& start : starts) {
    std::optional<DirectSearch> search;
    if (is_far(scene, start)) search.emplace(scene, start);
    if (search) start = search->from(std::move(start), kConstants.moves_first);
    searches.emplace_back(std::move(start), std::move(search));
  }
  std::ranges::stable_sort(searches, {}, [](const auto& pair) { return pair.first.misfit; });
  searches.resize(std::min(searches.size(), most));
  starts.clear();
  for (auto& [start, search] : searches) {
    starts.push_back(search ? search->from(std::move(start), kConstants.moves_further)
                            : std::move(start));
  }
  std::ranges::stable_sort(starts, {}, &Start::misfit);
}

}  // namespace

std::vector<Start> best_starts(const Scene& scene, const Effect& effect) {
  if (effect.options(scene.structure()) == 0) return {};
  auto best = likeliest(scene, effect, kConstants.starts_moved);
  move_far(scene, best, kConstants.starts_kept);
  for (auto& start : best) start = improved(scene, std::move(start));
  return best;
}

}  // namespace chladni::diagnosis
