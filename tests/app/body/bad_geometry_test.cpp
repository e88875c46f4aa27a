// Geometry that is not what it should be, one test each: what the program says, and how it ends.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/mesh/shapes.h"

namespace {

namespace fs = std::filesystem;
namespace shapes = chladni::mesh::shapes;
using chladni::mesh::Surface;

struct Ended {
  int status = -1;
  std::string said;
};

class BadGeometry : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("chladni_geometry_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// `chladni VERB` of a study of this file.
  Ended run(const std::string& verb, const std::string& name, const std::string& bytes,
            const std::string& mesh = "") const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return run_there(verb, folder_ / name, mesh);
  }
  Ended run_there(const std::string& verb, const fs::path& file,
                  const std::string& mesh = "") const {
    const bool own_unit = file.extension() == ".step";
    std::ofstream(folder_ / "study.toml")
        << "title = \"t\"\ngeometry = { file = \"" << file.filename().string() << "\""
        << (own_unit ? "" : ", unit = \"mm\"") << " }\n"
        << "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 "
           "kg/m^3\" }\nmodes = { count = 4 }\n"
        << mesh;
    const std::string command = "cd " + folder_.string() +
                                " && " CHLADNI_BINARY_DIR "/bin/chladni " + verb +
                                " study.toml -o out > said 2>&1";
    const int status = std::system(command.c_str());
    std::ifstream in(folder_ / "said");
    std::ostringstream text;
    text << in.rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text.str()};
  }

  fs::path folder_;
};

/// Text STL, coordinates as they are (the studies say mm).
std::string stl(const Surface& surface) {
  std::ostringstream text;
  text.precision(17);
  text << "solid body\n";
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int i : surface.triangles.row(t)) text << "vertex " << surface.points.row(i) << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid body\n";
  return text.str();
}

std::string binary_stl(const Surface& surface, const std::string& header, std::uint32_t count) {
  std::string bytes = header + std::string(80 - header.size(), ' ');
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(count);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) add(0.0F);
    for (const int i : surface.triangles.row(t)) {
      for (const double x : surface.points.row(i)) add(static_cast<float>(x));
    }
    add(std::uint16_t{0});
  }
  return bytes;
}

Surface block() { return shapes::box({0, 0, 0}, {80, 60, 20}); }

Surface without(Surface surface, const std::set<Eigen::Index>& triangles) {
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (triangles.contains(t)) continue;
    surface.triangles.row(kept) = surface.triangles.row(t);
    surface.patch[kept++] = surface.patch[t];
  }
  surface.triangles.conservativeResize(kept, 3);
  surface.patch.conservativeResize(kept);
  return surface;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect(const Ended& run, int status, const std::vector<std::string>& words) {
  EXPECT_EQ(run.status, status) << run.said;
  for (const std::string& word : words) {
    EXPECT_NE(run.said.find(word), std::string::npos) << "\"" << word << "\" is not in\n"
                                                      << run.said;
  }
}

/// Two tetrahedra on one face, as an Abaqus deck; `last` is the second one's connectivity.
std::string deck(const std::string& last = "2, 2, 3, 4, 5") {
  return "*NODE\n1, 0, 0, 0\n2, 10, 0, 0\n3, 0, 10, 0\n4, 0, 0, 10\n5, 10, 10, 10\n"
         "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n" +
         last + "\n";
}

TEST_F(BadGeometry, AnOpenSurfaceIsRefusedWithItsHoles) {
  expect(run("mesh", "open.stl", stl(without(block(), {10, 11}))), 3,
         {"the surface is open: 1 hole", "near (40, 30, 20) mm", "4 edges", "repair = \"fill\""});
}

TEST_F(BadGeometry, AnOpenSurfaceIsFilledOnRequest) {
  expect(run("mesh", "open.stl", stl(without(block(), {10, 11})), "mesh = { repair = \"fill\" }\n"),
         0, {"1 hole filled with 2 triangles"});
}

TEST_F(BadGeometry, NonManifoldEdgesAreRefusedWithTheirPlaces) {
  Surface touching = shapes::both(block(), shapes::box({80, 60, 0}, {120, 90, 20}));
  expect(
      run("mesh", "touching.stl", stl(touching)), 3,
      {"not a manifold: 1 edge with more than two triangles", "(80, 60, 0) mm", "unite the parts"});
}

TEST_F(BadGeometry, SelfIntersectionsAreRefusedBeforeTheMesher) {
  expect(run("mesh", "crossed.stl",
             stl(shapes::both(block(), shapes::box({20, 20, 10}, {40, 40, 40})))),
         3, {"the surface intersects itself", "pairs of triangles", "near ("});
}

TEST_F(BadGeometry, InsideOutIsTurnedAloud) {
  Surface turned = block();
  turned.triangles.col(1).swap(turned.triangles.col(2));
  expect(run("mesh", "turned.stl", stl(turned)), 0, {"the surface was inside out: turned"});
}

TEST_F(BadGeometry, MixedOrientationIsTurnedAloud) {
  Surface mixed = block();
  shapes::turn(mixed, 3);
  shapes::turn(mixed, 8);
  expect(run("mesh", "mixed.stl", stl(mixed)), 0,
         {"2 of 12 triangles faced the wrong way: turned"});
}

TEST_F(BadGeometry, DuplicateAndDegenerateTrianglesAreRemovedAndCounted) {
  std::string text = stl(block());
  const auto first = text.find("facet"), second = text.find("facet", text.find("endfacet") + 8);
  const std::string again = text.substr(first, second - first);
  const std::string flat =
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 40 0 0\nvertex "
      "80 0 0\nendloop\nendfacet\n";
  text.insert(second, again + flat);
  expect(run("mesh", "double.stl", text), 0,
         {"removed 1 duplicate triangle", "degenerate triangle", "more than 1 %"});
}

