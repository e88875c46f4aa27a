// The samples are Gmsh 4.8.4's own: two boxes, 2 x 1 x 1 ("table") and 2 x 1 x 0.5 on top of it
// ("wafer"), with the physical surfaces "top", "bottom face" and, between the two, "glue".
#include <gtest/gtest.h>

#include "io/read.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

class MshSample : public testing::TestWithParam<const char*> {};

TEST_P(MshSample, GivesTheTwoBoxes) {
  Notes notes;
  const auto body = parse_msh(sample(std::string("msh/") + GetParam()), &notes);
  EXPECT_NO_THROW(mesh::check(body));
  EXPECT_NEAR(mesh::volume(body), 3.0, 1e-12);
  EXPECT_NEAR(region_volume(body, "table"), 2.0, 1e-12);
  EXPECT_NEAR(region_volume(body, "wafer"), 1.0, 1e-12);
  EXPECT_EQ(body.region_names.size(), 2U);
  EXPECT_NEAR(patch_area(body, "top"), 2.0, 1e-12);
  EXPECT_NEAR(patch_area(body, "bottom face"), 2.0, 1e-12);
  EXPECT_NEAR(patch_area(body, "other"), 2 * 1.5 * (2 + 1), 1e-12);
  EXPECT_EQ(body.patch_names.size(), 3U);  // "glue" lies inside
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "not on the outer boundary"));
}

