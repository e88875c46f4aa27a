#include "stage/ensemble.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "fem/field_matrices.h"
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

// φφᵀ of a mass at a random place of the surface, in all three directions.
Eigen::MatrixXd mass_somewhere(const Solution& solution, Draw& draw) {
  const auto& body = solution.model.body;
  const auto face =
      static_cast<Eigen::Index>(draw.uniform() * static_cast<double>(body.faces.rows()));
  const Eigen::Index node = body.faces(std::min(face, body.faces.rows() - 1), 0);
  const auto rows = solution.modes.shapes.middleRows<3>(3 * node);
  return rows.transpose() * rows;
}

Member member(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  if (solver.info() != Eigen::Success || !solver.eigenvalues().allFinite()) {
    throw NumericalFailure(
        "ensemble: a draw of the uncertain body has no positive mass; "
        "choose smaller deviations");
  }
  return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt() / (2.0 * std::numbers::pi),
          solver.eigenvectors()};
}

}  // namespace

std::vector<Member> ensemble(const Solution& solution, const study::UncertaintyPlan& plan,
                             unsigned seed) {
  Draw draw(seed);
  const Eigen::MatrixXd basis = waves(solution.model.body, kWaves);
  Eigen::MatrixXd stiffness(basis.cols(), plan.members);
  Eigen::MatrixXd mass(basis.cols(), plan.members);
  for (Eigen::Index k = 0; k < plan.members; ++k) {
    const Eigen::VectorXd thickness = plan.thickness * amplitudes(draw);
    stiffness.col(k) = plan.modulus * amplitudes(draw) + 3.0 * thickness;  // bending goes as t³
    mass.col(k) = plan.density * amplitudes(draw) + thickness;
  }
  const auto& modes = solution.modes;
  const auto fields = fem::field_matrices(solution.model.body, solution.model.materials,
                                          modes.shapes, basis, basis);
  const Eigen::VectorXd lambda = (2.0 * std::numbers::pi * modes.frequency_hz).cwiseAbs2();
  std::vector<Member> members;
  for (Eigen::Index k = 0; k < plan.members; ++k) {
    Eigen::MatrixXd k_sum = lambda.asDiagonal();
    Eigen::MatrixXd m_sum = Eigen::MatrixXd::Identity(lambda.size(), lambda.size());
    for (Eigen::Index f = 0; f < basis.cols(); ++f) {
      k_sum += stiffness(f, k) * fields.stiffness[static_cast<std::size_t>(f)];
      m_sum += mass(f, k) * fields.mass[static_cast<std::size_t>(f)];
    }
    for (int i = 0; i < kMasses; ++i) {
      const double heavy = plan.attached_mass * std::abs(draw.normal());
      m_sum += heavy * mass_somewhere(solution, draw);
    }
    members.push_back(member(k_sum, m_sum));
  }
  return members;
}

}  // namespace chladni::stage
