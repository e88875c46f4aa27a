// Causes of one explanation and those of another that correspond to them.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

namespace chladni::diagnosis {

/// The counterpart in `among` of each of `causes`, one each: the first that is the same, else the
/// first that is related. None if a cause has no counterpart.
/// @param is_same, is_related  of a cause and its candidate
template <typename T, typename Same, typename Related>
[[nodiscard]] std::optional<std::vector<const T*>> counterparts(const std::vector<T>& causes,
                                                                const std::vector<T>& among,
                                                                const Same& is_same,
                                                                const Related& is_related) {
  std::vector<const T*> left;
  for (const auto& one : among) left.push_back(&one);
  std::vector<const T*> partners;
  for (const auto& cause : causes) {
    auto found = std::ranges::find_if(left, [&](const T* one) { return is_same(cause, *one); });
    if (found == left.end()) {
      found = std::ranges::find_if(left, [&](const T* one) { return is_related(cause, *one); });
    }
    if (found == left.end()) return std::nullopt;
    partners.push_back(*found);
    left.erase(found);
  }
  return partners;
}

}  // namespace chladni::diagnosis