// The node order is right where every mid-edge and face node stands where `with_order` puts it.
TEST_P(MshSample, HasOurNodeOrder) {
  const auto body = parse_msh(sample(std::string("msh/") + GetParam()));
  auto corners = body;
  corners.tets = Cells(body.tets.leftCols(4));
  mesh::find_boundary(corners);
  const auto ours = mesh::with_order(corners, body.order());
  ASSERT_EQ(ours.tets.cols(), body.tets.cols());
  for (Eigen::Index t = 0; t < body.tets.rows(); ++t) {
    for (Eigen::Index k = 0; k < body.tets.cols(); ++k) {
      EXPECT_LT((body.points.row(body.tets(t, k)) - ours.points.row(ours.tets(t, k))).norm(), 1e-9)
          << "cell " << t << " node " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gmsh, MshSample,
                         testing::Values("box_22.msh", "box_41.msh", "box_22_binary.msh",
                                         "box_41_binary.msh", "box_22_quadratic.msh",
                                         "box_41_quadratic_binary.msh", "box_41_cubic.msh"));

TEST(Msh, TextAndBinaryAgree) {
  for (const std::string version : {"22", "41"}) {
    const auto text = parse_msh(sample("msh/box_" + version + ".msh"));
    const auto binary = parse_msh(sample("msh/box_" + version + "_binary.msh"));
    EXPECT_EQ(text.tets, binary.tets);
    EXPECT_TRUE(text.points.isApprox(binary.points, 1e-14));
  }
}

std::string format_22(bool binary, bool big_endian = false) {
  return std::string("$MeshFormat\n2.2 ") + (binary ? "1" : "0") + " 8\n" +
         (binary ? bytes_of(std::int32_t{1}, big_endian) + "\n" : "") + "$EndMeshFormat\n";
}

std::string one_tet(const std::string& nodes = "1 2 3 4",
                    const std::string& points = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n",
                    const std::string& count = "4") {
  return format_22(false) + "$Nodes\n" + count + "\n" + points +
         "$EndNodes\n$Elements\n1\n7 4 2 0 1 " + nodes + "\n$EndElements\n";
}

TEST(Msh, ReadsBigEndian) {
  std::string nodes, tet;
  for (int n = 0; n < 4; ++n) {
    nodes += bytes_of(std::int32_t{n + 1}, true);
    for (int i = 1; i <= 3; ++i) nodes += bytes_of(i == n ? 1.0 : 0.0, true);
  }
  for (const std::int32_t x : {4, 1, 2, 7, 5, 1, 1, 2, 3, 4}) tet += bytes_of(x, true);
  const auto body = parse_msh(format_22(true, true) + "$Nodes\n4\n" + nodes +
                              "\n$EndNodes\n$Elements\n1\n" + tet + "\n$EndElements\n");
  EXPECT_NEAR(mesh::volume(body), 1.0 / 6.0, 1e-15);
  EXPECT_EQ(body.region_names, std::vector<std::string>{"volume_5"});
}

TEST(Msh, WithoutGroupsIsOneBodyWithNamedSides) {
  const auto body = parse_msh(one_tet());
  EXPECT_EQ(body.region_names, std::vector<std::string>{"body"});
  EXPECT_EQ(body.faces.rows(), 4);
  EXPECT_NEAR(patch_area(body, "bottom"), 0.5, 1e-15);
}

TEST(Msh, TurnsAMeshThatIsInsideOutAsAWhole) {
  for (const char* name : {"box_22.msh", "box_22_quadratic.msh", "box_41_cubic.msh"}) {
    auto mirrored = sample(std::string("msh/") + name);
    const auto start = mirrored.find("$Nodes"), end = mirrored.find("$EndNodes");
    std::istringstream in(mirrored.substr(start, end - start));
    std::string nodes, line;
    while (std::getline(in, line)) {  // a node's x, the third last number of its line, changes sign
      std::istringstream words(line);
      std::vector<std::string> all;
      for (std::string w; words >> w;) all.push_back(w);
      const bool v2 = std::string(name).find("22") != std::string::npos;
      const std::size_t x = v2 ? 1 : 0;
      if (all.size() == (v2 ? 4U : 3U)) all[x] = all[x][0] == '-' ? all[x].substr(1) : "-" + all[x];
      for (const auto& w : all) nodes += w + " ";
      nodes += "\n";
    }
    mirrored.replace(start, end - start, nodes);
    Notes notes;
    const auto body = parse_msh(mirrored, &notes);
    EXPECT_NO_THROW(mesh::check(body));
    EXPECT_NEAR(mesh::volume(body), 3.0, 1e-12);
    ASSERT_FALSE(notes.empty());
    EXPECT_TRUE(says(notes[0], "were inside out: renumbered"));
    if (body.order() == 1) continue;
    const auto straight = mesh::with_order(mesh::with_order(body, 1), body.order());
    for (Eigen::Index t = 0; t < body.tets.rows(); ++t) {
      for (Eigen::Index k = 0; k < body.tets.cols(); ++k) {
        EXPECT_LT(
            (body.points.row(body.tets(t, k)) - straight.points.row(straight.tets(t, k))).norm(),
            1e-9);
      }
    }
  }
}

TEST(Msh, NamesTheElementsThatAreInsideOutOrFlat) {
  const std::string two = replaced(replaced(one_tet(), "$Elements\n1\n", "$Elements\n2\n"),
                                   "$EndElements", "33 4 2 0 1 5 1 2 3\n$EndElements");
  const std::string good =
      replaced(replaced(two, "Nodes\n4\n", "Nodes\n5\n"), "$EndNodes", "5 0.3 0.3 -1\n$EndNodes");
  EXPECT_TRUE(says(refusal([&] { return parse_msh(replaced(good, "5 1 2 3", "5 2 1 3")); }),
                   "inside out while the others are not: element"));
  EXPECT_NO_THROW(static_cast<void>(parse_msh(good)));
  EXPECT_TRUE(says(refusal([&] { return parse_msh(one_tet("1 2 3 3")); }), "flat"));
  EXPECT_TRUE(says(refusal([&] { return parse_msh(one_tet("1 2 3 3")); }), "element 7"));
}

TEST(Msh, DropsNodesThatNoTetrahedronUses) {
  Notes notes;
  const auto body =
      parse_msh(one_tet("1 2 3 4", "9 8 8 8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", "5"), &notes);
  EXPECT_EQ(body.points.rows(), 4);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "1 node that no tetrahedron uses"));
}

TEST(Msh, KeepsCurvedEdgesAndTellsOfStrongOnes) {
  const std::string points =
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 %s 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n"
      "9 0 .5 .5\n10 .5 0 .5\n";
  const auto tet10 = [&](const std::string& y) {
    return replaced(one_tet("1 2 3 4 5 6 7 8 9 10", replaced(points, "%s", y), "10"), "7 4 2",
                    "7 11 2");
  };
  Notes notes;
  EXPECT_DOUBLE_EQ(parse_msh(tet10("-0.1"), &notes).points(4, 1), -0.1);
  EXPECT_TRUE(notes.empty());
  EXPECT_DOUBLE_EQ(parse_msh(tet10("-0.5"), &notes).points(4, 1), -0.5);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "element 7"));
  EXPECT_TRUE(says(refusal([&] { return parse_msh(tet10("2")); }), "folded over"));
}

