#include "simulators/plates/ritz_plate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulators/plates/gauss_rule.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

// P_k √(2k + 1) and its derivative, k = 0 … degree, at ξ in [−1, 1].
struct Legendre {
  Eigen::VectorXd value, slope;
};

Legendre legendre(int degree, double xi) {
  Legendre p{Eigen::VectorXd::Zero(degree + 1), Eigen::VectorXd::Zero(degree + 1)};
  p.value(0) = 1.0;
  if (degree > 0) {
    p.value(1) = xi;
    p.slope(1) = 1.0;
  }
  for (int k = 2; k <= degree; ++k) {
    p.value(k) = ((2.0 * k - 1.0) * xi * p.value(k - 1) - (k - 1.0) * p.value(k - 2)) / k;
    p.slope(k) = p.slope(k - 2) + (2.0 * k - 1.0) * p.value(k - 1);
  }
  for (int k = 0; k <= degree; ++k) {
    p.value(k) *= std::sqrt(2.0 * k + 1.0);
    p.slope(k) *= std::sqrt(2.0 * k + 1.0);
  }
  return p;
}

// The products of polynomials at k places: values and derivatives along x and y, each k×n/3.
struct Products {
  Eigen::MatrixXd value, by_x, by_y;
};

Products products(const RitzBody& body, const Eigen::MatrixX2d& places) {
  const Index m = body.degree_along_y() + 1;
  const Index all = (body.degree + 1) * m;
  const Index k = places.rows();
  Products at{Eigen::MatrixXd(k, all), Eigen::MatrixXd(k, all), Eigen::MatrixXd(k, all)};
  for (Index row = 0; row < k; ++row) {
    const auto x = legendre(body.degree, 2.0 * places(row, 0) / body.length);
    const auto y = legendre(body.degree_along_y(), 2.0 * places(row, 1) / body.width);
    for (Index i = 0; i <= body.degree; ++i) {
      at.value.row(row).segment(i * m, m) = x.value(i) * y.value.transpose();
      at.by_x.row(row).segment(i * m, m) = 2.0 / body.length * x.slope(i) * y.value.transpose();
      at.by_y.row(row).segment(i * m, m) = 2.0 / body.width * x.value(i) * y.slope.transpose();
    }
  }
  return at;
}

// Thickness or modulus at a place.
double field_at(const RitzBody& body, const Eigen::MatrixXd& field, double x, double y) {
  const Index rows = field.rows();
  const Index cols = field.cols();
  const auto p = legendre(static_cast<int>(rows) - 1, 2.0 * x / body.length);
  const auto q = legendre(static_cast<int>(cols) - 1, 2.0 * y / body.width);
  double sum = 0.0;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double scale =
          std::sqrt((2.0 * static_cast<double>(i) + 1.0) * (2.0 * static_cast<double>(j) + 1.0));
      sum += field(i, j) * p.value(i) * q.value(j) / scale;
    }
  }
  return sum;
}

// The factor of all stiffnesses at a place.
double modulus_at(const RitzBody& body, double x, double y) {
  if (body.modulus.size() == 0) return 1.0;
  const double factor = field_at(body, body.modulus, x, y);
  require(factor > 0.0, fmt::format("modulus {} times its mean at ({}, {}) m, expected more than 0",
                                    factor, x, y));
  return factor;
}

// Places with the properties of their areas: bending [N m] and shear [N/m] stiffness, mass [kg/m²],
// rotary inertia [kg], all times the area [m²].
struct Carried {
  Eigen::MatrixX2d places;
  std::vector<Eigen::Matrix3d> bending;  // of (κx, κy, κxy)
  Eigen::VectorXd shear, mass, rotary;
};

