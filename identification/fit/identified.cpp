#include "identification/identified.h"

#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "base/error.h"
#include "identification/constants.h"
#include "identification/delay_scan.h"
#include "identification/likelihood/compression.h"
#include "identification/poles/beyond_lines.h"
#include "identification/poles/mode_choice.h"
#include "identification/poles/order_search.h"
#include "identification/poles/start_poles.h"

namespace chladni::identification {
namespace {

// The poles that look repeated are used twice if that pays.
ModalFit first_fit(const FitData& data, const Start& start, const std::vector<Eigen::Index>& twice,
                   const FitOptions& options) {
  auto once = modal_fit(data, start, options);
  if (twice.empty()) return once;
  Start more = start;
  const auto n = start.pole.size();
  more.pole.conservativeResize(n + static_cast<Eigen::Index>(twice.size()));
  for (std::size_t t = 0; t < twice.size(); ++t) {
    more.pole(n + static_cast<Eigen::Index>(t)) = start.pole(twice[t]) * (1.0 + 1e-5);
  }
  auto fit = modal_fit(data, more, options);
  return pays(data, once, fit) ? fit : once;
}

// Delays of a fit with real modes: complex modes cannot give them, their phases look like delays.
Eigen::VectorXd delays_of_real_modes(const FitData& data, const Start& start,
                                     const FitOptions& options) {
  auto real = first_fit_options(options);
  real.damping = Damping::modal;
  return response_delays(modal_fit(data, start, real));
}

Identified from_start(const FitData& data, const Start& start,
                      const IdentificationOptions& options) {
  Identified result;
  std::vector<Eigen::Index> twice;
  if (options.modes == 0) {
    const ResidueProblem kept(data, start.pole, start.rigid_count > 0, options.fit.damping);
    twice = repeated(data, start.pole, kept.residues());
  }
  const auto few = data.noise_known ? first_fit_options(options.fit) : options.fit;
  result.fit = first_fit(data, start, twice, few);
  if (options.modes == 0 && !options.far_modes) {
    drop_modes_without_resonance(data, few, result.fit);
  }
  result.steps.push_back({result.fit.flexible_count(), result.fit.cost, result.fit.excess(), true});
  if (options.modes == 0 && data.noise_known) drop_idle_modes(data, few, result);
  if (data.noise_known && !result.fit.converged) {
    auto further = modal_fit(data, start_of(result.fit), options.fit);
    if (further.cost < result.fit.cost) result.fit = std::move(further);
  }
  add_missing_modes(data, options, result);
  if (options.modes == 0) look_above_lines(data, start, options, result);
  if (options.modes == 0 && !options.far_modes) {
    drop_modes_without_resonance(data, options.fit, result.fit);
  }
  if (options.modes == 0 && options.far_modes) drop_doubled_modes(data, options.fit, result);
  return result;
}

Start chosen_start(const FitData& data, const IdentificationOptions& options, Eigen::Index& order) {
  const auto found = start_poles(data, options);
  Start start;
  start.rigid_count = options.rigid_count >= 0
                          ? options.rigid_count
                          : rigid_rank(data, found.problem.residues(), options.most_rigid);
  start.pole = worthwhile(data, found.problem, found.pole, options.modes);
  require(start.pole.size() + start.rigid_count > 0,
          "identification: no resonance stands out of the noise in the band");
  order = found.order;
  return start;
}

// Whether a drift still matters where modes above the lines are fitted: what they add looks like
// one.
bool matters_beside_modes_above(const FitData& data, const Start& start, const FitOptions& all) {
  const auto options = first_fit_options(all);
  const auto above = with_modes_above(data, start, options.damping);
  const bool explains = modal_fit(data, above, options).cost <
                        Constants::above_explains * modal_fit(data, start, options).cost;
  return !explains || drift_fit(data, above, options).drift.matters();
}

// Finds the drift and, if it matters, takes it out of the data.
std::optional<Drift> drift_that_matters(FitData& data, const Start& found,
                                        const IdentificationOptions& options) {
  if (data.noise_stated || !options.drift || data.response_count() < 2 || found.pole.size() == 0) {
    return std::nullopt;
  }
  Start start;
  start.rigid_count = found.rigid_count;
  start.pole = strongest(data, found.pole, found.rigid_count > 0);
  auto [moved, fit] = drift_fit(data, start, options.fit);
  if (!moved.matters()) return std::nullopt;
  if (!matters_beside_modes_above(data, start, options.fit)) return std::nullopt;
  if (start.pole.size() < found.pole.size()) {  // perhaps the left-out poles are modes
    auto shifted = fit;
    shifted.parameter_count += data.response_count() - 1;  // their shifts about a mean of 0
    if (is_better(data, modal_fit(data, found, first_fit_options(options.fit)), shifted)) {
      return std::nullopt;
    }
  }
  data = without_drift(data, fit, moved.shift);
  return moved;
}

// Finds the modes from a start. Delays are fitted with real modes where the modes are complex.
Identified from_start_delayed(const FitData& data, const Start& start,
                              const IdentificationOptions& options) {
  if (!options.fit.delay || options.fit.damping != Damping::general) {
    return from_start(data, start, options);
  }
  const auto held = delays_of_real_modes(data, start, options.fit);
  const auto turned = undelayed(data, held);
  auto without = options;
  without.fit.delay = false;
  auto result = from_start(turned, start, without);
  free_delay(turned, options.fit, result.fit);
  put_back(held, options.fit.delay_of, result.fit);
  return result;
}

Identified from_all_responses(const FitData& measured, const IdentificationOptions& options) {
  // The delays are taken out of the data before the poles are found again.
  const auto delay = delays_at_start(measured, options);
  const auto data = options.fit.delay ? undelayed(measured, delay) : measured;
  Eigen::Index order = 0;
  const auto start = chosen_start(data, options, order);
  auto moved = data;
  const auto drift = drift_that_matters(moved, start, options);
  auto result = from_start_delayed(data, start, options);
  result.start_order = order;
  if (drift) {
    const auto again = chosen_start(moved, options, order);
    auto other = from_start_delayed(moved, again, options);
    if (is_better(data, other.fit, result.fit)) {
      result = std::move(other);
      result.start_order = order;
      result.drift = drift;
    }
  }
  if (options.fit.delay) put_back(delay, options.fit.delay_of, result.fit);
  return result;
}

// Delays, and what real residues at the poles that were found beside them leave.
struct ScannedDelays {
  Eigen::VectorXd delay_s;  // pq
  double cost = 0.0;
};

// Scans about first values, except of responses whose delays are held. A long delay bends phases so
// much that its poles are not the data's: they are sought without the first values.
using Held = Eigen::Array<bool, Eigen::Dynamic, 1>;
ScannedDelays scanned_beside(const FitData& data, const Eigen::VectorXd& first, const Held& held,
                             const IdentificationOptions& options) {
  const auto turned = undelayed(data, first);
  const auto found = start_poles(turned, options);
  const auto kept = worthwhile(turned, found.problem, found.pole, options.modes);
  const bool rigid = options.rigid_count != 0;
  const Eigen::VectorXd scanned = scanned_delays(turned, kept, rigid, options.fit.delay_of);
  const Eigen::VectorXd delay = first.array() + held.select(0.0, scanned.array());
  return {delay, ResidueProblem(undelayed(data, delay), kept, rigid).residues().cost};
}

// Fits again with modes at 0 Hz where springs hold the body and a fit without is far from the
// noise. Poles far below the lines are as good for a vector fit, but their residues cannot be told
// apart.
Identified on_springs(const FitData& measured, const IdentificationOptions& options) {
  auto found = from_all_responses(measured, options);
  if (!options.on_springs || !measured.noise_known ||
      noise_level(found.fit, measured) < Constants::bad_level) {
    return found;
  }
  auto with = options;
  with.rigid_count = -1;
  auto rigid = from_all_responses(measured, with);
  return rigid.fit.cost < found.fit.cost ? rigid : found;
}

// Finds poles from a few random combinations of the channels, then fits all directions that matter.
Identified from_compressed(const Compressed& small, const FitData& measured,
                           const IdentificationOptions& options) {
  const auto sketch = sketched(small.data, Constants::sketch);
  auto of_sketch = options;
  of_sketch.drift = false;  // each sketched response mixes all responses
  auto result = on_springs(sketch, of_sketch);
  if (sketch.response_count() < small.data.response_count()) {
    const double delay = result.fit.delay_s;
    const auto data = options.fit.delay ? undelayed(small.data, delay) : small.data;
    result.fit = modal_fit(data, start_at(result.fit.model), options.fit);
    result.steps.push_back(
        {result.fit.flexible_count(), result.fit.cost, result.fit.excess(), true});
    add_missing_modes(data, options, result);
    result.fit.delay_s += delay;
  }
  result.fit = expanded(result.fit, small, measured);
  return result;
}

}  // namespace

Eigen::VectorXd delays_at_start(const FitData& data, const IdentificationOptions& options) {
  const auto none = Eigen::VectorXd::Zero(data.response_count());
  if (!options.fit.delay) return none;
  const auto near = scanned_beside(data, none, Held::Constant(none.size(), false), options);
  const auto phases = phase_delays(data, options.fit.delay_of, options.fit.progress);
  // Damping lengthens what the phases say: within the reach of the scan the scan knows better.
  const double reached =
      (Constants::delay_high - Constants::delay_margin) / data.frequency_hz(data.line_count() - 1);
  const Held held = phases.array() < reached;
  if (held.all()) return near.delay_s;
  try {
    const Eigen::VectorXd first = held.select(near.delay_s.array(), phases.array());
    const auto far = scanned_beside(data, first, held, options);
    return far.cost < Constants::hardly_less * near.cost ? far.delay_s : near.delay_s;
  } catch (const NumericalFailure&) {  // the turned data determine no poles
    return near.delay_s;
  }
}

Identified identified(const FitData& measured, const IdentificationOptions& options) {
  const bool one_delay = !options.fit.delay || options.fit.delay_of == DelayOf::all;
  if (measured.response_count() > Constants::many_responses &&
      options.fit.damping == Damping::modal && one_delay) {
    if (const auto small = compressed(measured)) {
      return from_compressed(*small, measured, options);
    }
  }
  return on_springs(measured, options);
}

ModalFit refitted(const FitData& data, const ModalFit& fit, const FitOptions& options) {
  if (!options.delay) return modal_fit(data, start_at(fit.model), options);
  const auto delays = response_delays(fit);
  auto result = modal_fit(undelayed(data, delays), start_at(fit.model), options);
  put_back(delays, options.delay_of, result);
  return result;
}

void free_delay(const FitData& data, const FitOptions& options, ModalFit& fit) {
  auto free = modal_fit(data, start_of(fit), options);
  if (fit.cost - free.cost >
      0.5 * Constants::no_chance * Constants::no_chance * noise_level(fit, data)) {
    free.start_notes = fit.start_notes;
    free.notes.insert(free.notes.end(), fit.start_notes.begin(), fit.start_notes.end());
    fit = std::move(free);
  } else {
    fit.delay_std_s = free.delay_std_s;
    fit.channel_delay_std_s = free.channel_delay_std_s;
  }
}

void take_values(const ModalFit& from, ModalFit& into) {
  const auto modes = into.model.mode_count();
  if (into.complex || from.complex || from.model.mode_count() != modes) return;
  const auto before = into.model;
  into.model = from.model;
  for (Eigen::Index m = 0; m < modes; ++m) {
    const Eigen::ArrayXd along =
        before.output_shapes.col(m).cwiseProduct(into.model.output_shapes.col(m));
    if (into.output_std.col(m).array().isFinite().select(along, 0.0).sum() >= 0.0) continue;
    into.model.output_shapes.col(m) *= -1.0;
    into.model.input_shapes.row(m) *= -1.0;
  }
}

}  // namespace chladni::identification
