// Reads datasets 82 and 2412: what joins the nodes of a geometry.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/scan.h"
#include "io/uff/uff_datasets.h"

namespace chladni::io {
namespace {

constexpr std::array kBeams{11, 21, 22, 23, 24};  // rod, beams: a record more than other elements
constexpr long long kMostNodes = 1000;            // of an element

constexpr std::size_t kColumns = 10;  // of a whole number

// The whole numbers of a line. Numbers that fill their columns stand without blanks between them.
std::vector<std::string_view> integers_in(std::string_view line) {
  auto words = words_of(line);
  const auto runs_on = [](std::string_view word) { return word.size() > kColumns; };
  if (std::ranges::none_of(words, runs_on)) return words;
  words.clear();
  for (; !trimmed(line).empty(); line.remove_prefix(std::min(kColumns, line.size()))) {
    words.push_back(trimmed(line.substr(0, kColumns)));
  }
  return words;
}

// Reads `count` whole numbers from as many lines as they need.
std::vector<long long> integers(UffLines& lines, long long count, const char* what) {
  std::vector<long long> numbers;
  while (std::ssize(numbers) < count) {
    const auto line = lines.filled_record(what);
    for (const auto word : integers_in(line)) numbers.push_back(uff_integer(lines, word, what));
  }
  if (std::ssize(numbers) != count) {
    lines.fail(fmt::to_string(numbers.size()) + " numbers, expected " + fmt::to_string(count) +
               ": " + what);
  }
  return numbers;
}

long long count_of(UffLines& lines, std::string_view word, const char* what) {
  const auto count = uff_integer(lines, word, what);
  if (count < 0 || count > kMostNodes) {
    lines.fail(fmt::to_string(count) + " nodes, expected 0 to " + fmt::to_string(kMostNodes));
  }
  return count;
}

}  // namespace

std::vector<long long> uff_trace_line(UffLines& lines) {
  const std::string head(lines.filled_record("trace line"));
  const auto words = words_of(head);
  if (words.size() < 2) lines.fail("found " + shown(head) + ", expected three whole numbers");
  const auto count = count_of(lines, words[1], "number of nodes");
  static_cast<void>(lines.record("name of a trace line"));
  return integers(lines, count, "nodes of a trace line");
}

void read_elements_of_2412(UffLines& lines, std::vector<std::vector<long long>>& elements) {
  while (!lines.at_end_of_dataset()) {
    const std::string head(lines.record("element"));
    const auto words = words_of(head);
    if (words.size() < 6) lines.fail("found " + shown(head) + ", expected six whole numbers");
    const auto kind = uff_integer(lines, words[1], "kind of an element");
    const auto count = count_of(lines, words[5], "number of nodes");
    if (std::ranges::find(kBeams, kind) != kBeams.end()) {
      static_cast<void>(lines.filled_record("orientation of a beam"));
    }
    elements.push_back(integers(lines, count, "nodes of an element"));
  }
}

}  // namespace chladni::io
