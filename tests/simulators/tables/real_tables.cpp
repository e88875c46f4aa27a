#include "simulators/tables/real_tables.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {
namespace {

constexpr double kSide = 0.6;
constexpr double kThickness = 0.02;
constexpr double kYoung = 70e9;
constexpr double kPoisson = 0.3;
constexpr double kDensity = 2700.0;
constexpr double kPitch = 0.06;

constexpr TableParts kAll{true, true, true, true, true};

// The distance of the place from the centre of its pocket, along the axis where it is larger [m].
double from_pocket_centre(const Eigen::Vector2d& place) {
  const auto off = [](double x) { return std::abs(x / kPitch - std::floor(x / kPitch) - 0.5); };
  return kPitch * std::max(off(place.x()), off(place.y()));
}

bool in_pocket(const Eigen::Vector2d& place) { return from_pocket_centre(place) < 0.018; }

bool in_cut_out(const Eigen::Vector2d& place) {
  const auto deep = [](double across, double along) {
    return std::abs(across) > 0.5 * kSide - 0.024 && std::abs(along) < 0.03;
  };
  return deep(place.x(), place.y()) || deep(place.y(), place.x());
}

void scale(BendingStiffness& bending, double factor) {
  bending.d11 *= factor;
  bending.d12 *= factor;
  bending.d22 *= factor;
  bending.d66 *= factor;
}

// The differences between the table as built and the table as drawn.
struct Scatter {
  double pocket_mass = 0.5, pocket_stiffness = 0.35;
  double orthotropy = 0.0;
  Eigen::Vector4d corner_kg = Eigen::Vector4d::Constant(0.35);
  Eigen::VectorXd thickness;  // per cell, relative; empty: 1
};

// A smooth field on the cells, mean 0 and rms 1: 64 waves of the squared exponential's spectrum.
Eigen::VectorXd smooth_field(const PlateGrid& grid, double length, Dice& dice) {
  constexpr Eigen::Index kWaves = 64;
  const Eigen::MatrixXd wave = dice.normal(kWaves, 2) / length;
  Eigen::VectorXd phase(kWaves);
  for (double& angle : phase) angle = dice.between(0.0, 2.0 * std::numbers::pi);
  Eigen::VectorXd field(grid.cell_count());
  for (Eigen::Index c = 0; c < field.size(); ++c) {
    field(c) = (wave * grid.centre(c) + phase).array().cos().sum();
  }
  field.array() -= field.mean();
  return field / std::sqrt(field.squaredNorm() / static_cast<double>(field.size()));
}

Scatter scatter(unsigned seed, double thickness_rms) {
  Dice dice(seed);
  Scatter s;
  const PlateGrid grid{kSide, kSide, kTableCells, kTableCells};
  s.thickness = (1.0 + thickness_rms * smooth_field(grid, 0.2, dice).array()).max(0.5);
  s.orthotropy = dice.between(-0.12, 0.12);
  for (double& kg : s.corner_kg) kg *= dice.between(0.8, 1.2);
  s.pocket_stiffness *= dice.between(0.85, 1.15);
  s.pocket_mass *= dice.between(0.95, 1.05);
  return s;
}

void add_masses(const TableParts& parts, const Scatter& scatter, KirchhoffPlate& table) {
  constexpr double kEnd = 0.5 * kSide;
  for (int k = 0; k < 4; ++k) {
    const double angle = 0.5 * std::numbers::pi * k;
    const Eigen::Vector2d along(std::round(std::cos(angle)), std::round(std::sin(angle)));
    const Eigen::Vector2d across(-along.y(), along.x());
    if (parts.corner_masses) {
      table.masses.push_back({kEnd * (along + across), scatter.corner_kg(k)});
    }
    if (parts.edge_masses) table.masses.push_back({kEnd * along + 0.25 * kEnd * across, 0.3});
  }
  if (!parts.actuator_masses) return;
  const Eigen::MatrixX2d places = layout("quincunx");
  for (Eigen::Index k = 0; k < places.rows(); ++k) {
    table.masses.push_back({places.row(k).transpose(), 0.1});
  }
}

KirchhoffPlate table(const TableParts& parts, const Scatter& scatter, int cells) {
  require(cells == kTableCells || !(parts.pockets || parts.cut_outs),
          "table: pockets and cut-outs need " + std::to_string(kTableCells) +
              " cells along an edge, found " + std::to_string(cells));
  const double d = kYoung * std::pow(kThickness, 3) / (12.0 * (1.0 - kPoisson * kPoisson));
  auto plate = uniform_plate({kSide, kSide, cells, cells}, isotropic_bending(d, kPoisson),
                             kDensity * kThickness);
  for (Eigen::Index c = 0; c < plate.grid.cell_count(); ++c) {
    const Eigen::Vector2d place = plate.grid.centre(c);
    auto& bending = plate.bending[static_cast<std::size_t>(c)];
    const double thickness = scatter.thickness.size() > 0 ? scatter.thickness(c) : 1.0;
    scale(bending, std::pow(thickness, 3));
    plate.areal_mass(c) *= thickness;
    bending.d11 *= 1.0 + scatter.orthotropy;
    bending.d22 *= 1.0 - scatter.orthotropy;
    if (parts.pockets && in_pocket(place)) {
      scale(bending, scatter.pocket_stiffness);
      plate.areal_mass(c) *= scatter.pocket_mass;
    }
    if (parts.cut_outs && in_cut_out(place)) plate.areal_mass(c) = 0.0;
  }
  add_masses(parts, scatter, plate);
  return plate;
}

Eigen::MatrixX2d at_mounts(const std::vector<std::array<int, 2>>& millimetres) {
  Eigen::MatrixX2d places(static_cast<Eigen::Index>(millimetres.size()), 2);
  for (Eigen::Index k = 0; k < places.rows(); ++k) {
    const auto& [x, y] = millimetres[static_cast<std::size_t>(k)];
    places.row(k) << 1e-3 * x, 1e-3 * y;
  }
  return places;
}

// Thirteen of the 81 mounts, all with equal probability.
Eigen::MatrixX2d drawn(unsigned seed) {
  Dice dice(seed);
  const Eigen::MatrixX2d all = mounts();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(all.rows()));
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Eigen::Index>(k);
  for (std::size_t k = 0; k < 13; ++k) {
    const auto left = static_cast<Eigen::Index>(order.size() - k);
    std::swap(order[k], order[k + static_cast<std::size_t>(dice.below(left))]);
  }
  order.resize(13);
  return all(order, Eigen::all);
}

}  // namespace

