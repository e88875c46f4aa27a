#include "mesh/site.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/shapes/brick_grid.h"
#include "mesh/tets/triangle.h"
#include "random_meshes.h"

namespace chladni::mesh {
namespace {

using Vec = Eigen::Vector3d;

struct Random {
  std::mt19937 engine{20240607};
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
  Vec in_box(double low, double high) {
    return {uniform(low, high), uniform(low, high), uniform(low, high)};
  }
  Vec barycentric() {
    const double a = std::sqrt(uniform(0.0, 1.0));
    const double b = uniform(0.0, 1.0);
    return {1.0 - a, a * (1.0 - b), a * b};
  }
};

// Every node off a ball's chords, on it.
TetMesh ball(int order) {
  const Sphere sphere{.diameter = 0.2};
  TetMesh mesh = with_order(layered(sphere, 0.04), order);
  project_to_sphere(mesh, sphere);
  return mesh;
}

TEST(TriangleShape, SumsToOneAndIsOneAtItsNode) {
  Random random;
  for (const int order : {1, 2, 3}) {
    const Eigen::MatrixXd nodes = triangle_node_barycentric(order);
    for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
      const Eigen::VectorXd shape = triangle_shape(order, nodes.row(a).transpose());
      EXPECT_TRUE(shape.isApprox(Eigen::VectorXd::Unit(nodes.rows(), a), 1e-14));
    }
    for (int trial = 0; trial < 100; ++trial) {
      EXPECT_NEAR(triangle_shape(order, random.barycentric()).sum(), 1.0, 1e-14);
    }
  }
  EXPECT_THROW(static_cast<void>(triangle_shape(4, {1, 0, 0})), InvalidInput);
}

TEST(TriangleShape, ReproducesPolynomialsOfItsOrder) {
  Random random;
  for (const int order : {1, 2, 3}) {
    const Eigen::MatrixXd nodes = triangle_node_barycentric(order);
    for (int i = 0; i <= order; ++i) {
      for (int j = 0; i + j <= order; ++j) {
        const auto monomial = [&](const Vec& l) { return std::pow(l(1), i) * std::pow(l(2), j); };
        Eigen::VectorXd values(nodes.rows());
        for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
          values(a) = monomial(nodes.row(a).transpose());
        }
        for (int trial = 0; trial < 20; ++trial) {
          const Vec at = random.barycentric();
          EXPECT_NEAR(triangle_shape(order, at).dot(values), monomial(at), 1e-14);
        }
      }
    }
  }
}

TEST(TriangleShape, GradientIsTheDifference) {
  Random random;
  for (const int order : {1, 2, 3}) {
    const Vec at = random.barycentric();
    const FaceShape shape = face_shape(order, at);
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const FaceValues difference = (face_shape(order, at + kStep * Vec::Unit(axis)).value -
                                     face_shape(order, at - kStep * Vec::Unit(axis)).value) /
                                    (2.0 * kStep);
      EXPECT_LT((difference - shape.by_barycentric.col(axis)).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

// Least distance over all faces, each by a fine grid of its points: an upper bound.
double distance_by_sampling(const TetMesh& mesh, const Vec& point, int steps) {
  double least = HUGE_VAL;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vec at = Vec(steps - i - j, i, j) / steps;
        const Eigen::VectorXd shape = triangle_shape(mesh.order(), at);
        Vec here = Vec::Zero();
        for (Eigen::Index a = 0; a < shape.size(); ++a) {
          here += shape(a) * mesh.points.row(mesh.faces(f, a)).transpose();
        }
        least = std::min(least, (here - point).norm());
      }
    }
  }
  return least;
}

