#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <ctime>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/disc.h"
#include "shape_laws.h"

namespace chladni::mesh {
namespace {

using LayerVector = Eigen::Vector3d;
constexpr double kHalfTurn = std::numbers::pi;

const auto kMirrorX = [](const LayerVector& p) { return LayerVector(-p.x(), p.y(), p.z()); };
const auto kMirrorY = [](const LayerVector& p) { return LayerVector(p.x(), -p.y(), p.z()); };
const auto kDiagonal = [](const LayerVector& p) { return LayerVector(p.y(), p.x(), p.z()); };

const WaferTable kLayeredTable{.length = 0.6,
                               .width = 0.6,
                               .height = 0.05,
                               .face_sheet = 0.008,
                               .pockets_x = 9,
                               .pockets_y = 9,
                               .rib = 0.006};

double box_volume(const Plate& p) { return p.length * p.width * p.thickness; }

TEST(LayeredPlate, FillsTheBoxWithNamedSides) {
  const Plate plate{.length = 0.6, .width = 0.4, .thickness = 0.02};
  for (const int layers : {1, 2, 3}) {
    for (const double strip : {0.0, 0.02}) {
      const TetMesh mesh =
          layered(plate, {.edge_length = 0.07, .layers = layers, .edge_strip = strip});
      expect_sound(mesh);
      EXPECT_NEAR(volume(mesh), box_volume(plate), 1e-13 * box_volume(plate));
      const Surface sides = as_surface(mesh);
      EXPECT_EQ(mesh.patch_names,
                (std::vector<std::string>{"top", "bottom", "x_min", "x_max", "y_min", "y_max"}));
      EXPECT_NEAR(patch_area(sides, "top"), 0.24, 1e-13);
      EXPECT_NEAR(patch_area(sides, "bottom"), 0.24, 1e-13);
      EXPECT_NEAR(patch_area(sides, "x_max"), 0.008, 1e-14);
      EXPECT_NEAR(patch_area(sides, "y_min"), 0.012, 1e-14);
    }
  }
}

TEST(LayeredPlate, OriginIsTheCentreOfTheTop) {
  const auto box = bounding_box(layered(Plate{0.6, 0.4, 0.02}, 0.1, 2).points);
  EXPECT_TRUE(box.row(0).isApprox(Eigen::RowVector3d(-0.3, -0.2, -0.02)));
  EXPECT_TRUE(box.row(1).isApprox(Eigen::RowVector3d(0.3, 0.2, 0.0)));
}

TEST(LayeredPlate, HasTheSymmetryOfTheSquare) {
  for (const double edge : {0.6, 0.2, 0.13, 0.05}) {
    for (const int layers : {1, 2}) {
      const TetMesh mesh = layered(Plate{0.6, 0.6, 0.02},
                                   {.edge_length = edge, .layers = layers, .edge_strip = 0.02});
      EXPECT_TRUE(symmetric_under(mesh, kMirrorX));
      EXPECT_TRUE(symmetric_under(mesh, kMirrorY));
      EXPECT_TRUE(symmetric_under(mesh, kDiagonal));
    }
  }
}

TEST(LayeredPlate, MirroredCoordinatesAreMirroredToTheLastBit) {
  const TetMesh mesh = layered(Plate{0.6, 0.5, 0.02}, 0.037, 1);
  std::set<double> xs(mesh.points.col(0).begin(), mesh.points.col(0).end());
  for (const double x : xs) EXPECT_EQ(xs.count(-x), 1U) << x;
}

TEST(LayeredPlate, EdgesAreAsAsked) {
  const TetMesh mesh = layered(Plate{0.6, 0.6, 0.02}, 0.02, 1);
  EXPECT_EQ(mesh.tet_count(), 30 * 30 * 6);
  const Quality q = quality(mesh);
  EXPECT_NEAR(q.shortest_edge, 0.02, 1e-12);
  EXPECT_NEAR(q.longest_edge, std::sqrt(3.0) * 0.02, 1e-12);
  EXPECT_NEAR(q.smallest_dihedral_degrees, 45.0, 1e-6);
  EXPECT_NEAR(q.largest_dihedral_degrees, 90.0, 1e-6);
}

TEST(LayeredPlate, ThinOnesTakeMilliseconds) {
  const std::clock_t start = std::clock();
  const TetMesh mesh = layered(Plate{0.6, 0.6, 0.02}, 0.02, 1);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_LT(seconds, 0.25) << "of this process's own time; 2 ms are usual";
  EXPECT_NO_THROW(check(layered(Plate{10.0, 10.0, 0.001}, 0.5, 1)));
  EXPECT_NO_THROW(check(layered(Plate{0.5, 0.02, 0.002}, 0.1, 1)));
}

TEST(LayeredQuadrilateral, FillsSkewAndTaperedPlates) {
  const double s = std::sin(kHalfTurn / 4.0) * 10.0;
  Quadrilateral rhombus{.corners = {}, .thickness = 1.0};
  rhombus.corners << 0, 0, 10, 0, 10 + s, s, s, s;
  const TetMesh skew = layered(rhombus, 1.0, 1);
  expect_sound(skew);
  EXPECT_NEAR(volume(skew), 10.0 * s, 1e-11);
  Quadrilateral taper{.corners = {}, .thickness = 0.05};
  taper.corners << 0, -2.5, 10, -0.5, 10, 0.5, 0, 2.5;
  const TetMesh membrane = layered(taper, 0.5, 1);
  expect_sound(membrane);
  EXPECT_NEAR(volume(membrane), 30.0 * 0.05, 1e-12);
  EXPECT_NEAR(patch_area(as_surface(membrane), "x_min"), 5.0 * 0.05, 1e-12);
  EXPECT_NEAR(patch_area(as_surface(membrane), "x_max"), 1.0 * 0.05, 1e-12);
}

TEST(LayeredQuadrilateral, RefusesOnesThatAreNotConvex) {
  Quadrilateral bad{.corners = {}, .thickness = 1.0};
  bad.corners << 0, 0, 0, 1, 1, 1, 1, 0;  // clockwise
  EXPECT_THROW(static_cast<void>(layered(bad, 0.1, 1)), InvalidInput);
  bad.corners << 0, 0, 1, 0, 0.2, 0.2, 0, 1;  // an arrow head
  EXPECT_THROW(static_cast<void>(layered(bad, 0.1, 1)), InvalidInput);
}

TEST(LayeredDisc, HasTheVolumeOfTheDisc) {
  for (const double hole : {0.0, 0.05, 0.24}) {
    const Disc disc{.diameter = 0.3, .thickness = 0.01, .hole_diameter = hole};
    for (const double edge : {0.2, 0.03, 0.011}) {
      for (const int layers : {1, 2}) {
        const TetMesh mesh = layered(disc, edge, layers);
        expect_sound(mesh);
        const double exact = kHalfTurn / 4.0 * (0.09 - hole * hole) * 0.01;
        EXPECT_NEAR(volume(mesh), exact, 1e-12 * exact);
        EXPECT_NEAR(patch_area(as_surface(mesh), "top"), exact / 0.01, 1e-12);
        EXPECT_NEAR(patch_area(as_surface(mesh), "rim"), kHalfTurn * 0.3 * 0.01, 0.004 * 0.01);
      }
    }
  }
}

TEST(LayeredDisc, TurnsBy30DegreesAndIsMirroredAtEvery15) {
  for (const double hole : {0.0, 0.1}) {
    const TetMesh mesh =
        layered(Disc{.diameter = 0.3, .thickness = 0.01, .hole_diameter = hole}, 0.012, 2);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(kHalfTurn / 6.0, LayerVector::UnitZ()).toRotationMatrix();
    EXPECT_TRUE(symmetric_under(mesh, [&](const LayerVector& p) { return LayerVector(turn * p); }));
    EXPECT_TRUE(symmetric_under(mesh, kMirrorX));
    EXPECT_TRUE(symmetric_under(mesh, kMirrorY));
    EXPECT_TRUE(symmetric_under(mesh, kDiagonal));
  }
}

TEST(LayeredDisc, TrianglesStayNearTheSizeAskedFor) {
  const Quality q = quality(layered(Disc{.diameter = 0.3, .thickness = 0.01}, 0.01, 1));
  EXPECT_LT(q.longest_edge, 0.025);
  EXPECT_GT(q.shortest_edge, 0.0025);
}

TEST(LayeredTable, HasTheVolumeOfTheReferenceTable) {
  const TetMesh mesh = layered(kLayeredTable, 0.03, 1);
  expect_sound(mesh);
  EXPECT_NEAR(volume(mesh), 5752800e-9, 1e-12);
  const Surface outside = as_surface(mesh);
  EXPECT_NEAR(patch_area(outside, "pockets"), 81 * (0.06 * 0.06 + 4 * 0.06 * 0.042), 1e-10);
  EXPECT_NEAR(patch_area(outside, "bottom"), 0.36 - 81 * 0.0036, 1e-10);
  EXPECT_TRUE(symmetric_under(mesh, kMirrorX));
  EXPECT_TRUE(symmetric_under(mesh, kDiagonal));
}

TEST(LayeredTable, MirroredForEvenAndOddPockets) {
  for (const int pockets : {1, 2, 4, 5}) {
    for (const int across : {1, 2, 3}) {
      WaferTable table = kLayeredTable;
      table.pockets_x = table.pockets_y = pockets;
      table.rim = 0.01;
      const TetMesh mesh = layered(table, {.edge_length = 0.05, .across_ribs = across});
      expect_sound(mesh);
      EXPECT_TRUE(symmetric_under(mesh, kMirrorX)) << pockets;
      EXPECT_TRUE(symmetric_under(mesh, kMirrorY)) << pockets;
      EXPECT_TRUE(symmetric_under(mesh, kDiagonal)) << pockets;
    }
  }
}

TEST(LayeredTable, CutoutsKeepAWallToThePockets) {
  WaferTable table = kLayeredTable;
  table.edge_cutout_length = 0.09;
  table.edge_cutout_depth = 0.03;
  table.corner_cutout = 0.04;
  const TetMesh mesh = layered(table, 0.06, 1);
  expect_sound(mesh);
  EXPECT_TRUE(symmetric_under(mesh, kDiagonal));
  const Surface outside = as_surface(mesh);
  EXPECT_NEAR(patch_area(outside, "top"), 0.36 - 4 * (0.09 * 0.03 + 0.04 * 0.04), 1e-10);
  // Whole walls: three per cut-out at an edge, two per corner.
  EXPECT_NEAR(patch_area(outside, "cutouts"), 4 * 0.05 * (0.09 + 2 * 0.03 + 2 * 0.04), 1e-10);
  EXPECT_NEAR(patch_area(outside, "x_max"), 0.05 * (0.6 - 0.09 - 2 * 0.04), 1e-10);
}

TEST(LayeredTable, AcrossRibsCutsEveryRib) {
  const TetMesh coarse = layered(kLayeredTable, {.edge_length = 0.06, .across_ribs = 1});
  const TetMesh fine = layered(kLayeredTable, {.edge_length = 0.06, .across_ribs = 2});
  EXPECT_NEAR(quality(coarse).shortest_edge, 0.006, 1e-12);
  EXPECT_NEAR(quality(fine).shortest_edge, 0.003, 1e-12);
}

TEST(LayeredTable, WithoutPocketsIsABlock) {
  const WaferTable block{.length = 0.6, .width = 0.6, .height = 0.02};
  const TetMesh mesh = layered(block, 0.1, 2);
  const TetMesh plate = layered(Plate{0.6, 0.6, 0.02}, 0.1, 2);
  EXPECT_TRUE(mesh.points == plate.points);
  EXPECT_TRUE(mesh.tets == plate.tets);
}

TEST(LayeredSphere, VolumeConvergesWithTheSquareOfTheEdge) {
  for (const double hole : {0.0, 0.1}) {
    const Sphere ball{.diameter = 0.2, .hole_diameter = hole};
    const double exact = kHalfTurn / 6.0 * (0.008 - hole * hole * hole);
    double previous = 0.0;
    for (const double edge : {0.025, 0.0125, 0.00625}) {
      const TetMesh mesh = layered(ball, edge);
      expect_sound(mesh);
      const double error = std::abs(volume(mesh) / exact - 1.0);
      if (previous > 0.0) {
        EXPECT_LT(error, previous / 3.0);
      }
      previous = error;
      for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const bool outer = mesh.face_patch(f) == 0;
        for (const int p : mesh.faces.row(f)) {
          EXPECT_NEAR(mesh.points.row(p).norm(), outer ? 0.1 : hole / 2.0, 1e-15);
        }
      }
    }
  }
}

TEST(LayeredSphere, IsSymmetricAsACubeAndWellShaped) {
  const TetMesh mesh = layered(Sphere{.diameter = 0.2}, 0.02);
  EXPECT_TRUE(symmetric_under(mesh, kMirrorX));
  EXPECT_TRUE(symmetric_under(mesh, kDiagonal));
  EXPECT_TRUE(
      symmetric_under(mesh, [](const LayerVector& p) { return LayerVector(p.y(), p.z(), p.x()); }));
  EXPECT_GT(quality(mesh).smallest_radius_ratio, 0.3);
  EXPECT_GT(quality(mesh).smallest_dihedral_degrees, 20.0);
}

// Corners and all other nodes of rim and hole on the circles: as long and as heavy as it should be.
TEST(LayeredDisc, OfCurvedCellsIsRound) {
  for (const double hole : {0.0, 0.1}) {
    const Disc disc{.diameter = 0.3, .thickness = 0.01, .hole_diameter = hole};
    for (const int order : {2, 3}) {
      TetMesh mesh = layered(disc, 0.05, 1);
      project_to_disc(mesh, disc, order);
      mesh = with_order(mesh, order);
      project_to_disc(mesh, disc, order);
      EXPECT_NO_THROW(check(mesh));
      const auto box = bounding_box(mesh.points);
      EXPECT_NEAR(box(1, 0) - box(0, 0), 0.3, 0.3 * 4e-5);
      EXPECT_NEAR(box(1, 1) - box(0, 1), 0.3, 0.3 * 4e-5);
      const double exact = 0.01 * kHalfTurn / 4.0 * (0.09 - hole * hole);
      EXPECT_NEAR(volume(mesh) / exact, 1.0, 1e-12);
    }
  }
}

// However thin the wall, and whatever the edge length: no curved cell is turned over.
TEST(LayeredDisc, ThinRingsOfCurvedCellsAreSound) {
  for (const double wall : {0.02, 0.005, 1e-3, 1e-4, 1e-5}) {
    const Disc disc{.diameter = 0.2, .thickness = 0.005, .hole_diameter = 0.2 - 2.0 * wall};
    for (const int order : {2, 3}) {
      for (const double edge : {0.1, 0.02, 0.007}) {
        TetMesh mesh = layered(disc, edge, 1);
        EXPECT_NO_THROW(check(mesh));
        project_to_disc(mesh, disc, order);
        mesh = with_order(mesh, order);
        project_to_disc(mesh, disc, order);
        EXPECT_NO_THROW(check(mesh)) << wall << " " << order << " " << edge;
        const double exact = 0.005 * kHalfTurn * wall * (0.2 - wall);
        EXPECT_NEAR(volume(mesh) / exact, 1.0, 1e-9) << wall << " " << order << " " << edge;
      }
    }
  }
}

// Rings of many cells are counted by what they have, not by what a disc would have.
TEST(LayeredDisc, AnEdgeLengthThatAThinRingAllowsIsLaid) {
  const Disc ring{.diameter = 2.2, .thickness = 0.001, .hole_diameter = 2.198};
  const TetMesh mesh = layered(ring, 1e-3, 1);
  EXPECT_LT(mesh.tet_count(), 60000);
  EXPECT_NEAR(quality(mesh).shortest_edge, 1e-3, 3e-4);
}

TEST(LayeredSphere, ThinWallsOfCurvedCellsAreSound) {
  for (const double wall : {0.03, 0.01, 0.004, 0.001}) {
    const Sphere ball{.diameter = 0.2, .hole_diameter = 0.2 - 2.0 * wall};
    for (const int order : {2, 3}) {
      TetMesh mesh = with_order(layered(ball, 0.025), order);
      project_to_sphere(mesh, ball);
      EXPECT_NO_THROW(check(mesh)) << wall << " " << order;
      const double exact = kHalfTurn / 6.0 * (0.008 - std::pow(0.2 - 2.0 * wall, 3));
      EXPECT_NEAR(volume(mesh) / exact, 1.0, 2e-3) << wall << " " << order;
    }
  }
  const Sphere foil{.diameter = 0.2, .hole_diameter = 0.19998};
  EXPECT_THROW(static_cast<void>(layered(foil, 0.025)), InvalidInput);
}

TEST(LayeredSphere, CurvedCellsHaveTheVolumeOfTheBall) {
  const Sphere ball{.diameter = 0.2};
  TetMesh mesh = with_order(layered(ball, 0.03), 3);
  project_to_sphere(mesh, ball);
  EXPECT_NEAR(volume(mesh) / (kHalfTurn / 6.0 * 0.008), 1.0, 1e-4);
}

TEST(LayeredSphere, CurvedCellsKeepPositiveVolume) {
  for (const double hole : {0.0, 0.1}) {
    const Sphere ball{.diameter = 0.2, .hole_diameter = hole};
    for (const int order : {2, 3}) {
      TetMesh mesh = with_order(layered(ball, 0.04), order);
      project_to_sphere(mesh, ball);
      EXPECT_NO_THROW(check(mesh));
      for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        for (const int p : mesh.faces.row(f)) {
          EXPECT_NEAR(mesh.points.row(p).norm(), mesh.face_patch(f) == 0 ? 0.1 : 0.05, 1e-15);
        }
      }
    }
  }
}

