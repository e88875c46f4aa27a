#include "study/problems.h"

#include <fmt/format.h>

#include <numeric>

#include "base/error.h"

namespace chladni::study {
namespace {

constexpr std::size_t kShown = 20;

/// Insertions, deletions, changes and swaps of neighbours that turn a into b.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        now[j] = std::min(now[j], before[j - 2] + 1);
      }
    }
    before = last;
    last = now;
  }
  return last.back();
}

}  // namespace

void Problems::add(int line, int column, const std::string& message) {
  found_.push_back({line, column, message});
}

void Problems::throw_if_any() const {
  if (found_.empty()) return;
  auto sorted = found_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, sorted.size()); ++i) {
    const auto& p = sorted[i];
    if (i > 0) text += '\n';
    text +=
        file_ + ":" + fmt::to_string(p.line) + ":" + fmt::to_string(p.column) + ": " + p.message;
  }
  if (sorted.size() > kShown) {
    text += "\n" + file_ + ": and " + fmt::to_string(sorted.size() - kShown) + " more";
  }
  throw InvalidInput(text);
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(1, (word.size() + 2) / 3) + 1;
  for (const auto& name : known) {
    const std::size_t wrong = edits(word, name);
    if (wrong < fewest) {
      fewest = wrong;
      nearest = name;
    }
  }
  return nearest;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += '"' + names[i] + '"';
  }
  return text;
}

}  // namespace chladni::study
