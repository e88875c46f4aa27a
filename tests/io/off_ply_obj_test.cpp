#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "io/read.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

// The unit cube as six squares, outward.
constexpr int kSquares[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

std::string points_text(const std::string& start, const std::string& end) {
  std::ostringstream out;
  for (int i = 0; i < 8; ++i) {
    out << start << (i & 1) << " " << ((i >> 1) & 1) << " " << ((i >> 2) & 1) << end << "\n";
  }
  return out.str();
}

std::string squares_text(const std::string& start, const std::string& end, int first = 0) {
  std::ostringstream out;
  for (const auto& square : kSquares) {
    out << start;
    for (const int corner : square) out << " " << corner + first;
    out << end << "\n";
  }
  return out.str();
}

void expect_unit_cube(const mesh::Surface& surface) {
  EXPECT_EQ(surface.points.rows(), 8);
  EXPECT_EQ(surface.triangles.rows(), 12);
  EXPECT_EQ(surface.patch.size(), 12);
  EXPECT_DOUBLE_EQ(mesh::enclosed_volume(surface), 1.0);
}

double area(const mesh::Surface& surface) {
  mesh::TetMesh faces;
  faces.points = surface.points;
  faces.faces = surface.triangles;
  faces.face_patch = Eigen::VectorXi::Zero(surface.triangles.rows());
  faces.patch_names = {"all"};
  return patch_area(faces, "all");
}

std::string off_cube() { return "OFF\n8 6 12\n" + points_text("", "") + squares_text("4", ""); }

TEST(Off, ReadsTheVariantsOfTheHead) {
  expect_unit_cube(parse_off(off_cube()));
  expect_unit_cube(parse_off(replaced(off_cube(), "OFF\n8", "OFF 8")));
  expect_unit_cube(parse_off("COFF # colours\n\n# counts\n8 6 0\n" +
                             points_text("  ", " 0.5 0.5 0.5 1") + squares_text("4", " 255 0 0")));
  expect_unit_cube(parse_off("STCNOFF\n8 6 0\n" + points_text("", " 0 0 1 1 0 0 1 0.5 0.5") +
                             squares_text("4", "")));
  expect_unit_cube(parse_off(off_cube() + "# the end\n"));
}

TEST(Off, RefusesWhatItIsNot) {
  EXPECT_TRUE(says(refusal([] { return parse_off("4OFF\n8 6 0\n"); }), "three coordinates"));
  EXPECT_TRUE(says(refusal([] { return parse_off("OFF BINARY\n"); }), "save as ASCII OFF"));
  EXPECT_TRUE(says(refusal([] { return parse_off("solid cube\n"); }), "line 1: found 'solid'"));
  EXPECT_TRUE(says(refusal([] { return parse_off(""); }), "empty"));
  EXPECT_TRUE(says(refusal([] { return parse_off("OFF\n0 0 0\n"); }), "no triangle"));
}

TEST(Off, RefusesCountsAndCornersThatAreNotThere) {
  const auto with = [](const std::string& from, const std::string& to) {
    return refusal([&] { return parse_off(replaced(off_cube(), from, to)); });
  };
  EXPECT_TRUE(says(with("8 6 12", "4000000000 6 12"), "claims 4000000000 points"));
  EXPECT_TRUE(says(with("8 6 12", "-1 6 12"), "a negative number of points: -1"));
  EXPECT_TRUE(says(with("8 6 12", "8 5 12"), "behind the last face"));
  EXPECT_TRUE(says(with("4 0 2 3 1", "4 0 2 3 8"), "names point 8, expected 0 to 7"));
  EXPECT_TRUE(says(with("4 0 2 3 1", "99999 0 2 3 1"), "claims 99999 corners of a face"));
  EXPECT_TRUE(says(with("0 1 0\n", "0 1,5 0\n"),
                   "line 5: a point: found '1,5', expected a number "
                   "with a decimal point"));
  EXPECT_TRUE(says(with("0 1 0\n", "0 nan 0\n"), "line 5: "));
  EXPECT_TRUE(says(with("0 1 0\n", "0 1\n"), "line 5: a point of 2 coordinates, expected 3"));
}

TEST(Polygons, ConcaveOnesKeepTheirArea) {
  // An L of area 3 and a comb of area 5, whose fans from the first corner would leave the body.
  for (const auto& [text, expected] :
       {std::pair<std::string, double>{"OFF\n6 1 0\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n"
                                       "6 5 0 1 2 3 4\n",
                                       3.0},
        std::pair<std::string, double>{"OFF\n8 1 0\n1 2 0\n1 1 0\n2 1 0\n2 2 0\n3 2 0\n3 0 0\n"
                                       "0 0 0\n0 2 0\n8 0 7 6 5 4 3 2 1\n",
                                       5.0}}) {
    Notes notes;
    const auto surface = parse_off(text, &notes);
    EXPECT_NEAR(area(surface), expected, 1e-12);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_TRUE(says(notes[0], "1 concave polygons"));
  }
}

TEST(Polygons, WarpedOnesAreToldOf) {
  Notes notes;
  static_cast<void>(parse_off("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0.2\n0 1 0\n4 0 1 2 3\n", &notes));
  ASSERT_FALSE(notes.empty());
  EXPECT_TRUE(says(notes[0], "1 polygons are not flat"));
}

TEST(Polygons, OfTooManyCornersAreRefused) {
  std::ostringstream out;
  out << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n1001";
  for (int i = 0; i < 1001; ++i) out << " " << i % 3;
  EXPECT_TRUE(says(refusal([&] { return parse_off(out.str() + "\n"); }), "1001 corners"));
}

std::string ply_head(const std::string& format, const std::string& vertex_extra = "",
                     const std::string& face_list = "property list uchar int vertex_indices\n") {
  return "ply\nformat " + format +
         " 1.0\ncomment a cube\nobj_info made by hand\nelement vertex 8\n" +
         "property float x\nproperty float y\nproperty float z\n" + vertex_extra +
         "element face 6\n" + face_list + "end_header\n";
}

std::string binary_cube(bool big_endian) {
  std::string bytes = ply_head(big_endian ? "binary_big_endian" : "binary_little_endian",
                               "property uchar red\nproperty list ushort double weights\n",
                               "property list uint8 uint32 vertex_index\nproperty int16 flag\n"
                               "property list uchar float texcoord\n");
  for (int i = 0; i < 8; ++i) {
    for (const int x : {i & 1, (i >> 1) & 1, (i >> 2) & 1}) {
      bytes += bytes_of(static_cast<float>(x), big_endian);
    }
    bytes += "\xff" + bytes_of(std::uint16_t{2}, big_endian) + std::string(16, '\x7f');
  }
  for (const auto& square : kSquares) {
    bytes += '\4';
    for (const int corner : square)
      bytes += bytes_of(static_cast<std::uint32_t>(corner), big_endian);
    bytes += std::string(2, '\x80') + '\1' + std::string(4, '\x01');
  }
  return bytes;
}

std::string text_cube() { return ply_head("ascii") + points_text("", "") + squares_text("4", ""); }

TEST(Ply, TextAndBothByteOrdersGiveTheSameCube) {
  const auto text = parse_ply(text_cube());
  expect_unit_cube(text);
  for (const bool big_endian : {false, true}) {
    const auto binary = parse_ply(binary_cube(big_endian));
    expect_unit_cube(binary);
    EXPECT_EQ(binary.points, text.points);
    EXPECT_EQ(binary.triangles, text.triangles);
  }
}

TEST(Ply, StepsOverElementsAndPropertiesItDoesNotNeed) {
  const std::string with_edges =
      replaced(replaced(text_cube(), "end_header",
                        "element edge 1\nproperty int a\nproperty list "
                        "uchar float b\nelement nothing 4000000000\n"
                        "end_header"),
               "element vertex", "element material 1\nproperty double shine\nelement vertex");
  const std::size_t data = with_edges.find("end_header\n") + 11;
  expect_unit_cube(
      parse_ply(with_edges.substr(0, data) + "0.5\n" + with_edges.substr(data) + "7 2 0.5 0.25\n"));
  std::string crlf;
  for (const char c : text_cube()) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_unit_cube(parse_ply(crlf));
}

TEST(Ply, RefusesHeadsThatMakeNoSense) {
  const auto with = [](const std::string& from, const std::string& to) {
    return refusal([&] { return parse_ply(replaced(text_cube(), from, to)); });
  };
  EXPECT_TRUE(says(with("ply", "plx"), "does not start with 'ply'"));
  EXPECT_TRUE(says(with("ascii", "utf8"), "line 2: format 'utf8'"));
  EXPECT_TRUE(says(with("property float y", "property float q"), "lacks x, y or z"));
  EXPECT_TRUE(says(with("property float y", "property half y"), "found 'half', expected a type"));
  EXPECT_TRUE(says(with("property float y", "property float"), "a property without a name"));
  EXPECT_TRUE(says(with("vertex_indices", "corners"), "lacks the list 'vertex_indices'"));
  EXPECT_TRUE(says(with("uchar int vertex", "float int vertex"), "floating-point type"));
  EXPECT_TRUE(says(with("uchar int vertex", "uchar float vertex"), "floating-point type"));
  EXPECT_TRUE(says(with("element face", "element tristrips"), "triangle strips"));
  EXPECT_TRUE(says(with("element vertex 8", "element vertex x"), "expected a count"));
  EXPECT_TRUE(says(with("comment", "remark"), "found 'remark'"));
  EXPECT_TRUE(says(refusal([] { return parse_ply(""); }), "empty"));
}

TEST(Ply, RefusesCountsTheFileCannotHold) {
  EXPECT_TRUE(says(
      refusal([] { return parse_ply(replaced(text_cube(), "vertex 8", "vertex 4294967295")); }),
      "claims 4294967295 rows of element 'vertex'"));
  std::string bytes = replaced(binary_cube(false), "list uint8 uint32", "list int32 uint32");
  EXPECT_THROW(static_cast<void>(parse_ply(bytes)), InvalidInput);
  bytes = replaced(binary_cube(false), "vertex 8", "vertex 9223372036854775807");
  EXPECT_TRUE(says(refusal([&] { return parse_ply(bytes); }), "claims 9223372036854775807"));
}

TEST(Ply, RefusesEveryTruncation) {
  for (const std::string& whole : {text_cube(), binary_cube(false), binary_cube(true)}) {
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
      EXPECT_THROW(static_cast<void>(parse_ply(whole.substr(0, size))), InvalidInput) << size;
    }
  }
}

