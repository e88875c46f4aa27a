// Modes in classes of symmetry against the modes of the whole body.
#include "fem/mirrors.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <string>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/eigen/residual.h"
#include "fem/eigen/symmetric_product.h"
#include "fem/factor/factorization.h"
#include "fem/given_modes.h"
#include "mesh/bodies.h"
#include "tests/fem/peak_memory.h"
#include "tests/rotation/turn.h"

namespace chladni::fem {
namespace {

const Material kAluminium = isotropic(70e9, 0.33, 2700.0);

struct Body {
  mesh::TetMesh mesh;
  std::vector<Attachment> attachments = {};
  std::vector<Support> supports = {};
  Material material = kAluminium;

  [[nodiscard]] System system() const { return assemble(mesh, {material}, supports, attachments); }
  [[nodiscard]] std::vector<Mirror> mirrors(const System& system,
                                            const std::vector<int>& axes) const {
    std::vector<Mirror> result;
    for (const int axis : axes) {
      result.push_back(mirror_of(mesh, attachments, system, axis));
    }
    return result;
  }
};

Body plate(double length, double width, double thickness, double edge, int order = 2,
           int layers = 2) {
  return {.mesh = mesh::with_order(
              mesh::layered(mesh::Plate{length, width, thickness}, edge, layers), order)};
}

void attach(Body& body, const std::string& name, double x, double y,
            decltype(Attachment::what) what) {
  const mesh::SiteFinder sites(body.mesh);
  body.attachments.push_back({name, *sites.from_above(x, y), 0.0, std::move(what)});
}

// Masses at the corners, springs in the middle of the sides, a resonator along x on each side.
Body plate_with_all() {
  Body body = plate(0.3, 0.2, 0.01, 0.05);
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.07, 0.07}) attach(body, "mass", x, y, PointMass{0.2});
    attach(body, "spring", x, 0.0, GroundSpring{Eigen::Vector3d::UnitZ(), 1e5, 0.0});
    attach(body, "resonator", x, 0.0, Resonator{Eigen::Vector3d::UnitX(), 0.05, 1e6, 0.0});
  }
  return body;
}

// The laws: the same frequencies, counts and shapes as of the whole body, orthonormal on the whole.
void expect_the_same(const Body& body, const std::vector<int>& axes, int count) {
  const auto system = body.system();
  const ModesOptions options{.count = count};
  const auto whole = modes(system, options);
  const auto parts = modes_by_mirrors(system, body.mirrors(system, axes), options);
  const auto m = whole.modes.mode_count();
  const auto rigid = whole.modes.rigid_count;
  ASSERT_EQ(parts.modes.mode_count(), m);
  ASSERT_EQ(parts.modes.rigid_count, rigid);
  EXPECT_TRUE(parts.summary.complete);
  EXPECT_EQ(parts.summary.counted, parts.summary.found);
  EXPECT_GE(parts.summary.counted, m);
  EXPECT_LT(parts.summary.orthogonality, 1e-10);
  const Eigen::ArrayXd ratio = parts.modes.frequency_hz.tail(m - rigid).array() /
                               whole.modes.frequency_hz.tail(m - rigid).array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 1e-9);
  // Shapes up to a rotation within a cluster: each is in the span of those of like frequency.
  const Eigen::MatrixXd overlap =
      whole.modes.shapes.transpose() * (SymmetricProduct(system.mass) * parts.modes.shapes);
  for (Eigen::Index i = 0; i < m; ++i) {
    double share = 0.0;
    for (Eigen::Index j = 0; j < m; ++j) {
      const double apart = std::abs(whole.modes.frequency_hz(j) - parts.modes.frequency_hz(i));
      if (apart <= 1e-6 * parts.modes.frequency_hz(i)) share += std::pow(overlap(j, i), 2);
    }
    EXPECT_NEAR(share, 1.0, 1e-9) << "mode " << i;
  }
  ASSERT_EQ(parts.summary.clusters.size(), whole.summary.clusters.size());
}

TEST(Mirrors, GiveTheModesOfAPlate) {
  for (const auto& axes : std::vector<std::vector<int>>{{0}, {1}, {0, 1}, {0, 1, 2}}) {
    expect_the_same(plate(0.3, 0.2, 0.01, 0.05), axes, 14);
  }
}

TEST(Mirrors, GiveTheRepeatedModesOfASquare) {
  expect_the_same(plate(0.3, 0.3, 0.01, 0.05), {0, 1}, 20);
}

TEST(Mirrors, GiveTheModesOfASlenderBeamAndOfADisc) {
  expect_the_same(plate(0.5, 0.02, 0.002, 0.02, 3, 1), {0, 1}, 12);
  Body disc{.mesh = mesh::with_order(mesh::layered(mesh::Disc{0.2, 0.006}, 0.03, 1), 2)};
  expect_the_same(disc, {0, 1}, 12);
}

TEST(Mirrors, GiveTheModesOfWhatIsAttachedHeldAndTurned) {
  expect_the_same(plate_with_all(), {0, 1}, 12);
  Body held = plate(0.3, 0.2, 0.01, 0.05);
  held.supports = {{.patch = "x_min", .x = true, .y = true, .z = true}};
  expect_the_same(held, {1}, 10);
  held.supports.push_back({.patch = "x_max", .z = true});
  expect_the_same(held, {1}, 10);
}