void expect_consistent(const TetMesh& mesh, const Site& site, const Vec& point) {
  EXPECT_NEAR(site.weights.sum(), 1.0, 1e-13);
  EXPECT_NEAR(site.normal.norm(), 1.0, 1e-13);
  Vec here = Vec::Zero();
  for (Eigen::Index a = 0; a < site.nodes.size(); ++a) {
    here += site.weights(a) * mesh.points.row(site.nodes(a)).transpose();
  }
  EXPECT_LT((here - site.position).norm(), 1e-14);
  EXPECT_NEAR(site.distance, (site.position - point).norm(), 1e-14);
  EXPECT_TRUE(site.nodes == mesh.faces.row(site.face).transpose());
}

TEST(NearestSite, AgreesWithAllFacesTriedOneByOne) {
  Random random;
  for (const int order : {1, 2, 3}) {
    for (const TetMesh& mesh : {with_order(random_mesh(1), order), ball(order)}) {
      const SiteFinder sites(mesh);
      const double size = mesh.points.cwiseAbs().maxCoeff();
      for (int trial = 0; trial < 10; ++trial) {
        const Vec point = random.in_box(-1.5 * size, 1.5 * size);
        const Site site = sites.nearest(point);
        expect_consistent(mesh, site, point);
        const double sampled = distance_by_sampling(mesh, point, 12);
        EXPECT_LE(site.distance, sampled + 1e-13);
        EXPECT_GT(site.distance, sampled - 0.05 * size);
      }
    }
  }
}

TEST(NearestSite, IsAtTheDistanceOfTheBox) {
  Random random;
  const TetMesh mesh = with_order(layered(Plate{0.6, 0.4, 0.02}, 0.1, 1), 3);
  const SiteFinder sites(mesh);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec point = random.in_box(-0.5, 0.5);
    const Vec nearest = point.cwiseMax(Vec(-0.3, -0.2, -0.02)).cwiseMin(Vec(0.3, 0.2, 0.0));
    if (nearest == point) continue;
    const Site site = sites.nearest(point);
    EXPECT_LT((site.position - nearest).norm(), 1e-14);
    EXPECT_NEAR(site.distance, (point - nearest).norm(), 1e-14);
  }
}

TEST(NearestSite, OffABallIsAlongTheRadius) {
  Random random;
  for (const int order : {2, 3}) {
    const TetMesh mesh = ball(order);
    const SiteFinder sites(mesh);
    const double close = order == 2 ? 3e-4 : 1.5e-4;  // of the curved faces to the sphere, relative
    for (int trial = 0; trial < 200; ++trial) {
      const Vec direction = random.in_box(-1.0, 1.0).normalized();
      const Site site = sites.nearest(0.15 * direction);
      EXPECT_NEAR(site.distance, 0.05, 0.1 * close);
      EXPECT_LT((site.position - 0.1 * direction).norm(), 0.02 * std::sqrt(close));
      EXPECT_GT(site.normal.dot(direction), 0.999);
      // The foot of a perpendicular: no way to come nearer within the face.
      const Vec away = (0.15 * direction - site.position).normalized();
      EXPECT_GT(away.dot(site.normal), 0.999);
    }
  }
}

TEST(NearestSite, CornersEdgesAndNodesAreMetExactly) {
  for (const int order : {1, 2, 3}) {
    const TetMesh mesh = with_order(layered(Plate{0.6, 0.4, 0.02}, 0.1, 2), order);
    const SiteFinder sites(mesh);
    for (const auto face : mesh.faces.rowwise()) {
      for (const int p : face) {
        const Vec point = mesh.points.row(p);
        const Site site = sites.nearest(point);
        EXPECT_LT(site.distance, 1e-15);
        Eigen::Index largest = 0;
        site.weights.maxCoeff(&largest);
        EXPECT_EQ(site.nodes(largest), p);
        EXPECT_NEAR(site.weights(largest), 1.0, 1e-12);
      }
    }
  }
}

