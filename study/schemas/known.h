// Numbers of a study that say how well they are known: { value = "10.6 GPa", within = "15 %" }.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/calibrated.h"
#include "study/problems.h"
#include "study/study.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

/// A number that states its deviation, and where it stands.
struct KnownNumber {
  std::string key;        ///< "material.youngs_modulus[0]"
  int element = -1;       ///< of an array, counted from 0
  bool of_array = false;  ///< one statement for all numbers of the array
  int line = 0, column = 0;
  double deviation = 0.0;  ///< relative
  diagnosis::CalibratedConstant::Kind kind = diagnosis::CalibratedConstant::Kind::known;
};

/// Puts the plain value into the place of each such table, so that the readers of the study need
/// not know of them. [expect] has widths of its own and is left alone. Wrong statements are
/// problems.
[[nodiscard]] std::vector<KnownNumber> without_statements(TomlNode& tree, Problems& problems);

/// Sets Study::constants. A key that no diagnosis can calibrate is a problem, whose message has
/// the keys that it can.
void read_known(const std::vector<KnownNumber>& numbers, Study& study, Problems& problems);

/// The keys that may state how well they are known, for people.
[[nodiscard]] std::vector<std::string> keys_with_deviations();

}  // namespace chladni::study
