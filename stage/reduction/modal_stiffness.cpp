#include "stage/reduction/modal_stiffness.h"

#include "fem/field_matrices.h"

namespace chladni::stage {

Eigen::MatrixXd modal_stiffness(const Model& model, const modal::Modes& modes,
                                const ElasticChange& change) {
  auto materials = model.materials;
  for (auto& material : materials) {
    const Eigen::Matrix<double, 6, 6> gained = change(material);
    material.stiffness = gained;
  }
  auto all = fem::field_matrices(model.body, materials, modes.shapes,
                                 Eigen::MatrixXd::Ones(model.body.tet_count(), 1),
                                 Eigen::MatrixXd(model.body.tet_count(), 0));
  return unstrained(std::move(all.stiffness.front()), modes.frequency_hz);
}

Eigen::MatrixXd unstrained(Eigen::MatrixXd stiffness, const Eigen::VectorXd& frequency_hz) {
  for (Eigen::Index j = 0; j < frequency_hz.size(); ++j) {
    if (frequency_hz(j) != 0.0) continue;
    stiffness.row(j).setZero();
    stiffness.col(j).setZero();
  }
  return 0.5 * (stiffness + stiffness.transpose());
}

}  // namespace chladni::stage
