#include <gtest/gtest.h>

#include <clocale>
#include <limits>
#include <sstream>

#include "io/read.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

std::string text_facets(const mesh::Surface& surface, Eigen::Index first, Eigen::Index count) {
  std::ostringstream out;
  for (Eigen::Index t = first; t < first + count; ++t) {
    out << " facet normal 0 0 0\n  outer loop\n";
    for (int k = 0; k < 3; ++k) {
      out << "   vertex " << surface.points.row(surface.triangles(t, k)) << "\n";
    }
    out << "  endloop\n endfacet\n";
  }
  return out.str();
}

std::string text_stl(const mesh::Surface& surface) {
  return "solid cube\n" + text_facets(surface, 0, surface.triangles.rows()) + "endsolid cube\n";
}

std::string binary_stl(const mesh::Surface& surface, std::string header = "a cube") {
  header.resize(80, ' ');
  std::string bytes = header + bytes_of(static_cast<std::uint32_t>(surface.triangles.rows()));
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i) bytes += bytes_of(0.0F);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) {
        bytes += bytes_of(static_cast<float>(surface.points(surface.triangles(t, k), i)));
      }
    }
    bytes += bytes_of(static_cast<std::uint16_t>(0x7fff));  // a colour of some programs
  }
  return bytes;
}

void expect_unit_cube(const mesh::Surface& surface) {
  EXPECT_EQ(surface.points.rows(), 8);  // 36 corners, merged: the surface is connected
  EXPECT_EQ(surface.triangles.rows(), 12);
  EXPECT_DOUBLE_EQ(mesh::enclosed_volume(surface), 1.0);
  EXPECT_EQ(surface.patch.size(), 12);
  EXPECT_EQ(surface.patch_names.size(), 1U);
}

TEST(Stl, TextAndBinaryGiveTheSameCube) {
  const auto text = parse_stl(text_stl(unit_cube()));
  const auto binary = parse_stl(binary_stl(unit_cube()));
  expect_unit_cube(text);
  expect_unit_cube(binary);
  EXPECT_EQ(text.points, binary.points);
  EXPECT_EQ(text.triangles, binary.triangles);
}

TEST(Stl, BinaryThatStartsWithSolidIsToldBySize) {
  expect_unit_cube(parse_stl(binary_stl(unit_cube(), "solid facet normal, says the header")));
}

TEST(Stl, KeepsCoordinatesToTheLastBit) {
  auto cube = unit_cube();
  cube.points.array() = cube.points.array() * 0.1 + 1e-7;
  const auto read = parse_stl(binary_stl(cube));
  for (Eigen::Index i = 0; i < read.points.size(); ++i) {
    const double x = read.points.data()[i];
    EXPECT_TRUE(x == static_cast<double>(static_cast<float>(1e-7)) ||
                x == static_cast<double>(static_cast<float>(0.1 + 1e-7)));
  }
}

TEST(Stl, NegativeZeroIsZero) {
  auto cube = unit_cube();
  auto bytes = binary_stl(cube);
  for (std::size_t corner = 84 + 12; corner + 4 <= 84 + 48; corner += 4) {
    if (bytes.substr(corner, 4) == bytes_of(0.0F)) bytes.replace(corner, 4, bytes_of(-0.0F));
  }
  expect_unit_cube(parse_stl(bytes));
}

TEST(Stl, SeveralSolidsBecomePatches) {
  const auto cube = unit_cube();
  const auto surface =
      parse_stl("solid base plate\n" + text_facets(cube, 0, 2) + "endsolid base plate\nsolid\n" +
                text_facets(cube, 2, 2) + "endsolid\nSOLID empty\nENDSOLID\nsolid sides\n" +
                text_facets(cube, 4, 8) + "endsolid sides\n");
  EXPECT_EQ(surface.patch_names, (std::vector<std::string>{"base plate", "solid_2", "sides"}));
  EXPECT_EQ(surface.patch[0], 0);
  EXPECT_EQ(surface.patch[2], 1);
  EXPECT_EQ(surface.patch[11], 2);
  EXPECT_EQ(surface.points.rows(), 8);
}

