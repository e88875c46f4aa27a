#include "identification/poles/order_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/turn.h"
#include "identification/constants.h"
#include "identification/poles/beyond_lines.h"
#include "identification/poles/missing_mode.h"
#include "identification/poles/mode_choice.h"

namespace chladni::identification {
namespace {

// Which modes may be left out.
enum class Idle {
  worthless,  // those without worth at their poles
  weakest,    // the weakest ones, as long as the others can take their place
};

Start without_pole(Start start, Eigen::Index m) {
  const auto after = start.pole.size() - m - 1;
  start.pole.segment(m, after) = start.pole.tail(after).eval();
  start.pole.conservativeResize(start.pole.size() - 1);
  if (!start.general.empty()) start.general.erase(start.general.begin() + m);
  return start;
}

// Leaves out modes, one by one, as long as none of them pays.
bool drop_modes(const FitData& data, const FitOptions& options, Idle idle, Identified& result) {
  bool any = false;
  while (result.fit.flexible_count() > 1) {
    const auto start = start_at(result.fit.model);
    const auto residues =
        ResidueProblem(data, start.pole, start.rigid_count > 0, options.damping).residues();
    Eigen::Index weakest = 0;
    const double worth = residues.significance.minCoeff(&weakest);
    const bool has_worth = worth >= least_significance(data, residues.cost);
    if (has_worth && idle == Idle::worthless) break;
    auto fit = modal_fit(data, without_pole(start, weakest), options);
    const bool taken = !pays(data, fit, result.fit);
    result.steps.push_back({fit.flexible_count(), fit.cost, fit.excess(), taken});
    if (!taken) break;
    result.fit = std::move(fit);
    any = true;
  }
  return any;
}

// A start with one more mode. Complex modes stay as they are: fitted anew beside it, their residues
// often have no single direction, and the descent ends elsewhere.
Start one_more(const ModalFit& fit, const MissingMode& missing) {
  Start start = start_of(fit);
  start.pole.conservativeResize(start.pole.size() + 1);
  start.pole(start.pole.size() - 1) = missing.pole;
  if (fit.complex) start.general.push_back(missing.general);
  return start;
}

// The weaker one of two poles within this part of a bandwidth; -1: there are none.
Eigen::Index doubled_pole(const ModalFit& fit) {
  const auto pole = start_at(fit.model).pole;
  const auto rigid = fit.model.rigid_count;
  const auto size = [&](Eigen::Index m) {
    return fit.model.output_shapes.col(rigid + m).squaredNorm();
  };
  for (Eigen::Index m = 0; m < pole.size(); ++m) {
    for (Eigen::Index n = 0; n < m; ++n) {
      if (std::abs(pole(m) - pole(n)) < Constants::doubled * -pole(m).real()) {
        return size(m) < size(n) ? m : n;
      }
    }
  }
  return -1;
}

// A fit from another start, if there is one.
std::optional<ModalFit> fit_if_any(const FitData& data, const Start& start, const FitOptions& how) {
  try {
    return modal_fit(data, start, how);
  } catch (const InvalidInput&) {  // more parameters than numbers, a pole without damping
  } catch (const NumericalFailure&) {
  }
  return std::nullopt;
}

// A fit from another start, carried on only if the first iterations come near the cost of another.
std::optional<ModalFit> fit_if_near(const FitData& data, const Start& start, const FitOptions& how,
                                    double cost) {
  const auto few = first_fit_options(how);
  auto fit = fit_if_any(data, start, few);
  if (!fit || fit->cost > Constants::hopeless * cost) return std::nullopt;
  if (fit->converged || few.iterations >= how.iterations) return fit;
  return fit_if_any(data, start, how);
}

// The modes that may stand for some above the lines: those within of unusual damping, the weakest
// first, then the weakest of the others.
std::vector<Eigen::Index> doubtful_within(const FitData& data, const Start& start,
                                          Damping damping) {
  const bool rigid = start.rigid_count > 0;
  const auto worth = ResidueProblem(data, start.pole, rigid, damping).residues().significance;
  const auto usual = without_unusual(data, start.pole, rigid);
  std::vector<Eigen::Index> unusual;
  Eigen::Index weakest = -1;
  for (Eigen::Index m = 0; m < start.pole.size(); ++m) {
    if (std::abs(start.pole(m)) > kTwoPi * data.frequency_hz(data.line_count() - 1)) continue;
    if (std::find(usual.begin(), usual.end(), start.pole(m)) == usual.end()) {
      unusual.push_back(m);
    } else if (weakest < 0 || worth(m) < worth(weakest)) {
      weakest = m;
    }
  }
  std::sort(unusual.begin(), unusual.end(), [&](auto a, auto b) { return worth(a) < worth(b); });
  if (weakest >= 0) unusual.push_back(weakest);
  return unusual;
}

// Least part of the cost that a further mode must take. The model's own error draws modes as well,
// where it is a part of what is left.
double least_part(const FitData& data) { return Constants::least_decrease * data.error_share; }

// Whether a fit with a mode above the lines explains as much as one with a mode within, but for the
// least that a mode is worth: modes above exist, one within has to show.
bool explains_as_much(const FitData& data, const ModalFit& above, const ModalFit& within) {
  const double lost = above.cost - within.cost;
  return lost < least_part(data) * above.cost || lost < least_significance(data, within.cost);
}

// Exchanges a mode within the lines for one above them if that explains as much.
bool exchange_one(const FitData& data, const FitOptions& how, Identified& result) {
  const auto fitted = start_at(result.fit.model);
  for (const auto m : doubtful_within(data, fitted, how.damping)) {
    if (how.keep_best && interrupted()) return false;
    const auto start = with_mode_above(data, without_pole(fitted, m), how.damping);
    auto fit = fit_if_near(data, start, how, result.fit.cost);
    const bool taken = fit && explains_as_much(data, *fit, result.fit);
    if (fit) result.steps.push_back({fit->flexible_count(), fit->cost, fit->excess(), taken});
    if (!taken) continue;
    result.fit = *std::move(fit);
    return true;
  }
  return false;
}

// Exchanges modes within the lines for some above them, as long as those explain as much.
bool exchange_for_modes_above(const FitData& data, const FitOptions& how, Identified& result) {
  const auto most = result.fit.flexible_count();
  Eigen::Index count = 0;
  while (count < most && exchange_one(data, how, result)) ++count;
  return count > 0;
}

// Whether a search has added a mode.
bool has_added_modes(const Identified& result) {
  Eigen::Index modes = result.steps.front().modes;
  for (const auto& step : result.steps) {
    if (!step.taken) continue;
    if (step.modes > modes) return true;
    modes = step.modes;
  }
  return false;
}

// Fits poles and modes above the lines, and takes that fit if it is the better one.
bool try_above(const FitData& data, const Start& start, const FitOptions& how,
               const IdentificationOptions& options, Identified& result) {
  const auto more = with_modes_above(data, start, how.damping);
  if (start.pole.size() == 0 || more.pole.size() == start.pole.size()) return false;
  auto fit = fit_if_near(data, more, how, result.fit.cost);
  if (!fit) return false;
  if (!options.far_modes) drop_modes_without_resonance(data, how, *fit);
  Identified above{.fit = *std::move(fit), .steps = {}, .start_order = 0, .drift = {}};
  drop_idle_modes(data, how, above);
  const bool as_many = above.fit.parameter_count == result.fit.parameter_count;
  const bool taken = as_many ? explains_as_much(data, above.fit, result.fit)
                             : is_better(data, above.fit, result.fit);
  result.steps.push_back({above.fit.flexible_count(), above.fit.cost, above.fit.excess(), taken});
  if (taken) result.fit = std::move(above.fit);
  return taken;
}

}  // namespace

bool pays(const FitData& data, const ModalFit& before, const ModalFit& after) {
  const double level = noise_level(after, data);
  const double parameters = static_cast<double>(after.parameter_count - before.parameter_count);
  const double needed = 0.5 * level * std::max(1.0, parameters) *
                        std::log(static_cast<double>(data.measured_count()));
  const double won = before.cost - after.cost;
  const auto more = std::max<Eigen::Index>(1, after.flexible_count() - before.flexible_count());
  return won > needed && won > least_part(data) * static_cast<double>(more) * before.cost;
}

bool is_better(const FitData& data, const ModalFit& one, const ModalFit& other) {
  return one.parameter_count > other.parameter_count ? pays(data, other, one)
                                                     : !pays(data, one, other);
}

bool is_enough(const FitData& data, const IdentificationOptions& options, const ModalFit& fit) {
  if (!data.noise_known) return false;
  return fit.excess() < Constants::enough_excess ||
         (options.far_modes && noise_level(fit, data) < Constants::good_level);
}

void drop_idle_modes(const FitData& data, const FitOptions& options, Identified& result) {
  drop_modes(data, options, Idle::worthless, result);
}

namespace {

// Adds the mode that explains most of what is left, or one above the lines if `above` is true and
// that explains as much.
void add_modes(const FitData& data, const IdentificationOptions& options, bool above,
               Identified& result) {
  const auto room = data.measured_count() / (2 * parameters_of_mode(data, options.fit.damping));
  const auto most = options.modes > 0 ? options.modes : std::min(options.most_modes, room);
  while (result.fit.flexible_count() < most) {
    if (options.fit.keep_best && interrupted()) break;
    const bool wanted = options.modes > result.fit.flexible_count();
    if (!wanted && is_enough(data, options, result.fit)) break;
    const auto candidate = missing_mode(data, result.fit);
    if (!wanted && is_satellite(data, result.fit, candidate.pole)) break;
    const auto start = one_more(result.fit, candidate);
    auto fit = wanted ? modal_fit(data, start, options.fit) : fit_if_any(data, start, options.fit);
    if (above) {
      auto other =
          fit_if_near(data, with_mode_above(data, start_at(result.fit.model), options.fit.damping),
                      options.fit, result.fit.cost);
      if (other && (!fit || !pays(data, *other, *fit))) fit = std::move(other);
    }
    if (!fit) break;
    const bool taken = wanted || (pays(data, result.fit, *fit) &&
                                  (options.far_modes || !has_mode_without_resonance(data, *fit)));
    result.steps.push_back({fit->flexible_count(), fit->cost, fit->excess(), taken});
    if (!taken) break;
    result.fit = *std::move(fit);
  }
}

}  // namespace

void add_missing_modes(const FitData& data, const IdentificationOptions& options,
                       Identified& result) {
  add_modes(data, options, false, result);
}

void drop_doubled_modes(const FitData& data, const FitOptions& options, Identified& result) {
  for (Eigen::Index m = 0; result.fit.complex && (m = doubled_pole(result.fit)) >= 0;) {
    auto fit = modal_fit(data, without_pole(start_of(result.fit), m), options);
    const bool taken = !pays(data, fit, result.fit);
    result.steps.push_back({fit.flexible_count(), fit.cost, fit.excess(), taken});
    if (!taken) return;
    result.fit = std::move(fit);
  }
}

void look_above_lines(const FitData& data, const Start& start, const IdentificationOptions& options,
                      Identified& result) {
  const auto usual = [&](Start of) {
    of.pole = without_unusual(data, of.pole, of.rigid_count > 0);
    return of;
  };
  const auto few = first_fit_options(options.fit);
  bool any = false;
  if (!is_enough(data, options, result.fit)) {
    any = try_above(data, start, few, options, result);
    const auto less = usual(start);
    if (less.pole.size() < start.pole.size()) {
      any = try_above(data, less, few, options, result) || any;
    }
    if (any) add_modes(data, options, true, result);
  }
  for (int round = 0; round < Constants::rounds_above; ++round) {
    if (options.fit.keep_best && interrupted()) return;
    const auto fitted = start_at(result.fit.model);
    const auto less = usual(fitted);
    if (less.pole.size() == fitted.pole.size() ||
        !try_above(data, less, options.fit, options, result)) {
      break;
    }
    any = true;
    add_modes(data, options, true, result);
  }
  if (!any && !has_added_modes(result) && is_enough(data, options, result.fit)) return;
  // Where much more than noise is left, the model is another one.
  const bool near_noise = !data.noise_known || noise_level(result.fit, data) < Constants::bad_level;
  for (int round = 0; near_noise && round < Constants::rounds_above; ++round) {
    const bool exchanged = exchange_for_modes_above(data, options.fit, result);
    const bool dropped = drop_modes(data, options.fit, Idle::weakest, result);
    if (!exchanged && !dropped) return;
  }
}

}  // namespace chladni::identification
