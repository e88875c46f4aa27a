// What real rigs have and no model has.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "simulators/rigs/rig_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr double kShared = 1.0 / 3.0;  // of the variance, between channels of a side
constexpr Index kFieldOrder = 4;
constexpr double kNeighbours = 0.25;  // length of correlation, of the body's size

double signed_between(Dice& dice, double low, double high) {
  const double value = dice.between(low, high);
  return dice.uniform() < 0.5 ? -value : value;
}

void scale_material(RitzBody& plate, double stiffer, double denser) {
  auto& q = plate.stiffness;
  for (double* value : {&q.q11, &q.q12, &q.q22, &q.q66, &q.shear}) *value *= 1.0 + stiffer;
  plate.density *= 1.0 + denser;
}

// A smooth field without a mean, of this rms over the box (Legendre's P_i P_j has the mean square
// 1 / (2i + 1)(2j + 1)).
Eigen::MatrixXd smooth_field(Dice& dice, double rms, bool slender) {
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(kFieldOrder + 1, slender ? 1 : kFieldOrder + 1);
  double square = 0.0;
  for (Index i = 0; i <= kFieldOrder; ++i) {
    for (Index j = 0; j < field.cols() && i + j <= kFieldOrder; ++j) {
      if (i + j == 0) continue;
      field(i, j) = dice.normal() / static_cast<double>(i + j);
      square += field(i, j) * field(i, j) / static_cast<double>((2 * i + 1) * (2 * j + 1));
    }
  }
  return rms / std::sqrt(square) * field;
}

void add_channel_deviations(RigRecipe& recipe, Dice& dice, double nature) {
  for (auto* gains : {&recipe.output_gain, &recipe.input_gain}) {
    *gains = gains->array() * (1.0 + nature * alike(dice, gains->size(), 0.02).array());
  }
  for (auto* places : {&recipe.channels.outputs, &recipe.channels.inputs}) {
    for (Index axis = 0; axis < 2; ++axis) {
      const Eigen::VectorXd by = nature * alike(dice, places->rows(), 1e-3);
      if (axis == 0 || !recipe.body.rig.is_slender()) places->col(axis) += by;
    }
  }
}

// Accelerometers, and cables that damp some of them.
void add_sensors(RigRecipe& recipe, Dice& dice, double nature) {
  const double omega = 2.0 * pi * first_in_band(recipe.body);
  const double critical = 2.0 * recipe.body.rig.damping_ratio * recipe.body.mass * omega;
  for (const auto place : recipe.channels.outputs.rowwise()) {
    RitzPoint point;
    point.place = place.transpose();
    point.mass = nature * recipe.body.accelerometer * dice.between(0.7, 1.4);
    const bool cable = dice.uniform() < 0.4;
    const double damping = critical * dice.between(0.03, 0.15);
    if (cable) point.damping = nature * damping;
    recipe.points.push_back(point);
  }
}

// The strings: springs that carry a free body, and one string's own resonance.
void add_strings(RigRecipe& recipe, Dice& dice, double nature) {
  const double size = recipe.body.size();
  const bool held = recipe.plate.rigid_count() == 0;
  const double omega = 2.0 * pi * first_in_band(recipe.body);
  const double softness = dice.between(0.01, 0.025);
  std::vector<Eigen::Vector2d> hooks{{-0.35, -0.3}, {0.3, -0.33}, {-0.3, 0.32}};
  for (auto& hook : hooks) {
    hook = size * (hook + 0.03 * Eigen::Vector2d(dice.normal(), dice.normal()));
    if (recipe.body.rig.is_slender()) hook.y() = 0.0;
    while (!recipe.body.covers(hook)) hook *= 0.95;  // a draw beside the rim
    if (held) continue;
    RitzPoint point;
    point.place = hook;
    point.stiffness = nature * recipe.body.mass * std::pow(softness * omega, 2) / 3.0;
    recipe.points.push_back(point);
  }
  RitzResonator string;
  string.place = hooks[static_cast<std::size_t>(dice.below(3))];
  string.mass = nature * recipe.body.mass * dice.between(1e-4, 4e-4);
  const auto& rig = recipe.body.rig;
  string.frequency_hz = rig.low_hz * std::pow(rig.high_hz / rig.low_hz, dice.between(0.4, 1.0));
  string.damping_ratio = dice.between(5e-3, 0.02);
  if (nature > 0.0) recipe.resonators.push_back(string);
}

