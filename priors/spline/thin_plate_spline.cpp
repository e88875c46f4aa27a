#include "priors/spline/thin_plate_spline.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "base/finite.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

std::string degrees(double cosine) {
  return fmt::format("{:.6g}",
                     std::acos(std::min(std::abs(cosine), 1.0)) * 180.0 / std::numbers::pi);
}

// Gives each axis a sign: its largest entry is positive.
Eigen::MatrixXd oriented(Eigen::MatrixXd axes) {
  for (auto axis : axes.colwise()) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis(largest) < 0.0) axis = -axis;
  }
  return axes;
}

}  // namespace

SplineDomain spline_domain(const Places& places) {
  require(places.count() > 0, "thin plate spline: no places");
  SplineDomain domain;
  domain.direction = places.direction.row(0).transpose().normalized();
  (void)senses(domain.direction, places.direction);
  domain.origin = places.position.colwise().mean().transpose();
  Eigen::MatrixXd off = places.position.rowwise() - domain.origin.transpose();
  off -= (off * domain.direction) * domain.direction.transpose();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(finite(off, "thin plate spline: places"),
                                              Eigen::ComputeThinV);
  const auto& extent = svd.singularValues();
  require(extent(0) > 0.0 && extent(0) > 1e-12 * places.position.norm(),
          "thin plate spline: all places are at one point of the plane that they measure across; "
          "expected places beside each other");
  const Eigen::Index dimensions =
      extent.size() < 2 || extent(1) <= Constants::on_a_line * extent(0) ? 1 : 2;
  domain.axes = oriented(svd.matrixV().leftCols(dimensions));
  domain.size = off.norm() / std::sqrt(static_cast<double>(off.rows()));
  return domain;
}

Eigen::MatrixXd coordinates(const SplineDomain& domain, const Points& positions) {
  const Eigen::MatrixXd off = positions.rowwise() - domain.origin.transpose();
  return off * domain.axes / domain.size;
}

Eigen::VectorXd senses(const Eigen::Vector3d& direction, const Points& directions) {
  Eigen::VectorXd sense(directions.rows());
  for (Eigen::Index k = 0; k < directions.rows(); ++k) {
    const double length = directions.row(k).norm();
    const double cosine = directions.row(k).dot(direction.transpose()) / length;
    require(length > 0.0 && std::abs(cosine) > 1.0 - Constants::parallel,
            "interpolation: place " + fmt::to_string(k + 1) + " is measured or asked for " +
                degrees(cosine) +
                " degrees away from the first one's direction; expected one "
                "direction for all, as across a plate");
    sense(k) = cosine > 0.0 ? 1.0 : -1.0;
  }
  return sense;
}

Eigen::MatrixXd bending_kernel(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd kernel(a.rows(), b.rows());
  for (Eigen::Index j = 0; j < b.rows(); ++j) {
    const Eigen::ArrayXd square = (a.rowwise() - b.row(j)).rowwise().squaredNorm().array();
    if (a.cols() == 1) {
      kernel.col(j) = square * square.sqrt() / 12.0;
    } else {
      // r² ln r = r²/2 ln r²; 0 at r = 0.
      kernel.col(j) = square * square.max(1e-300).log() / (16.0 * std::numbers::pi);
    }
  }
  return kernel;
}

Eigen::MatrixXd plane_functions(const Eigen::MatrixXd& coordinates) {
  Eigen::MatrixXd functions(coordinates.rows(), 1 + coordinates.cols());
  functions << Eigen::VectorXd::Ones(coordinates.rows()), coordinates;
  return functions;
}

}  // namespace chladni::priors
