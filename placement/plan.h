// What a placement is for: the modes of a structure, its channels, and what is wanted of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "placement/heat_map.h"
#include "placement/layout.h"
#include "placement/observer_layouts.h"
#include "priors/interpolator.h"

namespace chladni::placement {

/// The s sensors, or the s actuators, of a structure with r modes.
struct Channels {
  Lines lines;              ///< places and directions
  Eigen::MatrixXd shapes;   ///< s×r [kg^-1/2]
  std::vector<char> stays;  ///< s: 1 where the channel keeps its place; empty: none does
  /// s×r [kg^-1/2 m^-1]: slopes along the surface, as `Sites::slopes`; empty: those of the
  /// surface's nearest point. Only an error of the position needs them.
  Eigen::MatrixXd slopes = {};

  [[nodiscard]] Eigen::Index count() const { return shapes.rows(); }
  [[nodiscard]] bool keeps(Eigen::Index channel) const {
    return !stays.empty() && stays[static_cast<std::size_t>(channel)] != 0;
  }
};

/// A structure with r modes, rigid-body modes first.
struct Structure {
  Eigen::VectorXd frequency_hz;   ///< r
  Eigen::VectorXd damping_ratio;  ///< r; 0 where unknown
  Eigen::Index rigid_count = 0;
  double mass_kg = 0.0;
  double size = 0.0;  ///< [m]: the diagonal of its box
  Channels sensors, actuators;
  std::vector<priors::SimilarModel> ensemble;  ///< other possible structures; may be empty
  Eigen::MatrixXd interest;  ///< k×r [kg^-1/2]: at the points of interest; may be empty
};

struct Sites;

/// The slopes of one channel, 1×r.
[[nodiscard]] Eigen::RowVectorXd slopes_of(const Channels& channels, Eigen::Index channel,
                                           const Sites& surface);
/// Those of the surface's nearest point, 1×r.
[[nodiscard]] Eigen::RowVectorXd slopes_near(const Eigen::RowVector3d& position,
                                             const Sites& surface);

/// @throws InvalidInput  arrays of the structure and of its surface that do not fit each other
void require_fit(const Structure& structure, const Sites& surface);

struct Plan {
  std::vector<int> modes;  ///< flexible ones, counted from 1; empty: the first three
  double up_to_hz = 0.0;   ///< all flexible modes below this instead; 0: use `modes`
  std::string criterion = "weakest_mode";
  double frequency_tolerance = 0.01;     ///< relative: closer neighbours are one group
  double noise = 0.01;                   ///< of an identified shape's entry, over the shape's rms
  double frf_noise = 0.0;                ///< [m/N] per line, instead of `noise`
  double resolution_hz = 0.0;            ///< between lines, beside frf_noise
  double position_error = 0.0;           ///< [m], standard deviation per axis
  Over over = Over::worst;               ///< the ensemble
  double spacing = 0.0;                  ///< [m], least distance between two devices
  int pairs = 1;                         ///< to choose together
  int sites = 0;                         ///< of a best layout; 0: one more than the wanted modes
  bool by_interpolation = false;         ///< the best layout by expected error comes first
  std::optional<ObserverTask> observer;  ///< what is to be known of a region's motion; none: no
                                         ///< such layout is chosen
  DeviceCounts devices;                  ///< of that layout; none: `sites` sensors
  bool by_observer = false;              ///< that layout comes first
};

}  // namespace chladni::placement
