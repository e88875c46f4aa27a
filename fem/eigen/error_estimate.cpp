#include "fem/error_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/interrupt.h"
#include "fem/element/bubbles.h"
#include "fem/element/element_matrices.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;
using ShapeColumns = Eigen::Ref<const Matrix>;

// The energies of single bubbles sum up to about half the energy of the error, up to 1.3 times on
// flat cells (plates, beams and cubes of cells that are as long as they are thick to 8 times so).
constexpr double kOneByOne = 2.4;

// Least energy of the error over that of the jumps, by the order of the elements. Of order 2 it was
// 0.10 to 0.45 on plates, beams, cubes and spheres, whatever the shape of their cells; of order 3
// it was 0.05 to 0.3.
constexpr std::array<double, 4> kOfJumps{0.0, 0.6, 0.27, 0.12};

// modes×3: the energy of the bubbles that a cell solves together, the sum of the energies of
// bubbles that are solved one by one, and the energy of the jumps.
using Energies = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// For each face of a cell (4·cell + face), the same face in the neighbouring cell; −1 on the
// boundary.
std::vector<std::int64_t> twins(const mesh::TetMesh& body) {
  struct Face {
    std::array<std::int32_t, 3> corner;
    std::int64_t place;
  };
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(4 * body.tet_count()));
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    for (std::size_t f = 0; f < 4; ++f) {
      Face face{{}, 4 * t + static_cast<std::int64_t>(f)};
      for (std::size_t i = 0; i < 3; ++i) face.corner[i] = body.tets(t, kFaceCorners[f][i]);
      std::sort(face.corner.begin(), face.corner.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.corner != b.corner ? a.corner < b.corner : a.place < b.place;
  });
  std::vector<std::int64_t> twin(faces.size(), -1);
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].corner != faces[i + 1].corner) continue;
    twin[static_cast<std::size_t>(faces[i].place)] = faces[i + 1].place;
    twin[static_cast<std::size_t>(faces[i + 1].place)] = faces[i].place;
  }
  return twin;
}

// 1/E of the material averaged over all directions (Reuss 1929), which does not depend on how its
// axes lie [1/Pa].
double tension_compliance(const Material& material) {
  const Eigen::Matrix<double, 6, 6> s = material.stiffness.inverse();
  const double along = s.diagonal().head<3>().sum();
  const double across = s(0, 1) + s(1, 2) + s(0, 2);
  const double bulk = along + 2.0 * across;                                                   // 1/K
  const double shear = (4.0 * (along - across) + 3.0 * s.diagonal().tail<3>().sum()) / 15.0;  // 1/G
  return bulk / 9.0 + shear / 3.0;
}

