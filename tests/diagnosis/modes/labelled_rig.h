// Measured rigs whose labels are mixed, and the structure that they are believed to be.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/index.h"
#include "diagnosis/measured_modes.h"
#include "diagnosis/structure.h"
#include "simulators/portable_random.h"
#include "simulators/rigs/real_body.h"
#include "simulators/rigs/real_rig.h"

namespace chladni::diagnosis {

inline ChannelSide believed_side(const simulators::BareModes& bare,
                                 const std::vector<std::string>& names,
                                 const Eigen::MatrixX2d& places, Eigen::Index modes) {
  constexpr double kStep = 1e-3;
  const auto shifted = [&](double u, double v) -> Eigen::MatrixXd {
    const Eigen::MatrixX2d there = places.rowwise() + Eigen::RowVector2d(u, v);
    return bare.shapes_at(there).leftCols(modes);
  };
  ChannelSide side;
  side.names = names;
  side.shapes = shifted(0.0, 0.0);
  side.slope_u = (shifted(kStep, 0.0) - shifted(-kStep, 0.0)) / (2.0 * kStep);
  side.slope_v = (shifted(0.0, kStep) - shifted(0.0, -kStep)) / (2.0 * kStep);
  side.aside_u = side.aside_v = 0.0 * side.shapes;
  side.places = places;
  return side;
}

/// The modes of a body and its channels, without cells: no cause inside the body is possible.
inline const Structure& believed(const std::string& name) {
  static std::map<std::string, Structure> made;
  if (const auto known = made.find(name); known != made.end()) return known->second;
  const auto body = simulators::real_body(name);
  const auto& bare = simulators::believed_modes(body);
  Structure structure;
  Eigen::Index modes = 0;
  while (modes < bare.frequency_hz.size() && bare.frequency_hz(modes) < 2.5 * body.rig.high_hz) {
    ++modes;
  }
  structure.frequency_hz = bare.frequency_hz.head(modes);
  structure.damping_ratio = Eigen::VectorXd::Constant(modes, 5e-3);
  structure.rigid_count = bare.rigid_count;
  const auto& channels = body.rig.channels;
  structure.outputs = believed_side(bare, channels.output_names, channels.outputs, modes);
  structure.inputs = believed_side(bare, channels.input_names, channels.inputs, modes);
  structure.residual = Eigen::MatrixXd::Zero(structure.output_count(), structure.input_count());
  structure.mass_kg = body.mass;
  structure.surface.places = channels.outputs;
  structure.surface.area = Eigen::VectorXd::Ones(channels.outputs.rows());
  structure.surface.shapes = structure.outputs.shapes;
  structure.surface.at = [](const Eigen::Vector2d&) { return std::nullopt; };
  return made.emplace(name, std::move(structure)).first->second;
}

/// A permutation of n channels that moves `count` of them, 2 or more, and no other.
inline std::vector<Eigen::Index> some_order(Eigen::Index n, Eigen::Index count,
                                            simulators::Dice& dice) {
  const auto shuffle = [&](std::vector<Eigen::Index>& all) {
    for (std::size_t i = all.size(); i > 1; --i) {
      std::swap(all[i - 1], all[at(dice.below(static_cast<Eigen::Index>(i)))]);
    }
  };
  std::vector<Eigen::Index> all(at(n));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  auto which = all;
  shuffle(which);
  which.resize(at(count));
  auto to = which;
  while (!std::ranges::equal(to, which, std::not_equal_to{})) shuffle(to);
  for (std::size_t i = 0; i < which.size(); ++i) all[at(which[i])] = to[i];
  return all;
}

/// Record i shows what channel order[i] did.
inline MeasuredModes mixed(MeasuredModes measured, const std::vector<Eigen::Index>& order) {
  measured.output_shapes = Eigen::MatrixXcd(measured.output_shapes(order, Eigen::all));
  measured.output_std = Eigen::MatrixXd(measured.output_std(order, Eigen::all));
  return measured;
}

}  // namespace chladni::diagnosis
