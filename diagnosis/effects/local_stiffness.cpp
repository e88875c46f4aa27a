#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/body_fields.h"
#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Effect::error. The patch has a smooth rim. Of the gain, discs of sharp rim left 0.004 when they
// were 10 % softer, 0.008 when twice as stiff, and 0.04 when almost no stiffness was left.
constexpr double kOutlineError = 0.04;

// Typical radius of a patch: a tenth of a face's side, a twentieth of a line.
double usual_radius(const Structure& structure) {
  const auto& box = structure.cells.size;
  const bool face = structure.fine.pitch.minCoeff() > 0.0;
  return face ? 0.1 * std::sqrt(structure.cells.area.sum()) : 0.05 * box.maxCoeff();
}

std::vector<Parameter> patch(const Structure& structure) {
  return {{.name = "factor",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .width = 0.5,
           .step = 1e-4},
          place_u(structure),
          place_v(structure),
          {.name = "radius",
           .unit = "m",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::extent,
           .centre = std::log(usual_radius(structure)),
           .width = 0.4,
           .step = 1e-4}};
}

Index has_patch_cells(const Structure& structure) {
  return structure.fine.count() > 8 && structure.cells.count() > 0 ? 1 : 0;
}

// 1 within the patch, with a smooth rim: exp(-(pi/4) (d/R)^4) has the area of a disc of radius R.
double profile(double d2, double radius) {
  const double t = d2 / (radius * radius);
  return t < 6.0 ? std::exp(-0.25 * std::numbers::pi * t * t) : 0.0;
}

// Points of a cell along an axis, from its centre: three, or many where the cell spans the body.
VectorXd points_along(const Structure& structure, Index axis) {
  constexpr Index kAcross = 48;  // two for each radius of the smallest patch on the widest line
  const double pitch = structure.fine.pitch(axis);
  const Index count = pitch > 0.0 ? 3 : kAcross;
  const double side = pitch > 0.0 ? pitch : structure.cells.size(axis);
  const double part = side / static_cast<double>(count);
  return VectorXd::LinSpaced(count, 0.5 * (part - side), 0.5 * (side - part));
}

// Mean of the profile over each cell.
VectorXd within(const Structure& structure, const VectorXd& x) {
  const auto& fine = structure.fine;
  const double radius = std::max(std::exp(x(3)), 0.5 * fine.pitch.maxCoeff());
  const VectorXd along_u = points_along(structure, 0);
  const VectorXd along_v = points_along(structure, 1);
  const Eigen::Array2d half(along_u.maxCoeff(), along_v.maxCoeff());
  VectorXd weight = VectorXd::Zero(fine.count());
  for (Index c = 0; c < fine.count(); ++c) {
    const Eigen::Vector2d from = fine.centres.row(c).transpose() - x.segment<2>(1);
    const Eigen::Vector2d nearest = (from.array().abs() - half).max(0.0);
    if (nearest.squaredNorm() > 6.0 * radius * radius) continue;
    for (const double u : along_u) {
      for (const double v : along_v) {
        weight(c) += profile((from + Eigen::Vector2d(u, v)).squaredNorm(), radius);
      }
    }
  }
  return weight / static_cast<double>(along_u.size() * along_v.size());
}

std::function<void(State&)> softening(const Structure& structure, Index /*option*/,
                                      const VectorXd& x) {
  const VectorXd weight = std::expm1(x(0)) * within(structure, x);
  return
      [by = sum_of(structure.fine.stiffness, weight)](State& state) { add_stiffness(state, by); };
}

// Tries the centre of each cell with the best factor to first order. The best few also start with
// given factors in both directions.
std::vector<EffectStart> centres(const Scene& scene) {
  const auto& structure = scene.structure();
  const double radius = std::log(usual_radius(structure));
  struct Found {
    double fall = 0.0;
    VectorXd x;
  };
  std::vector<Found> all;
  for (Index c = 0; c < structure.cells.count(); ++c) {
    VectorXd x(4);
    x << 0.0, structure.cells.centres(c, 0), structure.cells.centres(c, 1), radius;
    State softer = scene.state();
    VectorXd up = x;
    up(0) = 0.01;
    softening(structure, 0, up)(softer);
    const auto gain = scene.gain(slope(scene.state(), scene.now(), scene.state(), softer, 0.01));
    x(0) = std::clamp(gain.step, -1.6, 0.9);
    all.push_back({gain.fall, x});
  }
  std::ranges::stable_sort(all, [](const Found& a, const Found& b) { return a.fall > b.fall; });
  std::vector<EffectStart> starts;
  for (std::size_t n = 0; n < std::min<std::size_t>(4, all.size()); ++n) {
    for (const double factor : {-0.7, -0.3, -0.1, 0.1, 0.4, 1.0}) {
      VectorXd x = all[n].x;
      x(0) = std::log1p(factor);
      starts.push_back({0, x});
    }
    starts.push_back({0, all[n].x});
  }
  return starts;
}

}  // namespace

constinit const Effect local_stiffness{
    .name = "local_stiffness",
    .summary = "stiffer or softer in one place: crack, loose bolt, pocket, rib",
    .source = "K plus a factor of the stiffness within a patch",
    .confusable = "a mass of the opposite sign; factor and radius only as a product",
    .parameters = patch,
    .options = has_patch_cells,
    .channels = no_channels,
    .apply = at_once<softening>,
    .starts = centres,
    .change = softening,
    .error = kOutlineError,
    .error_follows_size = true,
    .in_study = {.table = InStudy::Table::variation,
                 .kind = "stiffness",
                 .at_place = true,
                 .keys = {{"radius", "radius", "m"}, {"relative", "factor", ""}}},
};

}  // namespace chladni::diagnosis
