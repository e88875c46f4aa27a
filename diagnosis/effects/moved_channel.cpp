#include "diagnosis/effects/moved_channel.h"

#include <cmath>

namespace chladni::diagnosis {

using Eigen::VectorXd;

VectorXd shape_change(const Structure& structure, const ChannelSide& side, Eigen::Index i,
                      const Eigen::Vector2d& by) {
  const Eigen::Vector2d place = side.places.row(i);
  const VectorXd first_order =
      (by(0) * side.slope_u.row(i) + by(1) * side.slope_v.row(i)).transpose();
  if (structure.surface.at == nullptr) return first_order;
  const auto here = structure.surface.at(place);
  const auto there = structure.surface.at(place + by);
  if (!here || !there) return first_order;
  // Only along the surface's normal does the surface know it.
  const double along = here->shape.dot(side.shapes.row(i));
  const double own = here->shape.squaredNorm();
  if (own <= 0.0) return first_order;
  const double sign = along / own;
  const bool normal = std::abs(std::abs(sign) - 1.0) < 0.02;
  if (!normal) return first_order;
  return sign * (there->shape - here->shape);
}

}  // namespace chladni::diagnosis
