#include "diagnosis/learned_levels.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {

Tolerances with_levels(Tolerances tolerances, const std::vector<ErrorLevel>& levels) {
  constexpr std::array<std::pair<std::string_view, double Tolerances::*>, 5> classes{
      {{"frequency", &Tolerances::frequency},
       {"damping", &Tolerances::damping},
       {"shape", &Tolerances::response},
       {"gain", &Tolerances::gain},
       {"place", &Tolerances::position}}};
  for (const auto& [name, tolerance] : classes) {
    const auto level = std::ranges::find(levels, name, &ErrorLevel::of);
    if (level == levels.end()) continue;
    tolerances.*tolerance = std::max(tolerances.*tolerance, level->value);
  }
  return tolerances;
}

bool are_beyond(const Tolerances& tolerances, const std::vector<ErrorLevel>& levels) {
  const auto exceeds = [&](std::string_view name, double largest) {
    const auto level = std::ranges::find(levels, name, &ErrorLevel::of);
    return level != levels.end() && level->determined >= kConstants.errors_of_a_level &&
           level->value > largest;
  };
  return exceeds("frequency", kConstants.beyond_tolerance * tolerances.frequency) ||
         exceeds("shape", kConstants.beyond_response * tolerances.response) ||
         exceeds("smooth_shape", kConstants.beyond_response * tolerances.response);
}

}  // namespace chladni::diagnosis
