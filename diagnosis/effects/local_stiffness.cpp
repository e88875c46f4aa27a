#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/body_fields.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Of the cells: their mean side.
double pitch(const Structure& structure) {
  const double area = structure.cells.area.mean();
  const auto& centres = structure.cells.centres;
  const Eigen::RowVector2d size = centres.colwise().maxCoeff() - centres.colwise().minCoeff();
  if (size.minCoeff() > 0.0) return std::sqrt(area);
  return size.maxCoeff() / static_cast<double>(std::max<Index>(1, structure.cells.count() - 1));
}

std::vector<Parameter> patch(const Structure& structure) {
  const double least = pitch(structure);
  return {{"factor", "1", Parameter::Scale::linear, 0.0, 0.4, 1e-4},
          {"u", "m", Parameter::Scale::place_u, 0.0, 1.0, 1e-5},
          {"v", "m", Parameter::Scale::place_v, 0.0, 1.0, 1e-5},
          {"radius", "m", Parameter::Scale::logarithmic, std::log(1.2 * least), 0.4, 1e-4}};
}

Index has_cells(const Structure& structure) { return structure.cells.count() > 8 ? 1 : 0; }

// 1 within the patch, falling smoothly: exp(-(pi/4) (d/R)^4) has the area of a disc of radius R.
VectorXd within(const Structure& structure, const VectorXd& x) {
  const auto& centres = structure.cells.centres;
  const double radius = std::max(std::exp(x(3)), 0.5 * pitch(structure));
  VectorXd weight(centres.rows());
  for (Index c = 0; c < centres.rows(); ++c) {
    const double d2 = (centres.row(c) - Eigen::RowVector2d(x(1), x(2))).squaredNorm();
    const double t = d2 / (radius * radius);
    weight(c) = t < 6.0 ? std::exp(-0.25 * std::numbers::pi * t * t) : 0.0;
  }
  return weight;
}

void soften(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  state.stiffness +=
      sum_of(structure.cells.stiffness, std::max(x(0), -0.999) * within(structure, x));
}

// The centre of each cell, the step in the factor to first order; the best few both ways.
std::vector<EffectStart> centres(const Scene& scene) {
  const auto& structure = scene.structure();
  const double radius = std::log(1.2 * pitch(structure));
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
    soften(softer, structure, 0, up);
    const auto gain = scene.gain(slope(scene.state(), scene.now(), scene.state(), softer, 0.01));
    x(0) = std::clamp(gain.step, -0.8, 1.5);
    all.push_back({gain.fall, x});
  }
  std::ranges::stable_sort(all, [](const Found& a, const Found& b) { return a.fall > b.fall; });
  std::vector<EffectStart> starts;
  for (std::size_t n = 0; n < std::min<std::size_t>(4, all.size()); ++n) {
    for (const double factor : {-0.7, -0.3, -0.1, 0.1, 0.4, 1.0}) {
      VectorXd x = all[n].x;
      x(0) = factor;
      starts.push_back({0, x});
    }
    starts.push_back({0, all[n].x});
  }
  return starts;
}

}  // namespace

const Effect local_stiffness{"local_stiffness",
                             "stiffer or softer in one place: crack, loose bolt, pocket, rib",
                             "K plus a factor of the stiffness within a patch",
                             "a mass of the opposite sign; factor and radius only as a product",
                             patch,
                             has_cells,
                             no_channels,
                             soften,
                             centres};

}  // namespace chladni::diagnosis