TEST(Stl, AcceptsWhatProgramsWrite) {
  const std::string plain = text_stl(unit_cube());
  std::string crlf, capitals = plain;
  for (const char c : plain) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_unit_cube(parse_stl(crlf));
  expect_unit_cube(parse_stl(capitals));
  expect_unit_cube(parse_stl("\xEF\xBB\xBF" + plain));
  expect_unit_cube(parse_stl(replaced(plain, "vertex 0 0 0", "vertex +0.0E+00 -0 1e-400")));
  expect_unit_cube(parse_stl(replaced(plain, "normal 0 0 0", "normal nan nan nan")));
}

TEST(Stl, NumbersDoNotDependOnTheLocale) {
  const char* const before = std::setlocale(LC_ALL, nullptr);
  const std::string kept = before == nullptr ? "C" : before;
  const bool has_german = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  auto cube = unit_cube();
  cube.points *= 0.5;
  const auto surface = parse_stl(text_stl(cube));
  std::setlocale(LC_ALL, kept.c_str());
  EXPECT_DOUBLE_EQ(mesh::enclosed_volume(surface), 0.125);
  if (!has_german) GTEST_SKIP() << "locale de_DE.UTF-8 is not installed: read under C only";
}

TEST(Stl, RefusesCommaDecimalsWithTheLine) {
  const std::string bad = replaced(text_stl(unit_cube()), "vertex 0 1 0", "vertex 0 1,5 0");
  const std::string message = refusal([&] { return parse_stl(bad); });
  EXPECT_TRUE(says(message, "line 5: "));
  EXPECT_TRUE(says(message, "found '1,5', expected a number with a decimal point"));
}

TEST(Stl, RefusesNumbersThatAreNotFinite) {
  const std::string text = text_stl(unit_cube());
  for (const char* word : {"nan", "inf", "-INF", "1e999"}) {
    const std::string bad = replaced(text, "vertex 0 1 0", std::string("vertex 0 ") + word + " 0");
    const std::string message = refusal([&] { return parse_stl(bad); });
    EXPECT_TRUE(says(message, "line 5: "));
    EXPECT_TRUE(says(message, "expected a finite number"));
  }
  auto bytes = binary_stl(unit_cube());
  bytes.replace(84 + 50 * 6 + 24, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_TRUE(says(refusal([&] { return parse_stl(bytes); }), "triangle 7 "));
}

TEST(Stl, RefusesACountThatTheFileCannotHold) {
  auto bytes = binary_stl(unit_cube());
  bytes.replace(80, 4, bytes_of(std::uint32_t{4294967295U}));
  const std::string message = refusal([&] { return parse_stl(bytes); });
  EXPECT_TRUE(says(message, "claims 4294967295 triangles"));
  EXPECT_TRUE(says(message, "hold 12"));
}

TEST(Stl, RefusesEveryTruncation) {
  const std::string binary = binary_stl(unit_cube()), text = text_stl(unit_cube());
  for (std::size_t size = 0; size < binary.size(); ++size) {
    EXPECT_THROW(static_cast<void>(parse_stl(binary.substr(0, size))), InvalidInput) << size;
  }
  for (std::size_t size = 0; size + sizeof("endsolid cube") < text.size(); ++size) {
    EXPECT_THROW(static_cast<void>(parse_stl(text.substr(0, size))), InvalidInput) << size;
  }
}

TEST(Stl, RefusesWhatIsNoTriangle) {
  const std::string text = text_stl(unit_cube());
  EXPECT_TRUE(says(
      refusal([&] { return parse_stl(replaced(text, "  endloop", "vertex 9 9 9\n endloop")); }),
      "facet 1 has more than three vertices"));
  EXPECT_TRUE(says(refusal([&] { return parse_stl(replaced(text, "outer", "inner")); }),
                   "line 3: found 'inner', expected 'outer'"));
  EXPECT_TRUE(says(refusal([] { return parse_stl("solid a\nendsolid a\n"); }), "no triangle"));
  EXPECT_TRUE(says(refusal([] { return parse_stl(std::string(84, '\0')); }), "no triangle"));
  EXPECT_TRUE(says(refusal([] { return parse_stl(""); }), "empty"));
  EXPECT_TRUE(says(refusal([] { return parse_stl("<html>not found</html>"); }), "22 bytes"));
}

}  // namespace
}  // namespace chladni::io
