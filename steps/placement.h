// Best places for the study's devices, and the quality of its layouts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "placement/determinant.h"
#include "placement/heat_map.h"
#include "placement/layout.h"
#include "placement/rules.h"
#include "placement/sites.h"
#include "stage/ensemble.h"
#include "stage/faces.h"
#include "stage/solution.h"

namespace chladni::steps {

/// The modes for which devices are placed.
struct WantedModes {
  std::vector<Eigen::Index> columns;             ///< of the study's modes, ascending
  std::vector<modal::ModeGroup> groups;          ///< of those columns
  Eigen::VectorXd rms;                           ///< for each wanted mode, of its group [kg^-1/2]
  Eigen::VectorXd sensor_noise, actuator_noise;  ///< per wanted mode [kg^-1/2]
};

struct BestPair {
  Eigen::Vector3d position;
  double score = 0.0;
  int limiting = -1;  ///< index of the group that limits the score
};

struct ScoredLayout {
  std::string name;
  std::vector<std::string> sensors, actuators;
  Eigen::VectorXd scores;  ///< as placement::layout_criteria(); NaN: does not apply
  std::vector<int> blind;  ///< modes that it cannot see, counted from 1 with the rigid ones
  int pairs = 0;           ///< collocated
  std::vector<io::Marker> markers;  ///< sensors and actuators
  /// For each point of the surface: expected error of an interpolated shape, root mean square over
  /// the wanted modes, relative to that of the shape; empty without channels.
  Eigen::VectorXd deviation;
};

struct Optimum {
  std::string by;  ///< "determinant" or "interpolation_error"
  placement::Choice choice;
  Points sites;                    ///< count×3 [m]
  Eigen::MatrixXd shapes;          ///< count×all modes [kg^-1/2], at the sites
  std::vector<Points> equivalent;  ///< equally good, by the symmetry of the body
  double certificate = 0.0;        ///< proven D-efficiency; 0: none
  std::string remark;              ///< reason for a missing certificate
};

struct Placed {
  stage::Faces faces;  ///< where devices may be
  placement::Surface surface;
  WantedModes wanted;
  const placement::Criterion* criterion = nullptr;
  std::vector<placement::HeatMap> maps;  ///< one per criterion of placement::criteria()
  std::size_t chosen = 0;                ///< index of the map of `criterion`
  std::vector<placement::Rule> rules;
  Eigen::VectorXi forbidden;    ///< per point of the surface: index of the rule, or −1
  std::vector<BestPair> best;   ///< single pairs, best first
  std::vector<BestPair> pairs;  ///< several together, if asked for
  std::vector<ScoredLayout> layouts;
  std::vector<Optimum> optima;  ///< the wanted one first
  std::vector<std::string> notes;
};

/// @throws InvalidInput  missing modes, no admissible site, more devices than sites, a patch or
///                       channel that does not exist
[[nodiscard]] Placed placed(const study::Study& study, const stage::Solution& solution,
                            stage::Work& work);

/// "7 (flex 1, 178.92 Hz)"; a group "10-11 (flex 4-5, 463.4 Hz)".
[[nodiscard]] std::string group_name(const stage::Solution& solution, const WantedModes& wanted,
                                     int group);

}  // namespace chladni::steps
