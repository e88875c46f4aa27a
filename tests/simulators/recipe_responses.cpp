#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "simulators/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

// A plate that is longer by as much as it is wider loses what the first one lost, stretched with
// it; one of another shape has losses of its own.
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

// From what the plate does to what is recorded, on one line.
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

// Those that a diagnosis has no coordinates for.
void soften_above(RitzModes& plate, double more, double above_hz) {
  constexpr Index kCoordinates = 64;
  const Index above = above_hz > 0.0 ? (plate.frequency_hz.array() > above_hz).count()
                                     : plate.mode_count() - kCoordinates;
  if (more != 0.0 && above > 0) plate.frequency_hz.tail(above) /= std::sqrt(1.0 + more);
}

// By its three rigid-body modes, all alike.
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

// The body alone is stiffer, what is fixed to it stays; a bare plate's shapes stay, too.
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

// Column by column where the body is another one for each.
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

}  // namespace

std::vector<Eigen::MatrixXcd> responses(const Recipe& recipe, const Eigen::VectorXd& hz,
                                        bool damping_stays) {
  const auto& nominal = believed_modes(recipe.rig.name, recipe.degree);
  RitzStage stage{recipe.same_body ? nominal : ritz_modes(recipe.body), {}, {}, {}, {}, {}};
  stage.damping = damping_of(recipe, nominal, stage.plate, damping_stays);
  stage.points = recipe.points;
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
