#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/tet_mesh.h"
#include "random_meshes.h"
#include "shape_laws.h"

namespace chladni::mesh {
namespace {

// What vtkLagrangeTetra and vtkLagrangeTriangle of VTK 9.1 say of order 3, times 3.
constexpr int kVtkTet20[20][3] = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {1, 0, 0},
                                  {2, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0},
                                  {0, 0, 1}, {0, 0, 2}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1},
                                  {0, 1, 2}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {1, 1, 0}};
constexpr int kVtkTriangle10[10][2] = {{0, 0}, {3, 0}, {0, 3}, {1, 0}, {2, 0},
                                       {2, 1}, {1, 2}, {0, 2}, {0, 1}, {1, 1}};
// VTK_QUADRATIC_TETRA: mid-edges 01 12 02 03 13 23.
constexpr int kVtkMidEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

TEST(NodeTable, IsVtks) {
  const Eigen::MatrixXd cubic = tet_node_barycentric(3);
  for (int a = 0; a < 20; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_DOUBLE_EQ(3.0 * cubic(a, axis + 1), kVtkTet20[a][axis]) << a;
    }
  }
  const Eigen::MatrixXd triangle = triangle_node_barycentric(3);
  for (int a = 0; a < 10; ++a) {
    EXPECT_DOUBLE_EQ(3.0 * triangle(a, 1), kVtkTriangle10[a][0]) << a;
    EXPECT_DOUBLE_EQ(3.0 * triangle(a, 2), kVtkTriangle10[a][1]) << a;
  }
  const Eigen::MatrixXd quadratic = tet_node_barycentric(2);
  for (int e = 0; e < 6; ++e) {
    EXPECT_EQ(quadratic(4 + e, kVtkMidEdges[e][0]), 0.5);
    EXPECT_EQ(quadratic(4 + e, kVtkMidEdges[e][1]), 0.5);
  }
}

TEST(NodeTable, BarycentricCoordinatesSumToOne) {
  for (const int order : {1, 2, 3}) {
    EXPECT_TRUE(tet_node_barycentric(order).rowwise().sum().isOnes(1e-15));
    EXPECT_TRUE(triangle_node_barycentric(order).rowwise().sum().isOnes(1e-15));
  }
  EXPECT_THROW(static_cast<void>(tet_node_barycentric(4)), InvalidInput);
  EXPECT_THROW(static_cast<void>(triangle_node_barycentric(0)), InvalidInput);
}

TEST(NodeTable, FacesLieOnTheirSideOfTheTetrahedron) {
  for (const int order : {1, 2, 3}) {
    const Eigen::MatrixXd tet = tet_node_barycentric(order);
    const Eigen::MatrixXd triangle = triangle_node_barycentric(order);
    const Eigen::MatrixXi nodes = tet_face_nodes(order);
    for (Eigen::Index f = 0; f < 4; ++f) {
      for (Eigen::Index a = 0; a < triangle.rows(); ++a) {
        const Eigen::RowVectorXd expected = triangle(a, 0) * tet.row(nodes(f, 0)) +
                                            triangle(a, 1) * tet.row(nodes(f, 1)) +
                                            triangle(a, 2) * tet.row(nodes(f, 2));
        EXPECT_TRUE(tet.row(nodes(f, a)).isApprox(expected, 1e-15));
      }
    }
  }
}

void expect_nodes_in_place(const TetMesh& mesh) {
  const Eigen::MatrixXd tet = tet_node_barycentric(mesh.order());
  for (const auto cell : mesh.tets.rowwise()) {
    Eigen::Matrix<double, 4, 3> corner;
    for (int a = 0; a < 4; ++a) corner.row(a) = mesh.points.row(cell(a));
    for (Eigen::Index a = 0; a < cell.cols(); ++a) {
      ASSERT_TRUE((mesh.points.row(cell(a)) - tet.row(a) * corner).norm() < 1e-14);
    }
  }
  const Eigen::MatrixXd triangle = triangle_node_barycentric(mesh.order());
  for (const auto cell : mesh.faces.rowwise()) {
    Eigen::Matrix3d corner;
    for (int a = 0; a < 3; ++a) corner.row(a) = mesh.points.row(cell(a));
    for (Eigen::Index a = 0; a < cell.cols(); ++a) {
      ASSERT_TRUE((mesh.points.row(cell(a)) - triangle.row(a) * corner).norm() < 1e-14);
    }
  }
}

