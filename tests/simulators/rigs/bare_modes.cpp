// Modes of a body without attachments, by the plates of plates/.
#include <algorithm>
#include <cmath>
#include <memory>

#include "simulators/plates/kirchhoff_plate.h"
#include "simulators/rigs/real_body.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

constexpr Index kRitzModes = 160;
constexpr int kCellModes = 80;
constexpr int kCells = 36;       // along each side; even, so that the L ends on cells
constexpr int kSamples = 8;      // of a cell along each side, for its share
constexpr double kLeast = 0.02;  // share of a cell that exists

// Legendre's polynomials P_0 to P_{count − 1}.
Eigen::VectorXd legendre(double x, Index count) {
  Eigen::VectorXd p = Eigen::VectorXd::Ones(count);
  if (count > 1) p(1) = x;
  for (Index n = 1; n + 1 < count; ++n) {
    const auto k = static_cast<double>(n);
    p(n + 1) = ((2.0 * k + 1.0) * x * p(n) - k * p(n - 1)) / (k + 1.0);
  }
  return p;
}

double field_at(const Eigen::MatrixXd& field, const RitzBody& plate, const Eigen::Vector2d& at) {
  return legendre(2.0 * at.x() / plate.length, field.rows())
      .dot(field * legendre(2.0 * at.y() / plate.width, field.cols()));
}

// The part of a cell for which `inside` is true.
template <class Inside>
double share(const PlateGrid& grid, Index cell, Inside inside) {
  const Eigen::Array2d pitch(grid.length / grid.nx, grid.width / grid.ny);
  int count = 0;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Array2d step((i + 0.5) / kSamples - 0.5, (j + 0.5) / kSamples - 0.5);
      count += inside(Eigen::Vector2d(grid.centre(cell) + (step * pitch).matrix())) ? 1 : 0;
    }
  }
  return static_cast<double>(count) / (kSamples * kSamples);
}

bool within(Outline outline, const RitzBody& plate, const Eigen::Vector2d& place) {
  if (outline == Outline::disc) return place.norm() <= 0.5 * plate.length;
  return outline == Outline::rectangle || place.minCoeff() <= 0.0;
}

// A crack in a cell is a soft layer in series with the rest of the cell.
double softened(const RitzCrack& crack, const PlateGrid& grid, const Eigen::Vector2d& centre) {
  const double pitch = grid.length / grid.nx;
  const Eigen::Vector2d line = crack.to - crack.from;
  const double along = std::clamp((centre - crack.from).dot(line) / line.squaredNorm(), 0.0, 1.0);
  if ((centre - crack.from - along * line).norm() > 0.5 * pitch) return 1.0;
  const double part = std::min(crack.width / pitch, 0.9);
  return 1.0 / (1.0 - part + part / (1.0 - crack.loss));
}

double stiffness_factor(const RitzBody& plate, const PlateGrid& grid, Index cell) {
  const Eigen::Vector2d centre = grid.centre(cell);
  double factor = plate.modulus.size() == 0 ? 1.0 : field_at(plate.modulus, plate, centre);
  for (const auto& disc : plate.discs) {
    factor *= 1.0 + (disc.stiffness - 1.0) * share(grid, cell, [&](const Eigen::Vector2d& place) {
                      return (place - disc.centre).norm() <= disc.radius;
                    });
  }
  for (const auto& crack : plate.cracks) factor *= softened(crack, grid, centre);
  return factor;
}

KirchhoffPlate cells_of(const RitzBody& plate, Outline outline) {
  KirchhoffPlate made;
  made.grid = {plate.length, plate.width, kCells, kCells};
  made.areal_mass = Eigen::VectorXd::Zero(made.grid.cell_count());
  made.bending.resize(static_cast<std::size_t>(made.grid.cell_count()));
  const auto& q = plate.stiffness;
  for (Index c = 0; c < made.grid.cell_count(); ++c) {
    const double part = share(
        made.grid, c, [&](const Eigen::Vector2d& place) { return within(outline, plate, place); });
    if (part < kLeast) continue;
    const double t = field_at(plate.thickness, plate, made.grid.centre(c));
    const double d = part * t * t * t / 12.0 * stiffness_factor(plate, made.grid, c);
    made.bending[static_cast<std::size_t>(c)] = {d * q.q11, d * q.q12, d * q.q22, d * q.q66};
    made.areal_mass(c) = part * plate.density * t;
  }
  return made;
}

}  // namespace

BareModes bare_modes(const RitzBody& plate, Outline outline) {
  BareModes made;
  made.rigid_count = plate.rigid_count();
  if (outline == Outline::rectangle) {
    auto kept = std::make_shared<RitzModes>(ritz_modes(plate));
    const Index n = std::min(kRitzModes, kept->mode_count());
    kept->frequency_hz = kept->frequency_hz.head(n).eval();
    kept->coefficients = kept->coefficients.leftCols(n).eval();
    made.frequency_hz = kept->frequency_hz;
    made.shapes_at = [kept](const Eigen::MatrixX2d& places) {
      return modal_rows(*kept, places).deflection;
    };
    return made;
  }
  const auto kept = std::make_shared<PlateModes>(plate_modes(cells_of(plate, outline), kCellModes));
  made.frequency_hz = kept->frequency_hz;
  made.shapes_at = [kept](const Eigen::MatrixX2d& places) { return shapes_at(*kept, places); };
  return made;
}

}  // namespace chladni::simulators
