#include <gtest/gtest.h>

#include "io/read.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

// Two tetrahedra on one another: 10 above z = 0 (corner at z = 1), 20 below (corner at z = -2).
const std::string kNodes =
    "*Heading\n a comment of the program\n** a comment\n*NODE, NSET=Nall\n"
    "1, 0., 0., 0.\n 2, +1.0E+0, 0., 0.\n3, 0., 1.0D0, 0.\n4, 0., 0., 1.\n5, 0., 0., -2.\n";
const std::string kTets = "*Element, type=C3D4, elset=Eall\n10, 1, 2, 3, 4\n20, 1, 3, 2, 5\n";

// 4 corners, then the middles of the edges 12 23 31 14 24 34.
const std::string kQuadratic =
    "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n"
    "9,.5,0,.5\n10,0,.5,.5\n*ELEMENT, TYPE=C3D10M\n7, 1, 2, 3, 4, 5,\n6, 7, 8,\n9, 10\n";

TEST(Inp, ReadsNodesElementsAndTheirNumbers) {
  const auto body = parse_inp(kNodes + kTets);
  EXPECT_NO_THROW(mesh::check(body));
  EXPECT_NEAR(mesh::volume(body), 1.0 / 6 + 2.0 / 6, 1e-15);
  EXPECT_EQ(body.points.rows(), 5);
  EXPECT_EQ(body.region_names, std::vector<std::string>{"Eall"});
  EXPECT_EQ(body.faces.rows(), 6);
}

TEST(Inp, QuadraticCellsGoOnOverLinesInOurOrder) {
  Notes notes;
  const auto body = parse_inp(kQuadratic, &notes);
  EXPECT_TRUE(notes.empty());
  ASSERT_EQ(body.tets.cols(), 10);
  const auto straight = mesh::with_order(mesh::with_order(body, 1), 2);
  for (Eigen::Index k = 0; k < 10; ++k) {
    EXPECT_LT((body.points.row(body.tets(0, k)) - straight.points.row(straight.tets(0, k))).norm(),
              1e-15);
  }
}

// The same two boxes as in the MSH tests, as Gmsh 4.8.4 writes them for Abaqus: triangles and
// physical groups are element sets.
TEST(Inp, ReadsWhatGmshWrites) {
  Notes notes;
  const auto body = parse_inp(sample("inp/box_gmsh_quadratic.inp"), &notes);
  EXPECT_NO_THROW(mesh::check(body));
  EXPECT_EQ(body.order(), 2);
  EXPECT_NEAR(region_volume(body, "table"), 2.0, 1e-12);
  EXPECT_NEAR(region_volume(body, "wafer"), 1.0, 1e-12);
  EXPECT_NEAR(patch_area(body, "top"), 2.0, 1e-12);
  EXPECT_NEAR(patch_area(body, "bottom_face"), 2.0, 1e-12);
  EXPECT_NEAR(patch_area(body, "other"), 9.0, 1e-12);
}

TEST(Inp, SectionsBecomeRegions) {
  const auto body = parse_inp(kNodes + kTets +
                              "*ELSET, ELSET=upper\n10,\n*ELSET, ELSET=lower, GENERATE\n15, 25, 5\n"
                              "*SOLID SECTION, ELSET=UPPER, MATERIAL=steel\n*Solid Section, "
                              "material=glass, elset=Lower\n1.,\n");
  EXPECT_NEAR(region_volume(body, "UPPER"), 1.0 / 6, 1e-15);
  EXPECT_NEAR(region_volume(body, "Lower"), 2.0 / 6, 1e-15);
}

TEST(Inp, ElementsWithoutSectionAreToldOf) {
  Notes notes;
  const auto body =
      parse_inp(kNodes + kTets + "*ELSET, ELSET=a\n10\n*SOLID SECTION, ELSET=a\n", &notes);
  EXPECT_EQ(body.region_names, (std::vector<std::string>{"a", "Eall"}));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "1 elements without *SOLID SECTION"));
}