TEST(WithOrder, EveryNodeIsWhereTheTableSaysAndThereOnce) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const TetMesh linear = random_mesh(seed);
    for (const int order : {1, 2, 3}) {
      const TetMesh mesh = with_order(linear, order);
      expect_nodes_in_place(mesh);
      ASSERT_NO_THROW(check(mesh));
      std::set<std::array<long long, 3>> places;
      for (const auto p : mesh.points.rowwise()) {
        places.insert(
            {std::llround(1e8 * p(0)), std::llround(1e8 * p(1)), std::llround(1e8 * p(2))});
      }
      EXPECT_EQ(places.size(), static_cast<std::size_t>(mesh.node_count()));
    }
  }
}

// A shell without cells gets the nodes that the faces of the body get.
TEST(WithOrder, AShellHasTheNodesOfItsBodysFaces) {
  const TetMesh linear = random_mesh(5);
  TetMesh shell = linear;
  shell.tets.resize(0, 4);
  shell.region.resize(0);
  for (const int order : {1, 2, 3}) {
    const TetMesh body = with_order(linear, order);
    const TetMesh faces = with_order(shell, order);
    EXPECT_EQ(faces.order(), order);
    EXPECT_EQ(faces.tet_count(), 0);
    ASSERT_EQ(faces.faces.rows(), body.faces.rows());
    ASSERT_EQ(faces.faces.cols(), body.faces.cols());
    for (Eigen::Index f = 0; f < faces.faces.rows(); ++f) {
      for (Eigen::Index a = 0; a < faces.faces.cols(); ++a) {
        EXPECT_LT((faces.points.row(faces.faces(f, a)) - body.points.row(body.faces(f, a))).norm(),
                  1e-14);
      }
    }
  }
  shell.faces(0, 0) = static_cast<int>(shell.points.rows());
  EXPECT_THROW(static_cast<void>(with_order(shell, 2)), InvalidInput);
}

TEST(WithOrder, CountsCornersEdgesAndFaces) {
  const TetMesh linear = random_mesh(4);
  std::set<std::set<int>> edges, faces;
  for (const auto tet : linear.tets.rowwise()) {
    for (const auto& [a, b] : kTetEdges) edges.insert({tet(a), tet(b)});
    for (const auto& [a, b, c] : kTetFaces) faces.insert({tet(a), tet(b), tet(c)});
  }
  const auto corners = linear.node_count();
  const auto e = static_cast<Eigen::Index>(edges.size());
  const auto f = static_cast<Eigen::Index>(faces.size());
  EXPECT_EQ(corners - e + f - linear.tet_count(), 1);  // Euler, of a ball
  EXPECT_EQ(with_order(linear, 2).node_count(), corners + e);
  EXPECT_EQ(with_order(linear, 3).node_count(), corners + 2 * e + f);
}

TEST(WithOrder, CornersRegionsAndPatchesStay) {
  TetMesh linear = layered(Plate{0.6, 0.5, 0.02}, 0.1, 1);
  linear.region_names = {"body", "wafer"};
  linear.region(3) = 1;
  for (const int order : {2, 3}) {
    const TetMesh mesh = with_order(linear, order);
    EXPECT_TRUE(mesh.points.topRows(linear.node_count()) == linear.points);
    EXPECT_TRUE(mesh.tets.leftCols(4) == linear.tets);
    EXPECT_TRUE(mesh.faces.leftCols(3) == linear.faces);
    EXPECT_TRUE(mesh.region == linear.region);
    EXPECT_TRUE(mesh.face_patch == linear.face_patch);
    EXPECT_EQ(mesh.patch_names, linear.patch_names);
    EXPECT_EQ(mesh.region_names, linear.region_names);
    EXPECT_DOUBLE_EQ(volume(mesh), volume(linear));
  }
}

