// What a parser of measured data promises, whatever the bytes were.
#pragma once

#include <string_view>

#include "io/node_shapes.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"

namespace chladni::io {

[[nodiscard]] inline bool is_sound(const FrfFile& file) {
  modal::check(file.set);
  return file.set.line_count() > 0;
}

[[nodiscard]] inline bool is_sound(const TimeFile& file) {
  const auto& data = file.data;
  if (!(data.sample_time_s > 0.0) || data.records.empty()) return false;
  for (const auto& record : data.records) {
    const auto n = record.outputs.rows();
    if (n == 0 || record.inputs.rows() != n || record.references.rows() != n) return false;
    if (static_cast<std::size_t>(record.outputs.cols()) != data.outputs.size()) return false;
    if (static_cast<std::size_t>(record.inputs.cols()) != data.inputs.size()) return false;
  }
  return true;
}

// A motion may be NaN, not measured, but not infinite.
[[nodiscard]] inline bool is_sound(const NodeShapes& file) {
  for (const auto& mode : file.modes) {
    for (const auto& [node, motion] : mode.motion) {
      if (motion.real().array().isInf().any() || motion.imag().array().isInf().any()) return false;
    }
  }
  return !file.modes.empty();
}

inline FrfOptions limited(std::string_view bytes) {
  FrfOptions options;
  options.limit_bytes = (std::size_t{1} << 16U) + 64 * bytes.size();
  return options;
}

inline FrfFile read_frf_csv(std::string_view bytes) {
  return parse_frf_csv(bytes, "f.csv", limited(bytes));
}

inline FrfFile read_frf_uff(std::string_view bytes) {
  return parse_frf_uff(bytes, "f.uff", limited(bytes));
}

inline TimeFile read_time_csv(std::string_view bytes) {
  TimeOptions options;
  options.sample_time_s = 0.1;
  return parse_time_csv(bytes, "f.csv", options);
}

inline NodeShapes read_shapes_uff(std::string_view bytes) {
  return parse_node_shapes(bytes, "f.unv");
}

inline TimeFile read_time_uff(std::string_view bytes) { return parse_time_uff(bytes, "f.uff"); }

}  // namespace chladni::io
