#include "identification/gains/matching.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.h"
#include "identification/constants.h"
#include "identification/gains/block_covariance.h"
#include "identification/gains/matched_sides.h"
#include "identification/gains/told_by_prior.h"

namespace chladni::identification {

namespace {

// The pairs that count for a group, with their known factors. A block takes only pairs at one
// place: no simulated mode belongs to it.
Ties ties_of(const Matching& state, std::size_t group) {
  Ties ties;
  const auto g = static_cast<Eigen::Index>(group);
  const auto mode = state.groups[group].first;
  std::vector<double> ratio;
  std::vector<double> deviation;
  for (Eigen::Index c = 0; c < std::ssize(state.options.pairs); ++c) {
    const auto& pair = state.options.pairs[static_cast<std::size_t>(c)];
    if (!state.residues.telling(c, g)) continue;
    if (state.groups[group].size > 1 && !pair.is_one_place()) continue;
    ties.outputs.push_back(pair.output);
    ties.inputs.push_back(pair.input);
    ratio.push_back(state.signs(c) * state.ratios.value(c, mode));
    deviation.push_back(state.ratios.deviation(c, mode));
  }
  ties.ratio = Eigen::Map<Eigen::VectorXd>(ratio.data(), std::ssize(ratio));
  ties.ratio_std = Eigen::Map<Eigen::VectorXd>(deviation.data(), std::ssize(deviation));
  return ties;
}

using Scaling = std::function<OneScale(const TwoSides&)>;

// Covariance of ω, ζ and both sides of a mode, with the sign of the sides; the poles have none
// where the fit gives none.
Eigen::MatrixXd with_poles(const Matching& state, Eigen::Index mode, const TwoSides& sides) {
  const auto both = sides.covariance.rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 + both, 2 + both);
  covariance.bottomRightCorner(both, both) = sides.covariance;
  if (mode >= std::ssize(state.fit.mode_covariance)) return covariance;
  const auto& fitted = state.fit.mode_covariance[static_cast<std::size_t>(mode)];
  if (fitted.rows() != 2 + both) return covariance;
  covariance.topRows(2) = fitted.topRows(2);
  covariance.leftCols(2) = fitted.leftCols(2);
  covariance.topRightCorner(2, state.q()) *= state.side;
  covariance.bottomLeftCorner(state.q(), 2) *= state.side;
  return covariance;
}

// Scales the mode and computes the deviations of all results.
void apply(Matching& state, std::size_t group, const Scaling& scaling, MatchedBy by) {
  const auto mode = state.groups[group].first;
  const auto p = state.p();
  const auto q = state.q();
  const auto sides = sides_of(state, group);
  const auto n = sides.ties.count();
  const auto scaled = scaling(sides);
  Eigen::VectorXd x(2 + p + q + n);
  x << Eigen::Vector2d::Zero(), sides.outputs, sides.inputs, sides.ties.ratio;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(x.size(), x.size());
  covariance.topLeftCorner(2 + p + q, 2 + p + q) = with_poles(state, mode, sides);
  covariance.bottomRightCorner(n, n) = sides.ties.ratio_std.cwiseAbs2().asDiagonal();
  const auto value = [&](const Eigen::VectorXd& at) {
    auto moved = sides;
    moved.outputs = at.segment(2, p);
    moved.inputs = at.segment(2 + p, q);
    moved.ties.ratio = at.tail(n);
    const auto one = scaling(moved);
    Eigen::VectorXd all(2 + p + 2 * q + 1);
    all << at.head(2), one.outputs, one.inputs, one.at_inputs, one.log_alpha;
    return all;
  };
  const auto factor = propagated_factor(value, x, covariance_factor(covariance));
  const Eigen::VectorXd deviation = factor.bottomRows(p + 2 * q + 1).rowwise().norm();
  const auto followed = factor.topRows(2 + p + q);
  auto& match = state.match;
  match.mode_covariance[static_cast<std::size_t>(mode)] = followed * followed.transpose();
  match.shapes.col(mode).head(p) = scaled.outputs;
  match.deviation.col(mode).head(p) = deviation.head(p);
  match.input_shapes.row(mode) = scaled.inputs.transpose();
  match.input_deviation.row(mode) = deviation.segment(p, q).transpose();
  state.at_inputs.col(mode) = scaled.at_inputs;
  state.at_inputs_std.col(mode) = deviation.segment(p + q, q);
  auto& told = match.modes[static_cast<std::size_t>(mode)];
  told.by = by;
  told.alpha = std::exp(scaled.log_alpha);
  told.alpha_std = told.alpha * deviation(p + 2 * q);
  told.sign = state.side;
  told.disagreement = scaled.chi_square;
}

// A guess: gives both sides the same rms.
void leave_unmatched(Matching& state, const modal::ModeGroup& group) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const auto& model = state.fit.model;
  for (Eigen::Index m = group.first; m < group.first + group.size; ++m) {
    const double l = model.output_shapes.col(m).norm() / std::sqrt(static_cast<double>(state.p()));
    const double r = model.input_shapes.row(m).norm() / std::sqrt(static_cast<double>(state.q()));
    const double alpha = l > 0.0 && r > 0.0 ? std::sqrt(l / r) : 1.0;
    auto& match = state.match;
    match.shapes.col(m).head(state.p()) = model.output_shapes.col(m) / alpha;
    match.input_shapes.row(m) = state.side * alpha * model.input_shapes.row(m);
    state.at_inputs.col(m) = match.input_shapes.row(m).transpose();
    match.deviation.col(m).setConstant(kInfinite);
    match.input_deviation.row(m).setConstant(kInfinite);
    state.at_inputs_std.col(m).setConstant(kInfinite);
    auto& told = match.modes[static_cast<std::size_t>(m)];
    told = {MatchedBy::nothing, alpha, kInfinite, state.side, 0.0, 0};
  }
}

