#include "cluster/reply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "host/atomic_file.h"

namespace chladni::cluster {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestText = std::size_t{64} << 20U;

// The words of reply.txt, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  std::string_view next() {
    constexpr auto between = " \n";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(between), rest_.size()));
    const auto word = rest_.substr(0, rest_.find_first_of(between));
    rest_.remove_prefix(word.size());
    return word;
  }
  void expect(std::string_view word) {
    const auto found = next();
    require(found == word,
            fmt::format("reply.txt has \"{}\", expected \"{}\"", found.substr(0, 40), word));
  }
  double number() { return parsed<double>(); }
  long long whole() { return parsed<long long>(); }
  // A number of things of which each takes two bytes of the text at least.
  std::size_t count(std::string_view name) {
    expect(name);
    const auto value = whole();
    require(value >= 0 && static_cast<std::size_t>(value) <= rest_.size() / 2,
            fmt::format("reply.txt announces {} {}", value, name));
    return static_cast<std::size_t>(value);
  }

 private:
  template <typename Number>
  Number parsed() {
    const auto word = next();
    Number value{};
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    require(fault == std::errc() && end == word.data() + word.size(),
            fmt::format("reply.txt has \"{}\", expected a number", word.substr(0, 40)));
    return value;
  }
  std::string_view rest_;
};

double from_big_endian(const char* bytes) {
  std::array<char, sizeof(double)> word{};
  std::copy_n(bytes, word.size(), word.begin());
  if constexpr (std::endian::native == std::endian::little) std::reverse(word.begin(), word.end());
  return std::bit_cast<double>(word);
}

Eigen::MatrixXd vectors_in(const fs::path& file, Eigen::Index rows, Eigen::Index columns) {
  std::error_code fault;
  const auto size = fs::file_size(file, fault);
  const auto wanted =
      sizeof(double) * static_cast<std::uintmax_t>(rows) * static_cast<std::uintmax_t>(columns);
  require(!fault && size == wanted,
          fmt::format("{} has {} bytes, expected {}", file.filename().string(), fault ? 0 : size,
                      wanted));
  std::ifstream in(file, std::ios::binary);
  std::array<char, 8192 * sizeof(double)> block{};
  Eigen::MatrixXd vectors(rows, columns);
  double* to = vectors.data();
  for (std::uintmax_t left = wanted; left > 0;) {
    const auto bytes = std::min<std::uintmax_t>(left, block.size());
    require(static_cast<bool>(in.read(block.data(), static_cast<std::streamsize>(bytes))),
            file.filename().string() + " cannot be read");
    for (std::size_t at = 0; at < bytes; at += sizeof(double)) {
      *to++ = from_big_endian(block.data() + at);
    }
    left -= bytes;
  }
  return vectors;
}

void sort(fem::GivenModes& given) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(given.lambda.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return given.lambda(a) < given.lambda(b);
  });
  if (std::is_sorted(order.begin(), order.end())) return;
  given.lambda = given.lambda(order).eval();
  given.shapes = given.shapes(Eigen::all, order).eval();
  given.corrections = given.corrections(Eigen::all, order).eval();
}

}  // namespace

Reply read_reply(const fs::path& folder, Eigen::Index rows) {
  const std::string text = read_whole(folder / "reply.txt", kLongestText);
  Words words(text);
  Reply reply;
  auto& given = reply.given;
  for (const auto* word : {"chladni-slepc", "1", "rows"}) words.expect(word);
  const auto found = words.whole();
  require(found == rows, fmt::format("modes of {} rows, expected {}", found, rows));
  words.expect("bound");
  given.bound = words.number();
  words.expect("counted");
  given.counted = words.whole();
  words.expect("seconds");
  reply.seconds = words.number();
  reply.peak_bytes.resize(words.count("ranks"));
  for (auto& bytes : reply.peak_bytes) bytes = words.number();
  const auto shifts = words.count("shifts");
  for (std::size_t i = 0; i < 2 * shifts; ++i) static_cast<void>(words.number());
  reply.shifts = static_cast<int>(shifts);
  given.lambda.resize(static_cast<Eigen::Index>(words.count("modes")));
  for (auto& lambda : given.lambda) lambda = words.number();
  words.expect("end");
  require(given.lambda.allFinite(), "eigenvalues that are not finite");
  given.shapes = vectors_in(folder / "shapes.petsc", rows, given.lambda.size());
  given.corrections = vectors_in(folder / "corrections.petsc", rows, given.lambda.size());
  sort(given);
  return reply;
}

}  // namespace chladni::cluster
