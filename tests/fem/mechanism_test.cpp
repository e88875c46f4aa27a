// Motions that cost no energy and are not those of a rigid body, along the shipped path: mesh,
// check, assemble, modes.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <utility>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "mesh/site.h"

namespace chladni::fem {
namespace {

// Two blocks of 100 mm, the second one moved, with one point for those at one place.
mesh::TetMesh two_blocks(const Eigen::RowVector3d& by, int order) {
  const auto block = mesh::with_order(mesh::layered(mesh::Plate{0.1, 0.1, 0.1}, 0.05, 2), order);
  mesh::TetMesh both = block;
  std::vector<int> number;
  for (Eigen::Index i = 0; i < block.node_count(); ++i) {
    const Eigen::RowVector3d at = block.points.row(i) + by;
    Eigen::Index k = 0;
    while (k < block.node_count() && (block.points.row(k) - at).norm() > 1e-9) ++k;
    if (k == block.node_count()) {
      k = both.node_count();
      both.points.conservativeResize(k + 1, 3);
      both.points.row(k) = at;
    }
    number.push_back(static_cast<int>(k));
  }
  both.tets.resize(2 * block.tet_count(), block.tets.cols());
  both.tets.topRows(block.tet_count()) = block.tets;
  for (Eigen::Index t = 0; t < block.tets.size(); ++t) {
    both.tets.data()[block.tets.size() + t] =
        number[static_cast<std::size_t>(block.tets.data()[t])];
  }
  both.region = Eigen::VectorXi::Zero(both.tet_count());
  mesh::find_boundary(both);
  return both;
}

template <typename Failure>
std::string mechanism_refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

void expect_words(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "\"" << words << "\" in \"" << text << "\"";
}

struct Joint {
  Eigen::RowVector3d by;
  int order;
  const char* joint;
};

class MechanismOf : public ::testing::TestWithParam<Joint> {};

TEST_P(MechanismOf, TwoBlocksIsRefusedByCheckAndByModes) {
  const auto body = two_blocks(GetParam().by, GetParam().order);
  expect_words(mechanism_refusal<InvalidInput>([&] { mesh::check(body); }), GetParam().joint);
  // Who leaves the check out is told by the modes themselves.
  const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)});
  ASSERT_EQ(system.rigid.cols(), 6);
  for (const bool certificate : {true, false}) {
    const auto text = mechanism_refusal<NumericalFailure>(
        [&] { (void)modes(system, {.count = 5, .certificate = certificate}); });
    expect_words(text, "beside the 6 rigid-body motions there is one that costs no energy");
    expect_words(text, "largest at (");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fem, MechanismOf,
    ::testing::Values(Joint{{0.1, 0.1, 0.0}, 1, "along the edge from (50, 50, "},
                      Joint{{0.1, 0.1, 0.0}, 2, "along the edge from (50, 50, "},
                      Joint{{0.1, 0.1, 0.1}, 2, "at the node at (50, 50, 0) mm"}));

// By a face they are one body.
TEST(Mechanism, IsNoneWhereTheBlocksShareAFace) {
  const auto body = two_blocks({0.1, 0.0, 0.0}, 2);
  EXPECT_NO_THROW(mesh::check(body));
  const auto found = modes(assemble(body, {isotropic(70e9, 0.33, 2700.0)}), {.count = 5});
  EXPECT_TRUE(found.summary.complete);
  EXPECT_GT(found.modes.frequency_hz(6), 1000.0);
}

// ---- Matrices without a body.

// Chains of n masses in a row, uncoupled, each free; `rigid` knows of the first motion only.
System chains(int count, int n) {
  System system;
  std::vector<Eigen::Triplet<double>> k;
  const int size = count * n;
  for (int c = 0; c < count; ++c) {
    for (int i = 0; i < n; ++i) {
      const int at = c * n + i;
      k.emplace_back(at, at, i == 0 || i + 1 == n ? 1e7 : 2e7);
      if (i + 1 < n) k.emplace_back(at + 1, at, -1e7);
    }
  }
  system.stiffness.resize(size, size);
  system.stiffness.setFromTriplets(k.begin(), k.end());
  system.mass.resize(size, size);
  system.mass.setIdentity();
  system.mass *= 0.1;
  system.rigid = Eigen::MatrixXd::Constant(size, 1, 1.0 / std::sqrt(0.1 * size));
  return system;
}

