#include "simulators/plates/kirchhoff_plate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "simulators/plates/lowest_modes.h"

namespace chladni::simulators {
namespace {

using Vector16 = Eigen::Matrix<double, 16, 1>;
using Matrix16 = Eigen::Matrix<double, 16, 16>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Cubic Hermite functions of value and (scaled) slope at t = 0 and 1, or their derivative by t.
Eigen::Vector4d hermite(double t, int derivative) {
  if (derivative == 0) {
    return {1 + t * t * (2 * t - 3), t * (1 - t) * (1 - t), t * t * (3 - 2 * t), t * t * (t - 1)};
  }
  if (derivative == 1) {
    return {6 * t * (t - 1), 1 + t * (3 * t - 4), 6 * t * (1 - t), t * (3 * t - 2)};
  }
  return {12 * t - 6, 6 * t - 4, 6 - 12 * t, 6 * t - 2};
}

// Products of the functions in the order of nodes (0,0) (1,0) (0,1) (1,1), for each w, wx, wy, wxy.
Vector16 products(const Eigen::Vector4d& x, const Eigen::Vector4d& y) {
  Vector16 all;
  for (Eigen::Index node = 0; node < 4; ++node) {
    const Eigen::Index a = 2 * (node % 2);
    const Eigen::Index b = 2 * (node / 2);
    all.segment<4>(4 * node) << x(a) * y(b), x(a + 1) * y(b), x(a) * y(b + 1), x(a + 1) * y(b + 1);
  }
  return all;
}

// Integrals over one cell. The cell's matrices are linear in its stiffness and mass.
struct CellMatrices {
  Matrix16 xx = Matrix16::Zero(), cross = Matrix16::Zero(), yy = Matrix16::Zero(),
           xy = Matrix16::Zero(), mass = Matrix16::Zero();
};

CellMatrices cell_matrices(const PlateGrid& grid) {
  const double hx = grid.length / grid.nx;
  const double hy = grid.width / grid.ny;
  // Four points: exact for the products of cubics.
  const std::array<double, 4> abscissa{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                       0.8611363115940526};
  const std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                     0.3478548451374538};
  CellMatrices sum;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double s = 0.5 * (1 + abscissa[i]);
      const double t = 0.5 * (1 + abscissa[j]);
      const double area = 0.25 * weight[i] * weight[j] * hx * hy;
      const Vector16 w = products(hermite(s, 0), hermite(t, 0));
      const Vector16 wxx = products(hermite(s, 2), hermite(t, 0)) / (hx * hx);
      const Vector16 wyy = products(hermite(s, 0), hermite(t, 2)) / (hy * hy);
      const Vector16 wxy = products(hermite(s, 1), hermite(t, 1)) / (hx * hy);
      sum.xx += area * wxx * wxx.transpose();
      sum.cross += area * (wxx * wyy.transpose() + wyy * wxx.transpose());
      sum.yy += area * wyy * wyy.transpose();
      sum.xy += 4 * area * wxy * wxy.transpose();
      sum.mass += area * w * w.transpose();
    }
  }
  return sum;
}

using CellDofs = std::array<Eigen::Index, 16>;

CellDofs cell_dofs(const PlateGrid& grid, Eigen::Index cell) {
  const Eigen::Index i = cell % grid.nx;
  const Eigen::Index j = cell / grid.nx;
  CellDofs dofs{};
  for (std::size_t k = 0; k < 16; ++k) {
    const auto node = static_cast<Eigen::Index>(k / 4);
    const Eigen::Index at = (j + node / 2) * (grid.nx + 1) + i + node % 2;
    dofs[k] = 4 * at + static_cast<Eigen::Index>(k % 4);
  }
  return dofs;
}

// The cell that contains a place (−1: none), and the shape functions at the place.
struct Spot {
  Eigen::Index cell = -1;
  Vector16 shape = Vector16::Zero();
};

Spot spot(const PlateGrid& grid, const std::vector<char>& present, const Eigen::Vector2d& place) {
  constexpr double kRim = 1e-9;  // of a cell
  const double x = (place.x() / grid.length + 0.5) * grid.nx;
  const double y = (place.y() / grid.width + 0.5) * grid.ny;
  const auto first = [](double at) { return static_cast<Eigen::Index>(std::floor(at - kRim)); };
  const auto last = [](double at) { return static_cast<Eigen::Index>(std::floor(at + kRim)); };
  for (Eigen::Index j = first(y); j <= last(y); ++j) {
    for (Eigen::Index i = first(x); i <= last(x); ++i) {
      if (i < 0 || j < 0 || i >= grid.nx || j >= grid.ny) continue;
      const Eigen::Index cell = j * grid.nx + i;
      if (present[static_cast<std::size_t>(cell)] == 0) continue;
      return {cell, products(hermite(x - static_cast<double>(i), 0),
                             hermite(y - static_cast<double>(j), 0))};
    }
  }
  return {};
}