using BlockScaling = std::function<BlockSides(const Eigen::MatrixXd&, const Eigen::MatrixXd&)>;

// One column for each mode of the block: L above, R below.
Eigen::VectorXd columns_of(const BlockSides& block) {
  Eigen::MatrixXd columns(block.outputs.rows() + block.inputs.cols(), block.outputs.cols());
  columns << block.outputs, block.inputs.transpose();
  return columns.reshaped();
}

BlockSides block_of(const Eigen::VectorXd& columns, Eigen::Index p, Eigen::Index g) {
  const Eigen::MatrixXd both = columns.reshaped(columns.size() / g, g);
  return {both.topRows(p), both.bottomRows(both.rows() - p).transpose()};
}

void apply(Matching& state, const modal::ModeGroup& group, const BlockScaling& scaling,
           MatchedBy by) {
  const auto p = state.p();
  const auto q = state.q();
  const auto g = group.size;
  const Eigen::VectorXd x = columns_of(fitted_block(state, group));
  const Eigen::MatrixXd factor = covariance_factor(block_covariance(state, group));
  const auto value = [&](const Eigen::VectorXd& at) {
    const auto moved = block_of(at, p, g);
    return columns_of(scaling(moved.outputs, moved.inputs));
  };
  const Eigen::MatrixXd scaled = value(x).reshaped(p + q, g);
  const Eigen::MatrixXd deviation = propagated(value, x, factor).reshaped(p + q, g);
  auto& match = state.match;
  match.shapes.topRows(p).middleCols(group.first, g) = scaled.topRows(p);
  match.deviation.topRows(p).middleCols(group.first, g) = deviation.topRows(p);
  match.input_shapes.middleRows(group.first, g) = scaled.bottomRows(q).transpose();
  match.input_deviation.middleRows(group.first, g) = deviation.bottomRows(q).transpose();
  state.at_inputs.middleCols(group.first, g) = scaled.bottomRows(q);
  state.at_inputs_std.middleCols(group.first, g) = deviation.bottomRows(q);
  for (Eigen::Index m = group.first; m < group.first + g; ++m) {
    match.modes[static_cast<std::size_t>(m)] = {by, 1.0, 0.0, state.side, 0.0, 0};
  }
}

void match_by_mass(Matching& state, const modal::ModeGroup& group) {
  const auto& geometry = *state.options.geometry;
  const Eigen::MatrixXd deviation = product_deviation(state, group);
  const auto body_of = [&](const Eigen::MatrixXd& l, const Eigen::MatrixXd& r) {
    return rigid_body(l * r, deviation, geometry.outputs, geometry.inputs);
  };
  const auto g = group.size;
  const auto fitted = fitted_block(state, group);
  auto body = body_of(fitted.outputs, fitted.inputs);
  const auto scaling = [&](const Eigen::MatrixXd& l, const Eigen::MatrixXd& r) {
    const auto modes = body_of(l, r).modes;
    return BlockSides{geometry.outputs * modes, (geometry.inputs * modes).transpose()};
  };
  apply(state, group, scaling, MatchedBy::geometry);
  const auto left = static_cast<double>(deviation.size() - g * (g + 1) / 2);
  if (left > 0.0 && body.misfit > 1.0 + 5.0 * std::sqrt(2.0 / left)) {
    state.match.warnings.push_back(
        fmt::format("modes at 0 Hz: a rigid body leaves {:.3g} times the noise's square; are the "
                    "channels' places and gains right?",
                    body.misfit));
  }
  const auto inverse_mass = [&](const Eigen::VectorXd& at) {
    const auto block = block_of(at, state.p(), g);
    const Eigen::MatrixXd modes = body_of(block.outputs, block.inputs).modes;
    return lower_entries(modes * modes.transpose());
  };
  const Eigen::MatrixXd factor = propagated_factor(
      inverse_mass, columns_of(fitted), covariance_factor(block_covariance(state, group)));
  body.inverse_covariance = std::max(1.0, body.misfit) * (factor * factor.transpose());
  state.match.rigid = body;
}