KirchhoffPlate nominal_table(const TableParts& parts, int cells) { return table(parts, {}, cells); }

KirchhoffPlate minimal_table(int cells) { return nominal_table({}, cells); }

KirchhoffPlate minimal_table_with_corner_masses(int cells) {
  return nominal_table({.corner_masses = true}, cells);
}

KirchhoffPlate accurate_table() { return nominal_table(kAll); }

KirchhoffPlate real_table(unsigned seed, double thickness_rms) {
  require(thickness_rms >= 0.0 && thickness_rms <= 0.2, "table: the thickness varies by " +
                                                            std::to_string(thickness_rms) +
                                                            " rms; expected 0 to 0.2");
  return table(kAll, scatter(seed, thickness_rms), kTableCells);
}

Eigen::MatrixX2d mounts() {
  Eigen::MatrixX2d places(81, 2);
  for (Eigen::Index k = 0; k < 81; ++k) {
    const Eigen::Index i = k % 9 - 4;
    const Eigen::Index j = k / 9 - 4;
    places.row(k) << kPitch * static_cast<double>(i), kPitch * static_cast<double>(j);
  }
  return places;
}

Eigen::MatrixX2d layout(const std::string& name) {
  if (name == "quincunx") {
    return at_mounts({{-240, -240},
                      {0, -240},
                      {240, -240},
                      {-120, -120},
                      {120, -120},
                      {-240, 0},
                      {0, 0},
                      {240, 0},
                      {-120, 120},
                      {120, 120},
                      {-240, 240},
                      {0, 240},
                      {240, 240}});
  }
  if (name == "rings") {
    return at_mounts({{-240, -240},
                      {240, -240},
                      {240, 240},
                      {-240, 240},
                      {60, -240},
                      {240, 60},
                      {-60, 240},
                      {-240, -60},
                      {60, 120},
                      {-120, 60},
                      {-60, -120},
                      {120, -60},
                      {0, 60}});
  }
  if (name == "rand1") return drawn(101);
  if (name == "rand2") return drawn(102);
  throw InvalidInput("there is no layout \"" + name +
                     "\"; there are: quincunx, rings, rand1, rand2");
}

}  // namespace chladni::simulators
