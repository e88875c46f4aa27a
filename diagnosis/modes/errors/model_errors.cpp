#include "diagnosis/modes/errors/model_errors.h"
#include "diagnosis/constants.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/fit/deviations.h"
#include "diagnosis/modes/errors/levels.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr int kNoClass = -1;

// c×3, along u, v and the normal.
Eigen::MatrixX3d directions_of(const ChannelSide& side) {
  return side.directions.rows() > 0
             ? side.directions
             : Eigen::MatrixX3d(Eigen::RowVector3d::UnitZ().replicate(side.count(), 1));
}

}  // namespace

MatrixXd smooth_factor(const Structure& structure) {
  const auto& out = structure.outputs;
  const auto& in = structure.inputs;
  Eigen::MatrixX2d places(out.count() + in.count(), 2);
  places << out.places, in.places;
  Eigen::MatrixX3d directions(places.rows(), 3);
  directions << directions_of(out), directions_of(in);
  const double length = kConstants.smooth_over * std::max(structure.surface.size(), 1e-9);
  MatrixXd covariance(places.rows(), places.rows());
  for (Index i = 0; i < places.rows(); ++i) {
    for (Index j = 0; j < places.rows(); ++j) {
      const double apart = std::sqrt(3.0) * (places.row(i) - places.row(j)).norm() / length;
      covariance(i, j) =
          directions.row(i).dot(directions.row(j)) * (1.0 + apart) * std::exp(-apart);
    }
  }
  covariance.diagonal().array() += 1e-6;
  return covariance.llt().matrixL();
}

std::vector<BodyError> body_errors(const Structure& structure, const Tolerances& tolerances,
                                   bool uniform_thickness) {
  const State base = state_of(structure);
  std::vector<BodyError> all;
  constexpr double kStep = 1e-3;
  const auto add = [&](const Deviation& deviation, int of, double unit) {
    State state = base;
    deviation.apply(state, kStep);
    BodyError error{of, (state.stiffness - base.stiffness) / (kStep * unit),
                    (state.mass - base.mass) / (kStep * unit)};
    for (auto* change : {&error.stiffness, &error.mass}) {
      if (change->isZero(0.0)) change->resize(0, 0);
    }
    if (error.stiffness.size() + error.mass.size() > 0) all.push_back(std::move(error));
  };
  Tolerances whole = no_tolerances();
  whole.modulus = tolerances.modulus;
  whole.density = tolerances.density;
  whole.orthotropy = tolerances.orthotropy;
  whole.mass = tolerances.mass;
  for (const auto& deviation : deviations(structure, whole, 0.0)) add(deviation, kNoClass, 1.0);
  Tolerances waves = no_tolerances();
  waves.thickness = tolerances.thickness;
  bool is_first = true;  // the uniform thickness comes before its waves
  for (const auto& deviation : deviations(structure, waves, 0.0)) {
    if (!is_first || uniform_thickness) {
      add(deviation, is_first ? kNoClass : static_cast<int>(ErrorClass::field),
          is_first ? 1.0 : waves.thickness);
    }
    is_first = false;
  }
  return all;
}

}  // namespace chladni::diagnosis