void match_block(Matching& state, std::size_t group) {
  const auto ties = ties_of(state, group);
  const auto scaling = [&](const Eigen::MatrixXd& l, const Eigen::MatrixXd& r) {
    const Eigen::MatrixXd turn = block_transformation(l, r, ties);
    return BlockSides{l * turn, turn.partialPivLu().solve(r)};
  };
  apply(state, state.groups[group], scaling, MatchedBy::pairs);
}

bool match_by_prior(Matching& state, std::size_t group) {
  const auto mode = state.groups[group].first;
  const double frequency_hz = state.fit.model.frequency_hz(mode);
  if (!state.options.prior || frequency_hz <= 0.0) return false;
  const auto& prior = *state.options.prior;
  const auto all_told = told_by_prior(sides_of(state, group), frequency_hz, prior);
  const auto& found = all_told.gain;
  const auto p = state.p();
  apply(
      state, group,
      [&](const TwoSides& at) {
        const double alpha = std::exp(0.5 * found.log_gain);
        OneScale scaled;
        scaled.outputs = at.outputs / alpha;
        scaled.inputs = scaled.at_inputs = found.sign * alpha * at.inputs;
        scaled.log_alpha = std::log(alpha);
        return scaled;
      },
      MatchedBy::prior);
  auto& match = state.match;
  const double relative = 0.5 * found.deviation;
  const double at_inputs = std::hypot(relative, deviation_of_sign(found.certainty));
  const auto widen = [](double part, auto deviation, const auto& values) {
    deviation = (deviation.array().square() + (part * values.array()).square()).sqrt();
  };
  widen(relative, match.deviation.col(mode).head(p), match.shapes.col(mode).head(p));
  widen(at_inputs, match.input_deviation.row(mode), match.input_shapes.row(mode));
  widen(at_inputs, state.at_inputs_std.col(mode), state.at_inputs.col(mode));
  auto& told = match.modes[static_cast<std::size_t>(mode)];
  told.alpha_std = told.alpha * relative;
  told.sign = state.side * found.sign;
  for (const auto& doubt : doubts_of_told(all_told, prior.aside.size())) {
    match.warnings.push_back(state.mode_name(state.groups[group]) + ": " + doubt);
  }
  return true;
}

// Adds the possible bending, a part of the shape's rms, to the deviations of rows that
// follow the motion.
void widen_by_bending(Matching& state, Eigen::Index mode, bool only_at_inputs) {
  const double bending = state.options.geometry->bending;
  auto& match = state.match;
  const auto shape = match.shapes.col(mode).head(state.p());
  const double off = bending * shape.norm() / std::sqrt(static_cast<double>(state.p()));
  const auto widen = [&](auto deviation) {
    deviation = (deviation.array().square() + off * off).sqrt();
  };
  widen(state.at_inputs_std.col(mode));
  if (only_at_inputs) return;
  widen(match.deviation.col(mode).head(state.p()));
  widen(match.input_deviation.row(mode));
}

void match_by_motion(Matching& state, std::size_t group) {
  const auto& geometry = *state.options.geometry;
  const bool by_sensors =
      state.options.rule == GainRule::thesis && ties_of(state, group).count() > 0;
  apply(
      state, group,
      [&](const TwoSides& at) {
        return by_sensors
                   ? extrapolated_from_sensors(at, geometry.outputs, geometry.inputs)
                   : scaled_by_motion(at, geometry.outputs, geometry.inputs, geometry.bending);
      },
      by_sensors ? MatchedBy::pairs : MatchedBy::geometry);
  widen_by_bending(state, state.groups[group].first, by_sensors);
  if (by_sensors) return;
  auto& told = state.match.modes[static_cast<std::size_t>(state.groups[group].first)];
  told.freedoms = std::max<Eigen::Index>(state.p() + state.q() - 1 - geometry.outputs.cols(), 0);
}

