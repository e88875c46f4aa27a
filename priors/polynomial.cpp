#include "priors/polynomial.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "base/error.h"

namespace chladni::priors {
namespace {

// T_0 .. T_degree at each x, by their recurrence; n×(degree+1).
Eigen::MatrixXd chebyshev(const Eigen::VectorXd& x, int degree) {
  Eigen::MatrixXd t(x.size(), degree + 1);
  t.col(0).setOnes();
  if (degree > 0) t.col(1) = x;
  for (int k = 2; k <= degree; ++k) {
    t.col(k) = 2.0 * x.cwiseProduct(t.col(k - 1)) - t.col(k - 2);
  }
  return t;
}

Eigen::MatrixXd functions_at(const ShapePolynomials& polynomials, const Eigen::MatrixX2d& at) {
  const auto along = [&](Eigen::Index axis) {
    return chebyshev(
        (at.col(axis).array() - polynomials.centre(axis)) / polynomials.half_width(axis),
        polynomials.degree);
  };
  const Eigen::MatrixXd u = along(0);
  const Eigen::MatrixXd v = along(1);
  Eigen::MatrixXd functions(at.rows(), polynomials.powers.rows());
  for (Eigen::Index c = 0; c < functions.cols(); ++c) {
    functions.col(c) =
        u.col(polynomials.powers(c, 0)).cwiseProduct(v.col(polynomials.powers(c, 1)));
  }
  return functions;
}

}  // namespace

ShapePolynomials polynomials(const Eigen::MatrixX2d& at, const Eigen::VectorXd& area,
                             const Eigen::MatrixXd& shapes, int degree) {
  const Eigen::Index count = (Eigen::Index{degree} + 1) * (degree + 2) / 2;
  require(
      degree >= 0 && at.rows() >= count && area.size() == at.rows() && shapes.rows() == at.rows(),
      "polynomials: degree " + fmt::to_string(degree) + " needs " + fmt::to_string(count) +
          " points with areas and shapes; found " + fmt::to_string(at.rows()));
  const Eigen::RowVector2d low = at.colwise().minCoeff();
  const Eigen::RowVector2d high = at.colwise().maxCoeff();
  ShapePolynomials fitted{degree, 0.5 * (low + high), 0.5 * (high - low), {}, {}, {}, {}};
  require(fitted.half_width.minCoeff() > 0.0, "polynomials: the points lie on one line");
  fitted.powers.resize(count, 2);
  Eigen::Index c = 0;
  for (int p = 0; p <= degree; ++p) {
    for (int q = 0; p + q <= degree; ++q) fitted.powers.row(c++) << p, q;
  }
  const Eigen::MatrixXd functions = functions_at(fitted, at);
  const Eigen::VectorXd weight = (area / area.sum()).cwiseSqrt();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(weight.asDiagonal() * functions));
  fitted.coefficients = factor.solve(Eigen::MatrixXd(weight.asDiagonal() * shapes));
  const Eigen::MatrixXd wrong = functions * fitted.coefficients - shapes;
  const auto rms = [&](const Eigen::MatrixXd& field) -> Eigen::VectorXd {
    return (weight.asDiagonal() * field).colwise().norm();
  };
  const Eigen::VectorXd scale = rms(shapes);
  fitted.rms_error = rms(wrong).cwiseQuotient(scale);
  fitted.largest_error = wrong.cwiseAbs().colwise().maxCoeff().transpose().cwiseQuotient(scale);
  return fitted;
}

Eigen::MatrixXd values(const ShapePolynomials& polynomials, const Eigen::MatrixX2d& at) {
  return functions_at(polynomials, at) * polynomials.coefficients;
}

}  // namespace chladni::priors
