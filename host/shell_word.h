// Words of a command line as a shell takes them.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace chladni {

/// In single quotes, whatever is in it.
[[nodiscard]] inline std::string shell_quoted(std::string_view word) {
  std::string quoted = "'";
  for (const char letter : word) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
  return quoted + "'";
}

/// The same only where a shell would take the word apart.
[[nodiscard]] inline std::string shell_word(const std::string& word) {
  constexpr std::string_view plain = "._/-+=:,@%";
  const bool is_plain = !word.empty() && std::ranges::all_of(word, [&](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter >= 0x80 || plain.find(letter) != plain.npos;
  });
  return is_plain ? word : shell_quoted(word);
}

}  // namespace chladni
