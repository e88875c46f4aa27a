#include "identification/gain_match.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/error.h"
#include "identification/gains/imaginary_rows.h"
#include "identification/gains/matching.h"
#include "identification/gains/pair_evidence.h"
#include "identification/gains/unknown_values.h"

namespace chladni::identification {

namespace {

void check_input(const ModalFit& fit, const Channels& outputs, const Channels& inputs,
                 const GainMatchOptions& options) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  require(std::ssize(outputs) == p && std::ssize(inputs) == q,
          fmt::format("gain match: {} and {} channels for a fit of {} outputs and {} inputs",
                      outputs.size(), inputs.size(), p, q));
  std::set<Eigen::Index> left;
  std::set<Eigen::Index> right;
  for (const auto& pair : options.pairs) {
    require(pair.output >= 0 && pair.output < p && pair.input >= 0 && pair.input < q,
            fmt::format("gain match: a pair of output {} and input {}; there are {} and {}",
                        pair.output + 1, pair.input + 1, p, q));
    const bool once = left.insert(pair.output).second && right.insert(pair.input).second;
    require(once, "gain match: " + outputs[static_cast<std::size_t>(pair.output)].name + " or " +
                      inputs[static_cast<std::size_t>(pair.input)].name +
                      " is in two collocated pairs");
  }
  if (!options.geometry) return;
  const auto& geometry = *options.geometry;
  require(geometry.outputs.rows() == p && geometry.inputs.rows() == q &&
              geometry.outputs.cols() == geometry.inputs.cols(),
          fmt::format("gain match: rigid directions of {} sensors and {} actuators; expected {} "
                      "and {}",
                      geometry.outputs.rows(), geometry.inputs.rows(), p, q));
  for (const auto mode : geometry.suspended) {
    require(mode >= fit.model.rigid_count && mode < fit.model.mode_count(),
            fmt::format("gain match: suspended mode {} is not a mode above 0 Hz", mode + 1));
  }
}

void scale_rigid_covariance(Matching& state, bool is_output, Eigen::Index channel, double factor) {
  auto& covariance = state.fit.rigid_covariance;
  const auto r = state.fit.model.rigid_count;
  if (covariance.rows() != r * (state.p() + state.q())) return;
  for (Eigen::Index m = 0; m < r; ++m) {
    const auto place = is_output ? m * state.p() + channel : r * state.p() + channel * r + m;
    covariance.row(place) *= factor;
    covariance.col(place) *= factor;
  }
}

// Multiplies the values of one channel, and their covariances, by a factor.
void scale_channel(Matching& state, bool is_output, Eigen::Index channel, double factor) {
  auto& model = state.fit.model;
  const bool has_residual = model.residual.size() > 0;
  if (is_output) {
    model.output_shapes.row(channel) *= factor;
    if (has_residual) model.residual.row(channel) *= factor;
  } else {
    model.input_shapes.col(channel) *= factor;
    if (has_residual) model.residual.col(channel) *= factor;
  }
  if (auto& complex = state.fit.complex) {
    if (is_output) {
      complex->outputs.row(channel) *= factor;
      complex->output_imaginary_std.row(channel) *= factor;
    } else {
      complex->inputs.col(channel) *= factor;
      complex->input_imaginary_std.col(channel) *= factor;
    }
  }
  const auto place = 2 + (is_output ? channel : state.p() + channel);
  for (auto& covariance : state.fit.mode_covariance) {
    if (covariance.rows() != 2 + state.p() + state.q()) continue;
    covariance.row(place) *= factor;
    covariance.col(place) *= factor;
  }
  scale_rigid_covariance(state, is_output, channel, factor);
}

// Divides the values of one side of a pair by the pair's gain.
void correct_gains(Matching& state) {
  const auto& options = state.options;
  if (options.fault == GainFault::nobody) return;
  const bool is_output = options.fault == GainFault::outputs;
  const Eigen::VectorXd doubts = gain_doubts(state.match.pairs);
  for (std::size_t c = 0; c < options.pairs.size(); ++c) {
    const auto& pair = options.pairs[c];
    const auto& gain = state.match.pairs[c];
    scale_channel(state, is_output, is_output ? pair.output : pair.input,
                  is_output ? 1.0 / gain.ratio : gain.ratio);
    const auto row = static_cast<Eigen::Index>(c);
    state.ratios.deviation.row(row) = (state.ratios.deviation.row(row).array().square() +
                                       (doubts(row) * state.ratios.value.row(row).array()).square())
                                          .sqrt();
  }
}

// Excludes a pair from a mode where its residue has an impossible sign.
void leave_out_contradictions(Matching& state) {
  const auto n = state.signs.size();
  for (Eigen::Index c = 0; c < n; ++c) {
    for (std::size_t g = 0; g < state.groups.size(); ++g) {
      const auto column = static_cast<Eigen::Index>(g);
      const double value = state.side * state.signs(c) * state.residues.value(c, column);
      if (!state.residues.telling(c, column) || value > 0.0) continue;
      state.residues.telling(c, column) = false;
      state.match.warnings.push_back(fmt::format(
          "{}: the residue of {} is negative there, others are not: not used for it; it is not one "
          "place, or the mode is blended with another",
          state.pair_name(c), state.mode_name(state.groups[g])));
    }
  }
}

void find_signs(Matching& state) {
  state.signs = pair_signs(state.residues);
  const auto n = state.signs.size();
  const bool any = (state.residues.telling.array()).any();
  if (any && n > 0 && (state.signs.array() < 0).all()) {
    state.side = -1;
    state.signs.setOnes();
    state.match.warnings.push_back(
        n == 1 ? state.pair_name(0) +
                     ": turned around: its residues are negative; all actuators are taken to count "
                     "against the sensors, but it may be this sensor or this actuator alone"
               : "all pairs are turned around: sensors and actuators count in opposite directions");
  } else if (!any) {
    const auto told = side_by_motion(state);
    state.side = told.side;
    if (state.side < 0) {
      state.match.warnings.emplace_back(
          told.by == ToldSide::at_zero
              ? "the modes at 0 Hz say that sensors and actuators count in opposite directions: "
                "the mass of the body would be negative"
              : "the suspended modes say that sensors and actuators count in opposite directions");
    }
  }
  for (Eigen::Index c = 0; c < n; ++c) {
    if (state.signs(c) > 0) continue;
    state.match.pairs[static_cast<std::size_t>(c)].turned = true;
    state.match.warnings.push_back(state.pair_name(c) +
                                   ": turned around: this sensor or this actuator counts against "
                                   "its direction");
  }
  leave_out_contradictions(state);
}

void gather_rows(Matching& state) {
  auto& match = state.match;
  for (Eigen::Index i = 0; i < state.p(); ++i) match.rows.push_back({false, i});
  for (Eigen::Index j = 0; j < state.q(); ++j) {
    const bool shares = std::ranges::any_of(state.options.pairs, [&](const CollocatedPair& pair) {
      return pair.input == j && pair.is_one_place();
    });
    if (!shares) match.rows.push_back({true, j});
  }
  const auto count = std::ssize(match.rows);
  match.shapes.conservativeResize(count, Eigen::NoChange);
  match.deviation.conservativeResize(count, Eigen::NoChange);
  for (Eigen::Index k = state.p(); k < count; ++k) {
    const auto j = match.rows[static_cast<std::size_t>(k)].channel;
    match.shapes.row(k) = state.at_inputs.row(j);
    match.deviation.row(k) = state.at_inputs_std.row(j);
  }
}

// The sign of the inputs as a whole. Pairs and motions tell it of all modes at once; the simulation
// tells it mode by mode, and most of its modes count.
int sign_of_inputs(const Matching& state) {
  int votes = 0;
  for (const auto& mode : state.match.modes) {
    if (mode.by == MatchedBy::pairs || mode.by == MatchedBy::geometry) return state.side;
    if (mode.by == MatchedBy::prior) votes += mode.sign;
  }
  if (votes == 0) return state.side;
  return votes < 0 ? -1 : 1;
}

Matching started(const ModalFit& fit, const Channels& outputs, const Channels& inputs,
                 const GainMatchOptions& options) {
  Matching state{fit, outputs, inputs, options, matched_groups(fit), {}, {}, {}, 1, {}, {}, {}};
  const auto m = fit.model.mode_count();
  bound_unknown(state.fit);
  state.ratios = place_ratios(options.pairs, m, options.simulation_error);
  state.match.modes.resize(static_cast<std::size_t>(m));
  state.match.mode_covariance.resize(static_cast<std::size_t>(m));
  state.match.pairs.resize(options.pairs.size());
  state.match.shapes = state.match.deviation = Eigen::MatrixXd::Zero(state.p(), m);
  state.match.input_shapes = state.match.input_deviation = Eigen::MatrixXd::Zero(m, state.q());
  state.at_inputs = state.at_inputs_std = Eigen::MatrixXd::Zero(state.q(), m);
  return state;
}

// Distance of two channels that act along one line, seen along it; infinite where they do not.
double distance_on_line(const modal::MeasuredChannel& output, const modal::MeasuredChannel& input) {
  constexpr double kOneLine = 0.999;  // cosine of the angle between their directions
  const auto states = [](const auto& channel) { return !channel.direction.isZero(); };
  if (states(output) && states(input) &&
      std::abs(output.direction.dot(input.direction)) <= kOneLine) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector3d line = states(output) ? output.direction : input.direction;
  const Eigen::Vector3d apart = *output.position - *input.position;
  return (apart - line * line.dot(apart)).norm();
}

// The sign of each mode's input shapes over those of the fit, m.
Eigen::VectorXd signs_of_modes(const GainMatch& match) {
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(match.input_shapes.rows());
  for (std::size_t m = 0; m < match.modes.size(); ++m) {
    signs(static_cast<Eigen::Index>(m)) = match.modes[m].sign;
  }
  return signs;
}

}  // namespace

