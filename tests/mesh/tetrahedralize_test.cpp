#include "mesh/tetrahedralize.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "host/worker.h"
#include "mesh/bodies.h"
#include "mesh/mesher/wire.h"
#include "rotation/turn.h"
#include "said.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::cube;

class Tetrahedralize : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1); }
};

void expect_patches_of(const TetMesh& mesh, const Surface& surface, double tolerance) {
  ASSERT_EQ(mesh.patch_names, surface.patch_names);
  for (int p = 0; p < static_cast<int>(surface.patch_names.size()); ++p) {
    const double expected = shapes::patch_area(surface.points, surface.triangles, surface.patch, p);
    EXPECT_NEAR(shapes::patch_area(mesh.points, mesh.faces, mesh.face_patch, p), expected,
                tolerance * expected)
        << surface.patch_names[static_cast<std::size_t>(p)];
  }
}

// The boundary's area vectors sum to zero and its flux is the volume: closed and outward.
void expect_outward_boundary(const TetMesh& mesh) {
  Surface boundary;
  boundary.points = mesh.points;
  boundary.triangles = mesh.faces;
  EXPECT_NEAR(enclosed_volume(boundary), volume(mesh), 1e-9 * volume(mesh));
}

TEST_F(Tetrahedralize, FillsPlatesExactly) {
  for (const Plate& plate :
       {Plate{0.6, 0.6, 0.02}, Plate{0.5, 0.02, 0.002}, Plate{0.3, 0.2, 0.1}}) {
    const Surface body = surface(plate);
    const TetMesh mesh = tetrahedralize(body, {});
    const double exact = plate.length * plate.width * plate.thickness;
    EXPECT_NEAR(volume(mesh), exact, 1e-9 * exact);
    expect_patches_of(mesh, body, 1e-9);
    expect_outward_boundary(mesh);
    const Quality good = quality(mesh);
    EXPECT_GT(good.smallest_dihedral_degrees, 8.0);
    EXPECT_LT(good.largest_dihedral_degrees, 165.0);
    EXPECT_GT(good.mean_radius_ratio, 0.6);
    RecordProperty("cells", static_cast<int>(mesh.tet_count()));
  }
}

TEST_F(Tetrahedralize, HasTheEdgeLengthAskedFor) {
  for (const double edge : {0.05, 0.1, 0.2}) {
    MesherOptions options;
    options.edge_length = edge;
    const TetMesh mesh = tetrahedralize(cube(), options);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
      for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}) {
        sum += (mesh.points.row(mesh.tets(t, a)) - mesh.points.row(mesh.tets(t, b))).norm();
      }
    }
    const double mean = sum / (6.0 * static_cast<double>(mesh.tet_count()));
    EXPECT_NEAR(mean, edge, 0.2 * edge);
    EXPECT_LT(quality(mesh).longest_edge, 2.2 * edge);
  }
}

TEST_F(Tetrahedralize, RepeatsItsBits) {
  const Surface body = surface(Plate{0.3, 0.2, 0.01});
  const TetMesh first = tetrahedralize(body, {});
  for (int run = 0; run < 2; ++run) {
    const TetMesh again = tetrahedralize(body, {});
    EXPECT_TRUE(first.points == again.points);
    EXPECT_TRUE(first.tets == again.tets);
    EXPECT_TRUE(first.faces == again.faces);
  }
}

TEST_F(Tetrahedralize, IsBlindToTheUnitAndToDistance) {
  EVERY_FOURTH_LANDING();
  const TetMesh metre = tetrahedralize(cube(), {});
  const TetMesh small = tetrahedralize(shapes::scaled(cube(), 0.0009765625), {});  // 2^-10: exact
  EXPECT_EQ(metre.tet_count(), small.tet_count());
  const TetMesh far = tetrahedralize(shapes::moved(cube(), {1e5, 0, 0}), {});
  EXPECT_NEAR(volume(far), 1.0, 1e-9);
  EXPECT_EQ(far.points.col(0).minCoeff(), 1e5);
}

TEST_F(Tetrahedralize, KeepsTheRegionsOfBondedBodies) {
  const Surface body =
      bonded(box({0, 0, 0}, {1, 1, 0.3}), box({0.2, 0.2, 0.3}, {0.7, 0.9, 0.5}), "table", "wafer");
  const TetMesh mesh = tetrahedralize(body, {});
  ASSERT_EQ(mesh.region_names, (std::vector<std::string>{"table", "wafer"}));
  std::array<double, 2> filled{};
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.row(k) = mesh.points.row(mesh.tets(t, k + 1)) - mesh.points.row(mesh.tets(t, 0));
    }
    filled[static_cast<std::size_t>(mesh.region[t])] += edges.determinant() / 6.0;
  }
  EXPECT_NEAR(filled[0], 0.3, 1e-9);
  EXPECT_NEAR(filled[1], 0.07, 1e-9);
  expect_outward_boundary(mesh);
  const auto& names = mesh.patch_names;
  const auto common = std::find(names.begin(), names.end(), "interface_wafer") - names.begin();
  ASSERT_LT(common, static_cast<std::ptrdiff_t>(names.size()));
  EXPECT_EQ((mesh.face_patch.array() == static_cast<int>(common)).count(), 0);
}

