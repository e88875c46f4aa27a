#include "diagnosis/body_fields.h"

#include <algorithm>

namespace chladni::diagnosis {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// With what each part of a cell is multiplied: what goes as t^power, and as t.
BodyChange change(const Structure& structure, const ArrayXd& powered, const ArrayXd& linear) {
  const auto& cells = structure.cells;
  BodyChange result{sum_of(cells.stiffness, powered), sum_of(cells.mass, linear)};
  add_shear_and_turning(structure, powered - linear, result.stiffness, result.mass);
  return result;
}

}  // namespace

MatrixXd smooth_fields(const BodyCells& cells) { return smooth_fields(cells, cells.centres); }

MatrixXd smooth_fields(const BodyCells& cells, const Eigen::MatrixX2d& places) {
  if (cells.count() == 0) return {};
  const Eigen::RowVector2d low = cells.from;
  const Eigen::RowVector2d spread =
      cells.centres.colwise().maxCoeff() - cells.centres.colwise().minCoeff();
  Eigen::RowVector2d size = cells.size;
  for (int axis = 0; axis < 2; ++axis) {
    if (spread(axis) < 0.3 * size(axis)) size(axis) = 0.0;  // one cell spans it: nothing varies
  }
  const auto along = [&](int axis) -> Eigen::ArrayXd {
    if (size(axis) <= 0.0) return Eigen::ArrayXd::Zero(places.rows());
    return 2.0 * (places.col(axis).array() - low(axis)) / size(axis) - 1.0;
  };
  const Eigen::ArrayXd u = along(0);
  const Eigen::ArrayXd v = along(1);
  MatrixXd fields(places.rows(), 0);
  const auto add = [&](const Eigen::ArrayXd& field) {
    fields.conservativeResize(Eigen::NoChange, fields.cols() + 1);
    fields.rightCols(1) = field.matrix();
  };
  if (size(0) > 0.0) add(u);
  if (size(1) > 0.0) add(v);
  if (size(0) > 0.0) add(1.5 * u.square() - 0.5);
  if (size(0) > 0.0 && size(1) > 0.0) add(u * v);
  if (size(1) > 0.0) add(1.5 * v.square() - 0.5);
  return fields;
}

MatrixXd sum_of(const std::vector<MatrixXd>& cells, const VectorXd& weight) {
  MatrixXd sum = MatrixXd::Zero(cells.front().rows(), cells.front().cols());
  for (Index c = 0; c < weight.size(); ++c) {
    if (weight(c) != 0.0) sum += weight(c) * cells[static_cast<std::size_t>(c)];
  }
  return sum;
}

void add_shear_and_turning(const Structure& structure, const VectorXd& powered_less_linear,
                           MatrixXd& stiffness, MatrixXd& mass) {
  const auto& cells = structure.cells;
  if (!cells.shear.empty()) stiffness -= sum_of(cells.shear, powered_less_linear);
  if (!cells.rotary.empty()) mass += sum_of(cells.rotary, powered_less_linear);
}

BodyChange thickened(const Structure& structure, const VectorXd& field) {
  const ArrayXd t = (1.0 + field.array()).max(0.05);
  return change(structure, t.pow(structure.bending_power) - 1.0, t - 1.0);
}

BodyChange thickened_smoothly(const Structure& structure, const VectorXd& x) {
  const auto& waves = structure.cells.waves;
  const VectorXd field = smooth_fields(structure.cells) * x;
  if (waves.bent.empty()) return thickened(structure, field);
  const ArrayXd t = (1.0 + field.array()).max(0.05);
  const double power = structure.bending_power;
  BodyChange result =
      change(structure, t.pow(power) - 1.0 - power * field.array(), t - 1.0 - field.array());
  result.stiffness += sum_of(waves.bent, x);
  result.mass += sum_of(waves.thickened, x);
  return result;
}

BodyChange thickness_slope(const Structure& structure, Index f) {
  const auto& waves = structure.cells.waves;
  const auto at = static_cast<std::size_t>(f);
  if (!waves.bent.empty()) return {waves.bent[at], waves.thickened[at]};
  const ArrayXd field = smooth_fields(structure.cells).col(f).array();
  return change(structure, structure.bending_power * field, field);
}

BodyChange thickness_slope(const Structure& structure) {
  const ArrayXd ones = ArrayXd::Ones(structure.cells.count());
  return change(structure, structure.bending_power * ones, ones);
}

MatrixXd stiffened_smoothly(const Structure& structure, const VectorXd& x) {
  const auto& cells = structure.cells;
  if (!cells.waves.modulus.empty()) return sum_of(cells.waves.modulus, x);
  return sum_of(cells.stiffness, smooth_fields(cells) * x);
}

}  // namespace chladni::diagnosis
