// A plate in a study's text, and what stands in it with causes.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "steps/extend/extended_study.h"

namespace chladni::steps {

inline const std::string kStudy = R"(# a free plate, ä comment that stays
title = "plate"
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }  # 6.5 kg
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "50 mm", order = 2 }
modes = { count = 40, damping_ratio = "0.5 %" }

[[sensor]]
name = "s1"  # in the corner
at = ["-250 mm", "15 cm"]
direction = "z"
[[sensor]]
name = "s2"
at = ["110 mm", "40 mm"]
direction = [0, 0, 1]
gain = 1.1
[[actuator]]
name = "a1"
at = ["-170 mm", "-120 mm"]
direction = "-z"
[[actuator]]
name = "a2"
at = ["230 mm", "0 mm"]
direction = "z"

[measurement]
frf = "measured.uff"
hold_out = []
)";

inline diagnosis::Surface chart() { return {}; }

using Numbers = std::vector<std::pair<std::string, double>>;

inline diagnosis::Cause cause(const std::string& effect, const Numbers& numbers,
                              const std::vector<std::string>& channels = {}) {
  diagnosis::Cause result;
  result.effect = effect;
  result.channels = channels;
  for (const auto& [name, value] : numbers) {
    result.parameters.push_back({name, "1", value, 0.01 * std::abs(value)});
  }
  result.probability = 0.98;
  return result;
}

inline diagnosis::Cause resonator(double hz, double damping_ratio, double u, double v) {
  return cause(
      "resonator",
      {{"mass", 0.1}, {"frequency", hz}, {"damping_ratio", damping_ratio}, {"u", u}, {"v", v}});
}

inline const std::filesystem::path kFile = "bench/study.toml";

inline steps::ExtendedStudy extended(const std::vector<diagnosis::Cause>& causes,
                                     const std::string& text = kStudy,
                                     const steps::DiagnosedOn& on = {}) {
  return steps::extended_study(text, kFile, chart(), causes, "bench", {}, true, on);
}

}  // namespace chladni::steps