TEST_F(Tetrahedralize, LeavesVoidsEmpty) {
  const Surface hollow = shapes::both(cube(), box({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}));
  MesherOptions options;
  options.edge_length = 0.15;
  const TetMesh mesh = tetrahedralize(hollow, options);
  EXPECT_NEAR(volume(mesh), 0.875, 1e-9);
  expect_outward_boundary(mesh);
}

TEST_F(Tetrahedralize, RefusesARegionThatNoPointNames) {
  Surface body = bonded(cube(), box({0, 0, 1}, {1, 1, 2}), "lower", "upper");
  body.regions[1].inside = {0.5, 0.5, 0.5};
  body.regions[0].inside = {0.4, 0.4, 0.4};
  MesherOptions options;
  options.edge_length = 0.3;
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(body, options); }),
               {"region", "inside point"});
}

// A mesher of the test's own: a shell script in a folder of its own while it lives. It is confined,
// so it starts no other program and writes no file.
class FalseMesher {
 public:
  explicit FalseMesher(const std::string& script)
      : folder_(std::filesystem::temp_directory_path() /
                ("chladni_false_mesher_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    const std::filesystem::path program = folder_ / "chladni-tetgen";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    setenv("CHLADNI_LIBEXEC", folder_.c_str(), 1);
  }
  ~FalseMesher() {
    setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1);
    std::filesystem::remove_all(folder_);
  }
  FalseMesher(const FalseMesher&) = delete;
  FalseMesher& operator=(const FalseMesher&) = delete;

  [[nodiscard]] std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

TEST_F(Tetrahedralize, NeverHandsTheMesherASurfaceThatIntersectsItself) {
  const FalseMesher mesher("echo 'it was started' >&2; exit 3");
  const Surface crossed = shapes::both(cube(), box({0.3, 0.4, 0.5}, {0.6, 0.7, 1.5}));
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(crossed, {}); }),
               {"intersects itself", "near (", "mm"});
  expect_words(message_of<WorkerDied>([&] { (void)tetrahedralize(cube(), {}); }),
               {"exit status 3", "it was started"});
}

TEST_F(Tetrahedralize, SaysHowTheMesherDied) {
  const FalseMesher mesher("kill -ABRT $$");
  expect_words(message_of<WorkerDied>([&] { (void)tetrahedralize(cube(), {}); }),
               {"the mesher died on a surface of 12 triangles", "signal 6", "coarser edge_length",
                "remesh = true"});
}

TEST_F(Tetrahedralize, BelievesNoAnswerThatIsNone) {
  const FalseMesher mesher("echo done");
  expect_words(message_of<WorkerDied>([&] { (void)tetrahedralize(cube(), {}); }),
               {"answer cannot be read", "CHLtet01"});
}

TEST_F(Tetrahedralize, BelievesNoSuccessWithNothing) {
  const FalseMesher mesher("exec cat \"${0%/*}/reply\"");
  std::ofstream(mesher.folder() / "reply", std::ios::binary) << wire::bytes_of(wire::Reply{});
  expect_words(message_of<NumericalFailure>([&] { (void)tetrahedralize(cube(), {}); }),
               {"0 cells", "1e+09 mm^3", "edge_length"});
}

TEST_F(Tetrahedralize, RefusesOptionsThatCannotBeMeant) {
  MesherOptions options;
  options.edge_length = -0.1;
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(cube(), options); }),
               {"edge_length", "-100 mm", "positive"});
  options = {};
  options.largest_radius_edge = 0.5;
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(cube(), options); }),
               {"radius-edge", "0.5"});
  options = {};
  options.smallest_dihedral_degrees = 80.0;
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(cube(), options); }),
               {"dihedral", "80"});
}

// A slip of units, told before anything is laid. The limits are for a program that does not tell.
TEST_F(Tetrahedralize, RefusesMoreCellsThanAnybodyMeshes) {
  MesherOptions options;
  options.edge_length = 1e-5;
  options.remesh_surface = false;
  options.time_limit = std::chrono::seconds(1);
  options.memory_limit_bytes = std::size_t{64} << 20U;
  const Surface plate = surface(Plate{0.6, 0.6, 0.02});
  expect_words(message_of<InvalidInput>([&] { (void)tetrahedralize(plate, options); }),
               {"edge_length of 0.01 mm", "million tetrahedra", "its unit"});
}