TEST(Inp, SurfacesBecomePatches) {
  const auto body = parse_inp(kNodes + kTets +
                              "*SURFACE, NAME=left, TYPE=ELEMENT\n10, S4\n20, S2\n"
                              "*ELSET, ELSET=low\n20\n*SURFACE, NAME=slope\nlow, S3\n");
  EXPECT_NEAR(patch_area(body, "left"), 0.5 + 1.0, 1e-15);  // the faces in the plane x = 0
  EXPECT_NEAR(patch_area(body, "slope"), 1.5, 1e-15);       // 1/2 |(-1, 0, -2) x (0, 1, 2) ...|
  EXPECT_EQ(body.patch_names.size(), 3U);
}

TEST(Inp, ASurfaceWithoutFacesTakesTheOuterOnes) {
  Notes notes;
  const auto body =
      parse_inp(kNodes + kTets + "*SURFACE, NAME=lower\nlow,\n*ELSET, ELSET=low\n20\n", &notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ((body.face_patch.array() == body.face_patch[0]).count(), 3);
  EXPECT_EQ(body.patch_names, (std::vector<std::string>{"lower", "other"}));
}

TEST(Inp, NodeSetsBecomePatches) {
  Notes notes;
  const auto body =
      parse_inp(kNodes + kTets + "*NSET, NSET=front\n1, 2,\n4, 5\n*NSET, NSET=point\n1\n", &notes);
  EXPECT_NEAR(patch_area(body, "front"), 0.5 + 1.0, 1e-15);                   // in the plane y = 0
  EXPECT_EQ(body.patch_names, (std::vector<std::string>{"front", "other"}));  // not Nall
  EXPECT_TRUE(notes.empty());
}

TEST(Inp, SetsOfSetsEndEvenWhereTheyNameThemselves) {
  const auto body = parse_inp(kNodes + kTets +
                              "*ELSET, ELSET=a\nb, 10\n*ELSET, ELSET=b\na, 20\n"
                              "*SOLID SECTION, ELSET=a\n");
  EXPECT_EQ(body.region_names, std::vector<std::string>{"a"});
}

// FreeCAD lists the sets of *ELEMENT by name.
TEST(Inp, ASetMayListSetsOfElements) {
  const std::string two = replaced(kTets, "20, 1", "*ELEMENT, TYPE=C3D4, ELSET=Low\n20, 1");
  const auto body = parse_inp(kNodes + two +
                              "*ELSET, ELSET=Mat1\nEall,\n*ELSET, ELSET=Mat2\nlow\n"
                              "*SURFACE, NAME=slope\nMat2, S3\n"
                              "*SOLID SECTION, ELSET=Mat1\n*SOLID SECTION, ELSET=Mat2\n");
  EXPECT_NEAR(region_volume(body, "Mat1"), 1.0 / 6, 1e-15);
  EXPECT_NEAR(region_volume(body, "Mat2"), 2.0 / 6, 1e-15);
  EXPECT_NEAR(patch_area(body, "slope"), 1.5, 1e-15);
  const auto shared = parse_inp(kNodes + two + "*ELSET, ELSET=p\nEall\n*ELSET, ELSET=q\nLow\n");
  EXPECT_EQ(shared.region_names, (std::vector<std::string>{"p", "q"}));
  const auto grouped = parse_inp(kNodes + two + "*ELSET, ELSET=whole\nEall, Low\n");
  EXPECT_EQ(grouped.region_names, (std::vector<std::string>{"Eall", "Low"}));
}

TEST(Inp, SetsOfOneNameAreUnited) {
  const auto body =
      parse_inp(kNodes + replaced(kTets, "20, 1", "*ELEMENT, TYPE=C3D4\n20, 1") +
                "*ELSET, ELSET=EALL\n20\n*SURFACE, NAME=skin\neall\n*SOLID SECTION, ELSET=Eall\n");
  EXPECT_EQ(body.region_names, std::vector<std::string>{"Eall"});
  EXPECT_EQ(body.patch_names, std::vector<std::string>{"skin"});
}

TEST(Inp, MembersThatAreNotThereAreToldOf) {
  EXPECT_TRUE(
      says(refusal([] { return parse_inp(kNodes + kTets + "*ELSET, ELSET=lower\n20, gone\n"); }),
           "*ELSET lists what is no element and no set of elements of this file: 'gone' of "
           "'lower'"));
  Notes notes;
  static_cast<void>(parse_inp(kNodes + kTets + "*NSET, NSET=front\n1, 2, 4, gone\n", &notes));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "no set of nodes of this file, left out: 'gone' of 'front'"));
}

