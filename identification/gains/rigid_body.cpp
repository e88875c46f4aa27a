#include "identification/gains/rigid_body.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/finite.h"
#include "dense/algebra.h"

namespace chladni::identification {

namespace {

// Design matrix. Column a + r b of the r² unknowns: entry (a, b) of the inverse mass.
Eigen::MatrixXd design(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs) {
  const auto r = outputs.cols();
  Eigen::MatrixXd rows(outputs.rows() * inputs.rows(), r * r);
  for (Eigen::Index b = 0; b < r; ++b) {
    for (Eigen::Index a = 0; a < r; ++a) {
      rows.col(a + r * b) = (outputs.col(a) * inputs.col(b).transpose()).reshaped();
    }
  }
  return rows;
}

// Maps the r (r + 1) / 2 entries of a symmetric matrix to all r² entries.
Eigen::MatrixXd symmetric_entries(Eigen::Index r) {
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(r * r, r * (r + 1) / 2);
  Eigen::Index column = 0;
  for (Eigen::Index b = 0; b < r; ++b) {
    for (Eigen::Index a = b; a < r; ++a) {
      spread(a + r * b, column) = spread(b + r * a, column) = 1.0;
      ++column;
    }
  }
  return spread;
}

struct Solution {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;  // for deviations of 1
  double square = 0.0;         // of the residual
  bool determined = false;
};

Solution least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values) {
  const Eigen::VectorXd scale = rows.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  qr.compute(rows * scale.asDiagonal());
  Solution solution;
  solution.determined = qr.rank() == rows.cols();
  if (!solution.determined) return solution;
  solution.value = scale.asDiagonal() * qr.solve(values);
  const auto n = rows.cols();
  const Eigen::MatrixXd root = qr.matrixR().topRows(n).template triangularView<Eigen::Upper>();
  const Eigen::MatrixXd inverse = qr.colsPermutation() * root.triangularView<Eigen::Upper>().solve(
                                                             Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd scaled = scale.asDiagonal() * inverse;
  solution.covariance = scaled * scaled.transpose();
  solution.square = (rows * solution.value - values).squaredNorm();
  return solution;
}

// Deviations of M, with d M = −M dS M for every entry of the symmetric S.
Eigen::MatrixXd mass_deviation(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& spread,
                               const Eigen::MatrixXd& covariance) {
  const auto r = mass.rows();
  Eigen::MatrixXd change(r * r, spread.cols());
  for (Eigen::Index c = 0; c < spread.cols(); ++c) {
    const Eigen::MatrixXd unit = spread.col(c).reshaped(r, r);
    change.col(c) = (mass * unit * mass).reshaped();
  }
  const Eigen::VectorXd variance = (change * covariance).cwiseProduct(change).rowwise().sum();
  return variance.cwiseMax(0.0).cwiseSqrt().reshaped(r, r);
}

bool positive_definite(const Eigen::MatrixXd& matrix) {
  if (!(matrix.diagonal().array() > 0.0).all()) return false;
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(finite(scaled, "mass of the rigid body"))
             .eigenvalues()(0) > 1e-12;
}

void check_sizes(const Eigen::MatrixXd& product, const Eigen::MatrixXd& deviation,
                 const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs) {
  const auto size = [](Eigen::Index rows, Eigen::Index cols) {
    return fmt::to_string(rows) + " by " + fmt::to_string(cols);
  };
  require(outputs.rows() == product.rows() && inputs.rows() == product.cols() &&
              outputs.cols() == inputs.cols() && outputs.cols() > 0,
          "rigid body: directions of " + size(outputs.rows(), outputs.cols()) + " and " +
              size(inputs.rows(), inputs.cols()) + " for a product of " +
              size(product.rows(), product.cols()));
  require(product.allFinite() && outputs.allFinite() && inputs.allFinite(),
          "rigid body: an entry is not finite");
  if (deviation.size() == 0) return;
  require(deviation.rows() == product.rows() && deviation.cols() == product.cols(),
          "rigid body: deviations of " + size(deviation.rows(), deviation.cols()) +
              " for a product of " + size(product.rows(), product.cols()));
  require((deviation.array() > 0.0).all(), "rigid body: a deviation is not positive");
}

}  // namespace

Eigen::MatrixXd rigid_directions(const Eigen::MatrixX3d& places, RigidMotion motion) {
  const Eigen::Index r = motion == RigidMotion::beam ? 2 : 3;
  Eigen::MatrixXd directions = Eigen::MatrixXd::Ones(places.rows(), r);
  directions.rightCols(r - 1) = places.leftCols(r - 1);
  return directions;
}

Eigen::VectorXd lower_entries(const Eigen::MatrixXd& symmetric) {
  const auto r = symmetric.rows();
  Eigen::VectorXd entries(r * (r + 1) / 2);
  Eigen::Index at = 0;
  for (Eigen::Index b = 0; b < r; ++b) {
    entries.segment(at, r - b) = symmetric.col(b).tail(r - b);
    at += r - b;
  }
  return entries;
}

RigidBody rigid_body(const Eigen::MatrixXd& product, const Eigen::MatrixXd& deviation,
                     const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs) {
  check_sizes(product, deviation, outputs, inputs);
  const auto r = outputs.cols();
  const bool known = deviation.size() > 0;
  const Eigen::VectorXd weight = known ? Eigen::VectorXd(deviation.reshaped().cwiseInverse())
                                       : Eigen::VectorXd::Ones(product.size());
  const Eigen::MatrixXd rows = weight.asDiagonal() * design(outputs, inputs);
  const Eigen::VectorXd values = weight.cwiseProduct(product.reshaped());
  const Eigen::MatrixXd spread = symmetric_entries(r);
  const auto symmetric = least_squares(rows * spread, values);
  if (!symmetric.determined) {
    throw NumericalFailure(
        "rigid body: the places of the sensors and actuators do not determine the " +
        fmt::to_string(r) + " by " + fmt::to_string(r) + " mass matrix");
  }
  const Eigen::MatrixXd inverse = (spread * symmetric.value).reshaped(r, r);
  if (!positive_definite(inverse)) {
    throw NumericalFailure(
        "rigid body: the mass matrix is not positive definite; a channel is turned around, at "
        "another place, or the modes at 0 Hz are not those of a rigid body");
  }
  RigidBody body;
  body.mass = dense::inverse_of(inverse.llt());
  body.mass = 0.5 * (body.mass + body.mass.transpose()).eval();
  body.modes = body.mass.llt().matrixU().solve(Eigen::MatrixXd::Identity(r, r));
  const auto left = product.size() - spread.cols();
  double unit = 1.0;
  if (left > 0) (known ? body.misfit : unit) = symmetric.square / static_cast<double>(left);
  body.mass_std = mass_deviation(body.mass, spread, unit * symmetric.covariance);
  const auto any = least_squares(rows, values);
  if (any.determined) {
    const Eigen::MatrixXd full = any.value.reshaped(r, r);
    const Eigen::VectorXd scale = inverse.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd even = scale.asDiagonal() * full * scale.asDiagonal();
    body.asymmetry = (even - even.transpose()).norm() / (even + even.transpose()).norm();
  }
  return body;
}

}  // namespace chladni::identification