TEST_F(BadGeometry, NoThicknessIsVolumeZero) {
  expect(run("mesh", "sheet.stl", stl(shapes::box({0, 0, 5}, {80, 60, 5}))), 3,
         {"volume 0: all points lie in one plane", "give the body a thickness"});
}

TEST_F(BadGeometry, WallsOfAHundredThousandthAreRefusedWithAdvice) {
  expect(run("mesh", "foil.stl", stl(shapes::box({0, 0, 0}, {800, 800, 0.004}))), 3,
         {"walls of", "at least 1e-5 of the body", "is a dimension or its unit wrong?"});
}

TEST_F(BadGeometry, SeveralBodiesAreRefusedAndListed) {
  expect(
      run("mesh", "two.stl", stl(shapes::both(block(), shapes::box({200, 0, 0}, {210, 10, 10})))),
      3,
      {"2 bodies that do not touch", "9.6e+04 mm^3 around (40, 30, 10) mm",
       "1000 mm^3 around (205, 5, 5) mm", "join them"});
}

TEST_F(BadGeometry, AUnitOffByAThousandWarns) {
  expect(run("check", "large.stl", stl(shapes::scaled(block(), 1000.0))), 0,
         {"warning: ", "the body is 80 m long", "is the length unit right?"});
  expect(run("check", "small.stl", stl(shapes::scaled(block(), 0.001))), 0,
         {"warning: ", "the body is 0.08 mm long"});
}

TEST_F(BadGeometry, NumbersThatAreNotFiniteAreRefusedWithTheirPlace) {
  expect(run("mesh", "nan.stl", replaced(stl(block()), "vertex", "vertex nan 0 0 #")), 3,
         {"nan.stl", "line 4", "expected a finite number"});
  Surface bad = block();
  bad.points(bad.triangles(6, 1), 2) = std::numeric_limits<double>::infinity();
  expect(run("mesh", "inf.stl", binary_stl(bad, "binary", 12)), 3,
         {"inf.stl", "triangle ", "not a finite number"});
}

TEST_F(BadGeometry, FarFromTheOriginIsSaid) {
  expect(run("check", "far.stl", stl(shapes::moved(block(), {1e9, 0, 0}))), 0,
         {"from the origin", "digits of its coordinates are lost"});
}

TEST_F(BadGeometry, BinaryThatStartsWithSolidIsReadBySize) {
  expect(run("mesh", "b.stl", binary_stl(block(), "solid made by a program", 12)), 0,
         {"80.0 x 60.0 x 20.0 mm"});
}

TEST_F(BadGeometry, ACountLargerThanTheFileAllocatesNothing) {
  expect(run("mesh", "lie.stl", binary_stl(block(), "binary", 4294967295U)), 3,
         {"claims 4294967295 triangles", "hold 12"});
}

TEST_F(BadGeometry, CommaDecimalsNameTheCause) {
  expect(run("mesh", "comma.stl", replaced(stl(block()), "vertex 0 0 0", "vertex 0,5 0 0")), 3,
         {"comma.stl", "line ", "found '0,5'", "decimal point"});
}

TEST_F(BadGeometry, InvertedTetrahedraAreNamed) {
  expect(run("mesh", "one.inp", deck("2, 2, 4, 3, 5")), 3, {"element 2", "inside out"});
  expect(run("mesh", "sound.inp", deck()), 0, {"2 tetrahedra"});
}

TEST_F(BadGeometry, AMidNodeFarOffItsEdgeIsSaidAndAFoldRefused) {
  const auto quadratic = [](const std::string& node5) {
    return "*NODE\n1,0,0,0\n2,10,0,0\n3,0,10,0\n4,0,0,10\n5," + node5 +
           "\n6,5,5,0\n7,0,5,0\n8,0,0,5\n9,5,0,5\n10,0,5,5\n*ELEMENT, TYPE=C3D10\n"
           "1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n";
  };
  expect(run("mesh", "bent.inp", quadratic("5,-4.5,0")), 0, {"element 1", "0.3"});
  expect(run("mesh", "folded.inp", quadratic("5,9,4")), 3, {"element 1"});
}

TEST_F(BadGeometry, NodesWithoutElementAreDroppedAloud) {
  expect(run("mesh", "loose.inp", replaced(deck(), "*ELEMENT", "6, 99, 99, 99\n*ELEMENT")), 0,
         {"1 node", "no tetrahedron"});
}

TEST_F(BadGeometry, IslandsAreNamed) {
  expect(run("mesh", "islands.inp",
             replaced(deck("2, 6, 7, 8, 9"), "*ELEMENT",
                      "6, 100, 0, 0\n7, 110, 0, 0\n8, 100, 10, 0\n9, 100, 0, 10\n*ELEMENT")),
         3,
         {"2 bodies share no node", "centre (2.5, 2.5, 2.5) mm", "centre (102.5, 2.5, 2.5) mm",
          "join them"});
}

TEST_F(BadGeometry, ABrokenStepFileIsOneClearLine) {
  const fs::path sound = CHLADNI_SOURCE_DIR "/tests/io/data/plate_with_hole.step";
  std::ifstream in(sound);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  for (const std::string& bytes :
       {whole.substr(0, whole.size() / 2), whole.substr(0, 200), std::string("no step at all"),
        replaced(whole, "ADVANCED_FACE", "ADVANCED_FOLLY")}) {
    const Ended ended = run("mesh", "broken.step", bytes);
    EXPECT_TRUE(ended.status == 3 || ended.status == 6) << ended.status << "\n" << ended.said;
    EXPECT_NE(ended.said.find("broken.step"), std::string::npos) << ended.said;
  }
}

}  // namespace