TEST(NearestSite, ReproducesFieldsOfItsOrder) {
  Random random;
  for (const int order : {1, 2, 3}) {
    const TetMesh mesh = with_order(random_mesh(2), order);
    const SiteFinder sites(mesh);
    const auto field = [&](const Vec& p) {
      return std::pow(1.0 + p.x() + 2 * p.y() - p.z(), order);
    };
    Eigen::VectorXd values = Eigen::VectorXd::Zero(3 * mesh.node_count());
    for (Eigen::Index p = 0; p < mesh.node_count(); ++p) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        values(3 * p + axis) = static_cast<double>(axis + 1) * field(mesh.points.row(p));
      }
    }
    const Vec direction = Vec(1.0, -2.0, 0.5).normalized();
    for (int trial = 0; trial < 100; ++trial) {
      const Site site = sites.nearest(random.in_box(-1.0, 1.0));
      const double expected = field(site.position) * direction.dot(Vec(1.0, 2.0, 3.0));
      EXPECT_NEAR(row_at(site, direction, mesh.node_count()).dot(values), expected, 1e-12);
    }
  }
}

TEST(NearestSite, RefusesPointsThatAreNotFinite) {
  const TetMesh mesh = layered(Plate{0.6, 0.4, 0.02}, 0.1, 1);
  const SiteFinder sites(mesh);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(sites.nearest({0.0, nan, 0.0})), InvalidInput);
  EXPECT_THROW(static_cast<void>(sites.from_above(HUGE_VAL, 0.0)), InvalidInput);
  TetMesh bare = mesh;
  bare.faces.resize(0, 3);
  EXPECT_THROW(SiteFinder{bare}, InvalidInput);
}

TEST(FromAbove, FindsTheTopOfAPlateEverywhereOnItsOutlineToo) {
  for (const int order : {1, 2, 3}) {
    const TetMesh mesh = with_order(layered(Plate{0.6, 0.4, 0.02}, 0.05, 1), order);
    const SiteFinder sites(mesh);
    for (int i = -12; i <= 12; ++i) {
      for (int j = -8; j <= 8; ++j) {  // corners, edges, nodes and places between
        const double x = 0.3 * i / 12.0;
        const double y = 0.2 * j / 8.0;
        const auto site = sites.from_above(x, y);
        ASSERT_TRUE(site.has_value()) << x << " " << y;
        EXPECT_LT((site->position - Vec(x, y, 0.0)).norm(), 1e-12);
        EXPECT_LT((site->normal - Vec::UnitZ()).norm(), 1e-12);
        EXPECT_LT(site->distance, 1e-12);
        EXPECT_EQ(mesh.patch_names[static_cast<std::size_t>(mesh.face_patch(site->face))], "top");
      }
    }
    EXPECT_FALSE(sites.from_above(0.3001, 0.0).has_value());
    EXPECT_FALSE(sites.from_above(0.0, -0.2001).has_value());
  }
}

// An inverted T: a foot of 100 x 60 x 20 mm under a stem of 20 x 60 x 80 mm.
TetMesh inverted_t() {
  auto grid =
      BrickGrid::block({-0.05, -0.01, 0.01, 0.05}, {-0.03, 0.0, 0.03}, {-0.1, -0.08, -0.04, 0.0});
  for (const int i : {0, 2}) {
    for (const int j : {0, 1}) {
      for (const int k : {1, 2}) grid.kind[grid.brick(i, j, k)] = 1;
    }
  }
  grid.void_patch = {"beside"};
  return tetrahedra(grid);
}

TEST(Beside, IsTheNearestMeasuredLevelHoweverLowItLies) {
  for (const int order : {1, 3}) {
    const TetMesh mesh = with_order(inverted_t(), order);
    const SiteFinder sites(mesh);
    for (const double off : {6e-9, 1e-6, 1e-3, 0.2}) {
      ASSERT_FALSE(sites.from_above(0.05 + off, 0.01).has_value());
      const Site foot = sites.beside(0.05 + off, 0.01);
      EXPECT_LT((foot.position - Vec(0.05, 0.01, -0.08)).norm(), 1e-11);
      EXPECT_NEAR(foot.distance, off, 1e-13);
      EXPECT_NEAR(foot.normal.z(), 1.0, 1e-12);
      const Site end = sites.beside(0.002, -0.03 - off);
      EXPECT_LT((end.position - Vec(0.002, -0.03, 0.0)).norm(), 1e-11);
      EXPECT_NEAR(end.distance, off, 1e-13);
    }
  }
}

