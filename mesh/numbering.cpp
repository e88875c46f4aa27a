#include "mesh/numbering.h"

#include <utility>

namespace chladni::mesh {

Numbering shared_numbers(const std::vector<Key>& keys, std::int32_t corner_count) {
  // A counting sort by the lowest corner comes first. Then the few keys of each corner are sorted.
  std::vector<std::size_t> begin(static_cast<std::size_t>(corner_count) + 1, 0);
  for (const Key& key : keys) ++begin[static_cast<std::size_t>(key[0]) + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  std::vector<std::pair<Key, std::int32_t>> sorted(keys.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    sorted[next[static_cast<std::size_t>(keys[i][0])]++] = {keys[i], static_cast<std::int32_t>(i)};
  }
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin[c]),
              sorted.begin() + static_cast<std::ptrdiff_t>(begin[c + 1]));
  }
  Numbering result;
  result.number.resize(keys.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted[i].first != sorted[i - 1].first) {
      result.first.push_back(sorted[i].second);
      result.uses.push_back(0);
    }
    ++result.uses.back();
    result.number[static_cast<std::size_t>(sorted[i].second)] =
        static_cast<std::int32_t>(result.first.size() - 1);
  }
  return result;
}

}  // namespace chladni::mesh