Eigen::Matrix3d plane_matrix(const PlaneStiffness& q, StiffnessPart part) {
  const auto has = [part](StiffnessPart one) { return part == StiffnessPart::all || part == one; };
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  if (has(StiffnessPart::along_x)) matrix(0, 0) = q.q11;
  if (has(StiffnessPart::along_y)) matrix(1, 1) = q.q22;
  if (has(StiffnessPart::across)) matrix(0, 1) = matrix(1, 0) = q.q12;
  if (has(StiffnessPart::shear)) matrix(2, 2) = q.q66;
  return matrix;
}

// Full stiffness and mass of the plate at places that represent areas.
Carried carried(const RitzBody& body, const AreaRule& rule, StiffnessPart part) {
  const Index k = rule.area.size();
  Carried all{rule.places, {}, Eigen::VectorXd(k), Eigen::VectorXd(k), Eigen::VectorXd(k)};
  const Eigen::Matrix3d plane = plane_matrix(body.stiffness, part);
  const bool shears = part == StiffnessPart::all || part == StiffnessPart::shear;
  for (Index i = 0; i < k; ++i) {
    const double t = field_at(body, body.thickness, rule.places(i, 0), rule.places(i, 1));
    const double e = modulus_at(body, rule.places(i, 0), rule.places(i, 1));
    require(t > 0.0, fmt::format("thickness {} m at ({}, {}) m, expected more than 0", t,
                                 rule.places(i, 0), rule.places(i, 1)));
    all.bending.emplace_back(plane * (e * t * t * t / 12.0 * rule.area(i)));
    all.shear(i) = shears ? 5.0 / 6.0 * body.stiffness.shear * e * t * rule.area(i) : 0.0;
    all.mass(i) = body.density * t * rule.area(i);
    all.rotary(i) = body.density * t * t * t / 12.0 * rule.area(i);
  }
  return all;
}

void scale(Carried& all, double stiffness, double mass) {
  for (auto& bending : all.bending) bending *= stiffness;
  all.shear *= stiffness;
  all.mass *= mass;
  all.rotary *= mass;
}

// The moments D κ. κ has k rows of κx, then of κy, then of κxy.
Eigen::MatrixXd moments(const Eigen::MatrixXd& curvature,
                        const std::vector<Eigen::Matrix3d>& bending) {
  const Index k = curvature.rows() / 3;
  Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(3 * k, curvature.cols());
  for (Index a = 0; a < 3; ++a) {
    for (Index b = 0; b < 3; ++b) {
      Eigen::VectorXd d(k);
      for (Index i = 0; i < k; ++i) d(i) = bending[static_cast<std::size_t>(i)](a, b);
      if (d.isZero(0.0)) continue;
      moment.middleRows(a * k, k) += d.asDiagonal() * curvature.middleRows(b * k, k);
    }
  }
  return moment;
}

// The bending stiffness on the coefficients of (ψx, ψy).
Eigen::MatrixXd bending_stiffness(const Products& at, const std::vector<Eigen::Matrix3d>& bending) {
  const Index m = at.value.cols();
  const Index k = at.value.rows();
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(3 * k, 2 * m);
  curvature.block(0, 0, k, m) = at.by_x;
  curvature.block(k, m, k, m) = at.by_y;
  curvature.block(2 * k, 0, k, m) = at.by_y;
  curvature.block(2 * k, m, k, m) = at.by_x;
  return curvature.transpose() * moments(curvature, bending);
}

void add(RitzMatrices& sum, const RitzBody& body, const Carried& all) {
  const auto at = products(body, all.places);
  const Index m = at.value.cols();
  auto& k = sum.stiffness;
  k.bottomRightCorner(2 * m, 2 * m) += bending_stiffness(at, all.bending);
  if (!all.shear.isZero(0.0)) {
    Eigen::MatrixXd strain(2 * all.places.rows(), 3 * m);
    strain << at.by_x, at.value, Eigen::MatrixXd::Zero(all.places.rows(), m), at.by_y,
        Eigen::MatrixXd::Zero(all.places.rows(), m), at.value;
    k += strain.transpose() * all.shear.replicate(2, 1).asDiagonal() * strain;
  }
  sum.mass.topLeftCorner(m, m) += at.value.transpose() * all.mass.asDiagonal() * at.value;
  const Eigen::MatrixXd rotary = at.value.transpose() * all.rotary.asDiagonal() * at.value;
  sum.mass.block(m, m, m, m) += rotary;
  sum.mass.block(2 * m, 2 * m, m, m) += rotary;
}

