#include <cmath>
#include <numbers>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/body_scale.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// As of a spring in one place.
double typical_pad_stiffness(const Structure& structure) {
  const double omega = first_omega(structure);
  return 0.01 * structure.mass_kg * omega * omega;
}
double typical_radius(const Structure& structure) {
  return 0.15 * std::sqrt(structure.surface.area.sum());
}

std::vector<Parameter> stiffness_radius_place(const Structure& structure) {
  auto u = place_u(structure);
  auto v = place_v(structure);
  // More than the error of the rim (ray).
  u.step = v.step = 20.0 * place_step(structure);
  return {{.name = "stiffness",
           .unit = "N/m",
           .scale = Parameter::Scale::logarithmic,
           .is_size = true,
           .centre = std::log(typical_pad_stiffness(structure)),
           .width = 3.0,
           .step = 1e-4},
          {.name = "radius",
           .unit = "m",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::extent,
           .centre = std::log(typical_radius(structure)),
           .width = 0.5,
           .step = 1e-3},
          u,
          v};
}

// Length of the ray from a place to the rim of the disc or of the surface, whichever is nearer.
double ray(const Surface& surface, const Vector2d& from, const Vector2d& along, double radius) {
  if (surface.holds(from + radius * along)) return radius;
  double on = 0.0;
  double off = radius;
  for (int half = 0; half < 16; ++half) {
    const double middle = 0.5 * (on + off);
    (surface.holds(from + middle * along) ? on : off) = middle;
  }
  return on;
}

// Motions of points spread over the part of the disc on the surface, (r + u)×n, each times the root
// of its share of the area: Gauss's three points in the square of the radius, on 16 rays.
MatrixXd motions(const Structure& structure, const Vector2d& centre, double radius) {
  constexpr int kRays = 16;
  const double aside = 0.5 * std::sqrt(0.6);
  const Eigen::Array3d part(0.5 - aside, 0.5, 0.5 + aside);
  const Eigen::Array3d share(5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0);
  const auto middle = structure.surface.at(centre);
  const Index rows = structure.mode_count() + (middle ? middle->upper.size() : 0);
  MatrixXd all = MatrixXd::Zero(rows, 3 * kRays);
  double area = 0.0;
  for (int n = 0; middle && n < kRays; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kRays;
    const Vector2d along(std::cos(angle), std::sin(angle));
    const double length = ray(structure.surface, centre, along, radius);
    for (Index k = 0; k < 3; ++k) {
      const auto motion = structure.surface.at(centre + length * std::sqrt(part(k)) * along);
      if (!motion) continue;
      const double weight = share(k) * length * length;
      area += weight;
      all.col(3 * n + k) << motion->shape, motion->upper;
      all.col(3 * n + k) *= std::sqrt(weight);
    }
  }
  return area > 0.0 ? MatrixXd(all / std::sqrt(area)) : MatrixXd(all);
}

std::function<void(State&)> bedding(const Structure& structure, Index /*option*/,
                                    const VectorXd& x) {
  const MatrixXd spread = motions(structure, {x(2), x(3)}, std::exp(x(1)));
  return [by = MatrixXd(std::exp(x(0)) * spread * spread.transpose())](State& state) {
    const MatrixXd before = state.stiffness;
    add_stiffness(state, by);
    // The springs are not the body's own.
    if (state.springs.size() == 0) state.springs = MatrixXd::Zero(before.rows(), before.cols());
    state.springs += state.stiffness - before;
  };
}

std::vector<EffectStart> pads(const Scene& scene) {
  const double stiffness = typical_pad_stiffness(scene.structure());
  const double radius = typical_radius(scene.structure());
  std::vector<VectorXd> sizes;
  for (double times = 1e-3; times < 200.0; times *= 4.0) {
    for (const double wide : {0.6, 1.2}) {
      sizes.push_back(Vector2d(std::log(times * stiffness), std::log(wide * radius)));
    }
  }
  return at_peaks(scene, sizes, 4);
}

}  // namespace

constinit const Effect elastic_pad{
    .name = "elastic_pad",
    .summary =
        "something soft lies under a part of the body: a foam pad, a "
        "gasket, a cushion",
    .source =
        "k / A over the part of a disc on the surface (Winkler 1867), on "
        "all modes",
    .confusable = "a spring in one place where the disc is small against the waves",
    .parameters = stiffness_radius_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = at_once<bedding>,
    .starts = pads,
    .change = bedding,
    .error = kHungError,
    .simpler = {{&ground_spring}},
    .in_study = {.refusal = "no key spreads a spring over a disc: say a spring "
                            "in each of several "
                            "places within it"},
};

}  // namespace chladni::diagnosis
