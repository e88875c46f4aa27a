// Reads STL, binary or text: triangles without neighbours, units or names.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "io/scan.h"
#include "io/surface/triangles.h"

namespace chladni::io {
namespace {

constexpr std::size_t kHeader = 80, kTriangle = 50;

std::uint32_t claimed_count(std::string_view bytes) {
  Scanner scanner(bytes.substr(kHeader));
  return Values(scanner, Encoding::little_endian).next<std::uint32_t>("the number of triangles");
}

// Whether the file is binary. The size decides, not the word "solid", because many binary files
// also start with this word.
bool has_binary_size(std::string_view bytes) {
  return bytes.size() >= kHeader + 4 &&
         bytes.size() == kHeader + 4 + kTriangle * std::size_t{claimed_count(bytes)};
}

bool looks_like_text(std::string_view bytes) {
  Scanner scanner(bytes);
  return upper(scanner.word()) == "SOLID" &&
         bytes.substr(0, 4096).find('\0') == std::string_view::npos;
}

[[noreturn]] void refuse_size(std::string_view bytes) {
  require(!bytes.empty(), "the file is empty");
  require(bytes.size() >= kHeader + 4,
          "neither a text STL (which starts with 'solid') nor a binary one (at least 84 bytes): " +
              fmt::to_string(bytes.size()) + " bytes");
  const std::size_t room = (bytes.size() - kHeader - 4) / kTriangle;
  throw InvalidInput("the header claims " + fmt::to_string(claimed_count(bytes)) +
                     " triangles, the file's " + fmt::to_string(bytes.size()) + " bytes hold " +
                     fmt::to_string(room) + ": truncated, or no STL");
}

mesh::Surface parse_binary(std::string_view bytes, Notes* notes) {
  const std::uint32_t count = claimed_count(bytes);
  require(count > 0, "no triangle in the file, expected a closed surface");
  Scanner scanner(bytes);
  Values values(scanner, Encoding::little_endian);
  static_cast<void>(scanner.raw(kHeader + 4, "the header"));
  Triangles triangles;
  const int patch = triangles.patch("surface");
  for (std::uint32_t t = 0; t < count; ++t) {
    static_cast<void>(scanner.raw(12, "a normal"));
    std::array<std::int32_t, 3> corner{};
    for (auto& c : corner) {
      Eigen::Vector3d p;
      for (double& x : p) x = static_cast<double>(values.next<float>("a vertex"));
      if (!p.allFinite()) {
        throw InvalidInput("triangle " + fmt::to_string(t + 1) +
                           " has a coordinate that is not a finite number");
      }
      c = triangles.merged_point(p);
    }
    static_cast<void>(scanner.raw(2, "an attribute"));
    triangles.triangle(corner[0], corner[1], corner[2], patch);
  }
  return triangles.surface(notes);
}

// Reads from after "facet" to after "endfacet". The normal is not trusted, so it is not read.
void parse_facet(Scanner& scanner, Triangles& triangles, int patch) {
  static_cast<void>(scanner.rest_of_line());
  scanner.expect("outer");
  scanner.expect("loop");
  std::array<std::int32_t, 3> corner{};
  for (auto& c : corner) {
    scanner.expect("vertex");
    Eigen::Vector3d p;
    for (double& x : p) x = scanner.number("a vertex");
    c = triangles.merged_point(p);
  }
  if (const auto word = scanner.word(); upper(word) != "ENDLOOP") {
    scanner.fail("facet " + fmt::to_string(triangles.triangle_count() + 1) +
                 " has more than three vertices or is cut off: found " + shown(word) +
                 ", expected 'endloop'");
  }
  scanner.expect("endfacet");
  triangles.triangle(corner[0], corner[1], corner[2], patch);
}

std::string solid_name(std::string_view rest, int number) {
  return rest.empty() ? "solid_" + fmt::to_string(number) : std::string(rest);
}

mesh::Surface parse_text(std::string_view bytes, Notes* notes) {
  Scanner scanner(bytes);
  Triangles triangles;
  int solids = 0;
  while (!scanner.remaining().empty()) {
    const std::string_view word = scanner.word();
    if (word.empty()) break;
    if (upper(word) != "SOLID") {
      scanner.fail("found " + shown(word) + ", expected 'solid' or the end of the file");
    }
    const std::string name = solid_name(scanner.rest_of_line(), ++solids);
    int patch = -1;
    for (;;) {
      const std::string_view key = scanner.word();
      if (key.empty()) scanner.fail_truncated("'facet' or 'endsolid'");
      if (upper(key) == "ENDSOLID") break;
      if (upper(key) != "FACET") {
        scanner.fail("found " + shown(key) + ", expected 'facet' or 'endsolid'");
      }
      if (patch < 0) patch = triangles.patch(name);
      parse_facet(scanner, triangles, patch);
    }
    static_cast<void>(scanner.rest_of_line());
  }
  return triangles.surface(notes);
}

}  // namespace

mesh::Surface parse_stl(std::string_view bytes, Notes* notes) {
  if (has_binary_size(bytes)) return parse_binary(bytes, notes);
  if (looks_like_text(bytes)) return parse_text(bytes, notes);
  refuse_size(bytes);
}

}  // namespace chladni::io
