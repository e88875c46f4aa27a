#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> offsets(const Structure& structure) {
  std::vector<Parameter> both{{"u", "m", Parameter::Scale::linear, 0.0, 0.01, 1e-5}};
  const bool wide = !structure.outputs.slope_v.isZero(0.0) || !structure.inputs.slope_v.isZero(0.0);
  if (wide) both.push_back({"v", "m", Parameter::Scale::linear, 0.0, 0.01, 1e-5});
  return both;
}

// What the shapes at channel i change by when it is moved: as the surface has it, or to first order
// for a channel beside it.
VectorXd moved(const Structure& structure, const ChannelSide& side, Index i, const VectorXd& x) {
  const Eigen::Vector2d by(x(0), x.size() > 1 ? x(1) : 0.0);
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

template <Side side>
void move(State& state, const Structure& structure, Index option, const VectorXd& x) {
  const VectorXd by = moved(structure, channels_of<side>(structure), option, x);
  if (side == Side::sensors) {
    state.outputs.row(option) += by.transpose();
  } else {
    state.inputs.col(option) += by;
  }
}

template <Side side>
std::vector<EffectStart> moves(const Scene& scene) {
  std::vector<EffectStart> starts;
  const auto n = static_cast<Index>(offsets(scene.structure()).size());
  for (Index i = 0; i < channels_of<side>(scene.structure()).count(); ++i) {
    starts.push_back({i, VectorXd::Zero(n)});
    for (Index axis = 0; axis < n; ++axis) {
      for (const double by : {-0.012, -0.004, -0.001, 0.001, 0.004, 0.012}) {
        starts.push_back({i, by * VectorXd::Unit(n, axis)});
      }
    }
  }
  return starts;
}

template <Side side>
Index all(const Structure& structure) {
  return channels_of<side>(structure).count();
}

}  // namespace

const Effect sensor_position{"sensor_position",
                             "a sensor looks at another point than it says",
                             "its row of the shapes at the place moved",
                             "a tilted sensor (the same to first order), its gain",
                             offsets,
                             all<Side::sensors>,
                             the_channel<Side::sensors>,
                             move<Side::sensors>,
                             moves<Side::sensors>};
const Effect actuator_position{"actuator_position",
                               "an actuator pushes at another point than it says",
                               "its column of the shapes at the place moved",
                               "a tilted actuator (the same to first order), its gain",
                               offsets,
                               all<Side::actuators>,
                               the_channel<Side::actuators>,
                               move<Side::actuators>,
                               moves<Side::actuators>};

}  // namespace chladni::diagnosis
