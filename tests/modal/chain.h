// Masses in a row joined by springs: a structure whose every answer is known.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "modal/reduced_model.h"

namespace chladni::modal {

/// n masses of 0.1 kg, springs of 1e7 N/m between neighbours and, where `held`, from the first to
/// the ground; dashpots in the columns of `dashpots` (n×d, C = D Dᵀ).
struct Chain {
  Eigen::MatrixXd stiffness, mass, dashpots;
  bool held = false;
};

inline Chain chain(Eigen::Index n, bool held) {
  Chain result{.stiffness = Eigen::MatrixXd::Zero(n, n),
               .mass = 0.1 * Eigen::MatrixXd::Identity(n, n),
               .dashpots = Eigen::MatrixXd(n, 0),
               .held = held};
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    result.stiffness.block<2, 2>(i, i) += 1e7 * (Eigen::Matrix2d() << 1, -1, -1, 1).finished();
  }
  if (held) result.stiffness(0, 0) += 1e7;
  return result;
}

/// The `kept` lowest modes at the masses `outputs` and `inputs`, with the static flexibility of the
/// others from all of the modes.
inline ReducedModel reduced(const Chain& chain, Eigen::Index kept,
                            const std::vector<Eigen::Index>& outputs,
                            const std::vector<Eigen::Index>& inputs, double damping_ratio) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(chain.stiffness,
                                                                         chain.mass);
  const auto n = chain.stiffness.rows();
  const Eigen::MatrixXd phi = solver.eigenvectors().leftCols(kept);
  const Eigen::MatrixXd rest = solver.eigenvectors().rightCols(n - kept);
  const Eigen::MatrixXd flexibility =
      rest * solver.eigenvalues().tail(n - kept).cwiseInverse().asDiagonal() * rest.transpose();
  ReducedModel model;
  model.rigid_count = chain.held ? 0 : 1;
  model.frequency_hz =
      solver.eigenvalues().head(kept).cwiseMax(0.0).cwiseSqrt() / (2.0 * std::numbers::pi);
  model.frequency_hz.head(model.rigid_count).setZero();
  model.damping_ratio = Eigen::VectorXd::Constant(kept, damping_ratio);
  model.output_shapes = phi(outputs, Eigen::all);
  model.input_shapes = phi(inputs, Eigen::all).transpose();
  model.residual = flexibility(outputs, inputs);
  model.dampers.shapes = chain.dashpots.transpose() * phi;
  model.dampers.to_outputs = (flexibility * chain.dashpots)(outputs, Eigen::all);
  model.dampers.from_inputs = (chain.dashpots.transpose() * flexibility)(Eigen::all, inputs);
  model.dampers.among = chain.dashpots.transpose() * flexibility * chain.dashpots;
  return model;
}

/// (K + jω (D Dᵀ + C) − ω² M)⁻¹ at the masses asked for.
inline Eigen::MatrixXcd direct(const Chain& chain, const Eigen::MatrixXd& damping,
                               double frequency_hz, const std::vector<Eigen::Index>& outputs,
                               const std::vector<Eigen::Index>& inputs) {
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_hz);
  const Eigen::MatrixXcd dynamic = chain.stiffness.cast<std::complex<double>>() +
                                   s * (chain.dashpots * chain.dashpots.transpose() + damping) +
                                   s * s * chain.mass;
  return Eigen::MatrixXcd(dynamic.inverse())(outputs, inputs);
}

}  // namespace chladni::modal