TEST_F(Tetrahedralize, ExpectsTheCellsThatItMakes) {
  MesherOptions options;
  options.edge_length = 0.08;
  const auto count = expected_count(1.0, 6.0, options.edge_length);
  const TetMesh mesh = tetrahedralize(cube(), options);
  EXPECT_NEAR(count.tets / static_cast<double>(mesh.tet_count()), 1.0, 0.3);
  EXPECT_NEAR(count.faces / static_cast<double>(mesh.faces.rows()), 1.0, 0.3);
}

// A plate of a tenth of an edge had 38 times the cells that its volume and area let expect.
TEST_F(Tetrahedralize, MeshesAThinBodyByTheEdgesThatAreWanted) {
  const Surface plate = surface(Plate{0.1, 0.1, 0.001});
  for (const double edge : {0.006, 0.008, 0.01}) {
    MesherOptions options;
    options.edge_length = edge;
    const auto count = expected_count(0.1 * 0.1 * 0.001, 2.0 * 0.01 + 0.4 * 0.001, edge);
    const TetMesh mesh = tetrahedralize(plate, options);
    EXPECT_NEAR(count.tets / static_cast<double>(mesh.tet_count()), 1.0, 0.2) << edge;
    EXPECT_NEAR(count.faces / static_cast<double>(mesh.faces.rows()), 1.0, 0.2) << edge;
    EXPECT_EQ(thin_wall_count(1e-5, 0.001, edge, 0).tets, 0.0);
  }
}

// From 9 to 6 thicknesses per edge the worst cell of one attempt decided at random whether there
// were as many unknowns as wanted or 20 times as many.
TEST_F(Tetrahedralize, AWaferHasMoreUnknownsTheShorterItsEdgesAre) {
  const Disc wafer{.diameter = 0.1, .thickness = 0.000775};
  double before = 0.0;
  double coarsest = 0.0;
  for (const double edge : {0.007, 0.0065, 0.006, 0.0055, 0.005}) {
    MesherOptions options;
    options.edge_length = edge;
    const TetMesh mesh = tetrahedralize(surface(wafer, edge), options);
    const auto unknowns = 3.0 * static_cast<double>(with_order(mesh, 2).node_count());
    if (before == 0.0) {
      coarsest = unknowns;
    } else {
      EXPECT_GT(unknowns, before) << edge;
      EXPECT_LT(unknowns, 1.6 * before) << edge;
    }
    before = unknowns;
    // No flatter than the wafer makes them.
    EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 0.5 * 66.0 * wafer.thickness / edge) << edge;
  }
  EXPECT_LT(before, 2.5 * coarsest);  // (7 / 5)² is 2
}

// Beside the thicker part that it is bonded to, a thin wall has cells as small as it is thick.
TEST(ThinWallCount, IsThatOfABondedWall) {
  EXPECT_EQ(thin_wall_count(1.0, 0.2, 1.0, 1).tets, 0.0);
  const auto one = thin_wall_count(1e-6, 0.001, 0.01, 1);
  const auto two = thin_wall_count(1e-6, 0.001, 0.01, 2);
  EXPECT_GT(one.tets, 1e-6 / 1e-9);
  EXPECT_GT(two.tets, one.tets);
  EXPECT_LT(two.faces, one.faces);
  EXPECT_EQ(thin_wall_count(1e-6, 0.001, 0.02, 1).tets, one.tets);  // however long the edge is
}

TEST_F(Tetrahedralize, SaysThatTheMesherRanOutOfMemory) {
  MesherOptions options;
  options.edge_length = 0.02;
  options.memory_limit_bytes = std::size_t{24} << 20U;
  expect_words(message_of<WorkerDied>([&] { (void)tetrahedralize(cube(), options); }),
               {"mesher died", "edge_length 20 mm", "coarser edge_length", "remesh = true"});
}

TEST_F(Tetrahedralize, SaysThatTheMesherTookTooLong) {
  MesherOptions options;
  options.edge_length = 0.008;
  options.remesh_surface = false;
  options.time_limit = std::chrono::seconds(1);
  expect_words(message_of<WorkerDied>([&] { (void)tetrahedralize(cube(), options); }),
               {"mesher died", "1 s", "coarser edge_length"});
}

TEST_F(Tetrahedralize, CoarsensAFineCurvedSurface) {
  const Surface torus = shapes::torus(0.3, 0.1, 200, 100);
  MesherOptions options;
  options.edge_length = 0.04;
  const TetMesh mesh = tetrahedralize(torus, options);
  EXPECT_LT(mesh.tet_count(), 20000);
  EXPECT_NEAR(volume(mesh), enclosed_volume(torus), 1e-3 * enclosed_volume(torus));
  EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 8.0);
  expect_outward_boundary(mesh);
}

