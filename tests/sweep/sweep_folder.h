// A folder with a base study, a plan and a program that only pretends to solve.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "study/sweep_plan.h"

namespace chladni::sweep {

inline void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

inline std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline const std::string kBase = R"(title = "a plate"
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }

[[sensor]]
name = "s1"
at = ["-250 mm", "150 mm"]
direction = "z"
)";

inline const std::string kPlan = R"(title = "plates"
base = "base.toml"

[[axis]]
key = "geometry.plate.thickness"
values = ["16 mm", "20 mm", "24 mm"]

[[axis]]
name = "modulus"
key = "material.youngs_modulus"
from = "60 GPa"
to = "80 GPa"
count = 2

[[result]]
name = "first"
file = "modes.json"
at = "modes.1.frequency_hz"
unit = "Hz"
better = "more"

[[result]]
name = "mass"
file = "modes.json"
at = "mass_kg"
better = "less"
)";

// Notes each call in `calls`. A study with "24 mm" is refused, one with "99 mm" kills its process.
inline const std::string kProgram = R"(#!/bin/sh
echo "$2" >> "$(dirname "$0")/calls"
if grep -q '24 mm' "$2"; then echo "error: it is too thick" >&2; exit 3; fi
if grep -q '99 mm' "$2" && [ ! -e "$(dirname "$0")/mended" ]; then kill -9 $$; fi
grep -q '16 mm' "$2" && f=160 || f=200
printf '{"modes": [{"frequency_hz": 0}, {"frequency_hz": %s}], "mass_kg": 4.5}\n' $f > "$4/modes.json"
)";

class SweepFolder {
 public:
  explicit SweepFolder(const std::string& name, const std::string& plan = kPlan)
      : path_(std::filesystem::temp_directory_path() /
              ("chladni_sweep_" + std::to_string(getpid()) + "_" + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
    write(path_ / "base.toml", kBase);
    write(path_ / "plan.toml", plan);
    write(path_ / "program", kProgram);
    std::filesystem::permissions(path_ / "program", std::filesystem::perms::owner_all);
  }
  ~SweepFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SweepFolder(const SweepFolder&) = delete;
  SweepFolder& operator=(const SweepFolder&) = delete;
  SweepFolder(SweepFolder&&) = delete;
  SweepFolder& operator=(SweepFolder&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] study::SweepPlan plan() const { return study::read_sweep(path_ / "plan.toml"); }
  /// How often the program was called.
  [[nodiscard]] long calls() const {
    const auto text = content(path_ / "calls");
    return std::count(text.begin(), text.end(), '\n');
  }

 private:
  std::filesystem::path path_;
};

}  // namespace chladni::sweep
