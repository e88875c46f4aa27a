#include <cmath>

#include "simulators/hidden_recipe.h"

namespace chladni::simulators {

using Eigen::Index;

void deviate(Recipe& recipe, Dice& dice, double times) {
  if (times == 0.0) return;
  const auto draw = [&](double deviation) { return times * deviation * dice.normal(); };
  for (auto* filters : {&recipe.outputs, &recipe.inputs}) {
    for (auto& filter : *filters) filter.gain *= 1.0 + draw(5e-3);
  }
  const double late = draw(1e-6);
  for (auto& filter : recipe.outputs) filter.delay_s += late;
  recipe.channels.outputs += times * 5e-4 * dice.normal(4, 2);
  recipe.channels.inputs += times * 5e-4 * dice.normal(13, 2);
  auto& body = recipe.body;
  const double stiffer = 1.0 + draw(5e-3);
  for (double* q : {&body.stiffness.q11, &body.stiffness.q12, &body.stiffness.q22,
                    &body.stiffness.q66, &body.stiffness.shear}) {
    *q *= stiffer;
  }
  body.stiffness.q11 *= 1.0 + draw(5e-3);
  body.density *= 1.0 + draw(3e-3);
  const double mean = body.thickness(0, 0);
  body.thickness = Eigen::MatrixXd::Zero(3, 3);
  body.thickness(0, 0) = mean;
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; i + j < 3; ++j) body.thickness(i, j) += mean * draw(1.5e-3);
  }
  recipe.damping_spread = (times * 0.2 * dice.normal(120, 1)).array().exp();
  recipe.same_body = false;
}

}  // namespace chladni::simulators