TEST(Ply, RefusesCoordinatesThatAreNotFinite) {
  std::string bytes = binary_cube(false);
  bytes.replace(bytes.find("end_header\n") + 11, 4,
                bytes_of(std::numeric_limits<float>::infinity()));
  EXPECT_TRUE(says(refusal([&] { return parse_ply(bytes); }), "vertex 0 has a coordinate"));
}

std::string obj_cube() { return "# a cube\n" + points_text("v ", "") + squares_text("f", "", 1); }

TEST(Obj, ReadsCornersOfEveryKind) {
  expect_unit_cube(parse_obj(obj_cube()));
  const std::string looks = "mtllib cube.mtl\nvt 0 0\nvn 0 0 1\n" + points_text("v ", " 1.0") +
                            "s off\n" + squares_text("f", "", 1);
  expect_unit_cube(parse_obj(looks));
  expect_unit_cube(parse_obj(replaced(looks, "f 1 3 4 2", "f 1/1 3/1 4/1 2/1")));
  expect_unit_cube(parse_obj(replaced(looks, "f 1 3 4 2", "f 1/1/1 3/1/1 4/1/1 2/1/1")));
  expect_unit_cube(parse_obj(replaced(looks, "f 1 3 4 2", "f 1//1 3//1 4//1 2//1")));
  expect_unit_cube(parse_obj(replaced(looks, "f 1 3 4 2", "f -8 -6 -5 -7")));
  expect_unit_cube(parse_obj(replaced(looks, "f 1 3 4 2", "f 1 3 \\\n 4 2")));
}

