#include "fem/body/rigid_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/element/element_matrices.h"

namespace chladni::fem {
namespace {

using Motions = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// Translations and rotations about `centre` on all degrees of freedom.
Motions about(const mesh::TetMesh& body, const AttachmentTerms& attachments,
              const Eigen::Vector3d& centre) {
  const auto nodes = body.node_count();
  Motions motions(3 * nodes + attachments.extra_count(), 6);
  const auto field = [&](const Eigen::Vector3d& point) {
    Eigen::Matrix<double, 3, 6> u;
    u.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) {
      u.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(point - centre));
    }
    return u;
  };
  for (Eigen::Index i = 0; i < nodes; ++i) {
    motions.middleRows<3>(3 * i) = field(body.points.row(i).transpose());
  }
  for (Eigen::Index i = 0; i < attachments.extra_count(); ++i) {
    const auto& extra = attachments.extras[static_cast<std::size_t>(i)];
    motions.row(3 * nodes + i) = extra.direction.transpose() * field(extra.position);
  }
  return motions;
}

Eigen::MatrixXd free_rows(const Eigen::MatrixXd& values, const DofMap& dofs) {
  Eigen::MatrixXd free(dofs.free_count, values.cols());
  for (Eigen::Index i = 0; i < dofs.free_dof.size(); ++i) {
    if (dofs.free_dof(i) >= 0) free.row(dofs.free_dof(i)) = values.row(i);
  }
  return free;
}

// Principal axes of a symmetric matrix. Each axis is matched to the nearest coordinate axis. Where
// two or three moments are equal, the axes in their plane are chosen nearest to x, y, z.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  const double tolerance = 1e-6 * solver.eigenvalues().cwiseAbs().maxCoeff();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  std::array<bool, 3> taken{};
  for (int first = 0; first < 3;) {
    int size = 1;
    while (first + size < 3 &&
           solver.eigenvalues()(first + size) - solver.eigenvalues()(first) < tolerance) {
      ++size;
    }
    const Eigen::MatrixXd space = solver.eigenvectors().middleCols(first, size);
    Eigen::MatrixXd chosen(3, 0);
    for (int k = 0; k < size; ++k) {
      int best = -1;
      Eigen::Vector3d direction = Eigen::Vector3d::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        if (taken[static_cast<std::size_t>(axis)]) continue;
        Eigen::Vector3d part = space * (space.transpose() * Eigen::Vector3d::Unit(axis));
        part -= chosen * (chosen.transpose() * part);
        if (part.norm() > direction.norm() + 1e-9) {
          direction = part;
          best = axis;
        }
      }
      if (best < 0) throw NumericalFailure("rigid-body motions: the body's inertia is not finite");
      taken[static_cast<std::size_t>(best)] = true;
      axes.col(best) = direction.normalized();
      chosen.conservativeResize(3, k + 1);
      chosen.col(k) = axes.col(best);
    }
    first += size;
  }
  return axes;
}

Eigen::MatrixXd gram(const SparseMatrix& mass, const Eigen::MatrixXd& motions) {
  return motions.transpose() * (mass.selfadjointView<Eigen::Lower>() * motions);
}

// Combines the six motions so that M is the identity on them: translations first, then rotations
// about the principal axes through the centre of mass. Returns the 6×6 combination. A motion of
// which supports hold all mass gets a large size; they resist it.
Eigen::MatrixXd mass_orthonormal(const Eigen::MatrixXd& g) {
  constexpr double kHeld = 1e-12;  // of the largest mass or moment of inertia
  Eigen::MatrixXd c = Eigen::MatrixXd::Identity(6, 6);
  const double least_mass = kHeld * g.diagonal().head(3).maxCoeff();
  for (int i = 0; i < 3; ++i) {
    for (int pass = 0; pass < 2; ++pass) {
      for (int j = 0; j < i; ++j) c.col(i) -= c.col(j) * (c.col(j).transpose() * g * c.col(i));
    }
    c.col(i) /= std::sqrt(std::max(c.col(i).dot(g * c.col(i)), least_mass));
  }
  Eigen::MatrixXd rotations = c.rightCols(3);
  rotations -= c.leftCols(3) * (c.leftCols(3).transpose() * g * rotations);
  const Eigen::Matrix3d inertia = rotations.transpose() * g * rotations;
  c.rightCols(3) = rotations * principal_axes(inertia);
  const double least_moment = kHeld * inertia.diagonal().maxCoeff();
  // Where moments are equal but for a millionth, the axes nearest to x, y, z are not quite
  // principal.
  for (int i = 3; i < 6; ++i) {
    for (int j = 3; j < i; ++j) c.col(i) -= c.col(j) * (c.col(j).transpose() * g * c.col(i));
    c.col(i) /= std::sqrt(std::max(c.col(i).dot(g * c.col(i)), least_moment));
  }
  return c;
}

// The stretch of each spring and the motion of each held degree of freedom under the six motions,
// relative to its largest possible value. There is one row per spring or held degree of freedom.
// The stiffness of a spring is left out, because it does not decide which motions the spring
// resists.
Eigen::MatrixXd stretches(const Motions& motions, const DofMap& dofs,
                          const AttachmentTerms& attachments) {
  std::vector<Eigen::Matrix<double, 1, 6>> rows;
  for (const auto& spring : attachments.springs) {
    Eigen::Matrix<double, 1, 6> stretch = Eigen::Matrix<double, 1, 6>::Zero();
    double most = 0.0;
    for (const auto& [dof, factor] : spring.row) {
      stretch += factor * motions.row(dof);
      most += std::abs(factor) * motions.row(dof).norm();
    }
    if (most > 0.0) rows.emplace_back(stretch / most);
  }
  for (Eigen::Index i = 0; i < dofs.free_dof.size(); ++i) {
    const double most = motions.row(i).norm();
    if (dofs.free_dof(i) < 0 && most > 0.0) rows.emplace_back(motions.row(i) / most);
  }
  Eigen::MatrixXd all(static_cast<Eigen::Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) all.row(static_cast<Eigen::Index>(i)) = rows[i];
  return all;
}

