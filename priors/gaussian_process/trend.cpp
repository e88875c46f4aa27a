#include "priors/gaussian_process/trend.h"

#include <Eigen/SVD>

#include "base/finite.h"
#include "priors/constants.h"

namespace chladni::priors {

Eigen::MatrixXd Trend::at(const Points& points) const {
  Eigen::MatrixXd values(points.rows(), count());
  if (!is_there) return values;
  values.col(0).setOnes();
  values.rightCols(slopes.cols()) = (points.rowwise() - centre) * slopes;
  return values;
}

Trend rigid_trend(const Points& points, const Eigen::RowVector3d& direction) {
  Trend trend;
  trend.is_there = true;
  trend.centre = points.colwise().mean();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction.transpose() * direction;
  const Eigen::MatrixXd spread = (points.rowwise() - trend.centre) * across;
  const Eigen::JacobiSVD<Eigen::MatrixXd> axes(finite(spread, "trend: places"), Eigen::ComputeThinV);
  const Eigen::VectorXd width = axes.singularValues();
  Eigen::Index rank = 0;
  while (rank < std::min<Eigen::Index>(2, width.size()) &&
         width(rank) > Constants::no_extent * width(0))
    ++rank;
  const double size = spread.rowwise().norm().maxCoeff();
  trend.slopes = axes.matrixV().leftCols(rank) / (size > 0.0 ? size : 1.0);
  return trend;
}

}  // namespace chladni::priors
