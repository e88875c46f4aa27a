// One number for each edge or face, for any number of cells that share it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace chladni::mesh {

/// The corners of an edge (the second one twice) or of a face, ascending.
using Key = std::array<std::int32_t, 3>;

[[nodiscard]] inline Key edge_key(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b), std::max(a, b)};
}

[[nodiscard]] inline Key face_key(std::int32_t a, std::int32_t b, std::int32_t c) {
  Key key{a, b, c};
  std::sort(key.begin(), key.end());
  return key;
}

/// The result of `shared_numbers`.
struct Numbering {
  std::vector<std::int32_t> number;  ///< per key: equal keys have one number
  std::vector<std::int32_t> first;   ///< per number: the first key that has it
  std::vector<std::int32_t> uses;    ///< per number: how many keys have it
};

/// Numbers `keys` from 0 upwards in the order of their corners. All corners are in
/// [0, corner_count). Cost: linear where each corner has few keys.
[[nodiscard]] Numbering shared_numbers(const std::vector<Key>& keys, std::int32_t corner_count);

}  // namespace chladni::mesh