int points_for(const RitzBody& body) {
  const auto waves = [](const Eigen::MatrixXd& field) {
    return static_cast<int>(std::max<Index>(1, std::max(field.rows(), field.cols()))) - 1;
  };
  return std::max(body.degree, body.degree_along_y()) + 1 +
         (3 * waves(body.thickness) + waves(body.modulus) + 1) / 2;
}

void add_disc(RitzMatrices& sum, const RitzBody& body, const RitzDisc& disc) {
  const Eigen::Vector2d half(0.5 * body.length, 0.5 * body.width);
  require((disc.centre.cwiseAbs().array() <= half.array()).all(), "a disc off the plate");
  require(disc.radius > 0.0 && disc.stiffness >= 0.0 && disc.mass >= 0.0, "a disc of less than 0");
  const double size = disc.radius / std::min(body.length, body.width);
  const int points = std::min(body.degree + 4, 6 + static_cast<int>(std::ceil(30.0 * size)));
  auto all = carried(body, disc_rule(disc.centre, disc.radius, half, points), StiffnessPart::all);
  scale(all, disc.stiffness - 1.0, disc.mass - 1.0);
  add(sum, body, all);
}

// Adds a crack: D′ = D − loss (D n)(D n)ᵀ / (nᵀ D n). The fraction `loss` of the moment about the
// crack's line is released.
void add_crack(RitzMatrices& sum, const RitzBody& body, const RitzCrack& crack) {
  require(crack.loss >= 0.0 && crack.loss <= 1.0 && crack.width > 0.0,
          "a crack needs a loss from 0 to 1 and a width");
  const Eigen::Vector2d along = crack.to - crack.from;
  const double size = along.norm() / std::min(body.length, body.width);
  auto all = carried(
      body,
      band_rule(crack.from, crack.to, crack.width, 6 + static_cast<int>(std::ceil(30.0 * size)), 4),
      StiffnessPart::all);
  const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const Eigen::Vector3d n(normal.x() * normal.x(), normal.y() * normal.y(),
                          2.0 * normal.x() * normal.y());
  for (auto& bending : all.bending) {
    const Eigen::Vector3d moment = bending * n;
    bending = -crack.loss * moment * moment.transpose() / n.dot(moment);
  }
  all.shear.setZero();
  all.mass.setZero();
  all.rotary.setZero();
  add(sum, body, all);
}

// Adds the symmetric outer product of a row that concerns w alone, of (w, ψx, ψy).
void add_outer(Eigen::MatrixXd& matrix, const Eigen::RowVectorXd& row, double factor) {
  if (factor == 0.0) return;
  matrix.topLeftCorner(row.size(), row.size()) += factor * row.transpose() * row;
}

void add_fixture(RitzMatrices& sum, const RitzBody& body, const RitzFixture& one) {
  const Eigen::Vector2d half(0.5 * body.length, 0.5 * body.width);
  require((one.place.cwiseAbs().array() <= half.array()).all(), "a fixture off the plate");
  require(one.footprint >= 0.0 && one.mass >= 0.0 && one.inertia_x >= 0.0 && one.inertia_y >= 0.0 &&
              one.stiffness >= 0.0 && one.turning_x >= 0.0 && one.turning_y >= 0.0,
          "a fixture of less than 0");
  constexpr int kPoints = 6;
  AreaRule rule{one.place.transpose(), Eigen::VectorXd::Ones(1)};
  if (one.footprint > 0.0) rule = disc_rule(one.place, 0.5 * one.footprint, half, kPoints);
  const auto at = products(body, rule.places);
  const Eigen::RowVectorXd share = rule.area.transpose() / rule.area.sum();
  const Eigen::RowVectorXd moves = share * at.value;
  const Eigen::RowVectorXd slope_x = share * at.by_x;
  const Eigen::RowVectorXd slope_y = share * at.by_y;
  add_outer(sum.mass, moves, one.mass);
  add_outer(sum.mass, slope_x, one.inertia_x);
  add_outer(sum.mass, slope_y, one.inertia_y);
  add_outer(sum.stiffness, moves, one.stiffness);
  add_outer(sum.stiffness, slope_x, one.turning_x);
  add_outer(sum.stiffness, slope_y, one.turning_y);
}

