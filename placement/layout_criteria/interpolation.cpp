#include "placement/interpolation.h"

#include <cmath>

#include "base/error.h"
#include "placement/layout_criteria/posterior.h"

namespace chladni::placement {
namespace {

void check(const ShapePrior& prior, const Eigen::MatrixXd& rows, const Eigen::MatrixXd& noise) {
  require(rows.cols() == prior.variance.rows() && noise.rows() == rows.rows() &&
              noise.cols() == prior.variance.cols(),
          "interpolation: the layout does not fit the prior");
  require(noise.size() == 0 || noise.minCoeff() > 0.0,
          "interpolation: the noise must be more than 0");
}

}  // namespace

void learn(const Eigen::RowVectorXd& row, double noise, Eigen::MatrixXd& root) {
  const Eigen::VectorXd seen = root.transpose() * row.transpose();
  const double spread = std::hypot(seen.norm(), noise);
  const Eigen::VectorXd ahead = root * seen;
  // W (I − γ v vᵀ): along v it shrinks by noise/spread.
  root.noalias() -= (1.0 / (spread * (spread + noise))) * ahead * seen.transpose();
}

Eigen::MatrixXd root_of_posterior(const Eigen::VectorXd& variance, const Eigen::MatrixXd& rows,
                                  const Eigen::VectorXd& noise) {
  Eigen::MatrixXd root = variance.cwiseSqrt().asDiagonal();
  for (Eigen::Index s = 0; s < rows.rows(); ++s) learn(rows.row(s), noise(s), root);
  return root;
}

ShapePrior shape_prior(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                       const Eigen::VectorXd& frequency_hz, const std::vector<Eigen::Index>& wanted,
                       const priors::DynamicResidual& prior) {
  require(shapes.rows() == area.size() && shapes.cols() == frequency_hz.size(),
          "interpolation: shapes, areas and frequencies do not fit together");
  ShapePrior known;
  const Eigen::MatrixXd weighted = (area / area.sum()).asDiagonal() * shapes;
  known.gram = shapes.transpose() * weighted;
  known.variance.resize(frequency_hz.size(), static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Eigen::VectorXd variance =
        priors::coefficient_variances(frequency_hz, frequency_hz(wanted[i]), prior);
    const double square = variance.dot(known.gram.diagonal());
    known.variance.col(static_cast<Eigen::Index>(i)) = variance / square;
  }
  return known;
}

ExpectedError expected_error(const ShapePrior& prior, const Eigen::MatrixXd& rows,
                             const Eigen::MatrixXd& noise) {
  check(prior, rows, noise);
  ExpectedError error{Eigen::VectorXd(prior.variance.cols())};
  for (Eigen::Index i = 0; i < error.per_mode.size(); ++i) {
    const Eigen::MatrixXd root = root_of_posterior(prior.variance.col(i), rows, noise.col(i));
    error.per_mode(i) = (prior.gram * root).cwiseProduct(root).sum();
  }
  return error;
}

Eigen::MatrixXd expected_deviation(const ShapePrior& prior, const Eigen::MatrixXd& rows,
                                   const Eigen::MatrixXd& noise, const Eigen::MatrixXd& places) {
  check(prior, rows, noise);
  Eigen::MatrixXd deviation(places.rows(), prior.variance.cols());
  for (Eigen::Index i = 0; i < deviation.cols(); ++i) {
    const Eigen::MatrixXd root = root_of_posterior(prior.variance.col(i), rows, noise.col(i));
    deviation.col(i) = (places * root).rowwise().norm();
  }
  return deviation;
}

}  // namespace chladni::placement