std::vector<CollocatedPair> collocated_pairs(const std::vector<modal::MeasuredChannel>& outputs,
                                             const std::vector<modal::MeasuredChannel>& inputs,
                                             double within_m) {
  struct Near {
    double distance;  // seen along the line
    double apart;     // also along it
    Eigen::Index output, input;
  };
  constexpr double kSame = 1e-6;  // [m]: rounding of places decides no pair
  std::vector<Near> near;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < inputs.size(); ++j) {
      if (!outputs[i].position || !inputs[j].position) continue;
      const double distance = distance_on_line(outputs[i], inputs[j]);
      if (distance <= within_m) {
        near.push_back({kSame * std::round(distance / kSame),
                        (*outputs[i].position - *inputs[j].position).norm(),
                        static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)});
      }
    }
  }
  std::ranges::stable_sort(near, {},
                           [](const Near& one) { return std::pair(one.distance, one.apart); });
  std::set<Eigen::Index> left;
  std::set<Eigen::Index> right;
  std::vector<CollocatedPair> pairs;
  for (const auto& one : near) {
    if (left.contains(one.output) || right.contains(one.input)) continue;
    left.insert(one.output);
    right.insert(one.input);
    const auto& output = outputs[static_cast<std::size_t>(one.output)];
    const auto& input = inputs[static_cast<std::size_t>(one.input)];
    pairs.push_back({one.output, one.input, {}, {}, sign_of_pair(output, input)});
  }
  std::ranges::sort(pairs, {}, &CollocatedPair::output);
  return pairs;
}