// The part of the six orthonormal motions that springs and supports do not resist: the null space
// of `stretches`. Its basis is made of projections of the motions, in their order.
Eigen::MatrixXd costless(const Eigen::MatrixXd& stretches) {
  // A link that does not stretch shows a rounding error of its lever (fem/matrices/attachment.cpp).
  constexpr double kRounding = 1e-8;
  if (stretches.rows() == 0) return Eigen::MatrixXd::Identity(6, 6);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(stretches, Eigen::ComputeFullV);
  const Eigen::Index count = 6 - (svd.singularValues().array() > kRounding).count();
  const Eigen::MatrixXd null = svd.matrixV().rightCols(count);
  Eigen::MatrixXd chosen(6, 0);
  for (Eigen::Index k = 0; k < 6 && chosen.cols() < count; ++k) {
    Eigen::VectorXd part = null * null.row(k).transpose();
    for (int pass = 0; pass < 2; ++pass) part -= chosen * (chosen.transpose() * part);
    if (part.norm() < 1e-6) continue;
    chosen.conservativeResize(Eigen::NoChange, chosen.cols() + 1);
    chosen.col(chosen.cols() - 1) = part.normalized();
  }
  return chosen;
}

// The six motions on all degrees of freedom, mass-orthonormal on the free ones.
Motions six(const mesh::TetMesh& body, const System& system, const AttachmentTerms& attachments) {
  const Eigen::Vector3d centre = body.points.colwise().mean().transpose();
  Motions all = about(body, attachments, centre);
  all *= mass_orthonormal(gram(system.mass, free_rows(all, system.dofs)));
  return all;
}

// Forces of the springs under `motions`, on all degrees of freedom.
Eigen::MatrixXd spring_forces(const Eigen::MatrixXd& motions, const AttachmentTerms& attachments) {
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(motions.rows(), motions.cols());
  for (const auto& term : attachments.stiffness) {
    forces.row(term.row()) += term.value() * motions.row(term.col());
    if (term.row() != term.col()) forces.row(term.col()) += term.value() * motions.row(term.row());
  }
  return forces;
}

}  // namespace

Eigen::MatrixXd rigid_motions(const mesh::TetMesh& body, const System& system,
                              const AttachmentTerms& attachments) {
  const Motions all = six(body, system, attachments);
  const Eigen::MatrixXd free = free_rows(all, system.dofs);
  const Eigen::MatrixXd passed = costless(stretches(all, system.dofs, attachments));
  if (passed.cols() == 6) return free;
  Eigen::MatrixXd left = free * passed;
  for (int pass = 0; pass < 2 && left.cols() > 0; ++pass) {
    const Eigen::LLT<Eigen::MatrixXd> llt(gram(system.mass, left));
    left = llt.matrixU().solve<Eigen::OnTheRight>(left);
  }
  return left;
}

Suspension suspension(const mesh::TetMesh& body, const System& system,
                      const AttachmentTerms& attachments) {
  if (attachments.stiffness.empty() || system.rigid.cols() == 6) return {};
  const Motions all = six(body, system, attachments);
  Eigen::MatrixXd passed = costless(stretches(all, system.dofs, AttachmentTerms{}));
  const Eigen::MatrixXd rigid = costless(stretches(all, system.dofs, attachments));
  passed -= rigid * (rigid.transpose() * passed);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(passed * passed.transpose()));
  const Eigen::Index count = (solver.eigenvalues().array() > 0.5).count();
  if (count == 0) return {};
  const Eigen::MatrixXd motions = all * solver.eigenvectors().rightCols(count);
  return {free_rows(motions, system.dofs),
          free_rows(spring_forces(motions, attachments), system.dofs)};
}

namespace {

// √(Σ V E / Σ V ρ) over the cells: a body may have a little rubber and much steel.
double speed_of(const mesh::TetMesh& body, const std::vector<Material>& materials) {
  const auto stiffness_of = [](const Material& one) {
    return one.stiffness.diagonal().head<3>().mean();
  };
  if (materials.size() == 1) {
    return std::sqrt(stiffness_of(materials.front()) / materials.front().density);
  }
  double stiffness = 0.0;
  double mass = 0.0;
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const double volume = std::abs(straight_cell(body, t).volume);
    const auto& material = materials[static_cast<std::size_t>(body.region(t))];
    stiffness += volume * stiffness_of(material);
    mass += volume * material.density;
  }
  return mass > 0.0 ? std::sqrt(stiffness / mass) : 0.0;
}

}  // namespace

double frequency_scale(const mesh::TetMesh& body, const std::vector<Material>& materials) {
  double area = 0.0;
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    const Eigen::Vector3d a = body.points.row(body.faces(f, 0));
    const Eigen::Vector3d b = body.points.row(body.faces(f, 1));
    const Eigen::Vector3d c = body.points.row(body.faces(f, 2));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  const double longest =
      (body.points.colwise().maxCoeff() - body.points.colwise().minCoeff()).maxCoeff();
  if (area <= 0.0 || longest <= 0.0) return 0.0;
  const double thickness = 2.0 * mesh::volume(body) / area;
  return 0.65 * speed_of(body, materials) * thickness / (longest * longest);
}

}  // namespace chladni::fem
