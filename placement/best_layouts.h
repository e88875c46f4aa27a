// The quality of layouts, and the best possible ones.
#pragma once

#include <string>
#include <vector>

#include "placement/candidates.h"
#include "placement/wanted_modes.h"

namespace chladni::placement {

/// The quality of a layout.
struct LayoutScore {
  Eigen::VectorXd scores;  ///< as `layout_criteria()`; NaN: does not apply
  std::vector<int> blind;  ///< modes that it cannot see, counted from 1 with the rigid ones
  int pairs = 0;           ///< collocated
  /// For each point of the surface: expected error of an interpolated shape, root mean square over
  /// the wanted modes, relative to that of the shape; empty without channels.
  Eigen::VectorXd deviation;
};

/// Scores layouts of one structure.
class LayoutScorer {
 public:
  /// Structure and surface must live longer.
  LayoutScorer(const Structure& structure, const Sites& surface, WantedModes wanted,
               const Plan& plan);

  /// Some channels of the structure, by index.
  [[nodiscard]] LayoutScore of_channels(const std::vector<std::size_t>& sensors,
                                        const std::vector<std::size_t>& actuators) const;
  /// Sensors at some sites. @param shapes  s×r [kg^-1/2]
  [[nodiscard]] LayoutScore of_sensors(const Eigen::MatrixXd& shapes) const;

 private:
  [[nodiscard]] LayoutScore scored(LayoutView view) const;
  [[nodiscard]] std::vector<int> blind_modes(LayoutView view) const;

  const Structure& structure_;
  const Sites& surface_;
  WantedModes wanted_;
  double frequency_tolerance_;
  LayoutView view_;  // without channels
};

/// A best layout of sensors.
struct Optimum {
  std::string by;                  ///< "determinant" or "interpolation_error"
  Choice choice;                   ///< rows of the candidates
  Points sites;                    ///< count×3 [m]
  Eigen::MatrixXd shapes;          ///< count×r [kg^-1/2], at the sites
  std::vector<Points> equivalent;  ///< equally good, by the symmetry of the body
  double certificate = 0.0;        ///< proven D-efficiency; 0: none
  std::string remark;              ///< reason for a missing certificate
};

/// The best layouts by determinant and by expected interpolation error, beside the channels that
/// stay; the plan's own comes first.
/// @throws InvalidInput  more sites than candidates; as `best_determinant`
[[nodiscard]] std::vector<Optimum> best_layouts(const Structure& structure, const Sites& surface,
                                                const Candidates& candidates,
                                                const WantedModes& wanted, const Plan& plan,
                                                unsigned seed);

}  // namespace chladni::placement