TEST(Msh, RefusesCellsThatAreNoTetrahedraByName) {
  EXPECT_TRUE(says(refusal([] { return parse_msh(replaced(one_tet(), "7 4 2", "7 5 2")); }),
                   "a hexahedron (element type 5)"));
  EXPECT_TRUE(says(refusal([] { return parse_msh(replaced(one_tet(), "7 4 2", "7 18 2")); }),
                   "a quadratic prism (serendipity)"));
  EXPECT_TRUE(says(refusal([] { return parse_msh(replaced(one_tet(), "7 4 2", "7 777 2")); }),
                   "unknown element type 777"));
  EXPECT_TRUE(says(refusal([] {
                     return parse_msh(replaced(one_tet(), "7 4 2 0 1 1 2 3 4", "7 2 2 0 1 1 2 3"));
                   }),
                   "1 triangles and no tetrahedron: mesh the volume"));
}

TEST(Msh, RefusesCountsThatTheFileCannotHold) {
  EXPECT_TRUE(
      says(refusal([] { return parse_msh(replaced(one_tet(), "Nodes\n4", "Nodes\n4000000000")); }),
           "claims 4000000000 nodes"));
  EXPECT_TRUE(says(refusal([] { return parse_msh(replaced(one_tet(), "Nodes\n4", "Nodes\n-4")); }),
                   "a negative number of nodes: -4"));
  EXPECT_THROW(static_cast<void>(parse_msh(replaced(one_tet(), "Nodes\n4", "Nodes\n5"))),
               InvalidInput);
  EXPECT_TRUE(says(refusal([] { return parse_msh(replaced(one_tet(), "Nodes\n4", "Nodes\n3")); }),
                   "found '4', expected '$EndNodes'"));
  auto binary = sample("msh/box_41_binary.msh");
  const auto nodes = binary.find("$Nodes\n") + 7;
  binary.replace(nodes + 8, 8, bytes_of(std::uint64_t{1} << 62U));
  EXPECT_TRUE(says(refusal([&] { return parse_msh(binary); }), "claims 4611686018427387904 nodes"));
}

TEST(Msh, RefusesEveryTruncation) {
  for (const char* name :
       {"msh/box_22.msh", "msh/box_22_binary.msh", "msh/box_41.msh", "msh/box_41_binary.msh"}) {
    const std::string whole = sample(name);
    const std::size_t end = whole.rfind("$EndElements") + 11;
    for (std::size_t size = 0; size < end; ++size) {
      EXPECT_THROW(static_cast<void>(parse_msh(whole.substr(0, size))), InvalidInput)
          << name << size;
    }
  }
}

TEST(Msh, RefusesNodesThatAreMissingDoubleOrNotFinite) {
  EXPECT_TRUE(
      says(refusal([] { return parse_msh(one_tet("1 2 3 99")); }), "element 7 names node 99"));
  EXPECT_TRUE(says(
      refusal([] { return parse_msh(one_tet("1 2 3 4", "1 0 0 0\n2 1 0 0\n3 0 1 0\n3 0 0 1\n")); }),
      "node 3 is there twice"));
  const std::string message = refusal(
      [] { return parse_msh(one_tet("1 2 3 4", "1 0 0 0\n2 nan 0 0\n3 0 1 0\n4 0 0 1\n")); });
  EXPECT_TRUE(says(message, "line 7: "));
  EXPECT_TRUE(says(message, "found 'nan', expected a finite number"));
}

TEST(Msh, RefusesPartitionedAndForeignFiles) {
  EXPECT_TRUE(
      says(refusal([] { return parse_msh(format_22(false) + "$PartitionedEntities\n2\n0\n"); }),
           "a partitioned mesh"));
  EXPECT_TRUE(says(refusal([] { return parse_msh("$MeshFormat\n4 0 8\n$EndMeshFormat\n"); }),
                   "MSH version '4', expected 4.1 or 2.2"));
  EXPECT_TRUE(says(refusal([] { return parse_msh("$NOD\n4\n"); }), "$MeshFormat"));
  EXPECT_TRUE(says(refusal([] { return parse_msh(""); }), "empty"));
  EXPECT_TRUE(says(refusal([] { return parse_msh(format_22(false)); }), "no tetrahedron"));
}

TEST(Msh, AnElementInTwoGroupsCountsOnce) {
  Notes notes;
  const auto twice = replaced(replaced(one_tet(), "$Elements\n1\n", "$Elements\n2\n"),
                              "$EndElements", "8 4 2 3 1 1 2 3 4\n$EndElements");
  EXPECT_EQ(parse_msh(twice, &notes).tets.rows(), 1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "1 element repeated"));
}

}  // namespace
}  // namespace chladni::io