Surface drilled_plate(double radius, int sides) {
  return difference(box({0, 0, 0}, {0.3, 0.2, 0.02}),
                    shapes::prism(0.1, 0.1, radius, -0.01, 0.03, sides));
}

// The bores' strips are 2 mm, 0.1 mm and 0.04 mm wide and 20 mm long.
TEST_F(Tetrahedralize, MeshesADrilledPlateWithSlivers) {
  EVERY_FOURTH_LANDING();
  for (const Surface& drilled :
       {drilled_plate(0.03, 90), drilled_plate(0.03, 1885), drilled_plate(0.002, 300)}) {
    const TetMesh mesh = tetrahedralize(drilled, {});
    EXPECT_NEAR(volume(mesh), enclosed_volume(drilled), 1e-3 * enclosed_volume(drilled));
    EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 8.0);
    EXPECT_LT(mesh.tet_count(), 25000);
    EXPECT_EQ(mesh.patch_names, drilled.patch_names);
    expect_outward_boundary(mesh);
  }
}

TEST_F(Tetrahedralize, KeepsTheSharpEdgesOfADrilledPlate) {
  EVERY_FOURTH_LANDING();
  const Surface drilled = drilled_plate(0.03, 1885);
  const TetMesh mesh = tetrahedralize(drilled, {});
  for (int p = 0; p < 6; ++p) {  // a bore of fewer chords takes less of the faces it opens on
    const double area = shapes::patch_area(drilled.points, drilled.triangles, drilled.patch, p);
    EXPECT_NEAR(shapes::patch_area(mesh.points, mesh.faces, mesh.face_patch, p), area,
                p < 4 ? 1e-9 * area : 1e-3 * area);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {  // every patch in its plane
      if (mesh.face_patch[f] != p) continue;
      for (const int i : mesh.faces.row(f)) {
        const std::array<double, 6> plane{0.0, 0.3, 0.0, 0.2, 0.0, 0.02};
        EXPECT_NEAR(mesh.points(i, p / 2), plane[static_cast<std::size_t>(p)], 1e-12);
      }
    }
  }
}

TEST_F(Tetrahedralize, MeshesWhatAFileInSinglePrecisionSays) {
  EVERY_FOURTH_LANDING();
  Surface drilled = shapes::as_soup(shapes::moved(drilled_plate(0.03, 1885), {1.0, 2.0, 3.0}));
  drilled.points = drilled.points.cast<float>().cast<double>();
  const TetMesh mesh = tetrahedralize(drilled, {});
  EXPECT_NEAR(volume(mesh), enclosed_volume(drilled), 1e-3 * enclosed_volume(drilled));
  EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 8.0);
  EXPECT_LT(mesh.tet_count(), 25000);
}

TEST_F(Tetrahedralize, KeepsTheRegionsOfARoundWaferOnATable) {
  const Surface body = bonded(box({-0.2, -0.2, -0.03}, {0.2, 0.2, 0.0}),
                              shapes::prism(0.0, 0.0, 0.15, 0.0, 0.01, 720), "table", "wafer");
  const TetMesh mesh = tetrahedralize(body, {});
  EXPECT_EQ(mesh.region_names, (std::vector<std::string>{"table", "wafer"}));
  const double exact = 0.16 * 0.03 + enclosed_volume(shapes::prism(0, 0, 0.15, 0.0, 0.01, 720));
  EXPECT_NEAR(volume(mesh), exact, 1e-3 * exact);
  EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 8.0);
  expect_outward_boundary(mesh);
}

TEST(DefaultEdgeLength, ResolvesTheWall) {
  EXPECT_NEAR(default_edge_length(surface(Plate{0.6, 0.6, 0.02})), 0.02, 1e-12);
  const double wall = 2.0 * 2e-5 / (2.0 * (0.5 * 0.02 + 0.5 * 0.002 + 0.02 * 0.002));
  EXPECT_NEAR(default_edge_length(surface(Plate{0.5, 0.02, 0.002})), 2.2 * wall, 1e-12);
  EXPECT_NEAR(default_edge_length(shapes::scaled(cube(), 7.0)), 7.0 / 30.0, 1e-12);
}

TEST(DefaultEdgeLength, StaysAffordable) {
  const double edge = default_edge_length(surface(Plate{1.0, 1.0, 0.0005}));
  const double cells = 0.0005 * 6.0 * std::sqrt(2.0) / std::pow(edge, 3);
  EXPECT_NEAR(cells, 1e6, 1.0);
}

}  // namespace
}  // namespace chladni::mesh
