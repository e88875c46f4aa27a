// What decides in this room: what a layout sees, where a search ends, what belongs to a site.
// docs/reference/constants_identification.md has the same list, with what was seen when one was
// halved and doubled; a test compares both. Lengths are relative to the body, times to the band.
#pragma once

#include <Eigen/Core>

namespace chladni::placement {

/// Each comment says what the constant decides [unit] (source).
struct Constants {
  // Layouts.
  /// Sight of a group of modes below which a layout cannot see it [points of average motion]
  /// (chosen, 8de1b5e).
  static constexpr double blind = 0.1;
  /// Directions of a sensor and an actuator are along one line above it; 2.6 degrees [cos] (chosen,
  /// c2b69c2).
  static constexpr double parallel = 0.999;
  /// Candidates of the first search; with more than twice as many, the search is refined about its
  /// best ones [sites] (chosen, 8de1b5e).
  static constexpr Eigen::Index coarse = 240;
  /// Reach of that refinement over the longest distance to a coarse candidate [1] (chosen,
  /// 8de1b5e).
  static constexpr double coarse_reach = 1.5;
  /// Gap of the relaxation at the root of the search tree [ln det] (chosen, ce0546a).
  static constexpr double root_tolerance = 1e-6;
  /// The same at its nodes [ln det] (chosen, 8de1b5e).
  static constexpr double node_tolerance = 1e-4;
  /// Least damping ratio of a mode in the predicted error of responses [1] (chosen, 8de1b5e).
  static constexpr double least_damping = 1e-3;
  /// Damping ratio of rigid-body modes that the suspension of an observer's layout holds [1]
  /// (chosen, 68edba4a).
  static constexpr double suspension_damping = 0.7;
  /// Time in which a drift forgets its level in the layout of an observer [drift times] (chosen,
  /// 68edba4a).
  static constexpr double drift_memory = 100.0;

  // Sites.
  /// Angle between normals up to which a refined site stays on its face; 45 degrees [cos] (chosen,
  /// 8de1b5e).
  static constexpr double same_face = 0.7;
  /// Most steps of a refinement [steps] (chosen, 8de1b5e).
  static constexpr int refine_steps = 200;
  /// Last step of a refinement [m] (chosen, 8de1b5e).
  static constexpr double last_step = 5e-5;
  /// The same at most, on a small body [diagonals of the surface] (chosen).
  static constexpr double last_step_part = 1e-3;
  /// Step on the surface that gives the slope of a mode [diagonals of the body] (chosen, 8de1b5e).
  static constexpr double slope_step = 1e-3;
  /// Distance of the rim of a footprint from the surface, beyond its bend, above which it reaches
  /// beyond an edge [radii] (chosen, 8de1b5e).
  static constexpr double rim_off = 0.05;
  /// Pieces of a curved edge from which a distance is kept [1] (chosen, caf9022).
  static constexpr int pieces = 8;
};

}  // namespace chladni::placement
