// Best places for the study's devices, and the quality of its layouts.
#pragma once

#include <string>
#include <vector>

#include "placement/best_layouts.h"
#include "placement/best_pairs.h"
#include "stage/ensemble.h"
#include "stage/faces.h"
#include "stage/solution.h"

namespace chladni::steps {

/// A layout of the study, or a best one, with its score.
struct ScoredLayout : placement::LayoutScore {
  std::string name;
  std::vector<std::string> sensors, actuators;
  std::vector<io::Marker> markers;  ///< sensors and actuators
};

/// The best places on the study's body, and the quality of its layouts.
struct BestPlaces : placement::PairPlaces {
  stage::Faces faces;  ///< where devices may be
  placement::Surface surface;
  placement::WantedModes wanted;
  std::vector<placement::Rule> rules;
  Eigen::VectorXi forbidden;  ///< per point of the surface: index of the rule, or −1
  std::vector<ScoredLayout> layouts;
  std::vector<placement::Optimum> optima;  ///< the wanted one first
  std::vector<std::string> notes;
};

/// @throws InvalidInput  missing modes, no admissible site, more devices than sites, a patch or
///                       channel that does not exist
[[nodiscard]] BestPlaces best_places(const study::Study& study, const stage::Solution& solution,
                                     stage::Work& work);

}  // namespace chladni::steps