std::string text(const Eigen::Vector2d& place) {
  return "(" + std::to_string(place.x()) + ", " + std::to_string(place.y()) + ") m";
}

std::vector<char> present_cells(const KirchhoffPlate& plate) {
  std::vector<char> present(static_cast<std::size_t>(plate.areal_mass.size()));
  for (std::size_t c = 0; c < present.size(); ++c) {
    present[c] = plate.areal_mass(static_cast<Eigen::Index>(c)) > 0.0 ? 1 : 0;
  }
  return present;
}

void check(const KirchhoffPlate& plate) {
  const auto& grid = plate.grid;
  require(grid.nx > 0 && grid.ny > 0 && grid.length > 0.0 && grid.width > 0.0,
          "plate: the grid is empty");
  require(plate.areal_mass.size() == grid.cell_count() &&
              plate.bending.size() == static_cast<std::size_t>(grid.cell_count()),
          "plate: " + std::to_string(plate.bending.size()) + " stiffnesses and " +
              std::to_string(plate.areal_mass.size()) + " masses, expected one per cell, " +
              std::to_string(grid.cell_count()));
  require(plate.areal_mass.allFinite() && plate.areal_mass.minCoeff() >= 0.0 &&
              plate.areal_mass.maxCoeff() > 0.0,
          "plate: a mass per area is negative or all are 0");
  for (std::size_t c = 0; c < plate.bending.size(); ++c) {
    const auto& d = plate.bending[c];
    require(plate.areal_mass(static_cast<Eigen::Index>(c)) == 0.0 ||
                (d.d11 > 0.0 && d.d66 > 0.0 && d.d11 * d.d22 > d.d12 * d.d12),
            "plate: the stiffness of cell " + std::to_string(c) + " is not positive definite");
  }
}

void require_one_piece(const PlateGrid& grid, const std::vector<char>& present) {
  std::vector<char> unseen = present;
  std::vector<Eigen::Index> open;
  const auto visit = [&](Eigen::Index i, Eigen::Index j) {
    if (i < 0 || j < 0 || i >= grid.nx || j >= grid.ny) return;
    auto& cell = unseen[static_cast<std::size_t>(j * grid.nx + i)];
    if (cell != 0) open.push_back(j * grid.nx + i);
    cell = 0;
  };
  const auto start = std::find(present.begin(), present.end(), 1) - present.begin();
  visit(start % grid.nx, start / grid.nx);
  while (!open.empty()) {
    const Eigen::Index cell = open.back();
    open.pop_back();
    visit(cell % grid.nx - 1, cell / grid.nx);
    visit(cell % grid.nx + 1, cell / grid.nx);
    visit(cell % grid.nx, cell / grid.nx - 1);
    visit(cell % grid.nx, cell / grid.nx + 1);
  }
  require(std::find(unseen.begin(), unseen.end(), 1) == unseen.end(),
          "plate: its cells are not in one piece");
}

