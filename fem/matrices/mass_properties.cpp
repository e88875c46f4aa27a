#include <Eigen/Dense>

#include "fem/assemble.h"
#include "fem/element/element_matrices.h"

namespace chladni::fem {
namespace {

// Mass, first moment ∫ρx and second moment ∫ρxxᵀ.
struct Moments {
  double mass = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void add(double m, const Eigen::Vector3d& at) {
    mass += m;
    first += m * at;
    second += m * at * at.transpose();
  }
};

// A linear tetrahedron: ∫xxᵀ = V/20 (Σ vᵢvᵢᵀ + Σvᵢ Σvᵢᵀ).
void add_straight(const mesh::TetMesh& body, Eigen::Index tet, double density,
                  const Eigen::Vector3d& origin, Moments& sum) {
  Eigen::Matrix<double, 3, 4> corner;
  for (int i = 0; i < 4; ++i) {
    corner.col(i) = body.points.row(body.tets(tet, i)).transpose() - origin;
  }
  const Eigen::Matrix3d edges = corner.rightCols<3>().colwise() - corner.col(0);
  const double mass = density * edges.determinant() / 6.0;
  const Eigen::Vector3d total = corner.rowwise().sum();
  sum.mass += mass;
  sum.first += mass / 4.0 * total;
  sum.second += mass / 20.0 * (corner * corner.transpose() + total * total.transpose());
}

void add_curved(const mesh::TetMesh& body, Eigen::Index tet, double density,
                const Eigen::Vector3d& origin, const TetRule& rule,
                const std::vector<ShapeValues>& at_points, Moments& sum) {
  Eigen::Matrix<double, 3, Eigen::Dynamic> nodes(3, body.tets.cols());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) {
    nodes.col(a) = body.points.row(body.tets(tet, a)).transpose() - origin;
  }
  for (std::size_t q = 0; q < at_points.size(); ++q) {
    const Eigen::Matrix3d jacobian = nodes * at_points[q].gradient;
    const double weight = rule.weights(static_cast<Eigen::Index>(q));
    sum.add(density * weight * jacobian.determinant() / 6.0, nodes * at_points[q].value);
  }
}

Eigen::Matrix3d inertia_of(const Eigen::Matrix3d& second) {
  return second.trace() * Eigen::Matrix3d::Identity() - second;
}

}  // namespace

MassProperties mass_properties(const mesh::TetMesh& body, const std::vector<Material>& materials,
                               const std::vector<Attachment>& attachments) {
  const auto& own = element(body.order());
  // The rule is exact for x² times the Jacobian's determinant on a curved cell.
  const auto rule = tet_rule(2 * own.order + 3 * (own.order - 1));
  std::vector<ShapeValues> at_points;
  for (const auto point : rule.points.rowwise()) {
    at_points.push_back(shape(own, point.transpose()));
  }
  const Eigen::Vector3d origin = body.points.colwise().mean().transpose();
  Moments sum;
  Eigen::Matrix3d own_inertia = Eigen::Matrix3d::Zero();
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const double density = materials[static_cast<std::size_t>(body.region(t))].density;
    if (is_straight(body, own, t)) {
      add_straight(body, t, density, origin, sum);
    } else {
      add_curved(body, t, density, origin, rule, at_points, sum);
    }
  }
  for (const auto& attachment : attachments) {
    const Eigen::Vector3d at = attachment.site.position - origin;
    if (const auto* point = std::get_if<PointMass>(&attachment.what)) {
      sum.add(point->mass, at);
      own_inertia += point->inertia;
    } else if (const auto* resonator = std::get_if<Resonator>(&attachment.what)) {
      sum.add(resonator->mass, at);
    }
  }
  const Eigen::Vector3d centre = sum.first / sum.mass;
  const Eigen::Matrix3d second = sum.second - sum.mass * centre * centre.transpose();
  return {.mass_kg = sum.mass,
          .centre_m = centre + origin,
          .inertia_kg_m2 = inertia_of(second) + own_inertia};
}

}  // namespace chladni::fem