// Tuned masses at one place: on the plane each is its own image, beside it those that are equal.
TEST(Mirrors, GiveTheModesOfSeveralResonatorsAtOnePlace) {
  Body body = plate(0.3, 0.2, 0.01, 0.05);
  for (const double stiffness : {1e6, 1e6, 3e5}) {
    for (const double x : {-0.1, 0.0, 0.1}) {
      attach(body, "tuned", x, 0.0, Resonator{Eigen::Vector3d::UnitZ(), 0.05, stiffness, 0.0});
    }
  }
  expect_the_same(body, {0}, 14);
  expect_the_same(body, {0, 1}, 14);
}

TEST(Mirrors, GiveAsManyModesAsAreAskedFor) {
  for (const int count : {1, 2, 7, 40}) expect_the_same(plate(0.2, 0.1, 0.02, 0.05), {0, 1}, count);
}

// The residuals are those of the whole body.
TEST(Mirrors, TellTheResidualsOfTheWholeBody) {
  const auto body = plate(0.3, 0.2, 0.01, 0.05);
  const auto system = body.system();
  const auto found = modes_by_mirrors(system, body.mirrors(system, {0, 1}), {.count = 10});
  const double s = inverted_shift(system);
  const Symbolic symbolic(system.stiffness);
  const Factorization factor(symbolic, system.stiffness, s, system.mass);
  const Eigen::VectorXd lambda = (2.0 * M_PI * found.modes.frequency_hz.tail(10)).array().square();
  const auto whole =
      residuals(system, factor, s, system.rigid, lambda, found.modes.shapes.rightCols(10));
  for (Eigen::Index i = 0; i < 10; ++i) {
    EXPECT_LT(found.summary.residual(6 + i), 1e-9);
    EXPECT_LT(whole(i), 1e-9);
  }
}

template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

void expect_refused(const Body& body, int axis, const std::string& part) {
  const auto system = body.system();
  const auto why = refusal([&] { (void)mirror_of(body.mesh, body.attachments, system, axis); });
  EXPECT_NE(why.find(part), std::string::npos) << why;
}

TEST(Mirrors, AreRefusedWhereTheBodyIsNotItsImage) {
  Body body = plate(0.3, 0.2, 0.01, 0.05);
  attach(body, "the mass", 0.1, 0.0, PointMass{0.2});
  expect_refused(body, 0, "the nearest attachment is \"the mass\"");
  EXPECT_NO_THROW((void)mirror_of(body.mesh, body.attachments, body.system(), 1));

  Body springs = plate(0.3, 0.2, 0.01, 0.05);
  attach(springs, "left", -0.1, 0.0, GroundSpring{Eigen::Vector3d::UnitZ(), 1e5, 0.0});
  attach(springs, "right", 0.1, 0.0, GroundSpring{Eigen::Vector3d::UnitZ(), 1.1e5, 0.0});
  expect_refused(springs, 0, "its stiffness differs from that of the image by ");

  Body resonator = plate(0.3, 0.2, 0.01, 0.05);
  attach(resonator, "r", 0.1, 0.0, Resonator{Eigen::Vector3d::UnitZ(), 0.05, 1e6, 0.0});
  expect_refused(resonator, 0, "a resonator is there and none at its image");

  Body held = plate(0.3, 0.2, 0.01, 0.05);
  held.supports = {{.patch = "x_min", .z = true}};
  expect_refused(held, 0, "a support holds it or its image alone");

  Body turned = plate(0.3, 0.2, 0.01, 0.05);
  turned.material.stiffness(0, 5) = turned.material.stiffness(5, 0) = 5e9;  // shear by stretching
  expect_refused(turned, 0, "its stiffness differs");

  Body uneven = plate(0.3, 0.2, 0.01, 0.05, 2, 1);  // one layer is cut along one diagonal
  expect_refused(uneven, 2, "the body is not its own mirror image across z");
}

TEST(Mirrors, AreOneToThree) {
  const auto system = plate(0.3, 0.2, 0.01, 0.1).system();
  EXPECT_THROW((void)modes_by_mirrors(system, {}, {.count = 2}), InvalidInput);
}

TEST(Mirrors, TakeTheMemoryThatTheyForecast) {
  const auto body = plate(0.6, 0.6, 0.02, 0.02, 2, 2);
  const auto system = body.system();
  const auto mirrors = body.mirrors(system, {0, 1});
  const ModesOptions options{.count = 20};
  const auto peak =
      peak_of([&] { return modes_by_mirrors(system, mirrors, options).summary.forecast_bytes; });
  ASSERT_GT(peak.used, 0.0);
  EXPECT_LT(peak.used, 1.1 * peak.forecast + 8e6);
  EXPECT_GT(peak.used, 0.6 * peak.forecast);
  RecordProperty("used_over_forecast", std::to_string(peak.used / peak.forecast));
  EXPECT_LT(peak.forecast, 0.6 * memory_forecast(system, options).total_bytes);
  EXPECT_LT(memory_forecast(system, mirrors, options).total_bytes, 1.1 * peak.forecast);
  EXPECT_GT(memory_forecast(system, mirrors, options).total_bytes, 0.8 * peak.forecast);
}

TEST(Mirrors, RefuseWhatDoesNotFit) {
  const auto body = plate(0.3, 0.2, 0.01, 0.05);
  const auto system = body.system();
  EXPECT_THROW((void)modes_by_mirrors(system, body.mirrors(system, {0, 1}),
                                      {.count = 5, .memory_limit_bytes = 100000}),
               FactorTooLarge);
}

}  // namespace
}  // namespace chladni::fem
