#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/tet_mesh.h"
#include "random_meshes.h"

namespace chladni::mesh {
namespace {

std::string mesh_complaint(const TetMesh& mesh) {
  try {
    check(mesh);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

void expect_mesh_complaint(const TetMesh& mesh, const std::string& words) {
  EXPECT_NE(mesh_complaint(mesh).find(words), std::string::npos)
      << "expected \"" << words << "\" in \"" << mesh_complaint(mesh) << "\"";
}

TetMesh joined(const TetMesh& a, const TetMesh& b) {
  TetMesh both = a;
  both.points.resize(a.points.rows() + b.points.rows(), 3);
  both.points << a.points, b.points;
  both.tets.resize(a.tets.rows() + b.tets.rows(), a.tets.cols());
  both.tets << a.tets, (b.tets.array() + static_cast<int>(a.points.rows())).matrix();
  both.region = Eigen::VectorXi::Zero(both.tets.rows());
  find_boundary(both);
  return both;
}

TEST(Check, AcceptsSoundMeshesOfEveryOrder) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const int order : {1, 2, 3}) {
      EXPECT_EQ(mesh_complaint(with_order(random_mesh(seed), order)), "");
    }
  }
}

TEST(Check, NamesInvertedTetrahedraUpToTen) {
  TetMesh mesh = random_mesh(1);
  std::swap(mesh.tets(17, 0), mesh.tets(17, 1));
  expect_mesh_complaint(mesh, "1 tetrahedra are inverted or flat");
  expect_mesh_complaint(mesh, "tetrahedron 17 at (");
  for (Eigen::Index t = 0; t < 25; ++t) {
    if (t != 17) std::swap(mesh.tets(t, 0), mesh.tets(t, 1));
  }
  expect_mesh_complaint(mesh, "25 tetrahedra are inverted or flat");
  expect_mesh_complaint(mesh, "and 15 more");
  expect_mesh_complaint(mesh, "tetrahedron 9 at (");
  EXPECT_EQ(mesh_complaint(mesh).find("tetrahedron 10 at"), std::string::npos);
}

TEST(Check, RefusesFlatOnesWhereverTheBodyStands) {
  for (const double away : {0.0, 1000.0}) {
    TetMesh mesh = layered(Plate{0.6, 0.6, 0.02}, 0.2, 1);
    mesh.points.col(2).setZero();
    mesh.points.array() += away;
    expect_mesh_complaint(mesh, "flat");
  }
  TetMesh thin = layered(Plate{10.0, 10.0, 1e-4}, 1.0, 1);
  EXPECT_EQ(mesh_complaint(thin), "");
}

TEST(Check, FindsCurvedCellsThatFoldOver) {
  for (const int order : {2, 3}) {
    TetMesh mesh = with_order(random_mesh(3), order);
    EXPECT_EQ(mesh_complaint(mesh), "");
    // A mid-edge node drawn beyond the other end of its edge.
    const Eigen::RowVector3d a = mesh.points.row(mesh.tets(5, 0));
    const Eigen::RowVector3d b = mesh.points.row(mesh.tets(5, 1));
    mesh.points.row(mesh.tets(5, 4)) = b + 0.5 * (b - a);
    expect_mesh_complaint(mesh, "tetrahedron 5 at");
  }
}

TEST(Check, NamesPointsThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TetMesh mesh = random_mesh(2);
    mesh.points(13, 1) = bad;
    expect_mesh_complaint(mesh, "point 13");
    expect_mesh_complaint(mesh, "not finite");
  }
}

TEST(Check, NamesIndicesOutOfRange) {
  const TetMesh sound = random_mesh(2);
  const auto count = static_cast<int>(sound.node_count());
  for (const int bad : {-1, count, 2000000000, std::numeric_limits<int>::min()}) {
    TetMesh mesh = sound;
    mesh.tets(8, 3) = bad;
    expect_mesh_complaint(mesh, "tetrahedron 8 names point " + std::to_string(bad));
    mesh = sound;
    mesh.faces(4, 1) = bad;
    expect_mesh_complaint(mesh, "boundary face 4 names point " + std::to_string(bad));
    mesh = sound;
    mesh.region(6) = bad;
    expect_mesh_complaint(mesh, "cell 6 has region " + std::to_string(bad));
    mesh = sound;
    mesh.face_patch(6) = bad;
    expect_mesh_complaint(mesh, "cell 6 has patch " + std::to_string(bad));
  }
}

TEST(Check, ListsBodiesThatShareNoNode) {
  const TetMesh a = layered(Plate{0.6, 0.6, 0.02}, 0.2, 1);
  TetMesh b = layered(Plate{0.1, 0.1, 0.01}, 0.1, 1);
  b.points.col(0).array() += 1.0;
  expect_mesh_complaint(joined(a, b), "2 bodies share no node");
  expect_mesh_complaint(joined(a, b), "volume 0.0072 m^3, centre (");
  expect_mesh_complaint(joined(a, b), "volume 0.0001 m^3, centre (1000, ");
  EXPECT_EQ(mesh_complaint(a), "");
}

