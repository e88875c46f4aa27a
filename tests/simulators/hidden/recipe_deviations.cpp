#include <cmath>

#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

// Draws one deviation after the other by a law.
class Deviations {
 public:
  Deviations(Dice& dice, const HiddenOptions& options) : dice_(dice), options_(options) {}

  [[nodiscard]] bool foreign() const { return options_.law != DeviationLaw::normal; }

  double operator()(double deviation) { return options_.deviation * deviation * one(); }

  // Deviations of n similar quantities, which share a part.
  Eigen::VectorXd alike(Index n, double deviation) {
    const double shared = options_.correlation;
    const double common = shared > 0.0 ? std::sqrt(shared) * one() : 0.0;
    Eigen::VectorXd values(n);
    for (double& value : values) value = common + std::sqrt(1.0 - shared) * one();
    return options_.deviation * deviation * values;
  }

 private:
  double one() {
    if (options_.law == DeviationLaw::normal) return dice_.normal();
    if (options_.law == DeviationLaw::uniform) return std::sqrt(3.0) * dice_.between(-1.0, 1.0);
    return dice_.student();
  }

  Dice& dice_;
  const HiddenOptions& options_;
};

void thicken(RitzBody& body, Deviations& draw) {
  const double mean = body.thickness(0, 0);
  const Index order = draw.foreign() ? 5 : 2;
  body.thickness = Eigen::MatrixXd::Zero(order + 1, order + 1);
  body.thickness(0, 0) = mean;
  for (Index i = 0; i <= order; ++i) {
    for (Index j = 0; i + j <= order; ++j) {
      const double size = draw.foreign() ? 3e-3 / static_cast<double>(2 + i + j) : 1.5e-3;
      body.thickness(i, j) += mean * draw(size);
    }
  }
}

void loosen(RitzBody& body, double relative, Deviations& draw) {
  for (auto& one : body.fixtures) {
    const double heavier = 1.0 + draw(relative);
    const double stiffer = 1.0 + draw(relative);
    for (double* size : {&one.mass, &one.inertia_x, &one.inertia_y}) *size *= heavier;
    for (double* size : {&one.stiffness, &one.turning_x, &one.turning_y}) *size *= stiffer;
  }
}

void displace(Eigen::MatrixX2d& places, bool slender, Deviations& draw) {
  for (Index axis = 0; axis < 2; ++axis) {
    const Eigen::VectorXd by = draw.alike(places.rows(), 5e-4);
    if (axis == 0 || !slender) places.col(axis) += by;
  }
}

}  // namespace

void deviate(Recipe& recipe, Dice& dice, const HiddenOptions& options) {
  if (options.deviation == 0.0) return;
  Deviations draw(dice, options);
  for (auto* filters : {&recipe.outputs, &recipe.inputs}) {
    const Eigen::VectorXd gains = draw.alike(static_cast<Index>(filters->size()), 5e-3);
    for (Index i = 0; i < gains.size(); ++i) {
      (*filters)[static_cast<std::size_t>(i)].gain *= 1.0 + gains(i);
    }
  }
  const double late = draw(1e-6);
  for (auto& filter : recipe.outputs) filter.delay_s += late;
  for (auto* filters : {&recipe.outputs, &recipe.inputs}) {
    if (options.own_delay_s == 0.0) break;
    for (auto& filter : *filters) filter.delay_s += options.own_delay_s * dice.normal();
  }
  displace(recipe.channels.outputs, recipe.rig.is_slender(), draw);
  displace(recipe.channels.inputs, recipe.rig.is_slender(), draw);
  auto& body = recipe.body;
  const double stiffer = 1.0 + draw(5e-3);
  for (double* q : {&body.stiffness.q11, &body.stiffness.q12, &body.stiffness.q22,
                    &body.stiffness.q66, &body.stiffness.shear}) {
    *q *= stiffer;
  }
  body.stiffness.q11 *= 1.0 + draw(5e-3);
  body.density *= 1.0 + draw(3e-3);
  thicken(body, draw);
  if (options.fixtures > 0.0) loosen(body, options.fixtures, draw);
  recipe.damping_spread = draw.alike(120, 0.2).array().exp();
  recipe.same_body = false;
}

}  // namespace chladni::simulators