TEST(WithOrder, ThereAndBackIsTheSame) {
  const TetMesh linear = random_mesh(5);
  for (const int order : {1, 2, 3}) {
    TetMesh there = with_order(linear, order);
    const TetMesh back = with_order(there, 1);
    EXPECT_TRUE(back.points == linear.points);
    EXPECT_TRUE(back.tets == linear.tets);
    EXPECT_TRUE(back.faces == linear.faces);
    sort_in_space(there);  // corners are no longer first, and still found
    const TetMesh sorted = with_order(there, 1);
    EXPECT_EQ(sorted.node_count(), linear.node_count());
    EXPECT_NO_THROW(check(sorted));
    EXPECT_NEAR(volume(sorted), volume(linear), 1e-14);
  }
}

// A ball of quadratic cells.
TetMesh curved_ball() {
  const Sphere ball{.diameter = 2.0};
  TetMesh mesh = with_order(layered(ball, 0.6), 2);
  project_to_sphere(mesh, ball);
  return mesh;
}

TEST(WithOrder, OfMoreNodesKeepsCurvedCells) {
  TetMesh quadratic = curved_ball();
  sort_in_space(quadratic);
  const TetMesh cubic = with_order(quadratic, 3);
  ASSERT_NO_THROW(check(cubic));
  EXPECT_NEAR(volume(cubic), volume(quadratic), 1e-13);
  EXPECT_GT(volume(cubic), 1.02 * volume(with_order(quadratic, 1)));
  const TetMesh back = with_order(cubic, 2);
  for (Eigen::Index t = 0; t < back.tets.rows(); ++t) {
    for (Eigen::Index a = 0; a < 10; ++a) {
      ASSERT_LT(
          (back.points.row(back.tets(t, a)) - quadratic.points.row(quadratic.tets(t, a))).norm(),
          1e-14);
    }
  }
}

TEST(LargestBend, IsNoneOfStraightCellsInAnyOrder) {
  for (const int order : {1, 2, 3}) {
    EXPECT_LT(largest_bend(with_order(random_mesh(8), order)), 1e-14);
  }
  TetMesh one;
  one.points.resize(10, 3);
  one.points << 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 1, 0, -0.1, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1,
      0, 1, 1;
  one.tets.resize(1, 10);
  one.tets << 0, 1, 2, 3, 4, 5, 6, 7, 8, 9;
  EXPECT_NEAR(largest_bend(one), 0.1 / std::sqrt(8.0), 1e-15);
  EXPECT_NEAR(largest_bend(with_order(curved_ball(), 3)), largest_bend(curved_ball()),
              0.2 * largest_bend(curved_ball()));
}

