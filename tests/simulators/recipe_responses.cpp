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

constexpr double kDamping = 5e-3;

// A plate that is longer by as much as it is wider loses what the first one lost, stretched with
// it; one of another shape has losses of its own.
RitzDamping damping_of(const Recipe& recipe, const RitzModes& plate, bool stays) {
  const auto& first = believed_table(recipe.body.degree);
  const auto& owner = stays && same_shape(plate.body, first.body) ? first : plate;
  const double ratio = kDamping * recipe.damping_factor;
  auto damping = recipe.hysteretic
                     ? hysteretic_damping(owner, ratio)
                     : modal_damping(owner, ratio, recipe.damping_exponent, first.frequency_hz(6));
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
void soften_above(RitzModes& plate, double more) {
  constexpr Index kCoordinates = 64;
  const Index above = plate.mode_count() - kCoordinates;
  if (more != 0.0 && above > 0) plate.frequency_hz.tail(above) /= std::sqrt(1.0 + more);
}

// By its three rigid-body modes, all alike.
void hold(RitzStage& stage, const Recipe& recipe) {
  if (recipe.held_hz <= 0.0) return;
  stage.plate.frequency_hz.head(3).setConstant(recipe.held_hz);
  stage.damping.viscous.diagonal().head(3).setConstant(4.0 * pi * recipe.held_damping *
                                                       recipe.held_hz);
}

// Column by column where the plate is another one for each: its frequencies go as the root of its
// stiffness, its shapes stay.
std::vector<Eigen::MatrixXcd> plate_responses(const RitzStage& stage, const Recipe& recipe,
                                              const Eigen::VectorXd& hz) {
  const auto& outputs = recipe.channels.outputs;
  const auto& inputs = recipe.channels.inputs;
  if (recipe.stiffening.size() == 0) return ritz_receptance(stage, {outputs, inputs, hz});
  std::vector<Eigen::MatrixXcd> value(static_cast<std::size_t>(hz.size()),
                                      Eigen::MatrixXcd(outputs.rows(), inputs.rows()));
  for (Index j = 0; j < inputs.rows(); ++j) {
    RitzStage then = stage;
    then.plate.frequency_hz *= std::sqrt(1.0 + recipe.stiffening(j));
    const auto column = ritz_receptance(then, {outputs, inputs.row(j), hz});
    for (std::size_t k = 0; k < value.size(); ++k) value[k].col(j) = column[k];
  }
  return value;
}

}  // namespace

std::vector<Eigen::MatrixXcd> responses(const Recipe& recipe, const Eigen::VectorXd& hz,
                                        bool damping_stays) {
  RitzStage stage{recipe.same_body ? believed_table(recipe.body.degree) : ritz_modes(recipe.body),
                  {},
                  {},
                  {},
                  {},
                  {}};
  stage.damping = damping_of(recipe, stage.plate, damping_stays);
  stage.points = recipe.points;
  stage.resonators = recipe.resonators;
  stage.pads = recipe.pads;
  stage.frame = recipe.frame;
  hold(stage, recipe);
  soften_above(stage.plate, recipe.yielding);
  auto value = plate_responses(stage, recipe, hz);
  for (std::size_t k = 0; k < value.size(); ++k) {
    value[k] = recorded(recipe, value[k], 2.0 * pi * hz(static_cast<Index>(k)));
  }
  return value;
}

}  // namespace chladni::simulators
