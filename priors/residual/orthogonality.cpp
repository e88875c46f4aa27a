#include "priors/residual/orthogonality.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "base/error.h"
#include "base/search.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

// Shape i, conditioned on products near zero with the other shapes of `known`. `alone` is its
// posterior from its own values.
ShapeCoefficients given_others(const ShapeCoefficients& alone,
                               const std::vector<ShapeCoefficients>& known, std::size_t i,
                               double tolerance) {
  const auto m = static_cast<Eigen::Index>(known.size());
  const Eigen::Index k = alone.root.cols();
  const Eigen::VectorXd& mean = known[i].mean;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(m, alone.mean.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    const auto& other = known[static_cast<std::size_t>(j)];
    const double length = other.mean.norm();
    if (static_cast<std::size_t>(j) == i || length == 0.0) continue;
    const double variance = tolerance * tolerance * mean.squaredNorm() +
                            (other.root.transpose() * mean).squaredNorm() / (length * length);
    if (variance > 0.0) rows.row(j) = other.mean.transpose() / (length * std::sqrt(variance));
  }
  const Eigen::MatrixXd seen = rows * alone.root;
  const Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(k, k) + seen.transpose() * seen;
  const Eigen::LLT<Eigen::MatrixXd> factor(precision);
  if (factor.info() != Eigen::Success) {
    throw NumericalFailure("orthogonality: the shapes leave no positive covariance");
  }
  ShapeCoefficients better = alone;
  better.mean -= alone.root * factor.solve(Eigen::VectorXd(seen.transpose() * (rows * alone.mean)));
  better.root = factor.matrixU().solve<Eigen::OnTheRight>(alone.root);
  return better;
}

// Squares of the products of unit shapes, with the variance of each product.
struct Products {
  std::vector<double> square, variance;
};

Products products_of(const std::vector<ShapeCoefficients>& shapes) {
  Products products;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double lengths = shapes[i].mean.squaredNorm() * shapes[j].mean.squaredNorm();
      if (lengths == 0.0) continue;
      const double product = shapes[i].mean.dot(shapes[j].mean);
      const double variance = (shapes[i].root.transpose() * shapes[j].mean).squaredNorm() +
                              (shapes[j].root.transpose() * shapes[i].mean).squaredNorm() +
                              (shapes[i].root.transpose() * shapes[j].root).squaredNorm();
      products.square.push_back(product * product / lengths);
      products.variance.push_back(variance / lengths);
    }
  }
  return products;
}

}  // namespace

double learned_tolerance(const std::vector<ShapeCoefficients>& shapes) {
  const auto products = products_of(shapes);
  const auto misfit = [&](double log_spread) {
    const double away = log_spread - std::log(Constants::middle_product);
    double sum = away * away;
    for (std::size_t k = 0; k < products.square.size(); ++k) {
      const double variance = std::exp(2.0 * log_spread) + products.variance[k];
      sum += std::log(variance) + products.square[k] / variance;
    }
    return sum;
  };
  // A grid is enough for a spread: its steps of 8 % are finer than what a few products tell.
  return 2.0 *
         std::exp(lowest_of_scan(misfit, std::log(Constants::least_product),
                                 std::log(Constants::most_product), Constants::product_intervals)
                      .at);
}

std::vector<ShapeCoefficients> orthogonal_shapes(const std::vector<ShapeCoefficients>& shapes,
                                                 const OrthogonalityOptions& options) {
  require(options.tolerance > 0.0 && options.sweeps >= 0,
          "orthogonality: the tolerance must be more than 0 and the sweeps 0 or more");
  auto known = shapes;
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    auto next = known;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      next[i] = given_others(shapes[i], known, i, options.tolerance);
    }
    known = std::move(next);
  }
  return known;
}

}  // namespace chladni::priors
