// Letters of a text in UTF-8: the painter cuts between them, and paints a "?" for what is none.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::picture {

/// Bytes of the letter at the front of `words`, which are not empty; 0: it is not UTF-8. Of the
/// forms that are too long, as of surrogates, no font has letters: they need not be told apart.
[[nodiscard]] inline std::size_t letter_size(std::string_view words) {
  const auto first = static_cast<unsigned char>(words.front());
  if (first < 0x80U) return 1;
  const std::size_t size = first >= 0xF0U && first < 0xF8U ? 4 : first >= 0xE0U ? 3 : 2;
  if (first < 0xC0U || first >= 0xF8U || words.size() < size) return 0;
  const auto goes_on = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  return std::ranges::all_of(words.substr(1, size - 1), goes_on) ? size : 0;
}

/// The letters, in their order. A byte that is part of none counts as one.
[[nodiscard]] inline std::vector<std::string_view> letters_of(std::string_view words) {
  std::vector<std::string_view> letters;
  while (!words.empty()) {
    const auto size = std::max<std::size_t>(1, letter_size(words));
    letters.push_back(words.substr(0, size));
    words.remove_prefix(size);
  }
  return letters;
}

/// The words, with "?" for each letter that is not ASCII and that `has` does not know, and for each
/// byte that is part of no letter.
[[nodiscard]] inline std::string paintable(std::string_view words,
                                           const std::function<bool(std::string_view)>& has) {
  std::string result;
  for (const auto letter : letters_of(words)) {
    const bool ascii = static_cast<unsigned char>(letter.front()) < 0x80U;
    result += ascii || (letter_size(letter) > 0 && has(letter)) ? letter : "?";
  }
  return result;
}

/// The words where they fit, else as many of their letters as fit with "..." behind them.
/// @param fits  true for all shorter words, if it is for longer ones
[[nodiscard]] inline std::string shortened(const std::string& words,
                                           const std::function<bool(const std::string&)>& fits) {
  if (fits(words)) return words;
  std::vector<std::size_t> ends{0};
  for (const auto letter : letters_of(words)) ends.push_back(ends.back() + letter.size());
  const auto first_too_long = std::partition_point(
      ends.begin() + 1, ends.end(), [&](auto end) { return fits(words.substr(0, end) + "..."); });
  return words.substr(0, *(first_too_long - 1)) + "...";
}

}  // namespace chladni::picture
