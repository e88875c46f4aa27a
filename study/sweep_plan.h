// A plan of many studies: one that all extend, and the axes along which they differ.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/toml/toml_tree.h"

namespace chladni::study {

/// Most variants of a plan.
inline constexpr long long kMostVariants = 100'000;

/// One point of an axis: what it is called in tables, and the keys that it sets.
struct AxisPoint {
  std::string label;  ///< "20 mm", "corners"
  TomlNode sets;      ///< a document with these keys alone
};

/// An axis between two numbers, which a sample takes anywhere between them.
struct AxisRange {
  double from = 0.0, to = 0.0;  ///< in the unit as written
  bool is_logarithmic = false;
  std::string unit;  ///< " mm", with its space; empty: a bare number
};

struct SweepAxis {
  std::string name;
  std::string key;                ///< "geometry.plate.thickness"; empty: an axis of choices
  std::vector<AxisPoint> points;  ///< of the grid; a range without a count has none
  std::optional<AxisRange> range;
};

/// A number that is gathered from each variant's results.
struct SweepResult {
  enum class Better { none, more, less };
  std::string name;
  std::string file;  ///< "modes.json"
  std::string at;    ///< "modes.6.frequency_hz": keys, and places in arrays counted from 0
  std::string unit;  ///< of the head of its column
  Better better = Better::none;
};

struct SweepPlan {
  std::filesystem::path file;
  std::string name, title;
  std::filesystem::path base;  ///< the study that all variants extend
  std::string verb;            ///< "modes", "place", ...
  std::vector<SweepAxis> axes;
  std::vector<SweepResult> results;
  long long sample_count = 0;  ///< 0: the whole grid
  unsigned seed = 1;           ///< of the sample
};

/// A document in which `key` alone stands: "geometry.plate.thickness", "sensor[s1].at".
/// @throws InvalidInput  not such a key
[[nodiscard]] TomlNode document_with(std::string_view key, const TomlNode& value);

/// The value at a share of the range, 0 to 1, as a study writes it.
[[nodiscard]] TomlNode value_on(const AxisRange& range, double share);

/// Reads a plan (docs/reference/sweeps.md). Its base lies anywhere.
/// @param gathers  results are gathered: the plan needs one
/// @throws InvalidInput  cannot be read, or is no plan: all that is wrong, each with its line
[[nodiscard]] SweepPlan read_sweep(const std::filesystem::path& file, bool gathers = true);

}  // namespace chladni::study
