#include "diagnosis/effects/body_scale.h"

#include <limits>

namespace chladni::diagnosis {
namespace {

constexpr double kUnit = 0.6;  // m

}  // namespace

double body_scale(const Structure& structure) {
  if (structure.cells.count() > 0) return structure.cells.size.maxCoeff() / kUnit;
  constexpr double kFar = std::numeric_limits<double>::max();
  Eigen::RowVector2d low = Eigen::RowVector2d::Constant(kFar);
  Eigen::RowVector2d high = -low;
  for (const auto* places :
       {&structure.surface.places, &structure.outputs.places, &structure.inputs.places}) {
    if (places->rows() == 0) continue;
    low = low.cwiseMin(places->colwise().minCoeff());
    high = high.cwiseMax(places->colwise().maxCoeff());
  }
  const double longest = (high - low).maxCoeff();
  return longest > 0.0 ? longest / kUnit : 1.0;
}

}  // namespace chladni::diagnosis