TEST(Mechanism, OfTwoChainsIsRefused) {
  for (const int n : {10, 40, 200}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      for (const bool certificate : {true, false}) {
        const auto text = mechanism_refusal<NumericalFailure>([&] {
          (void)modes(chains(2, n), {.count = 5, .certificate = certificate, .seed = seed});
        });
        expect_words(text, "beside the 1 rigid-body motions there is one that costs no energy");
        expect_words(text, "degree of freedom ");
      }
    }
  }
}

TEST(Modes, RefuseAStiffnessThatGivesEnergy) {
  auto system = chains(1, 40);
  system.stiffness.coeffRef(20, 20) -= 1e2;
  system.rigid.resize(40, 0);
  expect_words(mechanism_refusal<NumericalFailure>([&] { (void)modes(system, {.count = 3}); }),
               "the stiffness matrix is not positive semidefinite");
}

// Squares of motions of 1e-170 are 0: all directions vanished, and the program with them.
TEST(Modes, RefuseConstantsBeyondTheRangeOfNumbers) {
  auto system = chains(1, 400);
  system.stiffness.coeffRef(200, 200) += 1e2;
  system.stiffness *= 1e170;
  system.rigid.resize(400, 0);
  EXPECT_THROW((void)modes(system, {.count = 3}), NumericalFailure);
}

TEST(Modes, RefuseARigidMotionThatIsNone) {
  auto system = chains(1, 40);
  system.stiffness.coeffRef(20, 20) += 1e4;
  expect_words(mechanism_refusal<NumericalFailure>([&] { (void)modes(system, {.count = 3}); }),
               "rigid-body motion 1 solves its equation only to");
}

// A residual that is a number of its own kind is never below a bound.
TEST(Modes, NeverShowANegativeResidual) {
  const auto found = modes(chains(1, 40), {.count = 10}).summary;
  EXPECT_GE(found.residual.minCoeff(), 0.0);
  EXPECT_LT(found.residual.maxCoeff(), 1e-9);
  EXPECT_TRUE(found.warnings.empty());
}

// ---- Springs as soft as one likes are springs.

TEST(RigidMotions, AreHeldByTheSoftestSpring) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.1, 0.08, 0.06}, 0.03, 2), 2);
  const mesh::SiteFinder finder(body);
  std::vector<Attachment> springs;
  const auto hold = [&](double x, double y, const Eigen::Vector3d& along, double stiffness) {
    springs.push_back(
        {"spring", finder.from_above(x, y).value(), 0.0, GroundSpring{along, stiffness, 0.0}});
  };
  for (const double x : {-0.03, 0.03}) {
    for (const double y : {-0.02, 0.02}) {
      hold(x, y, Eigen::Vector3d::UnitX(), 1e9);
      hold(x, y, Eigen::Vector3d::UnitY(), 1e9);
    }
  }
  const std::vector<Material> steel{isotropic(210e9, 0.3, 7850.0)};
  const auto before = assemble(body, steel, {}, springs);
  EXPECT_EQ(before.rigid.cols(), 3);  // up and down, and turning about the plane of the springs
  EXPECT_EQ(before.suspended.cols(), 3);
  for (const auto& [x, y] : {std::pair{0.0, 0.02}, {-0.03, -0.02}, {0.03, -0.02}}) {
    hold(x, y, Eigen::Vector3d::UnitZ(), 1e-6);  // 1e-15 of the others
  }
  const auto after = assemble(body, steel, {}, springs);
  EXPECT_EQ(after.rigid.cols(), 0);
  EXPECT_EQ(after.suspended.cols(), 6);
}

// ---- Cells that are turned inside out between their nodes.

TEST(Assemble, RefusesACellThatIsInvertedWhereItIsIntegrated) {
  const auto sound = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.1}, 0.1, 1), 2);
  const std::vector<Material> steel{isotropic(210e9, 0.3, 7850.0)};
  auto straight = sound;
  for (const int a : {0}) std::swap(straight.tets(3, a), straight.tets(3, a + 1));
  expect_words(mechanism_refusal<InvalidInput>([&] { (void)assemble(straight, steel); }),
               "tetrahedron ");
  auto curved = sound;
  const Eigen::RowVector3d a = curved.points.row(curved.tets(5, 0));
  const Eigen::RowVector3d b = curved.points.row(curved.tets(5, 1));
  curved.points.row(curved.tets(5, 4)) = b + 1.5 * (b - a);
  const auto text = mechanism_refusal<InvalidInput>([&] { (void)assemble(curved, steel); });
  expect_words(text, "is inverted or flat: its mapping has the determinant -");
  expect_words(text, " mm ");
}

}  // namespace
}  // namespace chladni::fem