TEST(Inp, ANodeSurfaceHasAreasBesideItsNodes) {
  Notes notes;
  const auto body = parse_inp(kNodes + kTets +
                                  "*NSET, NSET=three\n1, 2, 4\n*SURFACE, NAME=y, TYPE=NODE\n"
                                  "three, 1.5\n5, 3\n",
                              &notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_NEAR(patch_area(body, "three"), 0.5, 1e-15);
  EXPECT_NEAR(patch_area(body, "y"), 1.0, 1e-15);
}

TEST(Inp, ADotIsPartOfAName) {
  const auto body = parse_inp(kNodes + kTets +
                              "*ELSET, ELSET=plate_2.5mm\n10\n*ELSET, ELSET=rib_2.5mm\n20\n"
                              "*SOLID SECTION, ELSET=plate_2.5mm\n"
                              "*SOLID SECTION, ELSET=rib_2.5mm\n");
  EXPECT_NEAR(region_volume(body, "plate_2.5mm"), 1.0 / 6, 1e-15);
  EXPECT_NEAR(region_volume(body, "rib_2.5mm"), 2.0 / 6, 1e-15);
}

TEST(Inp, NamesMayBeQuotedInDataLines) {
  const auto body = parse_inp(kNodes + kTets +
                              "*ELSET, ELSET=\"the low one\"\n20\n*ELSET, ELSET=low\n"
                              "\"the low one\"\n*SURFACE, NAME=slope\n\"The low one\", S3\n"
                              "*SOLID SECTION, ELSET=low\n");
  EXPECT_NEAR(region_volume(body, "low"), 2.0 / 6, 1e-15);
  EXPECT_NEAR(patch_area(body, "slope"), 1.5, 1e-15);
}

TEST(Inp, HugeRangesCostNothing) {
  const auto body =
      parse_inp(kNodes + kTets + "*ELSET, ELSET=all, GENERATE\n1, 9007199254740992, 1\n");
  EXPECT_EQ(body.region_names, std::vector<std::string>{"all"});
}

TEST(Inp, ReadsOnePartWithItsAssembly) {
  Notes notes;
  const auto body = parse_inp(
      "*Part, name=P\n" + replaced(kNodes, "*Heading\n a comment of the program\n", "") + kTets +
          "*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n*End Instance\n*Node\n"
          "1, 9., 9., 9.\n*Nset, nset=RP\n1\n*Nset, nset=Front, instance=P-1\n1, 2, 4, 5\n"
          "*Elset, elset=_low_S3, internal, instance=P-1\n20\n*Surface, type=ELEMENT, name=Low\n"
          "_low_S3, S3\n*End Assembly\n*Material, name=steel\n*Density\n7850.\n",
      &notes);
  EXPECT_NEAR(mesh::volume(body), 0.5, 1e-15);
  EXPECT_NEAR(patch_area(body, "Front"), 1.5, 1e-15);
  EXPECT_NEAR(patch_area(body, "Low"), 1.5, 1e-15);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "*DENSITY, *MATERIAL"));
}

