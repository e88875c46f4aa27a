// Reads OFF (Geomview): points, then polygons. Colours, normals and texture places are skipped.
#include <fmt/format.h>

#include <array>

#include "base/error.h"
#include "io/scan.h"
#include "io/surface/triangles.h"

namespace chladni::io {
namespace {

// Reads the head [ST][C][N][4][n]OFF. Four or n coordinates are refused.
void read_head(Scanner& scanner) {
  const std::string_view word = scanner.word();
  if (!word.ends_with("OFF")) {
    scanner.fail("found " + shown(word) + ", expected 'OFF' (or COFF, NOFF, STOFF) at the start");
  }
  std::string_view prefix = word.substr(0, word.size() - 3);
  for (const std::string_view part : {"ST", "C", "N"}) {
    if (prefix.starts_with(part)) prefix.remove_prefix(part.size());
  }
  if (!prefix.empty()) {
    scanner.fail("found " + shown(word) + ", expected points of three coordinates: OFF, COFF, " +
                 "NOFF or STOFF");
  }
}

std::int64_t read_vertex_count(Scanner& scanner) {
  const std::string_view word = scanner.word();
  if (upper(word) == "BINARY") scanner.fail("a binary OFF, expected text: save as ASCII OFF");
  if (word.empty()) scanner.fail_truncated("the number of points");
  const auto count = integer_in(word);
  if (!count) scanner.fail("found " + shown(word) + ", expected the number of points");
  scanner.require_room(*count, "points", 6);
  return *count;
}

void read_point(Scanner& scanner, Triangles& triangles) {
  Eigen::Vector3d p;
  p[0] = scanner.number("a point");
  for (int i = 1; i < 3; ++i) {
    const std::string_view word = scanner.word_on_line();
    const auto value = number_in(word);
    if (!value) {
      scanner.fail(word.empty() ? "a point of " + fmt::to_string(i) + " coordinates, expected 3"
                                : "a point: " + not_a_number(word));
    }
    p[i] = *value;
  }
  static_cast<void>(scanner.rest_of_line());  // normal, colour, texture
  static_cast<void>(triangles.point(p));
}

void read_face(Scanner& scanner, Triangles& triangles, int patch) {
  const std::int64_t size = scanner.count("corners of a face", 2);
  std::vector<std::int32_t> corners;
  for (std::int64_t k = 0; k < size; ++k) {
    corners.push_back(triangles.corner(scanner.integer("a corner of a face"), scanner));
  }
  static_cast<void>(scanner.rest_of_line());  // colour
  triangles.face(corners, patch, scanner);
}

}  // namespace

mesh::Surface parse_off(std::string_view bytes, Notes* notes) {
  require(!trimmed(bytes).empty(), "the file is empty");
  Scanner scanner(bytes, '#');
  read_head(scanner);
  const std::int64_t points = read_vertex_count(scanner);
  const std::int64_t faces = scanner.count("faces", 4);
  static_cast<void>(scanner.rest_of_line());  // the number of edges is not used
  Triangles triangles;
  for (std::int64_t i = 0; i < points; ++i) read_point(scanner, triangles);
  const int patch = triangles.patch("surface");
  for (std::int64_t i = 0; i < faces; ++i) read_face(scanner, triangles, patch);
  if (const auto word = scanner.word(); !word.empty()) {
    scanner.fail("found " + shown(word) + " behind the last face: the counts do not fit the file");
  }
  return triangles.surface(notes);
}

}  // namespace chladni::io
