#include "diagnosis/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

void fits(const Eigen::MatrixXd& values, Eigen::Index rows, Eigen::Index cols,
          const std::string& what) {
  require(values.rows() == rows && values.cols() == cols,
          fmt::format("{}: {} x {} numbers, expected {} x {}", what, values.rows(), values.cols(),
                      rows, cols));
  require(values.allFinite(), what + ": a number that is not finite");
}

void check_side(const ChannelSide& side, Eigen::Index modes, const std::string& what) {
  const Eigen::Index n = side.count();
  require(static_cast<Eigen::Index>(side.names.size()) == n, what + ": one name each is expected");
  fits(side.shapes, n, modes, "shapes at the " + what);
  fits(side.slope_u, n, modes, "slopes along u at the " + what);
  fits(side.slope_v, n, modes, "slopes along v at the " + what);
  fits(side.aside_u, n, modes, "motion along u at the " + what);
  fits(side.aside_v, n, modes, "motion along v at the " + what);
  fits(side.places, n, 2, "places of the " + what);
  if (side.directions.rows() > 0) fits(side.directions, n, 3, "directions of the " + what);
  require(side.upper.size() == 0 || side.upper.rows() == n,
          "modes above the band at the " + what + ": one row each is expected");
}

void check_cells(const BodyCells& cells, Eigen::Index modes) {
  const auto n = static_cast<std::size_t>(cells.count());
  require(
      cells.stiffness.size() == n && cells.mass.size() == n && cells.area.size() == cells.count(),
      "cells of the body: centres, areas and matrices differ in number");
  for (const auto* parts : {&cells.shear, &cells.rotary}) {
    require(parts->empty() || parts->size() == n, "cells of the body: a part of some only");
    for (const auto& part : *parts) fits(part, modes, modes, "a part of a cell");
  }
  const auto& waves = cells.waves;
  require(waves.bent.size() == waves.modulus.size() && waves.thickened.size() == waves.bent.size(),
          "waves of the body: their matrices differ in number");
  for (const auto* parts : {&waves.modulus, &waves.bent, &waves.thickened}) {
    for (const auto& part : *parts) fits(part, modes, modes, "a wave over the body");
  }
  for (std::size_t c = 0; c < n; ++c) {
    fits(cells.stiffness[c], modes, modes, "stiffness of a cell");
    fits(cells.mass[c], modes, modes, "mass of a cell");
  }
}

void check_fine(const FineCells& fine, const ChannelSide& outputs, Eigen::Index modes) {
  require(static_cast<Eigen::Index>(fine.stiffness.size()) == fine.count(),
          "fine cells of the body: centres and matrices differ in number");
  for (const auto& one : fine.stiffness) {
    const Eigen::Index size = fine.stiffness.front().rows();
    fits(one, size, size, "stiffness of a fine cell");
    require(size >= modes && size <= modes + outputs.upper.cols(),
            "stiffness of a fine cell: its modes are not those of the structure");
  }
}

// Cosine between the shapes of channel i and those along the normal at the nearest place; 0 where
// either moves in no mode.
double cosine_by_shapes(const Surface& surface, const ChannelSide& side, Eigen::Index i) {
  Eigen::Index nearest = 0;
  (surface.places.rowwise() - side.places.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
  const auto own = side.shapes.row(i);
  const auto there = surface.shapes.row(nearest);
  const double most = own.norm() * there.norm();
  return most > 0.0 ? own.dot(there) / most : 0.0;
}

}  // namespace

ChannelSide part_of(const ChannelSide& side, const std::vector<Eigen::Index>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  // What a side does not state has no rows.
  const auto take = [&](const Eigen::MatrixXd& from) {
    return from.rows() == 0 ? Eigen::MatrixXd(count, from.cols())
                            : Eigen::MatrixXd(from(rows, Eigen::all));
  };
  ChannelSide part;
  for (const Eigen::Index i : rows) part.names.push_back(side.names[at(i)]);
  part.shapes = take(side.shapes);
  part.slope_u = take(side.slope_u);
  part.slope_v = take(side.slope_v);
  part.aside_u = take(side.aside_u);
  part.aside_v = take(side.aside_v);
  part.places = side.places(rows, Eigen::all);
  if (side.directions.rows() > 0) part.directions = side.directions(rows, Eigen::all);
  if (side.upper.cols() > 0) part.upper = side.upper(rows, Eigen::all);
  return part;
}