// An independent instance brings its own nodes and elements. The dot parts the instance from a name
// that may have dots itself.
TEST(Inp, ReadsAnIndependentInstance) {
  Notes notes;
  const auto body = parse_inp(
      "*Part, name=P\n*End Part\n*Assembly, name=A\n*Instance, name=P.1, part=P\n" +
          replaced(kNodes, "*Heading\n a comment of the program\n", "") + kTets +
          "*Elset, elset=low_2.5\n20\n*End Instance\n*Node\n1, 9., 9., 9.\n"
          "*Elset, elset=both, instance=P.1\nP.1.low_2.5, P.1.10\n"
          "*Surface, name=slope\np.1.Low_2.5, S3\n*End Assembly\n*Solid Section, elset=both\n",
      &notes);
  EXPECT_EQ(body.points.rows(), 5);
  EXPECT_NEAR(region_volume(body, "both"), 0.5, 1e-15);
  EXPECT_NEAR(patch_area(body, "slope"), 1.5, 1e-15);
  EXPECT_TRUE(notes.empty());
}

TEST(Inp, OnlyDataOfThisReaderMustBeInTheFile) {
  const auto body = parse_inp(kNodes + kTets + "*AMPLITUDE, NAME=a, INPUT=steps.txt\n");
  EXPECT_EQ(body.tet_count(), 2);
  for (const std::string card : {"NODE", "ELEMENT, TYPE=C3D4", "NSET, NSET=a", "ELSET, ELSET=a",
                                 "SURFACE, NAME=a", "INCLUDE"}) {
    EXPECT_TRUE(says(refusal([&] { return parse_inp("*" + card + ", INPUT=data.txt\n"); }),
                     "not in this file"));
  }
}

TEST(Inp, KeywordLinesGoOnAfterAComma) {
  const auto body = parse_inp(kNodes + replaced(kTets, ", elset=", ",\n** between\nELSET = "));
  EXPECT_EQ(body.region_names, std::vector<std::string>{"Eall"});
}

TEST(Inp, RefusesOtherElementsByName) {
  for (const std::string type : {"C3D8R", "S4R", "SPRINGA", "C3D15", "C3D20", "C3D4 8", ""}) {
    const std::string message =
        refusal([&] { return parse_inp(kNodes + replaced(kTets, "C3D4", type)); });
    EXPECT_TRUE(says(message, "line 10: element type '" + type + "'"));
  }
}

TEST(Inp, RefusesDecksThatAreNotWhole) {
  EXPECT_TRUE(says(refusal([] { return parse_inp("*INCLUDE, INPUT=mesh.inp\n"); }), "*INCLUDE"));
  EXPECT_TRUE(says(refusal([] { return parse_inp("*NODE, INPUT=nodes.txt\n"); }), "*NODE"));
  EXPECT_TRUE(says(refusal([] { return parse_inp(kNodes + "*NGEN\n1, 5\n"); }), "*NGEN"));
  EXPECT_TRUE(
      says(refusal([] { return parse_inp("*Part\n*End Part\n*Part\n"); }), "several parts"));
  EXPECT_TRUE(says(refusal([] { return parse_inp("*Instance\n 1., 0., 0.\n"); }), "is moved"));
  EXPECT_TRUE(says(refusal([] { return parse_inp("*NODE, SYSTEM=C\n"); }), "cylindrical"));
  EXPECT_TRUE(says(refusal([] { return parse_inp(kNodes); }), "no tetrahedron"));
  EXPECT_TRUE(says(refusal([] { return parse_inp(" \n"); }), "empty"));
}

