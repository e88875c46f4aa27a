#include "fem/system.h"

namespace chladni::fem {

Eigen::MatrixXd on_nodes(const DofMap& dofs, const Eigen::MatrixXd& free) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(3 * dofs.node_count, free.cols());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (dofs.free_dof(i) >= 0) values.row(i) = free.row(dofs.free_dof(i));
  }
  return values;
}

}  // namespace chladni::fem