TEST(WithOrder, RefusesWhatIsNotThere) {
  TetMesh mesh = random_mesh(6);
  EXPECT_THROW(static_cast<void>(with_order(mesh, 0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(with_order(mesh, 4)), InvalidInput);
  TetMesh outside = mesh;
  outside.tets(7, 2) = static_cast<int>(mesh.node_count());
  EXPECT_THROW(static_cast<void>(with_order(outside, 2)), InvalidInput);
  TetMesh stray = mesh;
  stray.faces.row(0) << mesh.faces(0, 0), mesh.faces(1, 1), mesh.faces(20, 2);
  EXPECT_THROW(static_cast<void>(with_order(stray, 3)), InvalidInput);
}

TEST(FindBoundary, FindsWhatTheBodyKnew) {
  for (const int order : {1, 2, 3}) {
    const TetMesh plate = with_order(layered(Plate{0.6, 0.5, 0.02}, 0.1, 2), order);
    TetMesh found = plate;
    find_boundary(found);
    EXPECT_EQ(found.patch_names, std::vector<std::string>{"boundary"});
    std::map<std::array<int, 3>, std::set<int>> own, again;
    for (Eigen::Index f = 0; f < plate.faces.rows(); ++f) {
      for (const int p : plate.faces.row(f)) own[sorted_corners(plate.faces, f)].insert(p);
      for (const int p : found.faces.row(f)) again[sorted_corners(found.faces, f)].insert(p);
    }
    EXPECT_EQ(own, again);
    expect_nodes_in_place(found);
    EXPECT_NEAR(enclosed_volume(as_surface(found)), 0.6 * 0.5 * 0.02, 1e-15);
  }
}

TEST(FindBoundary, RefusesAFaceOfThreeTetrahedra) {
  TetMesh mesh;
  mesh.points.resize(6, 3);
  mesh.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 1, 1, 1;
  mesh.tets.resize(3, 4);
  mesh.tets << 0, 1, 2, 3, 0, 2, 1, 4, 0, 1, 2, 5;
  mesh.region = Eigen::VectorXi::Zero(3);
  mesh.region_names = {"body"};
  EXPECT_THROW(find_boundary(mesh), InvalidInput);
  mesh.tets(0, 0) = -1;
  EXPECT_THROW(find_boundary(mesh), InvalidInput);
}

TEST(NamePatches, FindsTheSidesOfABox) {
  for (const int order : {1, 3}) {
    const TetMesh plate = with_order(layered(Plate{0.6, 0.5, 0.02}, 0.1, 2), order);
    TetMesh named = plate;
    find_boundary(named);
    name_patches(named);
    EXPECT_EQ(named.patch_names, plate.patch_names);
    for (const auto& name : plate.patch_names) {
      EXPECT_NEAR(patch_area(as_surface(named), name), patch_area(as_surface(plate), name), 1e-14);
    }
  }
}

TEST(NamePatches, CurvedSidesAreOnePieceByFallingArea) {
  TetMesh ring = layered(Disc{.diameter = 0.3, .thickness = 0.02, .hole_diameter = 0.1}, 0.02, 1);
  find_boundary(ring);
  name_patches(ring);
  EXPECT_EQ(ring.patch_names, (std::vector<std::string>{"top", "bottom", "side_1", "side_2"}));
  const Surface sides = as_surface(ring);
  EXPECT_GT(patch_area(sides, "side_1"), 2.9 * patch_area(sides, "side_2"));
  name_patches(ring, 5.0);  // each facet of the rim by itself: 15 or 7.5 degrees apart
  EXPECT_GT(ring.patch_names.size(), 40U);
  EXPECT_THROW(name_patches(ring, 0.0), InvalidInput);
}

TEST(SortInSpace, MovesNothingAndBringsNeighboursTogether) {
  for (const int order : {1, 2, 3}) {
    const TetMesh before = with_order(random_mesh(7), order);
    TetMesh after = before;
    sort_in_space(after);
    const auto here = [](const Eigen::Vector3d& p) { return p; };
    EXPECT_EQ(cells_after(before, here), cells_after(after, here));
    EXPECT_NO_THROW(check(after));
    EXPECT_NEAR(enclosed_volume(as_surface(after)), enclosed_volume(as_surface(before)), 1e-15);
    const auto spread = [](const TetMesh& mesh) {
      return (mesh.tets.rowwise().maxCoeff() - mesh.tets.rowwise().minCoeff())
          .cast<double>()
          .mean();
    };
    EXPECT_LT(spread(after), 0.5 * spread(before));
  }
}

TEST(SortInSpace, CarriesRegionsAndPatches) {
  TetMesh mesh = layered(Plate{0.6, 0.5, 0.02}, 0.1, 1);
  mesh.region_names = {"body", "left"};
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    mesh.region(t) = mesh.points(mesh.tets(t, 0), 0) + mesh.points(mesh.tets(t, 1), 0) +
                                 mesh.points(mesh.tets(t, 2), 0) + mesh.points(mesh.tets(t, 3), 0) <
                             0.0
                         ? 1
                         : 0;
  }
  const double top = patch_area(as_surface(mesh), "top");
  const Eigen::VectorXi before = mesh.region;
  sort_in_space(mesh);
  EXPECT_EQ(mesh.region.sum(), before.sum());
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    double x = 0.0;
    for (int a = 0; a < 4; ++a) x += mesh.points(mesh.tets(t, a), 0);
    EXPECT_EQ(mesh.region(t), x < 0.0 ? 1 : 0);
  }
  EXPECT_DOUBLE_EQ(patch_area(as_surface(mesh), "top"), top);
}

}  // namespace
}  // namespace chladni::mesh