void check(const RitzBody& body) {
  require(body.length > 0.0 && body.width > 0.0 && body.density > 0.0 && body.degree >= 2,
          "a plate needs a length, a width, a density and a degree of 2 or more");
  require(body.thickness.size() > 0, "a plate needs a thickness");
}

void check_on_plate(const RitzBody& body, const Eigen::MatrixX2d& places) {
  const double beyond = 0.5 * (1.0 + 1e-12);
  for (const auto& place : places.rowwise()) {
    require(std::abs(place(0)) <= beyond * body.length && std::abs(place(1)) <= beyond * body.width,
            fmt::format("({}, {}) m is not on the plate", place(0), place(1)));
  }
}

}  // namespace

PlaneStiffness isotropic_plane(double youngs_modulus, double poisson) {
  const double q = youngs_modulus / (1.0 - poisson * poisson);
  const double g = youngs_modulus / (2.0 + 2.0 * poisson);
  return {q, poisson * q, q, g, g};
}

Index RitzBody::rigid_count() const {
  Eigen::Vector3d held = Eigen::Vector3d::Zero();  // lift, slope along x, slope along y
  for (const auto& one : fixtures) {
    const auto springs = [](double constant) { return constant > 0.0 ? 1.0 : 0.0; };
    held += Eigen::Vector3d(springs(one.stiffness), springs(one.turning_x), springs(one.turning_y));
  }
  if (held.isZero(0.0)) return 3;
  require((held.array() > 0.0).all(),
          "a plate that is held in part only: expected springs "
          "against lifting and against turning about both axes");
  return 0;
}

RitzBody aluminium_table(int degree) {
  RitzBody body;
  body.length = body.width = 0.6;
  body.stiffness = isotropic_plane(70e9, 0.33);
  body.density = 2700.0;
  body.thickness = Eigen::MatrixXd::Constant(1, 1, 0.02);
  body.degree = degree;
  return body;
}