void add_frame(RigRecipe& recipe, Dice& dice, double nature) {
  FrameMode frame;
  frame.mass = recipe.body.mass * dice.between(100.0, 300.0) / std::max(nature, 1e-9);
  frame.frequency_hz = recipe.body.rig.high_hz * dice.between(0.15, 0.8);
  frame.damping_ratio = dice.between(0.01, 0.04);
  const auto coupled = [&](Index n) {
    Eigen::VectorXd all(n);
    for (double& one : all) one = -dice.between(0.2, 1.0);
    return all;
  };
  frame.outputs = coupled(recipe.channels.outputs.rows());
  frame.inputs = coupled(recipe.channels.inputs.rows());
  if (nature > 0.0) recipe.frames.push_back(frame);
}

void add_model_form_error(RigRecipe& recipe, Dice& dice, const RealRigOptions& options) {
  auto& error = recipe.error;
  const double frequency = dice.between(0.01, 0.03);
  const double shape = dice.between(0.05, 0.1);
  const auto chosen = [&](double wanted, double drawn) {
    return options.nature * (wanted < 0.0 ? drawn : wanted);
  };
  error.frequency = chosen(options.frequency_error, frequency);
  error.shape = chosen(options.shape_error, shape);
  error.phase = options.nature * std::tan(dice.between(1.0, 4.0) * pi / 180.0);
  error.of_body = options.errors_of_body;
  const Index n = believed_modes(recipe.body).frequency_hz.size();
  const Index p = recipe.body.rig.channels.outputs.rows();
  Eigen::MatrixX2d places(p + recipe.body.rig.channels.inputs.rows(), 2);
  places << recipe.body.rig.channels.outputs, recipe.body.rig.channels.inputs;
  error.frequency_draw = dice.normal(n, 1);
  const double length = kNeighbours * recipe.body.size();
  error.shape_draw = smooth_draws(dice, places, length, n);
  error.phase_draw = smooth_draws(dice, places, length, n);
}

}  // namespace

Eigen::VectorXd alike(Dice& dice, Index n, double size) {
  const double common = std::sqrt(kShared) * dice.student();
  Eigen::VectorXd all(n);
  for (double& one : all) one = size * (common + std::sqrt(1.0 - kShared) * dice.student());
  return all;
}

Eigen::MatrixXd smooth_draws(Dice& dice, const Eigen::MatrixX2d& places, double length, Index n) {
  const Index k = places.rows();
  Eigen::MatrixXd covariance(k, k);
  for (Index i = 0; i < k; ++i) {
    for (Index j = 0; j < k; ++j) {
      const double apart = (places.row(i) - places.row(j)).squaredNorm() / (length * length);
      covariance(i, j) = 0.999 * std::exp(-0.5 * apart) + (i == j ? 0.001 : 0.0);
    }
  }
  return Eigen::MatrixXd(covariance.llt().matrixL()) * dice.normal(k, n);
}

RigRecipe believed_recipe(const RealBody& body) {
  RigRecipe recipe;
  recipe.body = body;
  recipe.plate = body.rig.body;
  recipe.channels = body.rig.channels;
  recipe.output_of.resize(static_cast<std::size_t>(recipe.channels.outputs.rows()));
  std::iota(recipe.output_of.begin(), recipe.output_of.end(), 0);
  recipe.output_gain = Eigen::VectorXd::Ones(recipe.channels.outputs.rows());
  recipe.input_gain = Eigen::VectorXd::Ones(recipe.channels.inputs.rows());
  return recipe;
}

void add_nature(RigRecipe& recipe, unsigned seed, const RealRigOptions& options) {
  const double nature = options.nature;
  if (nature == 0.0) return;
  Dice dice(seed);
  const bool slender = recipe.body.rig.is_slender();
  const double stiffer = nature * signed_between(dice, 0.01, 0.02);
  scale_material(recipe.plate, stiffer, nature * signed_between(dice, 0.01, 0.02));
  const double thickness = recipe.plate.thickness(0, 0);
  recipe.plate.thickness =
      thickness * smooth_field(dice, nature * dice.between(5e-3, 0.01), slender);
  recipe.plate.thickness(0, 0) = thickness;
  recipe.damping_factor = (0.3 * nature * dice.normal(120, 1).array()).exp();
  add_channel_deviations(recipe, dice, nature);
  add_sensors(recipe, dice, nature);
  add_strings(recipe, dice, nature);
  add_frame(recipe, dice, nature);
  add_model_form_error(recipe, dice, options);
}

}  // namespace chladni::simulators