void scatter(const Matrix16& matrix, const CellDofs& dofs, const std::vector<Eigen::Index>& row,
             Triplets& into) {
  for (std::size_t b = 0; b < 16; ++b) {
    for (std::size_t a = 0; a < 16; ++a) {
      const Eigen::Index i = row[static_cast<std::size_t>(dofs[a])];
      const Eigen::Index j = row[static_cast<std::size_t>(dofs[b])];
      if (i >= j) {
        into.emplace_back(static_cast<int>(i), static_cast<int>(j),
                          matrix(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
      }
    }
  }
}

// Rows of the system for the degrees of freedom of nodes of existing cells; −1 for the others.
std::vector<Eigen::Index> rows_of(const PlateGrid& grid, const std::vector<char>& present) {
  std::vector<Eigen::Index> row(static_cast<std::size_t>(4 * grid.node_count()), -1);
  for (Eigen::Index c = 0; c < grid.cell_count(); ++c) {
    if (present[static_cast<std::size_t>(c)] == 0) continue;
    for (const auto dof : cell_dofs(grid, c)) row[static_cast<std::size_t>(dof)] = 0;
  }
  Eigen::Index count = 0;
  for (auto& r : row) {
    if (r == 0) r = count++;
  }
  return row;
}

Pencil assembled(const KirchhoffPlate& plate, const std::vector<char>& present,
                 const std::vector<Eigen::Index>& row) {
  const auto unit = cell_matrices(plate.grid);
  Triplets stiffness;
  Triplets mass;
  for (Eigen::Index c = 0; c < plate.grid.cell_count(); ++c) {
    if (present[static_cast<std::size_t>(c)] == 0) continue;
    const auto& d = plate.bending[static_cast<std::size_t>(c)];
    const auto dofs = cell_dofs(plate.grid, c);
    scatter(d.d11 * unit.xx + d.d12 * unit.cross + d.d22 * unit.yy + d.d66 * unit.xy, dofs, row,
            stiffness);
    scatter(plate.areal_mass(c) * unit.mass, dofs, row, mass);
  }
  for (const auto& point : plate.masses) {
    const auto at = spot(plate.grid, present, point.place);
    require(at.cell >= 0, "plate: the mass at " + text(point.place) + " is not on the plate");
    require(point.kg >= 0.0, "plate: the mass at " + text(point.place) + " is negative");
    scatter(point.kg * at.shape * at.shape.transpose(), cell_dofs(plate.grid, at.cell), row, mass);
  }
  const Eigen::Index n = *std::max_element(row.begin(), row.end()) + 1;
  Pencil pencil{Eigen::SparseMatrix<double>(n, n), Eigen::SparseMatrix<double>(n, n), {}};
  pencil.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  pencil.mass.setFromTriplets(mass.begin(), mass.end());
  return pencil;
}

// The functions 1, x and y as degrees of freedom. The elements contain them exactly.
Eigen::MatrixXd rigid_motions(const PlateGrid& grid, const std::vector<Eigen::Index>& row,
                              Eigen::Index count) {
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(count, 3);
  const double hx = grid.length / grid.nx;
  const double hy = grid.width / grid.ny;
  for (Eigen::Index node = 0; node < grid.node_count(); ++node) {
    const Eigen::Index r = row[static_cast<std::size_t>(4 * node)];
    if (r < 0) continue;
    const Eigen::Index i = node % (grid.nx + 1);
    const Eigen::Index j = node / (grid.nx + 1);
    const double x = static_cast<double>(i) * hx - 0.5 * grid.length;
    const double y = static_cast<double>(j) * hy - 0.5 * grid.width;
    motions.row(r) << 1.0, x, y;
    motions(r + 1, 1) = hx;
    motions(r + 2, 2) = hy;
  }
  return motions;
}

// The approximate square of the first flexible angular frequency of a plate with mean stiffness and
// mass.
double first_eigenvalue(const KirchhoffPlate& plate) {
  double stiffness = 0.0;
  for (std::size_t c = 0; c < plate.bending.size(); ++c) {
    if (plate.areal_mass(static_cast<Eigen::Index>(c)) > 0.0) stiffness += plate.bending[c].d11;
  }
  const double size = std::max(plate.grid.length, plate.grid.width);
  return 180.0 * stiffness / (plate.areal_mass.sum() * std::pow(size, 4));
}

}  // namespace

Eigen::Vector2d PlateGrid::centre(Eigen::Index cell) const {
  const Eigen::Index i = cell % nx;
  const Eigen::Index j = cell / nx;
  return {(static_cast<double>(i) + 0.5) * length / nx - 0.5 * length,
          (static_cast<double>(j) + 0.5) * width / ny - 0.5 * width};
}

BendingStiffness isotropic_bending(double d, double poisson) {
  return {d, poisson * d, d, 0.5 * (1.0 - poisson) * d};
}

KirchhoffPlate uniform_plate(const PlateGrid& grid, const BendingStiffness& bending,
                             double areal_mass) {
  return {grid,
          std::vector<BendingStiffness>(static_cast<std::size_t>(grid.cell_count()), bending),
          Eigen::VectorXd::Constant(grid.cell_count(), areal_mass),
          {}};
}

PlateModes plate_modes(const KirchhoffPlate& plate, int flexible) {
  check(plate);
  PlateModes modes;
  modes.grid = plate.grid;
  modes.present = present_cells(plate);
  require_one_piece(plate.grid, modes.present);
  const auto row = rows_of(plate.grid, modes.present);
  auto pencil = assembled(plate, modes.present, row);
  pencil.rigid = rigid_motions(plate.grid, row, pencil.mass.rows());
  const auto found = lowest_modes(pencil, flexible, first_eigenvalue(plate));
  modes.frequency_hz = found.lambda.cwiseSqrt() / (2.0 * std::numbers::pi);
  modes.dofs = Eigen::MatrixXd::Zero(4 * plate.grid.node_count(), found.lambda.size());
  for (std::size_t dof = 0; dof < row.size(); ++dof) {
    if (row[dof] >= 0) {
      modes.dofs.row(static_cast<Eigen::Index>(dof)) = found.shapes.row(row[dof]);
    }
  }
  return modes;
}

PlateFieldMatrices plate_field_matrices(const KirchhoffPlate& plate, const PlateModes& modes,
                                        const Eigen::MatrixXd& fields) {
  check(plate);
  require(fields.rows() == plate.grid.cell_count(), "plate: a field has not one value per cell");
  const auto unit = cell_matrices(plate.grid);
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(modes.mode_count(), modes.mode_count());
  const std::vector<Eigen::MatrixXd> none(static_cast<std::size_t>(fields.cols()), zero);
  PlateFieldMatrices sum{none, none};
  for (Eigen::Index c = 0; c < plate.grid.cell_count(); ++c) {
    if (modes.present[static_cast<std::size_t>(c)] == 0) continue;
    const auto& d = plate.bending[static_cast<std::size_t>(c)];
    const Eigen::MatrixXd local = modes.dofs(cell_dofs(plate.grid, c), Eigen::all);
    const Eigen::MatrixXd stiffness =
        local.transpose() *
        (d.d11 * unit.xx + d.d12 * unit.cross + d.d22 * unit.yy + d.d66 * unit.xy) * local;
    const Eigen::MatrixXd mass = plate.areal_mass(c) * local.transpose() * unit.mass * local;
    for (Eigen::Index f = 0; f < fields.cols(); ++f) {
      sum.stiffness[static_cast<std::size_t>(f)] += fields(c, f) * stiffness;
      sum.mass[static_cast<std::size_t>(f)] += fields(c, f) * mass;
    }
  }
  return sum;
}

bool covers(const PlateModes& modes, const Eigen::Vector2d& place) {
  return spot(modes.grid, modes.present, place).cell >= 0;
}

Eigen::MatrixXd shapes_at(const PlateModes& modes, const Eigen::MatrixX2d& places) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(places.rows(), modes.mode_count());
  for (Eigen::Index k = 0; k < places.rows(); ++k) {
    const Eigen::Vector2d place = places.row(k).transpose();
    const auto at = spot(modes.grid, modes.present, place);
    require(at.cell >= 0, "plate: " + text(place) + " is not on the plate");
    const auto dofs = cell_dofs(modes.grid, at.cell);
    for (std::size_t a = 0; a < 16; ++a) {
      values.row(k) += at.shape(static_cast<Eigen::Index>(a)) * modes.dofs.row(dofs[a]);
    }
  }
  return values;
}

