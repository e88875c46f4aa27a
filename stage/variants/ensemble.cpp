#include "stage/ensemble.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/draw.h"
#include "base/error.h"
#include "fem/field_matrices.h"
#include "mesh/surface.h"
#include "stage/estimates/waves.h"

namespace chladni::stage {
namespace {

constexpr int kWaves = 4;  // half waves of a field along each of the two longest sides, plus one
constexpr int kMasses = 4;

// Amplitudes of a smooth field with variance about 1: long waves are stronger.
Eigen::VectorXd amplitudes(Draw& draw) {
  Eigen::VectorXd share(kWaves * kWaves);
  double variance = 0.0;
  for (int a = 0; a < kWaves; ++a) {
    for (int b = 0; b < kWaves; ++b) {
      const double strength = 1.0 / (1.0 + a * a + b * b);
      variance += strength * strength * (a > 0 ? 0.5 : 1.0) * (b > 0 ? 0.5 : 1.0);
      share(kWaves * a + b) = strength * draw.normal();
    }
  }
  return share / std::sqrt(variance);
}

// Sums of the areas of the boundary's faces up to each of them [m²].
std::vector<double> areas_up_to(const mesh::TetMesh& body) {
  std::vector<double> sums;
  double sum = 0.0;
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    sum += mesh::area(body.points, body.faces.row(f).leftCols(3));
    sums.push_back(sum);
  }
  return sums;
}

// φφᵀ of a mass at a random place of the surface, in all three directions. A face is as likely as
// it is large, so that the places do not depend on where the mesh is fine.
Eigen::MatrixXd mass_somewhere(const Solution& solution, const std::vector<double>& areas,
                               Draw& draw) {
  const auto& body = solution.model.body;
  const auto found = std::ranges::upper_bound(areas, draw.uniform() * areas.back());
  const auto face = std::min<Eigen::Index>(found - areas.begin(), std::ssize(areas) - 1);
  const auto rows = solution.modes.shapes.middleRows<3>(3 * Eigen::Index{body.faces(face, 0)});
  return rows.transpose() * rows;
}

constexpr double kRounding = 1e-6;  // of the largest eigenvalue; rigid-body modes have none
constexpr int kDraws = 100;

// None where the stiffness or the mass is not positive: no body has such.
std::optional<Member> member(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  if (mass.llt().info() != Eigen::Success) return std::nullopt;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  const auto& values = solver.eigenvalues();
  if (solver.info() != Eigen::Success || !values.allFinite() ||
      values.minCoeff() < -kRounding * values.maxCoeff()) {
    return std::nullopt;
  }
  return Member{values.cwiseMax(0.0).cwiseSqrt() / (2.0 * std::numbers::pi), solver.eigenvectors()};
}

// Relative changes of stiffness and mass, as amplitudes of the waves.
struct Change {
  Eigen::VectorXd stiffness, mass;
};

Change drawn_change(const study::UncertaintyPlan& plan, Draw& draw) {
  const Eigen::VectorXd thickness = plan.thickness * amplitudes(draw);
  Change change;
  change.stiffness = plan.modulus * amplitudes(draw) + 3.0 * thickness;  // bending goes as t³
  change.mass = plan.density * amplitudes(draw) + thickness;
  return change;
}

// The study's body in the basis of its modes, and its waves.
struct Basis {
  const Solution& solution;
  std::vector<double> areas;  // areas_up_to
  Eigen::VectorXd lambda;
  fem::FieldMatrices fields;
};

std::optional<Member> changed(const Basis& of, const Change& change,
                              const study::UncertaintyPlan& plan, Draw& draw) {
  Eigen::MatrixXd stiffness = of.lambda.asDiagonal();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(of.lambda.size(), of.lambda.size());
  for (Eigen::Index f = 0; f < change.mass.size(); ++f) {
    stiffness += change.stiffness(f) * of.fields.stiffness[static_cast<std::size_t>(f)];
    mass += change.mass(f) * of.fields.mass[static_cast<std::size_t>(f)];
  }
  for (int i = 0; i < kMasses; ++i) {
    const double heavy = plan.attached_mass * std::abs(draw.normal());
    mass += heavy * mass_somewhere(of.solution, of.areas, draw);
  }
  return member(stiffness, mass);
}

}  // namespace

std::vector<Member> ensemble(const Solution& solution, const study::UncertaintyPlan& plan,
                             unsigned seed) {
  Draw draw(seed);
  std::vector<Change> changes;
  for (Eigen::Index k = 0; k < plan.members; ++k) changes.push_back(drawn_change(plan, draw));
  const auto& modes = solution.modes;
  const Eigen::MatrixXd basis = waves(solution.model.body, kWaves);
  const Basis of{solution, areas_up_to(solution.model.body),
                 (2.0 * std::numbers::pi * modes.frequency_hz).cwiseAbs2(),
                 fem::field_matrices(solution.model.body, solution.model.materials, modes.shapes,
                                     basis, basis)};
  std::vector<Member> members;
  for (auto& change : changes) {
    auto drawn = changed(of, change, plan, draw);
    for (int again = 1; !drawn && again < kDraws; ++again) {
      drawn = changed(of, drawn_change(plan, draw), plan, draw);
    }
    if (!drawn) {
      throw NumericalFailure(
          "ensemble: none of 100 draws of the uncertain body has a positive stiffness and mass; "
          "choose smaller deviations");
    }
    members.push_back(*std::move(drawn));
  }
  return members;
}

}  // namespace chladni::stage
