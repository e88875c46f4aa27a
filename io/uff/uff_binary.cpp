// Reads the numbers of dataset 58b. The stated lengths may be wrong.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/measured/measurable.h"
#include "io/scan.h"
#include "io/uff/uff_datasets.h"

namespace chladni::io {
namespace {

/// A possible layout of the bytes of n points.
struct Packing {
  std::size_t start = 0;                ///< line ends before the first byte
  std::size_t size = 0;                 ///< bytes of the numbers
  std::size_t abscissa = 0, value = 0;  ///< bytes of each number; abscissa 0: even spacing
  std::size_t skipped = 0;              ///< unused bytes after the numbers
};

/// The line with "58b".
struct Head {
  long long order = 1, format = 2, bytes = -1;
};

Head read_head(const UffLines& lines, const std::string& line) {
  auto words = words_of(line);
  const bool apart = words.size() > 1 && upper(words[1]) == "B";
  words.erase(words.begin(), words.begin() + (apart ? 2 : 1));
  if (words.size() < 4) {
    lines.fail("found " + shown(trimmed(line)) +
               ", expected 58b, byte order, format, number of "
               "lines and number of bytes");
  }
  Head head;
  head.order = uff_integer(lines, words[0], "byte order");
  head.format = uff_integer(lines, words[1], "format of numbers");
  head.bytes = uff_integer(lines, words[3], "number of bytes");
  if (head.format != 2) {
    lines.fail("format of numbers " + fmt::to_string(head.format) + ", expected 2 (IEEE 754)");
  }
  if (head.order != 1 && head.order != 2) {
    lines.fail("byte order " + fmt::to_string(head.order) +
               ", expected 1 (little endian) or 2 (big endian)");
  }
  return head;
}

// Whether the dataset's last -1, or the end of the file, follows these bytes.
bool is_followed_by_end(std::string_view rest, std::size_t at) {
  if (at > rest.size()) return false;
  rest.remove_prefix(at);
  const auto first = rest.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return rest.size() < 8;
  if (first > 16 || rest.substr(first, 2) != "-1") return false;
  const auto behind = rest.substr(first + 2, 1);
  return behind.empty() || std::string_view(" \t\r\n").find(behind) != std::string_view::npos;
}

std::vector<std::size_t> starts_of(std::string_view rest) {
  std::vector<std::size_t> starts{0};
  if (rest.starts_with("\r\n")) starts.push_back(2);
  if (rest.starts_with("\n") || rest.starts_with("\r")) starts.push_back(1);
  return starts;
}

std::vector<Packing> packings_of(std::size_t points, int ordinate_type, bool even) {
  const bool is_double = ordinate_type == 4 || ordinate_type == 6;
  const std::size_t parts = ordinate_type >= 5 ? 2 : 1;
  std::vector<Packing> result;
  const auto add = [&](std::size_t abscissa, std::size_t value) {
    result.push_back(
        {.size = points * (abscissa + parts * value), .abscissa = abscissa, .value = value});
  };
  const std::size_t value = is_double ? 8 : 4;
  add(even ? 0 : value, value);
  if (is_double && !even) add(4, value);
  return result;
}

std::optional<Packing> packing(const UffLines& lines, std::vector<Packing> packings,
                               const Head& head) {
  for (const auto start : starts_of(lines.rest())) {
    for (Packing& one : packings) {
      one.start = start;
      if (one.size <= lines.left() && is_followed_by_end(lines.rest(), start + one.size))
        return one;
    }
  }
  for (Packing& one : packings) {  // the head may state more bytes than the numbers need
    one.start = 0;
    const auto stated = static_cast<std::size_t>(std::max(head.bytes, 0LL));
    if (stated <= one.size || stated > lines.left()) continue;
    one.skipped = stated - one.size;
    if (is_followed_by_end(lines.rest(), stated)) return one;
  }
  return std::nullopt;
}

double number_at(const char* from, std::size_t size, bool big_endian) {
  std::array<char, 8> bytes{};
  std::memcpy(bytes.data(), from, size);
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  }
  if (size == 4) {
    float single = 0.0F;
    std::memcpy(&single, bytes.data(), 4);
    return static_cast<double>(single);
  }
  return std::bit_cast<double>(bytes);
}

std::vector<double> numbers_of(std::string_view bytes, const Packing& packing, bool is_complex,
                               bool big_endian) {
  std::vector<double> numbers;
  const std::size_t parts = is_complex ? 2 : 1;
  for (std::size_t at = 0; at < packing.size;) {
    const auto next = [&](std::size_t size) {
      numbers.push_back(number_at(bytes.data() + at, size, big_endian));
      at += size;
    };
    if (packing.abscissa > 0) next(packing.abscissa);
    for (std::size_t part = 0; part < parts; ++part) next(packing.value);
  }
  return numbers;
}

// The share of numbers that no instrument measures. A wrong byte order gives mostly such numbers.
double absurd_share(const std::vector<double>& numbers) {
  const auto count = std::count_if(numbers.begin(), numbers.end(), [](double value) {
    const double size = std::abs(value);
    return size != 0.0 && !(size > 1e-30 && size < 1e30);
  });
  return static_cast<double>(count) / static_cast<double>(numbers.size());
}

}  // namespace

std::vector<double> uff_binary_numbers(UffLines& lines, const std::string& head, std::size_t points,
                                       int ordinate_type, bool even,
                                       std::vector<std::string>& notes) {
  const Head said = read_head(lines, head);
  const auto packings = packings_of(points, ordinate_type, even);
  const auto found = packing(lines, packings, said);
  if (!found) {
    lines.fail(fmt::to_string(points) + " values are " + fmt::to_string(packings.front().size) +
               " bytes, the head says " + fmt::to_string(said.bytes) + " and the file has " +
               fmt::to_string(lines.left()) + " left; no -1 stands where they end" +
               (lines.left() < packings.front().size
                    ? " (the file is cut off)"
                    : " (was the file sent as text, which changes line ends?)"));
  }
  const std::string at = "dataset 58b before line " + fmt::to_string(lines.line());
  if (static_cast<std::size_t>(std::max(said.bytes, 0LL)) != found->size + found->skipped) {
    notes.push_back(at + ": its head says " + fmt::to_string(said.bytes) + " bytes, it has " +
                    fmt::to_string(found->size));
  }
  const auto bytes = lines.rest().substr(found->start, found->size);
  const bool is_complex = ordinate_type >= 5;
  auto numbers = numbers_of(bytes, *found, is_complex, said.order == 2);
  if (absurd_share(numbers) > 0.1) {
    auto swapped = numbers_of(bytes, *found, is_complex, said.order != 2);
    if (absurd_share(swapped) < 0.01) {
      notes.push_back(at + ": its head says " + (said.order == 2 ? "big" : "little") +
                      " endian, its numbers are of the other order");
      numbers = std::move(swapped);
    }
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (is_measurable(numbers[k])) continue;
    lines.fail("number " + fmt::to_string(k + 1) + ": " + not_measurable(numbers[k]));
  }
  lines.skip(found->start + found->size + found->skipped);
  return numbers;
}

}  // namespace chladni::io
