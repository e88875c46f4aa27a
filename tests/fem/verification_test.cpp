// Cases of the reference tables that no study can ask for; the others are in models/ (and on
// docs/reference/verification.md).
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

// ---- The strip: which mode bends which way.

struct Strip {
  double width = 0.02;
  mesh::TetMesh body;
  System system;
  ModesResult found;
};

Strip strip() {
  Strip s;
  const mesh::Plate beam{.length = 0.5, .width = s.width, .thickness = 0.002};
  s.body = mesh::with_order(mesh::layered(beam, mesh::default_layering(beam, 3)), 3);
  s.system = assemble(s.body, {isotropic(210e9, 0.3, 7850.0)});
  s.found = modes(s.system, {.count = 11});
  return s;
}

// 'w' weak bending, 'v' strong bending, 't' torsion, by where the mass that moves is.
char kind_of(const Strip& strip, Eigen::Index mode) {
  const Eigen::VectorXd mass = strip.system.mass.diagonal();
  double along_y = 0.0;
  double along_z = 0.0;
  double far_from_axis = 0.0;  // of what moves along z, weighted by y²
  for (Eigen::Index node = 0; node < strip.body.node_count(); ++node) {
    const double y = strip.body.points(node, 1);
    const double v = strip.found.modes.shapes(3 * node + 1, mode);
    const double w = strip.found.modes.shapes(3 * node + 2, mode);
    along_y += mass(3 * node + 1) * v * v;
    along_z += mass(3 * node + 2) * w * w;
    far_from_axis += mass(3 * node + 2) * w * w * y * y;
  }
  if (along_y > along_z) return 'v';
  // The mean of y² is 1/3 of the half width's where w is even over the width, 3/5 where it is odd.
  const double half = 0.5 * strip.width;
  return far_from_axis / along_z < 0.45 * half * half ? 'w' : 't';
}

TEST(Strip, BendsAndTwistsInThePublishedOrder) {
  const auto found = strip();
  std::string order;
  for (Eigen::Index mode = 6; mode < 17; ++mode) order += kind_of(found, mode);
  EXPECT_EQ(order, "wwwwvwtwwvt");
}

// ---- NAFEMS FV42: the breathing modes of a hollow sphere.

constexpr double kInner = 1.8, kOuter = 6.0, kAngle = 0.3;

// A cut of it between four planes through the centre, a 140th of the whole, where few other modes
// are: a block of cells bent into place.
mesh::TetMesh sector(int cells_along_radius) {
  auto body = mesh::with_order(
      mesh::layered(mesh::Plate{1.0, 1.0, 1.0},
                    mesh::Layering{.edge_length = 0.5, .layers = cells_along_radius}),
      3);
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    const Eigen::RowVector3d at = body.points.row(i);
    const double r = kInner + (kOuter - kInner) * (at(2) + 1.0);
    const Eigen::RowVector3d ray(std::tan(kAngle * (at(0) + 0.5)), std::tan(kAngle * (at(1) + 0.5)),
                                 1.0);
    body.points.row(i) = r * ray.normalized();
  }
  return body;
}

mesh::Site at_node(const mesh::TetMesh& body, Eigen::Index face, Eigen::Index corner) {
  mesh::Site site;
  site.nodes = body.faces.row(face).transpose();
  site.weights = Eigen::VectorXd::Unit(site.nodes.size(), corner);
  site.position = body.points.row(site.nodes(corner)).transpose();
  site.normal = Eigen::Vector3d::UnitZ();
  site.face = face;
  return site;
}

// Breathing motion slides along each plane: two planes are coordinate planes, on the oblique two
// every node is held across by a stiff spring.
std::vector<Attachment> held_across(const mesh::TetMesh& body) {
  std::vector<Attachment> springs;
  std::set<std::pair<int, int>> done;
  for (Eigen::Index face = 0; face < body.faces.rows(); ++face) {
    for (Eigen::Index corner = 0; corner < body.faces.cols(); ++corner) {
      for (const int axis : {0, 1}) {
        const auto site = at_node(body, face, corner);
        Eigen::Vector3d across = std::cos(kAngle) * Eigen::Vector3d::Unit(axis);
        across(2) = -std::sin(kAngle);
        if (std::abs(across.dot(site.position)) > 1e-9) continue;
        if (!done.emplace(site.nodes(corner), axis).second) continue;
        springs.push_back({"wall", site, 0.0, GroundSpring{across, 1e15, 0.0}});
      }
    }
  }
  return springs;
}

// The part of the mass that moves along the radius.
double radial_part(const mesh::TetMesh& body, const System& system, const Eigen::VectorXd& shape) {
  const Eigen::MatrixXd field = on_nodes(system.dofs, shape);
  double radial = 0.0;
  double all = 0.0;
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    const Eigen::Vector3d u = field.col(0).segment<3>(3 * i);
    radial += std::pow(u.dot(body.points.row(i).transpose().normalized()), 2);
    all += u.squaredNorm();
  }
  return radial / all;
}

TEST(HollowSphere, BreathesAtThePublishedFrequencies) {
  const auto body = sector(8);
  const auto system =
      assemble(body, {isotropic(200e9, 0.3, 8000.0)},
               {{.patch = "x_min", .x = true}, {.patch = "y_min", .y = true}}, held_across(body));
  const auto found = modes(system, {.count = 120}).modes;
  std::vector<double> radial;
  for (Eigen::Index i = 0; i < found.mode_count(); ++i) {
    if (radial_part(body, system, found.shapes.col(i)) > 0.999) {
      radial.push_back(found.frequency_hz(i));
    }
  }
  const std::vector<double> published{369.943, 838.033, 1451.192, 2116.956, 2795.814};
  ASSERT_GE(radial.size(), published.size());
  for (std::size_t i = 0; i < published.size(); ++i) {
    EXPECT_NEAR(radial[i] / published[i], 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace chladni::fem
