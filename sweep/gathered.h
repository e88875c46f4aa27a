// The results of a sweep in one table.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "sweep/sweep.h"

namespace chladni::sweep {

struct GatheredRow {
  Entry entry;
  Eigen::VectorXd results;  ///< one per result of the plan; NaN where there is none
  bool on_front = false;    ///< no other variant is as good in all results and better in one
};

struct Gathered {
  std::vector<GatheredRow> rows;  ///< all variants of the plan
  long long done = 0, failed = 0, open = 0;
};

/// Rows of `values` (n × k, more is better) that no other row dominates. Equal rows are all on the
/// front; a row with a value that is not finite is not. Cost: n² k.
[[nodiscard]] std::vector<bool> pareto_front(const Eigen::MatrixXd& values);

/// The number at `place` of a JSON text: "modes.6.frequency_hz". NaN where there is none.
[[nodiscard]] double number_at(const io::Json& json, const std::string& place);

/// Reads what the variants left.
[[nodiscard]] Gathered gathered(const Sweep& sweep);

/// The counts, the front and the best of each result, for a terminal.
[[nodiscard]] std::string text(const Sweep& sweep, const Gathered& gathered);
/// Every variant: its number, state, axes, results and folder. JSON, and CSV with a head.
[[nodiscard]] io::Json json(const Sweep& sweep, const Gathered& gathered);
/// These variants, counted from 0, with their axes and states, and without results. Cost: as
/// `entry` of each. @throws InvalidInput  as `Sweep::entry`
[[nodiscard]] io::Json json(const Sweep& sweep, const std::vector<long long>& which);
[[nodiscard]] std::string csv(const Sweep& sweep, const Gathered& gathered);
/// sweep.json, table.csv and, with `pictures`, sweep.png: each result over each axis of numbers,
/// and the first two results that are compared, with the front.
/// @return the pictures that the painter could not paint, each with the reason; all else is there
std::vector<std::string> leave(const Sweep& sweep, const Gathered& gathered,
                               const std::filesystem::path& folder, bool pictures);

}  // namespace chladni::sweep