// One point for those that are at one place.
TetMesh merged(TetMesh both) {
  std::vector<int> same(static_cast<std::size_t>(both.node_count()));
  Points kept(0, 3);
  for (Eigen::Index i = 0; i < both.node_count(); ++i) {
    Eigen::Index k = 0;
    while (k < kept.rows() && (kept.row(k) - both.points.row(i)).norm() > 1e-9) ++k;
    if (k == kept.rows()) {
      kept.conservativeResize(k + 1, 3);
      kept.row(k) = both.points.row(i);
    }
    same[static_cast<std::size_t>(i)] = static_cast<int>(k);
  }
  for (auto& node : both.tets.reshaped()) node = same[static_cast<std::size_t>(node)];
  both.points = kept;
  find_boundary(both);
  return both;
}

// Two blocks of 100 x 100 x 100 mm, the second one moved and joined to the first where they touch.
TetMesh two_blocks(const Eigen::RowVector3d& by, int order) {
  const TetMesh a = with_order(layered(Plate{0.1, 0.1, 0.1}, 0.05, 2), order);
  TetMesh b = a;
  b.points.rowwise() += by;
  return merged(joined(a, b));
}

TEST(Check, RefusesAHingeByItsPlace) {
  for (const int order : {1, 2, 3}) {
    const TetMesh hinge = two_blocks({0.1, 0.1, 0.0}, order);
    expect_mesh_complaint(hinge, "1 places where parts of the body meet in an edge or a node only");
    expect_mesh_complaint(hinge, "along the edge from (50, 50, ");
    expect_mesh_complaint(hinge, "volume 0.001 m^3, centre (100, 100, -50) mm");
  }
}

TEST(Check, RefusesABallJointByItsPlace) {
  for (const int order : {1, 2}) {
    expect_mesh_complaint(two_blocks({0.1, 0.1, 0.1}, order), "at the node at (50, 50, 0) mm");
  }
}

TEST(Check, AcceptsBlocksThatShareAFace) {
  EXPECT_EQ(mesh_complaint(two_blocks({0.1, 0.0, 0.0}, 2)), "");
  EXPECT_EQ(mesh_complaint(two_blocks({0.1, 0.05, 0.0}, 2)), "");
}

// Four blocks in a ring, each joined to the next along one upright edge: a linkage of four bars
// that moves in one way. A fifth block on top of two of them, by faces, makes it stiff.
TEST(Check, TellsALinkageFromAFrame) {
  const auto add = [](const TetMesh& to, const Eigen::RowVector3d& by) {
    TetMesh block = layered(Plate{0.1, 0.1, 0.1}, 0.05, 2);
    block.points.rowwise() += by;
    return merged(joined(to, block));
  };
  TetMesh ring = layered(Plate{0.1, 0.1, 0.1}, 0.05, 2);
  for (const auto& [x, y] : {std::pair{0.1, 0.1}, {0.0, 0.2}, {-0.1, 0.1}}) {
    ring = add(ring, {x, y, 0.0});
  }
  expect_mesh_complaint(ring, "4 places where parts of the body meet in an edge or a node only");
  TetMesh stiff = ring;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.0, 0.1}, {0.1, 0.1}}) {
    stiff = add(stiff, {x, y, 0.1});
  }
  EXPECT_EQ(mesh_complaint(stiff), "");
}

TEST(Check, RefusesPointsWithoutATetrahedron) {
  TetMesh mesh = random_mesh(4);
  mesh.points.conservativeResize(mesh.points.rows() + 1, 3);
  mesh.points.bottomRows(1) << 0.5, 0.25, 0.125;
  expect_mesh_complaint(mesh, "used by no tetrahedron");
  expect_mesh_complaint(mesh, "(500, 250, 125) mm");
}

TEST(Check, RefusesArraysThatDoNotFit) {
  const TetMesh sound = random_mesh(4);
  expect_mesh_complaint(TetMesh{}, "no tetrahedra");
  const auto refused = [&](const std::function<void(TetMesh&)>& spoil) {
    TetMesh mesh = sound;
    spoil(mesh);
    EXPECT_NE(mesh_complaint(mesh), "");
  };
  refused([](TetMesh& m) { m.tets.conservativeResize(m.tets.rows(), 5); });
  refused([](TetMesh& m) { m.region.conservativeResize(m.region.size() - 1); });
  refused([](TetMesh& m) { m.face_patch.conservativeResize(m.face_patch.size() - 1); });
  refused([](TetMesh& m) { m.region_names.clear(); });
  refused([](TetMesh& m) { m.patch_names.clear(); });
  refused([](TetMesh& m) { m.faces = Cells::Zero(m.faces.rows(), 6); });
}

}  // namespace
}  // namespace chladni::mesh