TEST(Obj, ReadsCornersRelativeToThePointsSoFar) {
  const auto surface = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -3 -1\n");
  EXPECT_EQ(surface.triangles.row(0), Eigen::RowVector3i(0, 1, 2));
  EXPECT_EQ(surface.triangles.row(1), Eigen::RowVector3i(0, 1, 3));
}

TEST(Obj, GroupsObjectsOrMaterialsBecomePatches) {
  const std::string faces = squares_text("f", "", 1);
  const std::size_t half = faces.find("f 3");
  const auto names = [&](const std::string& first, const std::string& second) {
    return parse_obj(points_text("v ", "") + first + faces.substr(0, half) + second +
                     faces.substr(half))
        .patch_names;
  };
  EXPECT_EQ(names("", ""), std::vector<std::string>{"surface"});
  EXPECT_EQ(names("o cube\n", ""), std::vector<std::string>{"cube"});
  EXPECT_EQ(names("g low side\n", "g rest\n"), (std::vector<std::string>{"low side", "rest"}));
  EXPECT_EQ(names("o cube\nusemtl steel\n", "usemtl glass\n"),
            (std::vector<std::string>{"steel", "glass"}));
  EXPECT_EQ(names("g a\nusemtl steel\n", "g b\nusemtl glass\n"),
            (std::vector<std::string>{"a.steel", "b.glass"}));
}

