#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

// The damping of the plate. A plate with the same shape but another size has the damping of the
// nominal plate, stretched with it. A plate of another shape has its own damping.
RitzDamping damping_of(const Recipe& recipe, const RitzModes& nominal, const RitzModes& plate,
                       bool stays) {
  const auto& owner = stays && same_shape(plate.body, nominal.body) ? nominal : plate;
  const double ratio = recipe.rig.damping_ratio * recipe.damping_factor;
  auto damping = recipe.hysteretic ? hysteretic_damping(owner, ratio)
                                   : modal_damping(owner, ratio, recipe.damping_exponent,
                                                   nominal.frequency_hz(6));
  const auto count = std::min(recipe.damping_spread.size(), plate.mode_count());
  for (auto* losses : {&damping.viscous, &damping.loss}) {
    if (losses->size() > 0) losses->diagonal().head(count).array() *= recipe.damping_spread.array();
  }
  return &owner == &plate ? damping : carried_over(damping, owner, plate);
}

Complex passed(const ChannelFilter& filter, double omega) {
  const Complex s(0.0, omega);
  Complex value = filter.gain * std::exp(-s * filter.delay_s) * std::pow(s, filter.power);
  if (filter.corner_hz > 0.0) value /= 1.0 + s / (2.0 * pi * filter.corner_hz);
  if (filter.notch_hz > 0.0) {
    const double own = 2.0 * pi * filter.notch_hz;
    const Complex through = s * s + own * own;
    value *= through / (through + 2.0 * filter.notch_damping * own * s);
  }
  return value;
}

// The recorded responses on one line, from the responses of the plate.
Eigen::MatrixXcd recorded(const Recipe& recipe, const Eigen::MatrixXcd& plate, double omega) {
  Eigen::MatrixXcd seen = plate;
  if (recipe.foreign_hz > 0.0) {
    const double own = 2.0 * pi * recipe.foreign_hz;
    const Complex dynamic(own * own - omega * omega, 2.0 * recipe.foreign_damping * own * omega);
    seen += (recipe.foreign_outputs * recipe.foreign_inputs.transpose()).cast<Complex>() / dynamic;
  }
  Eigen::MatrixXcd value(seen.rows(), seen.cols());
  for (Index i = 0; i < value.rows(); ++i) {
    for (Index j = 0; j < value.cols(); ++j) {
      const auto row = static_cast<std::size_t>(i);
      const auto col = static_cast<std::size_t>(j);
      value(i, j) = passed(recipe.outputs[row], omega) * passed(recipe.inputs[col], omega) *
                    seen(recipe.output_of[row], recipe.input_of[col]);
    }
  }
  return recipe.output_mix * value * recipe.input_mix;
}

// Softens the modes for which a diagnosis has no coordinates.
void soften_above(RitzModes& plate, double more, double above_hz) {
  constexpr Index kCoordinates = 64;
  const Index above = above_hz > 0.0 ? (plate.frequency_hz.array() > above_hz).count()
                                     : plate.mode_count() - kCoordinates;
  if (more != 0.0 && above > 0) plate.frequency_hz.tail(above) /= std::sqrt(1.0 + more);
}

// Holds the plate: gives its three rigid-body modes one frequency and damping.
void hold(RitzStage& stage, const Recipe& recipe) {
  if (recipe.held_hz <= 0.0) return;
  stage.plate.frequency_hz.head(3).setConstant(recipe.held_hz);
  stage.damping.viscous.diagonal().head(3).setConstant(4.0 * pi * recipe.held_damping *
                                                       recipe.held_hz);
}

RitzGrid grid_of(const Recipe& recipe, const Eigen::VectorXd& hz) {
  const double top = 0.5 * recipe.rig.body.thickness(0, 0);
  RitzGrid grid{recipe.channels.outputs, recipe.channels.inputs, hz};
  grid.output_tilts = recipe.output_tilts;
  grid.input_tilts = recipe.input_tilts;
  grid.output_height = top;
  grid.input_height = recipe.rig.driven_from_below ? -top : top;
  return grid;
}

// Makes the body alone stiffer; its fixtures do not change. The shapes of a bare plate do not
// change either.
RitzStage stiffened(const RitzStage& stage, double by) {
  RitzStage then = stage;
  if (stage.plate.body.fixtures.empty()) {
    then.plate.frequency_hz *= std::sqrt(1.0 + by);
    return then;
  }
  auto body = stage.plate.body;
  auto& q = body.stiffness;
  for (double* value : {&q.q11, &q.q12, &q.q22, &q.q66, &q.shear}) *value *= 1.0 + by;
  then.plate = ritz_modes(body);
  then.damping = carried_over(stage.damping, stage.plate, then.plate);
  return then;
}

// The responses of the plate. They are computed column by column where each input has another body.
std::vector<Eigen::MatrixXcd> plate_responses(const RitzStage& stage, const Recipe& recipe,
                                              const Eigen::VectorXd& hz) {
  const auto grid = grid_of(recipe, hz);
  if (recipe.stiffening.size() == 0) return ritz_receptance(stage, grid);
  std::vector<Eigen::MatrixXcd> value(static_cast<std::size_t>(hz.size()),
                                      Eigen::MatrixXcd(grid.outputs.rows(), grid.inputs.rows()));
  for (Index j = 0; j < grid.inputs.rows(); ++j) {
    auto one = grid;
    one.inputs = grid.inputs.row(j);
    one.input_tilts = grid.input_tilts.row(j);
    const auto column = ritz_receptance(stiffened(stage, recipe.stiffening(j)), one);
    for (std::size_t k = 0; k < value.size(); ++k) value[k].col(j) = column[k];
  }
  return value;
}

// Half the thickness above the middle plane a mass moves aside by as much for each slope.
std::vector<RitzPoint> points_of(const Recipe& recipe) {
  auto points = recipe.points;
  if (!recipe.on_face) return points;
  const double height = 0.5 * recipe.body.thickness(0, 0);
  for (auto& point : points) point.rotary_inertia += point.mass * height * height;
  return points;
}

}  // namespace

std::vector<Eigen::MatrixXcd> responses(const Recipe& recipe, const Eigen::VectorXd& hz,
                                        bool damping_stays) {
  const auto& nominal = believed_modes(recipe.rig.name, recipe.degree);
  RitzStage stage{recipe.same_body ? nominal : ritz_modes(recipe.body), {}, {}, {}, {}, {}};
  stage.damping = damping_of(recipe, nominal, stage.plate, damping_stays);
  stage.points = points_of(recipe);
  stage.resonators = recipe.resonators;
  stage.pads = recipe.pads;
  stage.frame = recipe.frame;
  hold(stage, recipe);
  soften_above(stage.plate, recipe.yielding, recipe.above_hz);
  auto value = plate_responses(stage, recipe, hz);
  for (std::size_t k = 0; k < value.size(); ++k) {
    value[k] = recorded(recipe, value[k], 2.0 * pi * hz(static_cast<Index>(k)));
  }
  return value;
}

}  // namespace chladni::simulators