RitzMatrices ritz_matrices(const RitzBody& body) {
  check(body);
  const Index n = 3 * (body.degree + 1) * (body.degree_along_y() + 1);
  const Eigen::Vector2d half(0.5 * body.length, 0.5 * body.width);
  RitzMatrices sum{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  add(sum, body, carried(body, rectangle_rule(-half, half, points_for(body)), StiffnessPart::all));
  for (const auto& disc : body.discs) add_disc(sum, body, disc);
  for (const auto& crack : body.cracks) add_crack(sum, body, crack);
  for (const auto& fixture : body.fixtures) add_fixture(sum, body, fixture);
  return sum;
}

RitzMatrices modal_cell(const RitzModes& modes, Index count, const Eigen::Vector2d& low,
                        const Eigen::Vector2d& high, StiffnessPart part) {
  const auto& body = modes.body;
  const double share =
      std::max((high.x() - low.x()) / body.length, (high.y() - low.y()) / body.width);
  // Small cells see a part of each polynomial: 9 points for a tenth of a side.
  const int points = std::min(points_for(body), 7 + static_cast<int>(std::ceil(20.0 * share)));
  const auto all = carried(body, rectangle_rule(low, high, points), part);
  const auto at = products(body, all.places);
  const Index m = at.value.cols();
  const Eigen::MatrixXd w = modes.coefficients.topLeftCorner(m, count);
  const Eigen::MatrixXd x = modes.coefficients.block(m, 0, m, count);
  const Eigen::MatrixXd y = modes.coefficients.block(2 * m, 0, m, count);
  const Index k = all.places.rows();
  Eigen::MatrixXd curvature(3 * k, count);
  curvature << at.by_x * x, at.by_y * y, at.by_y * x + at.by_x * y;
  Eigen::MatrixXd strain(2 * k, count);
  strain << at.by_x * w + at.value * x, at.by_y * w + at.value * y;
  const Eigen::MatrixXd moves = at.value * w;
  const Eigen::MatrixXd turns_x = at.value * x;
  const Eigen::MatrixXd turns_y = at.value * y;
  return {curvature.transpose() * moments(curvature, all.bending) +
              strain.transpose() * all.shear.replicate(2, 1).asDiagonal() * strain,
          moves.transpose() * all.mass.asDiagonal() * moves +
              turns_x.transpose() * all.rotary.asDiagonal() * turns_x +
              turns_y.transpose() * all.rotary.asDiagonal() * turns_y};
}

bool same_shape(const RitzBody& a, const RitzBody& b) {
  return std::abs(a.length / b.length - a.width / b.width) < 1e-12;
}

RitzModes ritz_modes(const RitzBody& body) {
  const auto matrices = ritz_matrices(body);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrices.stiffness,
                                                                         matrices.mass);
  const Eigen::VectorXd lambda = solver.eigenvalues();
  const Index rigid = body.rigid_count();
  require(solver.info() == Eigen::Success && lambda(0) > -1e-9 * lambda(lambda.size() - 1) &&
              lambda(rigid) > 0.0,
          "the plate's stiffness is not definite");
  RitzModes modes{body, (lambda.cwiseMax(0.0).cwiseSqrt() / (2.0 * pi)).eval(),
                  solver.eigenvectors()};
  modes.frequency_hz.head(rigid).setZero();
  return modes;
}

RitzRows ritz_rows(const RitzBody& body, const Eigen::MatrixX2d& places) {
  check_on_plate(body, places);
  const auto at = products(body, places);
  const Index m = at.value.cols();
  const auto of_field = [m](const Eigen::MatrixXd& values, Index field) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(values.rows(), 3 * m);
    rows.middleCols(field * m, m) = values;
    return rows;
  };
  return {of_field(at.value, 0), of_field(at.by_x, 0), of_field(at.by_y, 0), of_field(at.value, 1),
          of_field(at.value, 2)};
}

RitzRows modal_rows(const RitzModes& modes, const Eigen::MatrixX2d& places) {
  check_on_plate(modes.body, places);
  const auto at = products(modes.body, places);
  const Index m = at.value.cols();
  const Index k = places.rows();
  const auto field = [&](Index n) { return modes.coefficients.middleRows(n * m, m); };
  Eigen::MatrixXd of_deflection(3 * k, m);
  of_deflection << at.value, at.by_x, at.by_y;
  const Eigen::MatrixXd w = of_deflection * field(0);
  return {w.topRows(k), w.middleRows(k, k), w.bottomRows(k), at.value * field(1),
          at.value * field(2)};
}

Eigen::MatrixX3d deflection_at(const RitzModes& modes, const Eigen::Vector2d& place) {
  const auto at = products(modes.body, place.transpose());
  const auto field = modes.coefficients.topRows(at.value.cols());
  Eigen::MatrixX3d columns(modes.mode_count(), 3);
  columns.col(0).noalias() = field.transpose() * at.value.row(0).transpose();
  columns.col(1).noalias() = field.transpose() * at.by_x.row(0).transpose();
  columns.col(2).noalias() = field.transpose() * at.by_y.row(0).transpose();
  return columns;
}

}  // namespace chladni::simulators