class Estimate {
 public:
  Estimate(const mesh::TetMesh& body, const std::vector<Material>& materials, const DofMap& dofs)
      : body_(body),
        materials_(materials),
        dofs_(dofs),
        bubbles_(body.order()),
        twin_(twins(body)),
        straight_(static_cast<std::size_t>(body.tet_count())) {
    for (const auto& material : materials) {
      elasticity_.push_back(elasticity(material));
      compliance_.push_back(tension_compliance(material));
    }
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      straight_[static_cast<std::size_t>(t)] = is_straight(body, bubbles_.own(), t) ? 1 : 0;
    }
  }

  // Energy of the error of each mode. The shapes are on the free degrees of freedom, n×modes. The
  // parts of the sum do not depend on the number of threads.
  //
  // The tractions of a flat cell, long against the body's thickness, leave forces across the face
  // that neighbours carry. The cell alone bends under them, (length / thickness)² times softer than
  // it shears, and its bubbles together take far too much energy. One bubble alone does not bend.
  // The smaller of the two energies serves order 2. Those of order 1 one by one know too little of
  // the error, and order 3 has no basis here that is the same from every corner of a cell.
  //
  // Bubbles vanish at the nodes. What a cell leaves of a bending wave that it spans does not, and
  // both energies can be a hundredth of the error. The jumps of the tractions show it.
  Eigen::VectorXd energy(const ShapeColumns& shapes, const Eigen::VectorXd& lambda) const {
    constexpr Eigen::Index kParts = 256;
    const auto modes = shapes.cols();
    Matrix sums = Matrix::Zero(3 * modes, kParts);
    parallel_ranges(static_cast<std::size_t>(kParts), [&](std::size_t begin, std::size_t end) {
      for (auto part = static_cast<Eigen::Index>(begin); part < static_cast<Eigen::Index>(end);
           ++part) {
        const auto last = (part + 1) * body_.tet_count() / kParts;
        for (auto tet = part * body_.tet_count() / kParts; tet < last; ++tet) {
          if (tet % 64 == 0) throw_if_interrupted();
          sums.col(part) += cell_energy(tet, shapes, lambda).reshaped();
        }
      }
    });
    const Eigen::VectorXd sum = sums.rowwise().sum();
    Eigen::VectorXd bubbles = sum.head(modes);
    if (body_.order() == 2) bubbles = bubbles.cwiseMin(sum.segment(modes, modes));
    return bubbles.cwiseMax(kOfJumps[static_cast<std::size_t>(body_.order())] * sum.tail(modes));
  }

 private:
  // Displacements of the cell's n nodes, n×3·modes: column 3·mode + axis; 0 where the body is held.
  [[nodiscard]] Matrix displacements(Eigen::Index tet, const ShapeColumns& shapes) const {
    Matrix u(bubbles_.own().nodes, 3 * shapes.cols());
    for (Eigen::Index a = 0; a < u.rows(); ++a) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const int row = dofs_.free_dof(3 * Eigen::Index{body_.tets(tet, a)} + axis);
        for (Eigen::Index mode = 0; mode < shapes.cols(); ++mode) {
          u(a, 3 * mode + axis) = row >= 0 ? shapes(row, mode) : 0.0;
        }
      }
    }
    return u;
  }

  // Outward traction times area, per point, mode and axis, on face f of a cell with displacements
  // `u`.
  [[nodiscard]] Eigen::VectorXd tractions(Eigen::Index tet, std::size_t f, const Matrix& u) const {
    const auto& c = materials_[static_cast<std::size_t>(body_.region(tet))].stiffness;
    const auto modes = u.cols() / 3;
    const Matrix slopes = bubbles_.on_face(body_, tet, f).gradients * u;  // 3q×3·modes, by ξ
    const auto face = bubbles_.geometry(body_, tet, f, is_straight_cell(tet));
    Eigen::VectorXd to(static_cast<Eigen::Index>(face.area.size()) * 3 * modes);
    Eigen::Index row = 0;
    for (std::size_t q = 0; q < face.area.size(); ++q) {
      const Eigen::Vector3d& n = face.area[q];
      for (Eigen::Index mode = 0; mode < modes; ++mode, row += 3) {
        const Eigen::Matrix3d h =  // ∂u_i/∂x_k at row i
            slopes.block<3, 3>(3 * static_cast<Eigen::Index>(q), 3 * mode).transpose() *
            face.gradient[q];
        Eigen::Matrix<double, 6, 1> strain;
        strain << h(0, 0), h(1, 1), h(2, 2), h(1, 2) + h(2, 1), h(0, 2) + h(2, 0),
            h(0, 1) + h(1, 0);
        const Eigen::Matrix<double, 6, 1> s = c * strain;
        to(row) = s(0) * n(0) + s(5) * n(1) + s(4) * n(2);
        to(row + 1) = s(5) * n(0) + s(1) * n(1) + s(3) * n(2);
        to(row + 2) = s(4) * n(0) + s(3) * n(1) + s(2) * n(2);
      }
    }
    return to;
  }

  [[nodiscard]] bool is_straight_cell(Eigen::Index tet) const {
    return straight_[static_cast<std::size_t>(tet)] != 0;
  }

  [[nodiscard]] double compliance(Eigen::Index tet) const {
    return compliance_[static_cast<std::size_t>(body_.region(tet))];
  }

  [[nodiscard]] bool is_held(Eigen::Index tet, std::size_t face, Eigen::Index axis) const {
    return std::all_of(kFaceCorners[face].begin(), kFaceCorners[face].end(), [&](int corner) {
      return dofs_.free_dof(3 * Eigen::Index{body_.tets(tet, corner)} + axis) < 0;
    });
  }

  // The mean of the tractions of both sides of face f (the outward normals are opposite), `own`
  // those of the cell, weighted by the compliances: of a stiff and a soft cell the soft one knows
  // the traction, and the error is left to the stiff one, which it costs less energy. The force is
  // zero on a free surface. It is the cell's own traction along axes that a support holds.
  [[nodiscard]] Eigen::VectorXd force_on(Eigen::Index tet, std::size_t f,
                                         const Eigen::VectorXd& own,
                                         const ShapeColumns& shapes) const {
    const auto twin = twin_[static_cast<std::size_t>(4 * tet) + f];
    Eigen::VectorXd force = own;
    if (twin >= 0) {
      const auto behind = static_cast<Eigen::Index>(twin / 4);
      const double here = compliance(tet);
      const double there = compliance(behind);
      return (here * force - there * tractions(behind, static_cast<std::size_t>(twin % 4),
                                               displacements(behind, shapes))) /
             (here + there);
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (is_held(tet, f, axis)) continue;
      for (Eigen::Index row = axis; row < force.size(); row += 3) force(row) = 0.0;
    }
    return force;
  }

  // Adds ∫ t·v over the faces. Returns the energy of the jumps: ∫ h S |t − own t|² with h the
  // height of the cell above the face and S its compliance under tension.
  Eigen::VectorXd add_faces(Eigen::Index tet, const Matrix& u, const ShapeColumns& shapes,
                            Matrix& residual) const {
    Eigen::VectorXd jumps = Eigen::VectorXd::Zero(shapes.cols());
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& on_face = bubbles_.on_face(body_, tet, f);
      const Eigen::VectorXd own = tractions(tet, f, u);
      const Eigen::VectorXd force = force_on(tet, f, own, shapes);
      jumps += jump_energy(tet, f, force - own);
      Eigen::Index row = 0;
      for (Eigen::Index q = 0; q < bubbles_.face_weights().size(); ++q) {
        for (Eigen::Index column = 0; column < u.cols(); ++column, ++row) {
          if (force(row) == 0.0) continue;
          residual.col(column) +=
              (bubbles_.face_weights()(q) * force(row)) * on_face.bubbles.row(q).transpose();
        }
      }
    }
    return jumps;
  }

  // `jump` is times the area, as the tractions are.
  [[nodiscard]] Eigen::VectorXd jump_energy(Eigen::Index tet, std::size_t f,
                                            const Eigen::VectorXd& jump) const {
    const double soft = compliance(tet);
    const double volume = straight_cell(body_, tet).volume;
    const auto& weights = bubbles_.face_weights();
    Eigen::VectorXd energy = Eigen::VectorXd::Zero(jump.size() / (3 * weights.size()));
    const auto face = bubbles_.geometry(body_, tet, f, is_straight_cell(tet));
    Eigen::Index row = 0;
    for (Eigen::Index q = 0; q < weights.size(); ++q) {
      const double area_2 = face.area[static_cast<std::size_t>(q)].squaredNorm();
      for (Eigen::Index mode = 0; mode < energy.size(); ++mode, row += 3) {
        energy(mode) +=
            weights(q) * soft * 3.0 * volume / area_2 * jump.segment<3>(row).squaredNorm();
      }
    }
    return energy;
  }

  [[nodiscard]] Energies cell_energy(Eigen::Index tet, const ShapeColumns& shapes,
                                     const Eigen::VectorXd& lambda) const {
    const auto region = static_cast<std::size_t>(body_.region(tet));
    const auto cell = bubbles_.integrals(body_, tet, is_straight_cell(tet), materials_[region],
                                         elasticity_[region]);
    const auto b = bubbles_.count();
    const auto n = Eigen::Index{bubbles_.own().nodes};
    const Matrix u = displacements(tet, shapes);
    const auto modes = shapes.cols();
    Matrix residual = cell.mass * u;  // b×3·modes
    for (Eigen::Index mode = 0; mode < modes; ++mode) {
      residual.middleCols(3 * mode, 3) *= lambda(mode);
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        const Eigen::Map<
            const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
            k(cell.mixed.col(3 * i + j).data(), b, n);
        for (Eigen::Index mode = 0; mode < modes; ++mode) {
          residual.col(3 * mode + i).noalias() -= k * u.col(3 * mode + j);
        }
      }
    }
    const Eigen::VectorXd jumps = add_faces(tet, u, shapes, residual);
    Energies energy = solved(cell.stiffness, residual, modes);
    energy.col(1) *= kOneByOne * (1.0 + compactness(tet));
    energy.col(2) = jumps;
    return energy;
  }

  // Above 1 for cells less than 2.5 times as long as thick, where bubbles one by one may know as
  // little as a third of the error; 0 for flatter ones. A power of the shortest height over the
  // longest edge, by the corners.
  [[nodiscard]] double compactness(Eigen::Index tet) const {
    constexpr double kFlat = 0.25;
    constexpr double kSteep = 10.0;
    const auto corner = [&](int a) -> Eigen::Vector3d {
      return body_.points.row(body_.tets(tet, a));
    };
    double longest = 0.0;
    for (const auto& [a, b] : mesh::kTetEdges) {
      longest = std::max(longest, (corner(a) - corner(b)).norm());
    }
    double largest = 0.0;  // twice the area of a face
    for (const auto& [a, b, c] : kFaceCorners) {
      largest = std::max(largest, (corner(b) - corner(a)).cross(corner(c) - corner(a)).norm());
    }
    const double volume = straight_cell(body_, tet).volume;
    return std::pow(6.0 * volume / largest / longest / kFlat, kSteep);
  }

  // The energy r·K⁻¹r of each mode, with K the stiffness of the bubbles and r the residual; and the
  // same with the 3×3 blocks of K alone that each bubble has with itself.
  [[nodiscard]] Energies solved(const BubbleIntegrals::Products& local, const Matrix& residual,
                                Eigen::Index modes) const {
    const auto b = bubbles_.count();
    Matrix stiffness(3 * b, 3 * b);
    for (Eigen::Index a = 0, pair = 0; a < b; ++a) {
      for (Eigen::Index c = 0; c <= a; ++c, ++pair) {
        for (Eigen::Index i = 0; i < 3; ++i) {
          for (Eigen::Index j = 0; j < 3; ++j) {
            stiffness(i * b + a, j * b + c) = local(pair, 3 * i + j);
            stiffness(j * b + c, i * b + a) = local(pair, 3 * i + j);
          }
        }
      }
    }
    const Eigen::Map<const Matrix> r(residual.data(), 3 * b, modes);  // axis by axis
    const Eigen::LLT<Matrix> factor(stiffness);
    const Matrix half = factor.matrixL().solve(r);
    Energies energy = Energies::Zero(modes, 3);
    energy.col(0) = half.colwise().squaredNorm().transpose();
    for (Eigen::Index a = 0; a < b; ++a) {
      Eigen::Matrix3d own;
      for (Eigen::Index k = 0; k < 9; ++k) own(k / 3, k % 3) = local(a * (a + 3) / 2, k);
      const Eigen::LLT<Eigen::Matrix3d> one(own);
      for (Eigen::Index mode = 0; mode < modes; ++mode) {
        const Eigen::Vector3d force = residual.block<1, 3>(a, 3 * mode).transpose();
        energy(mode, 1) += force.dot(one.solve(force));
      }
    }
    return energy;
  }

  const mesh::TetMesh& body_;
  const std::vector<Material>& materials_;
  const DofMap& dofs_;
  Bubbles bubbles_;
  std::vector<std::int64_t> twin_;
  std::vector<char> straight_;
  std::vector<Eigen::Matrix<double, 9, 9>> elasticity_;
  std::vector<double> compliance_;  // under tension [1/Pa]
};

}  // namespace

Eigen::VectorXd frequency_error(const mesh::TetMesh& body, const std::vector<Material>& materials,
                                const System& system, const modal::Modes& modes) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(modes.mode_count());
  const auto rigid = modes.rigid_count;
  const auto flexible = modes.mode_count() - rigid;
  if (flexible == 0) return error;
  const Eigen::VectorXd lambda =
      (2.0 * std::numbers::pi * modes.frequency_hz.tail(flexible)).array().square();
  const Eigen::VectorXd energy =
      Estimate(body, materials, system.dofs).energy(modes.shapes.rightCols(flexible), lambda);
  // Let u be the exact answer to the force λ M φ of the mode φ. Its energy is λ + `energy`, and
  // Schwarz' quotient of φ and u is λ / (1 + energy / λ): the converged λ but for the error of the
  // shape. Half the ratio, the limit for small errors, would leave more than the whole frequency.
  error.tail(flexible) = 1.0 - (1.0 + (energy.array() / lambda.array())).rsqrt();
  return error;
}

}  // namespace chladni::fem