TEST(Obj, RefusesWhatItCannotMean) {
  const auto with = [](const std::string& from, const std::string& to) {
    return refusal([&] { return parse_obj(replaced(obj_cube(), from, to)); });
  };
  EXPECT_TRUE(says(with("f 1 3 4 2", "f 1 3 9 2"), "line 10: a face names point 9"));
  EXPECT_TRUE(says(with("f 1 3 4 2", "f 1 3 -9 2"), "names point -9, but there are 8"));
  EXPECT_TRUE(says(with("f 1 3 4 2", "f 1 3 0 2"), "found '0'"));
  EXPECT_TRUE(says(with("f 1 3 4 2", "f a b c"), "found 'a'"));
  EXPECT_TRUE(says(with("v 0 1 0", "v 0 1,5 0"), "line 4: a point: found '1,5'"));
  EXPECT_TRUE(says(with("v 0 1 0", "v 0 inf 0"), "expected a finite number"));
  EXPECT_TRUE(says(with("v 0 1 0", "v 0 1"), "a point of 2 coordinates"));
  EXPECT_TRUE(says(with("f 1 3 4 2", "curv 0 1 1 2"), "free-form"));
  EXPECT_TRUE(says(refusal([] { return parse_obj("\n"); }), "empty"));
  EXPECT_TRUE(says(refusal([] { return parse_obj("v 0 0 0\n"); }), "no triangle"));
}

TEST(Obj, TellsWhatItPassedOver) {
  Notes notes;
  expect_unit_cube(parse_obj(obj_cube() + "l 1 2\nf 1 2\nsparkle 3\n", &notes));
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_TRUE(says(notes[0], "1 lines and points"));
  EXPECT_TRUE(says(notes[1], "'sparkle'"));
  EXPECT_TRUE(says(notes[2], "fewer than three corners"));
}

}  // namespace
}  // namespace chladni::io