TEST(Beside, OfABallIsItsEquator) {
  const TetMesh mesh = ball(2);
  const SiteFinder sites(mesh);
  for (const double angle : {0.0, 0.3, 1.1, 2.0, 4.0}) {
    const Site site = sites.beside(0.15 * std::cos(angle), 0.15 * std::sin(angle));
    EXPECT_NEAR(site.distance, 0.05, 1e-4);
    EXPECT_LT((site.position - 0.1 * Vec(std::cos(angle), std::sin(angle), 0.0)).norm(), 2e-3);
  }
}

TEST(FromAbove, MissesHolesAndTakesTheHighest) {
  WaferTable table{.length = 0.3, .width = 0.3, .height = 0.05};
  table.corner_cutout = 0.05;
  const TetMesh cut = layered(table, 0.05, 1);
  EXPECT_FALSE(SiteFinder(cut).from_above(0.13, -0.13).has_value());
  EXPECT_TRUE(SiteFinder(cut).from_above(0.1, -0.1).has_value());  // the inner corner itself
  const TetMesh ring =
      layered(Disc{.diameter = 0.3, .thickness = 0.01, .hole_diameter = 0.1}, 0.02, 1);
  EXPECT_FALSE(SiteFinder(ring).from_above(0.0, 0.0).has_value());
  EXPECT_TRUE(SiteFinder(ring).from_above(0.0, 0.1).has_value());
  // A hollow ball has four crossings; the outermost counts.
  const TetMesh shell = layered(Sphere{.diameter = 0.2, .hole_diameter = 0.1}, 0.02);
  const auto site = SiteFinder(shell).from_above(0.003, 0.002);
  ASSERT_TRUE(site.has_value());
  EXPECT_NEAR(site->position.z(), 0.1, 0.002);
}

TEST(FromAbove, MeetsCurvedFacesWhereTheyAre) {
  Random random;
  for (const int order : {2, 3}) {
    const TetMesh mesh = ball(order);
    const SiteFinder sites(mesh);
    for (int trial = 0; trial < 200; ++trial) {
      const double r = 0.09 * std::sqrt(random.uniform(0.0, 1.0));
      const double angle = random.uniform(0.0, 6.3);
      const double x = r * std::cos(angle);
      const double y = r * std::sin(angle);
      const auto site = sites.from_above(x, y);
      ASSERT_TRUE(site.has_value()) << x << " " << y;
      EXPECT_LT(site->distance, 1e-10);
      EXPECT_NEAR(site->position.z(), std::sqrt(0.01 - r * r), order == 2 ? 2e-4 : 2e-5);
    }
  }
}

TEST(RowAt, RefusesWhatDoesNotFit) {
  const TetMesh mesh = layered(Plate{0.6, 0.4, 0.02}, 0.1, 1);
  const SiteFinder finder(mesh);
  const Site site = finder.nearest({0.01, 0.02, 0.1});
  const auto n = mesh.node_count();
  EXPECT_THROW(static_cast<void>(row_at(site, Vec(0, 0, 2), n)), InvalidInput);
  EXPECT_THROW(static_cast<void>(row_at(site, Vec::Zero(), n)), InvalidInput);
  EXPECT_THROW(static_cast<void>(row_at(site, Vec::UnitZ(), site.nodes.maxCoeff())), InvalidInput);
  EXPECT_THROW(static_cast<void>(row_at(Site{}, Vec::UnitZ(), n)), InvalidInput);
  const auto row = row_at(site, Vec::UnitZ(), n);
  EXPECT_EQ(row.size(), 3 * n);
  EXPECT_NEAR(row.sum(), 1.0, 1e-14);
}

}  // namespace
}  // namespace chladni::mesh