// The likeliest scale of pairs that contradict each other, with rows that do not change: the pairs
// are not at one place, and rows that agree there would be wrong elsewhere. The deviation of the
// scale is what the pairs scatter by.
void keep_rows(Matching& state, std::size_t group, ModeMatch tied) {
  const auto mode = state.groups[group].first;
  const double doubt = std::sqrt(tied.disagreement / static_cast<double>(tied.freedoms));
  apply(
      state, group,
      [](const TwoSides& at) {
        auto one = scaled_by_ties(at);
        const double alpha = std::exp(one.log_alpha);
        one.outputs = at.outputs / alpha;
        one.inputs = one.at_inputs = alpha * at.inputs;
        return one;
      },
      MatchedBy::pairs);
  auto& told = state.match.modes[static_cast<std::size_t>(mode)];
  told.freedoms = tied.freedoms;
  told.alpha_std *= doubt;
}

void match_by_pairs(Matching& state, std::size_t group) {
  const bool tied = state.options.rule == GainRule::tied;
  apply(
      state, group,
      [&](const TwoSides& at) { return tied ? scaled_by_ties(at) : scaled_by_thesis(at); },
      MatchedBy::pairs);
  auto& told = state.match.modes[static_cast<std::size_t>(state.groups[group].first)];
  if (!tied) return;
  told.freedoms = ties_of(state, group).count() - 1;
  if (contradicted(told)) keep_rows(state, group, told);
}

// Whether the rigid motion gives the scale of a mode, with or without pairs.
bool goes_by_motion(const Matching& state, std::size_t group) {
  const auto& modes = state.groups[group];
  if (modes.size != 1 || !is_suspended(state, modes.first)) return false;
  return !state.options.geometry->pairs_first || ties_of(state, group).count() == 0;
}

// @returns  whether the group was scaled; failures become warnings
bool matched(Matching& state, std::size_t group) {
  const auto& modes = state.groups[group];
  try {
    if (tells_mass(state, modes)) {
      match_by_mass(state, modes);
      return true;
    }
    if (goes_by_motion(state, group)) {
      match_by_motion(state, group);
      return true;
    }
  } catch (const NumericalFailure& failure) {
    state.match.warnings.push_back(state.mode_name(modes) + ": " + failure.what());
  }
  try {
    if (ties_of(state, group).count() > 0) {
      modes.size == 1 ? match_by_pairs(state, group) : match_block(state, group);
      return true;
    }
    if (modes.size == 1 && match_by_prior(state, group)) return true;
  } catch (const NumericalFailure& failure) {
    state.match.warnings.push_back(state.mode_name(modes) + ": " + failure.what());
    return false;
  }
  state.match.warnings.push_back(
      state.mode_name(modes) +
      (state.options.pairs.empty()
           ? ": no collocated pair: not scaled"
           : ": every pair is near a node of it, or not known there: not scaled"));
  return false;
}

}  // namespace

TwoSides turned(TwoSides sides) {
  const auto p = sides.outputs.size();
  const auto q = sides.inputs.size();
  sides.inputs *= -1.0;
  sides.covariance.topRightCorner(p, q) *= -1.0;
  sides.covariance.bottomLeftCorner(q, p) *= -1.0;
  return sides;
}

TwoSides sides_of(const Matching& state, std::size_t group) {
  const auto mode = state.groups[group].first;
  TwoSides sides{state.fit.model.output_shapes.col(mode),
                 state.fit.model.input_shapes.row(mode).transpose(),
                 shape_covariance(state.fit, mode), ties_of(state, group)};
  return state.side < 0 ? turned(std::move(sides)) : sides;
}

BlockSides fitted_block(const Matching& state, const modal::ModeGroup& group) {
  return {state.fit.model.output_shapes.middleCols(group.first, group.size),
          state.side * state.fit.model.input_shapes.middleRows(group.first, group.size)};
}

bool is_suspended(const Matching& state, Eigen::Index mode) {
  return state.options.geometry && std::ranges::find(state.options.geometry->suspended, mode) !=
                                       state.options.geometry->suspended.end();
}

bool tells_mass(const Matching& state, const modal::ModeGroup& group) {
  return group.first < state.fit.model.rigid_count && state.options.geometry &&
         state.options.geometry->outputs.cols() == group.size;
}

void match_group(Matching& state, std::size_t group) {
  if (!matched(state, group)) leave_unmatched(state, state.groups[group]);
}

}  // namespace chladni::identification
