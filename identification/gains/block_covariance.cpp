#include "identification/gains/block_covariance.h"

namespace chladni::identification {

Eigen::MatrixXd block_covariance(const Matching& state, const modal::ModeGroup& group) {
  const auto p = state.p();
  const auto q = state.q();
  const auto g = group.size;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(g * (p + q), g * (p + q));
  const auto& rigid = state.fit.rigid_covariance;
  if (group.first < state.fit.model.rigid_count && rigid.rows() == covariance.rows()) {
    std::vector<Eigen::Index> where;  // in (vec L, vec R)
    for (Eigen::Index m = 0; m < g; ++m) {
      for (Eigen::Index i = 0; i < p; ++i) where.push_back(m * p + i);
      for (Eigen::Index j = 0; j < q; ++j) where.push_back(g * p + j * g + m);
    }
    covariance = rigid(where, where);
  } else {
    for (Eigen::Index m = 0; m < g; ++m) {
      covariance.block(m * (p + q), m * (p + q), p + q, p + q) =
          shape_covariance(state.fit, group.first + m);
    }
  }
  for (Eigen::Index m = 0; m < g; ++m) {
    covariance.middleRows(m * (p + q) + p, q) *= state.side;
    covariance.middleCols(m * (p + q) + p, q) *= state.side;
  }
  return covariance;
}

Eigen::MatrixXd product_deviation(const Matching& state, const modal::ModeGroup& group) {
  const auto p = state.p();
  const auto q = state.q();
  const auto& model = state.fit.model;
  const Eigen::MatrixXd covariance = block_covariance(state, group);
  Eigen::MatrixXd deviation(p, q);
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < q; ++j) {
      std::vector<Eigen::Index> where;
      Eigen::VectorXd slope(2 * group.size);
      for (Eigen::Index m = 0; m < group.size; ++m) {
        where.push_back(m * (p + q) + i);
        where.push_back(m * (p + q) + p + j);
        slope(2 * m) = state.side * model.input_shapes(group.first + m, j);
        slope(2 * m + 1) = model.output_shapes(i, group.first + m);
      }
      deviation(i, j) = slope.dot(covariance(where, where) * slope);
    }
  }
  if (!(deviation.minCoeff() > 0.0)) return {};
  return deviation.cwiseSqrt();
}

}  // namespace chladni::identification