TEST(Inp, RefusesFieldsThatMakeNoSense) {
  const auto with = [](const std::string& from, const std::string& to) {
    return refusal([&] { return parse_inp(replaced(kNodes + kTets, from, to)); });
  };
  EXPECT_TRUE(says(with("3, 0., 1.0D0, 0.", "3, 0., 1,5, 0."), "line 7: a node of 5 fields"));
  EXPECT_TRUE(says(with("1.0D0", "nan"), "line 7: found 'nan', expected a finite number"));
  EXPECT_TRUE(says(with("1.0D0", "1.0x"), "found '1.0x', expected a number"));
  EXPECT_TRUE(says(with("3, 0., 1", "x3, 0., 1"), "found 'x3', expected a whole number from 1"));
  EXPECT_TRUE(says(with("10, 1, 2, 3, 4", "10, 1, 2, 3, 4, 5"), "element 10 has 5 nodes"));
  EXPECT_TRUE(says(with("20, 1, 3, 2, 5", "20, 1, 3, 2"), "element 20 has 3 nodes, expected 4"));
  EXPECT_TRUE(says(with("20, 1, 3, 2, 5", "20, 1, 3, 2, 6"), "element 20 names node 6"));
  EXPECT_TRUE(says(refusal([] { return parse_inp(kNodes + "*ELEMENT, TYPE=C3D4\n,\n"); }),
                   "line 11: an element without numbers"));
  EXPECT_TRUE(says(with("20, 1, 3, 2, 5", "10, 1, 3, 2, 5"), "element 10 is there twice"));
  EXPECT_TRUE(says(with("5, 0., 0., -2.", "4, 0., 0., -2."), "node 4 is there twice"));
  EXPECT_TRUE(
      says(with("20, 1, 3, 2, 5", "20, 1, 2, 3, 5"), "inside out while the others are not"));
}

TEST(Inp, RefusesSetsAndFacesThatAreNotThere) {
  const auto after = [](const std::string& text) {
    return refusal([&] { return parse_inp(kNodes + kTets + text); });
  };
  EXPECT_TRUE(says(after("*SOLID SECTION, ELSET=gone\n"), "unknown set 'gone'"));
  EXPECT_TRUE(says(after("*SURFACE, NAME=s\ngone, S1\n"), "unknown set 'gone'"));
  EXPECT_TRUE(says(after("*SURFACE, NAME=s\n10, S5\n"), "face 'S5', expected S1 to S4"));
  EXPECT_TRUE(says(after("*SURFACE\n10, S1\n"), "*SURFACE without a name"));
  EXPECT_TRUE(says(after("*ELSET\n10\n"), "*ELSET without a name"));
  EXPECT_TRUE(says(after("*ELSET, ELSET=a, GENERATE\n1, 5, 0\n"), "found '0'"));
}

// A part that is mirrored into its neighbour instead of away from it counts twice.
TEST(Inp, RefusesCellsThatOverlapBesideACommonFace) {
  const auto with = [](const std::string& corner, const std::string& cell) {
    return "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,0,0," + corner +
           "\n*Element, type=C3D4\n10, 1, 2, 3, 4\n" + cell;
  };
  EXPECT_NO_THROW(static_cast<void>(parse_inp(with("-2", "20, 1, 3, 2, 5\n"))));
  for (const std::string cell : {"20, 1, 2, 3, 5\n", "20, 3, 1, 2, 5\n", "20, 5, 1, 3, 2\n"}) {
    EXPECT_TRUE(says(refusal([&] { return parse_inp(with("2", cell)); }),
                     "2 tetrahedra are on the same side of a face as another one, so that they "
                     "overlap: element 10 20"));
  }
}

TEST(Inp, TurnsAMeshThatIsInsideOutAsAWhole) {
  Notes notes;
  const auto body = parse_inp(replaced(kQuadratic, "7, 1, 2, 3, 4, 5,\n6, 7, 8,\n9, 10",
                                       "7, 2, 1, 3, 4, 5,\n7, 6, 9,\n8, 10"),
                              &notes);
  EXPECT_NO_THROW(mesh::check(body));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(says(notes[0], "all 1 elements were inside out: renumbered"));
}

}  // namespace
}  // namespace chladni::io
