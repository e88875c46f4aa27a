#include "diagnosis/body_fields.h"

#include <algorithm>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sums the parts of all cells, with one factor for t^power and one for t.
BodyChange change(const Structure& structure, const ArrayXd& powered, const ArrayXd& linear) {
  const auto& cells = structure.cells;
  BodyChange result{sum_of(cells.stiffness, powered), sum_of(cells.mass, linear)};
  add_shear_and_turning(structure, powered - linear, result.stiffness, result.mass);
  return result;
}

// Size of the box; 0 along an axis that one cell spans, because no field varies along it.
Eigen::RowVector2d resolved_size(const BodyCells& cells) {
  const Eigen::RowVector2d spread =
      cells.centres.colwise().maxCoeff() - cells.centres.colwise().minCoeff();
  Eigen::RowVector2d size = cells.size;
  for (int axis = 0; axis < 2; ++axis) {
    if (spread(axis) < 0.3 * size(axis)) size(axis) = 0.0;
  }
  return size;
}

// Coordinate from -1 to 1 over the box; 0 along an axis that is not resolved.
ArrayXd along(const BodyCells& cells, const Eigen::MatrixX2d& places, Index axis) {
  const double size = resolved_size(cells)(axis);
  if (size <= 0.0) return ArrayXd::Zero(places.rows());
  return 2.0 * (places.col(axis).array() - cells.from(axis)) / size - 1.0;
}

}  // namespace

MatrixXd smooth_fields(const BodyCells& cells) { return smooth_fields(cells, cells.centres); }

MatrixXd smooth_fields(const BodyCells& cells, const Eigen::MatrixX2d& places) {
  if (cells.count() == 0) return {};
  const auto size = resolved_size(cells);
  const ArrayXd u = along(cells, places, 0);
  const ArrayXd v = along(cells, places, 1);
  MatrixXd fields(places.rows(), 0);
  const auto add = [&](const ArrayXd& field) {
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

std::vector<std::string_view> names_of_smooth_fields(const BodyCells& cells) {
  if (cells.count() == 0) return {};
  const auto size = resolved_size(cells);
  std::vector<std::string_view> names;
  for (const auto name : kSmoothFields) {
    const bool has_u = name.find('u') != std::string_view::npos;
    const bool has_v = name.find('v') != std::string_view::npos;
    if ((has_u && size(0) <= 0.0) || (has_v && size(1) <= 0.0)) continue;
    names.push_back(name);
  }
  return names;
}

MatrixXd short_waves(const BodyCells& cells) {
  constexpr Index kOrder = 6;
  if (cells.count() == 0) return {};
  const auto resolved = resolved_size(cells);
  if (resolved.minCoeff() > 0.0) return {cells.count(), 0};
  Index axis = 0;
  resolved.maxCoeff(&axis);
  const ArrayXd at = along(cells, cells.centres, axis);
  MatrixXd orders(cells.count(), kOrder + 1);
  orders.col(0).setOnes();
  orders.col(1) = at;
  for (Index n = 1; n < kOrder; ++n) {  // Bonnet's recursion
    const auto k = static_cast<double>(n);
    orders.col(n + 1) =
        ((2.0 * k + 1.0) * at * orders.col(n).array() - k * orders.col(n - 1).array()) / (k + 1.0);
  }
  return orders.rightCols(kOrder - 2);
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
  const ArrayXd t = (1.0 + field.array()).max(kConstants.thinnest);
  return change(structure, t.pow(structure.bending_power) - 1.0, t - 1.0);
}

BodyChange thickened_smoothly(const Structure& structure, const VectorXd& x) {
  const auto& waves = structure.cells.waves;
  const VectorXd field = smooth_fields(structure.cells) * x;
  if (waves.bent.empty()) return thickened(structure, field);
  const ArrayXd t = (1.0 + field.array()).max(kConstants.thinnest);
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
  return thickness_slope(structure, VectorXd(smooth_fields(structure.cells).col(f)));
}

BodyChange thickness_slope(const Structure& structure, const VectorXd& field) {
  return change(structure, structure.bending_power * field.array(), field.array());
}

BodyChange thickness_slope(const Structure& structure) {
  return thickness_slope(structure, VectorXd(VectorXd::Ones(structure.cells.count())));
}

MatrixXd stiffened_smoothly(const Structure& structure, const VectorXd& x) {
  const auto& cells = structure.cells;
  if (!cells.waves.modulus.empty()) return sum_of(cells.waves.modulus, x);
  return sum_of(cells.stiffness, smooth_fields(cells) * x);
}

}  // namespace chladni::diagnosis