TEST(DefaultLayering, IsUsable) {
  for (const int order : {1, 2, 3}) {
    const Plate beam{.length = 0.5, .width = 0.02, .thickness = 0.002};
    EXPECT_NO_THROW(check(layered(beam, default_layering(beam, order))));
    const Plate upright{.length = 0.02, .width = 0.5, .thickness = 0.1};
    EXPECT_NO_THROW(check(layered(upright, default_layering(upright, order))));
    const Disc mirror{.diameter = 0.3, .thickness = 0.003};
    EXPECT_NO_THROW(check(layered(mirror, default_layering(mirror, order))));
    EXPECT_NO_THROW(check(layered(kLayeredTable, default_layering(kLayeredTable, order))));
  }
  EXPECT_THROW(static_cast<void>(default_layering(kLayeredTable, 4)), InvalidInput);
}

TEST(Layered, RefusesSizesThatCannotBeMeant) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Plate plate{.length = 0.6, .width = 0.6, .thickness = 0.02};
  for (const double edge : {0.0, -1.0, kNaN, 1e-9, 1e-4}) {
    EXPECT_THROW(static_cast<void>(layered(plate, edge, 1)), InvalidInput) << edge;
    EXPECT_THROW(static_cast<void>(layered(Disc{.diameter = 0.3, .thickness = 0.1}, edge, 20)),
                 InvalidInput)
        << edge;
  }
  EXPECT_THROW(static_cast<void>(layered(plate, 0.1, 0)), InvalidInput);
  for (const double bad : {0.0, -0.02, kNaN, HUGE_VAL}) {
    EXPECT_THROW(static_cast<void>(layered(Plate{0.6, bad, 0.02}, 0.1, 1)), InvalidInput);
    EXPECT_THROW(static_cast<void>(layered(Plate{0.6, 0.6, bad}, 0.1, 1)), InvalidInput);
    EXPECT_THROW(static_cast<void>(layered(Disc{.diameter = bad, .thickness = 0.1}, 0.1, 1)),
                 InvalidInput);
    EXPECT_THROW(static_cast<void>(layered(Sphere{.diameter = bad}, 0.1)), InvalidInput);
  }
  WaferTable bored = kLayeredTable;
  bored.bores.push_back({.centre = {0.0, 0.0}, .diameter = 0.01});
  EXPECT_THROW(static_cast<void>(layered(bored, 0.03, 1)), InvalidInput);
}

// A slip of units must not take minutes and the memory: it is refused before anything is laid.
TEST(Layered, RefusesMoreCellsThanAnybodySolves) {
  const auto refused = [](const auto& body, double edge) {
    try {
      (void)layered(body, {.edge_length = edge, .layers = 1});
    } catch (const InvalidInput& e) {
      return std::string(e.what()).find("unit of the dimensions") != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused(Plate{.length = 1000.0, .width = 600.0, .thickness = 5.0}, 0.2));
  EXPECT_TRUE(refused(Disc{.diameter = 1000.0, .thickness = 5.0}, 0.2));
}

}  // namespace
}  // namespace chladni::mesh
