#include <cmath>
#include <numbers>

#include "base/index.h"
#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

HiddenEffect notch(Recipe& recipe, Drawn& drawn) {
  const Index i = drawn.channel(recipe.channels.output_names);
  auto& filter = recipe.outputs[at(i)];
  filter.notch_hz = drawn.scale.frequency * drawn.dice.between(150.0, 700.0);
  filter.notch_damping = drawn.size(0.01, 0.5);
  return {"",
          {{"frequency", filter.notch_hz}, {"damping_ratio", filter.notch_damping}},
          {},
          {recipe.channels.output_names[at(i)]}};
}
HiddenEffect rising_damping(Recipe& recipe, Drawn& drawn) {
  recipe.damping_exponent = drawn.size(0.3, 1.5);
  return {"", {{"exponent", recipe.damping_exponent}}, {}, {}};
}
HiddenEffect crosstalk(Recipe& recipe, Drawn& drawn) {
  const double x = drawn.size(0.01, 0.15);
  const auto mix = [&](Eigen::MatrixXd& matrix) {
    matrix += x * drawn.dice.normal(matrix.rows(), matrix.cols());
    matrix.diagonal().setOnes();
  };
  mix(recipe.output_mix);
  mix(recipe.input_mix);
  return {"", {{"rms", x}}, {}, {}};
}
HiddenEffect crack(Recipe& recipe, Drawn& drawn) {
  const Eigen::Vector2d middle = drawn.place(0.1);
  const double length = drawn.size(0.06, 0.25);
  const double angle = drawn.dice.between(0.0, pi);
  const Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d rim(0.295, 0.295);
  const auto within = [&rim](const Eigen::Vector2d& end) -> Eigen::Vector2d {
    return end.cwiseMin(rim).cwiseMax(-rim);
  };
  recipe.body.cracks.push_back({within(middle - half), within(middle + half), 0.01, 0.9});
  recipe.same_body = false;
  return {"", {{"length", length}}, middle, {}};
}
HiddenEffect six_masses(Recipe& recipe, Drawn& drawn) {
  const double total = drawn.scale.mass * drawn.size(0.1, 3.0);
  for (int i = 0; i < 6; ++i) {
    const double m = total / 6.0 * drawn.dice.between(0.4, 1.6);
    const Eigen::Vector2d place = drawn.place();
    drawn.taken_places.push_back(place);
    recipe.points.push_back({place, m, 0.0, 0.0, 0.0});
  }
  return {"", {{"mass", total}}, {}, {}};
}
HiddenEffect other_plate(Recipe& recipe, Drawn& drawn) {
  auto& body = recipe.body;
  body.length = drawn.dice.between(0.35, 0.8);
  body.width = drawn.dice.between(0.35, 0.8);
  body.thickness *= drawn.dice.between(0.4, 1.5);
  const bool steel = drawn.dice.uniform() < 0.5;
  body.stiffness = isotropic_plane(steel ? 205e9 : 70e9, 0.3);
  body.density = steel ? 7850.0 : 2700.0;
  for (auto* places : {&recipe.channels.outputs, &recipe.channels.inputs}) {
    places->col(0) *= body.length / 0.6;
    places->col(1) *= body.width / 0.6;
  }
  recipe.same_body = false;
  return {"", {{"length", body.length}, {"width", body.width}}, {}, {}};
}
HiddenEffect in_plane_mode(Recipe& recipe, Drawn& drawn) {
  recipe.foreign_hz = drawn.scale.frequency * drawn.dice.between(150.0, 750.0);
  recipe.foreign_damping = 0.005;
  const double relative = drawn.size(0.02, 0.5);
  const double size = 0.22 * relative / std::sqrt(drawn.scale.mass);  // 0.22: the body's own shapes
  recipe.foreign_outputs = size * drawn.dice.normal(recipe.channels.outputs.rows(), 1);
  recipe.foreign_inputs = size * drawn.dice.normal(recipe.channels.inputs.rows(), 1);
  return {"", {{"frequency", recipe.foreign_hz}, {"relative", relative}}, {}, {}};
}

}  // namespace

const std::vector<HiddenKind>& kinds_outside() {
  // A test run hides every fourth of them: the two slowest, notch and six masses, not in one run.
  static const std::vector<HiddenKind> kinds = {
      {"sensor_notch", true, notch},          {"rising_damping", true, rising_damping},
      {"crosstalk", true, crosstalk},         {"line_crack", true, crack},
      {"other_plate", true, other_plate},     {"six_masses", true, six_masses},
      {"in_plane_mode", true, in_plane_mode},
  };
  return kinds;
}

}  // namespace chladni::simulators
