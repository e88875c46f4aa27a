#include "identification/field/rigid_band.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "base/error.h"
#include "identification/gains/matched_sides.h"

namespace chladni::identification {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

void require_covariance(const RigidBody& body) {
  const auto r = body.modes.rows();
  const auto count = r * (r + 1) / 2;
  require(body.inverse_covariance.rows() == count && body.inverse_covariance.cols() == count,
          fmt::format("rigid body: a covariance of {} entries of the inverse mass; expected {}",
                      body.inverse_covariance.rows(), count));
}

// The symmetric matrix of its lower entries.
Eigen::MatrixXd symmetric_of(const Eigen::VectorXd& entries, Eigen::Index r) {
  Eigen::MatrixXd matrix(r, r);
  Eigen::Index at = 0;
  for (Eigen::Index b = 0; b < r; ++b) {
    for (Eigen::Index a = b; a < r; ++a) matrix(a, b) = matrix(b, a) = entries(at++);
  }
  return matrix;
}

// Change of T, T Tᵀ = M⁻¹ upper triangular, with a small change dS of M⁻¹: T⁻¹ dT is the upper
// triangle, with half of the diagonal, of T⁻¹ dS T⁻ᵀ.
Eigen::MatrixXd change_of_modes(const Eigen::MatrixXd& modes, const Eigen::MatrixXd& change) {
  const auto upper = modes.triangularView<Eigen::Upper>();
  const Eigen::MatrixXd left = upper.solve(change);
  const Eigen::MatrixXd turned = left.transpose();
  Eigen::MatrixXd inner = upper.solve(turned);
  inner.diagonal() *= 0.5;
  for (Eigen::Index a = 1; a < inner.rows(); ++a) inner.row(a).head(a).setZero();
  return modes * inner;
}

// The directions D of rows D T.
Eigen::MatrixXd directions_of(const Eigen::MatrixXd& rows, const RigidBody& body) {
  const Eigen::MatrixXd columns = rows.transpose();
  const Eigen::MatrixXd directions =
      body.modes.transpose().triangularView<Eigen::Lower>().solve(columns);
  return directions.transpose();
}

// Factors of the lower entries of a symmetric S in dᵀ S e.
Eigen::VectorXd entry_factors(const Eigen::VectorXd& d, const Eigen::VectorXd& e) {
  const Eigen::MatrixXd both = d * e.transpose();
  Eigen::MatrixXd factors = both + both.transpose();
  factors.diagonal() *= 0.5;
  return lower_entries(factors);
}

Eigen::MatrixXd variance_of_body(const RigidBody& body, const Eigen::MatrixXd& shapes,
                                 const Eigen::MatrixXd& inputs) {
  require_covariance(body);
  if (!body.inverse_covariance.allFinite()) {
    return Eigen::MatrixXd::Constant(shapes.rows(), inputs.cols(), kUnknown);
  }
  const auto there = directions_of(shapes, body);
  const auto driven = directions_of(inputs.transpose(), body);
  Eigen::MatrixXd variance(shapes.rows(), inputs.cols());
  for (Eigen::Index i = 0; i < variance.rows(); ++i) {
    for (Eigen::Index j = 0; j < variance.cols(); ++j) {
      const auto factors = entry_factors(there.row(i), driven.row(j));
      variance(i, j) = factors.dot(body.inverse_covariance * factors);
    }
  }
  return variance;
}

// Covariances of the rigid-body entries of each actuator's column, r×r, in the basis of the match;
// empty where the fit states none. The fit's basis of these modes is any: `turn` leads to that of
// the match.
std::vector<Eigen::MatrixXd> input_covariances(const ModalFit& fit, const GainMatch& match) {
  const auto r = fit.model.rigid_count;
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  if (r == 0 || fit.rigid_covariance.rows() != r * (p + q)) return {};
  const Eigen::MatrixXd from = fit.model.input_shapes.topRows(r).transpose();  // q×r
  const Eigen::MatrixXd to = match.input_shapes.topRows(r).transpose();
  const Eigen::MatrixXd turn = from.completeOrthogonalDecomposition().solve(to).transpose();
  std::vector<Eigen::MatrixXd> all;
  for (Eigen::Index j = 0; j < q; ++j) {
    const auto at = r * p + r * j;
    all.emplace_back(turn * fit.rigid_covariance.block(at, at, r, r) * turn.transpose());
  }
  return all;
}

}  // namespace

Eigen::MatrixXd rigid_deviation(const RigidBody& body, const Eigen::MatrixXd& directions) {
  require_covariance(body);
  const auto r = body.modes.rows();
  Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(directions.rows(), r);
  if (!body.inverse_covariance.allFinite()) return variance.array() + kUnknown;
  const Eigen::MatrixXd factor = covariance_factor(body.inverse_covariance);
  for (const auto& entries : factor.colwise()) {
    variance += (directions * change_of_modes(body.modes, symmetric_of(entries, r))).cwiseAbs2();
  }
  return variance.cwiseSqrt();
}

Eigen::MatrixXd rigid_variance(const ModalFit& fit, const GainMatch& match,
                               const PlacesOfInterest& places) {
  const auto r = fit.model.rigid_count;
  const Eigen::MatrixXd shapes = places.shapes.leftCols(r);
  const Eigen::MatrixXd deviation = places.deviation.leftCols(r);
  const Eigen::MatrixXd inputs = match.input_shapes.topRows(r);
  if (r > 0 && match.rigid) {
    Eigen::MatrixXd variance = variance_of_body(*match.rigid, shapes, inputs);
    for (Eigen::Index i = 0; i < variance.rows(); ++i) {
      if (shapes.row(i).isZero(0.0)) {
        variance.row(i) = deviation.row(i).cwiseAbs2() * inputs.cwiseAbs2();
      }
      if (!deviation.row(i).allFinite()) variance.row(i).setConstant(kUnknown);
    }
    return variance;
  }
  Eigen::MatrixXd variance = deviation.cwiseAbs2() * inputs.cwiseAbs2();
  const auto covariances = input_covariances(fit, match);
  for (std::size_t j = 0; j < covariances.size(); ++j) {
    const Eigen::MatrixXd driven = shapes * covariances[j];
    variance.col(static_cast<Eigen::Index>(j)) += driven.cwiseProduct(shapes).rowwise().sum();
  }
  return variance;
}

}  // namespace chladni::identification
