#include "placement/plan.h"

#include <fmt/format.h>

#include "base/error.h"
#include "placement/sites.h"

namespace chladni::placement {
namespace {

void require_size(Eigen::Index found, Eigen::Index expected, const std::string& what) {
  require(found == expected,
          fmt::format("placement: {} is {}; expected {}", what, found, expected));
}

void require_channels(const Channels& channels, Eigen::Index modes, const std::string& kind) {
  const auto count = channels.count();
  if (count > 0) require_size(channels.shapes.cols(), modes, "the number of modes at " + kind);
  if (channels.slopes.size() > 0) {
    require_size(channels.slopes.rows(), count, "the number of slope rows of " + kind);
    require_size(channels.slopes.cols(), modes, "the number of slopes of " + kind);
  }
  require_size(channels.lines.position.rows(), count, "the number of places of " + kind);
  require_size(channels.lines.direction.rows(), count, "the number of directions of " + kind);
  require(channels.shapes.allFinite() && channels.slopes.allFinite() &&
              channels.lines.position.allFinite() && channels.lines.direction.allFinite(),
          "placement: a shape, slope, place or direction of the " + kind + " is not finite");
  constexpr double kUnit = 1e-6;
  require(((channels.lines.direction.rowwise().norm().array() - 1.0).abs() < kUnit).all(),
          "placement: a direction of the " + kind + " is not of length 1");
  require(channels.stays.empty() || std::ssize(channels.stays) == count,
          "placement: `stays` has not one mark for each of the " + kind);
}

}  // namespace

Eigen::RowVectorXd slopes_near(const Eigen::RowVector3d& position, const Sites& surface) {
  Eigen::Index nearest = 0;
  (surface.position.rowwise() - position).rowwise().squaredNorm().minCoeff(&nearest);
  return surface.slopes.row(nearest);
}

Eigen::RowVectorXd slopes_of(const Channels& channels, Eigen::Index channel, const Sites& surface) {
  if (channels.slopes.size() > 0) return channels.slopes.row(channel);
  return slopes_near(channels.lines.position.row(channel), surface);
}

void require_fit(const Structure& structure, const Sites& surface) {
  const auto modes = structure.frequency_hz.size();
  require(surface.count() > 0, "placement: the surface has no points");
  require_size(surface.shapes.rows(), surface.count(), "the number of the surface's shape rows");
  require_size(surface.shapes.cols(), modes, "the number of modes on the surface");
  require_size(surface.slopes.rows(), surface.count(), "the number of the surface's slope rows");
  require_size(surface.slopes.cols(), modes, "the number of the surface's slopes");
  require_size(surface.area.size(), surface.count(), "the number of areas");
  require_size(structure.damping_ratio.size(), modes, "the number of damping ratios");
  require(structure.rigid_count >= 0 && structure.rigid_count <= modes,
          "placement: there are more rigid-body modes than modes");
  require(structure.mass_kg > 0.0, "placement: the structure has no mass");
  require(surface.shapes.allFinite() && structure.frequency_hz.allFinite(),
          "placement: a shape or frequency is not finite");
  require_channels(structure.sensors, modes, "sensors");
  require_channels(structure.actuators, modes, "actuators");
  for (const auto& member : structure.ensemble) {
    require_size(member.turn.rows(), modes, "the number of modes of a member of the ensemble");
    require_size(member.turn.cols(), modes, "the number of modes of a member of the ensemble");
  }
}

}  // namespace chladni::placement