bool contradicted(const ModeMatch& mode) {
  const auto freedoms = static_cast<double>(mode.freedoms);
  return mode.freedoms > 0 && mode.disagreement >= freedoms + 5.0 * std::sqrt(2.0 * freedoms) + 4.0;
}

GainMatch gain_match(const ModalFit& fit, const std::vector<modal::MeasuredChannel>& outputs,
                     const std::vector<modal::MeasuredChannel>& inputs,
                     const GainMatchOptions& options) {
  check_input(fit, outputs, inputs, options);
  auto state = started(fit, outputs, inputs, options);
  agree_in_phase(state);
  state.residues =
      pair_residues(state.fit, state.groups, options.pairs, state.ratios, options.significance);
  find_signs(state);
  auto gains = pair_gains(state.fit, state.groups, options.pairs, state.ratios, state.residues);
  for (std::size_t c = 0; c < gains.gains.size(); ++c) {
    gains.gains[c].turned = state.match.pairs[c].turned;
    state.match.pairs[c] = gains.gains[c];
  }
  correct_gains(state);
  warn_of_gains(state, gains.left);
  for (std::size_t group = 0; group < state.groups.size(); ++group) match_group(state, group);
  warn_of_disagreement(state);
  warn_of_prior(state);
  mark_unknown(fit, state);
  state.match.side = sign_of_inputs(state);
  state.match.residual = state.match.side * state.fit.model.residual;
  state.match.residual_known = fit.residual_std.array().isFinite();
  gather_rows(state);
  add_imaginary_rows(state);
  return std::move(state.match);
}

Eigen::MatrixXd driving_shapes(const GainMatch& match) {
  return match.input_shapes.array().colwise() * signs_of_modes(match).array();
}

Eigen::MatrixXd driving_imaginary(const GainMatch& match) {
  if (match.input_imaginary.size() == 0) return {};
  return match.input_imaginary.array().colwise() * signs_of_modes(match).array();
}

modal::ReducedModel extended_model(const ModalFit& fit, const GainMatch& match) {
  auto model = fit.model;
  model.output_shapes = match.shapes;
  model.input_shapes = match.input_shapes;
  model.residual = Eigen::MatrixXd::Zero(match.shapes.rows(), fit.model.input_count());
  if (match.residual.size() > 0) model.residual.topRows(match.residual.rows()) = match.residual;
  return model;
}

modal::ReducedModel driven_model(const ModalFit& fit, const GainMatch& match) {
  auto model = extended_model(fit, match);
  model.input_shapes = driving_shapes(match);
  model.residual *= match.side;
  return model;
}

}  // namespace chladni::identification