PlateSurface plate_surface(const PlateModes& modes, int per_side) {
  require(per_side == 1 || per_side == 2,
          "plate: 1 or 2 points per side of a cell, found " + std::to_string(per_side));
  const Eigen::Index cells = std::count(modes.present.begin(), modes.present.end(), 1);
  const Eigen::Index each = Eigen::Index{per_side} * per_side;
  const double off = per_side == 1 ? 0.0 : 0.5 / std::numbers::sqrt3;
  const Eigen::Vector2d h(modes.grid.length / modes.grid.nx, modes.grid.width / modes.grid.ny);
  PlateSurface surface{Eigen::MatrixX2d(cells * each, 2), {}};
  surface.area.setConstant(cells * each, modes.grid.cell_area() / static_cast<double>(each));
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < modes.grid.cell_count(); ++c) {
    if (modes.present[static_cast<std::size_t>(c)] == 0) continue;
    for (Eigen::Index q = 0; q < each; ++q) {
      const Eigen::Vector2d sign((q % 2) != 0 ? 1.0 : -1.0, q / 2 != 0 ? 1.0 : -1.0);
      surface.places.row(row++) = modes.grid.centre(c) + off * sign.cwiseProduct(h);
    }
  }
  return surface;
}

}  // namespace chladni::simulators