Eigen::MatrixXd GrownForms::at(double by) const {
  const auto& side = by < 0.0 ? smaller : larger;
  const Eigen::Index m = steps.size();
  if (m == 0) return rows;
  Eigen::VectorXd nodes(m + 1);
  nodes << 0.0, steps;
  const double x = std::min(std::abs(by), steps(m - 1));
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows.rows(), rows.cols());
  for (Eigen::Index i = 0; i <= m; ++i) {  // Lagrange's form
    double weight = 1.0;
    for (Eigen::Index j = 0; j <= m; ++j) {
      if (j != i) weight *= (x - nodes(j)) / (nodes(i) - nodes(j));
    }
    result += weight * (i == 0 ? rows : side[chladni::at(i - 1)]);
  }
  return result;
}

Eigen::MatrixXd GrownForms::gain(double by) const {
  const Eigen::MatrixXd there = at(by);
  return there.transpose() * there - rows.transpose() * rows;
}

Eigen::VectorXd parts_along_normal(const Structure& structure, const ChannelSide& side) {
  if (side.directions.rows() > 0) return side.directions.col(2);
  const auto& surface = structure.surface;
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(side.count());
  for (Eigen::Index i = 0; i < signs.size() && surface.count() > 0; ++i) {
    if (cosine_by_shapes(surface, side, i) < -kConstants.against_normal) signs(i) = -1.0;
  }
  return signs;
}

void check(const Structure& structure) {
  const Eigen::Index r = structure.mode_count();
  require(r > structure.rigid_count && structure.rigid_count >= 0, "no flexible mode");
  fits(structure.frequency_hz, r, 1, "frequencies");
  fits(structure.damping_ratio, r, 1, "damping ratios");
  require((structure.frequency_hz.head(structure.rigid_count).array() == 0.0).all() &&
              (structure.frequency_hz.tail(r - structure.rigid_count).array() > 0.0).all(),
          "rigid-body modes come first, at exactly 0 Hz");
  if (structure.dashpots.size() > 0) fits(structure.dashpots, r, r, "dashpots");
  if (structure.frequency_error.size() > 0) {
    fits(structure.frequency_error, r, 1, "errors of the frequencies");
    require(structure.frequency_error.minCoeff() >= 0.0,
            "errors of the frequencies: one is below 0");
  }
  for (const auto* attached : {&structure.dashpots, &structure.springs, &structure.masses}) {
    if (attached->size() > 0) fits(*attached, r, r, "what is attached to the body");
  }
  const auto& grown = structure.grown;
  for (const auto* forms : {&grown.springs, &grown.masses, &grown.dashpots}) {
    if (forms->count() == 0) continue;
    fits(forms->rows, forms->count(), r, "what is attached to a larger body");
    const auto steps = static_cast<std::size_t>(forms->steps.size());
    require(forms->smaller.size() == steps && forms->larger.size() == steps,
            "what is attached to a larger body: one matrix per step is expected");
    for (const auto* side : {&forms->smaller, &forms->larger}) {
      for (const auto& rows : *side) {
        fits(rows, forms->count(), r, "what is attached to a larger body");
      }
    }
  }
  if (structure.correction.size() > 0) fits(structure.correction, r, r, "corrected stiffness");
  check_side(structure.outputs, r, "sensors");
  check_side(structure.inputs, r, "actuators");
  fits(structure.residual, structure.output_count(), structure.input_count(), "residual");
  fits(structure.surface.shapes, structure.surface.count(), r, "shapes on the surface");
  fits(structure.surface.area, structure.surface.count(), 1, "areas of the surface");
  require(structure.surface.count() == 0 || structure.surface.at != nullptr,
          "a surface without its map");
  check_cells(structure.cells, r);
  check_fine(structure.fine, structure.outputs, r);
  if (structure.directional.along_u.size() == 0) return;
  fits(structure.directional.along_u, r, r, "stiffness along u");
  fits(structure.directional.along_v, r, r, "stiffness along v");
  fits(structure.directional.across, r, r, "stiffness across");
  fits(structure.directional.shear, r, r, "stiffness in shear");
}

std::vector<Eigen::Index> spread_places(const Surface& surface, Eigen::Index about) {
  const Eigen::Index step = std::max<Eigen::Index>(1, surface.count() / about);
  std::vector<Eigen::Index> places;
  for (Eigen::Index n = step / 2; n < surface.count(); n += step) places.push_back(n);
  return places;
}

}  // namespace chladni::diagnosis
