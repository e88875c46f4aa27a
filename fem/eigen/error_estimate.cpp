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

class Estimate {
 public:
  Estimate(const mesh::TetMesh& body, const std::vector<Material>& materials, const DofMap& dofs)
      : body_(body),
        materials_(materials),
        dofs_(dofs),
        bubbles_(body.order()),
        twin_(twins(body)),
        straight_(static_cast<std::size_t>(body.tet_count())) {
    for (const auto& material : materials) elasticity_.push_back(elasticity(material));
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      straight_[static_cast<std::size_t>(t)] = is_straight(body, bubbles_.own(), t) ? 1 : 0;
    }
  }

  // Energy of the error of each mode. The shapes are on the free degrees of freedom, n×modes. The
  // parts of the sum do not depend on the number of threads.
  Eigen::VectorXd energy(const ShapeColumns& shapes, const Eigen::VectorXd& lambda) const {
    constexpr Eigen::Index kParts = 256;
    Matrix sums = Matrix::Zero(shapes.cols(), kParts);
    parallel_ranges(static_cast<std::size_t>(kParts), [&](std::size_t begin, std::size_t end) {
      for (auto part = static_cast<Eigen::Index>(begin); part < static_cast<Eigen::Index>(end);
           ++part) {
        const auto last = (part + 1) * body_.tet_count() / kParts;
        for (auto tet = part * body_.tet_count() / kParts; tet < last; ++tet) {
          if (tet % 64 == 0) throw_if_interrupted();
          sums.col(part) += cell_energy(tet, shapes, lambda);
        }
      }
    });
    return sums.rowwise().sum();
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

  [[nodiscard]] bool is_held(Eigen::Index tet, std::size_t face, Eigen::Index axis) const {
    return std::all_of(kFaceCorners[face].begin(), kFaceCorners[face].end(), [&](int corner) {
      return dofs_.free_dof(3 * Eigen::Index{body_.tets(tet, corner)} + axis) < 0;
    });
  }

  // The mean of the tractions of both sides of face f (the outward normals are opposite). The force
  // is zero on a free surface. It is the cell's own traction along axes that a support holds.
  [[nodiscard]] Eigen::VectorXd force_on(Eigen::Index tet, std::size_t f, const Matrix& u,
                                         const ShapeColumns& shapes) const {
    const auto twin = twin_[static_cast<std::size_t>(4 * tet) + f];
    Eigen::VectorXd force = tractions(tet, f, u);
    if (twin >= 0) {
      const auto behind = static_cast<Eigen::Index>(twin / 4);
      return 0.5 * (force - tractions(behind, static_cast<std::size_t>(twin % 4),
                                      displacements(behind, shapes)));
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (is_held(tet, f, axis)) continue;
      for (Eigen::Index row = axis; row < force.size(); row += 3) force(row) = 0.0;
    }
    return force;
  }

  // Adds ∫ t·v over the faces.
  void add_faces(Eigen::Index tet, const Matrix& u, const ShapeColumns& shapes,
                 Matrix& residual) const {
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& on_face = bubbles_.on_face(body_, tet, f);
      const Eigen::VectorXd force = force_on(tet, f, u, shapes);
      Eigen::Index row = 0;
      for (Eigen::Index q = 0; q < bubbles_.face_weights().size(); ++q) {
        for (Eigen::Index column = 0; column < u.cols(); ++column, ++row) {
          if (force(row) == 0.0) continue;
          residual.col(column) +=
              (bubbles_.face_weights()(q) * force(row)) * on_face.bubbles.row(q).transpose();
        }
      }
    }
  }

  [[nodiscard]] Eigen::VectorXd cell_energy(Eigen::Index tet, const ShapeColumns& shapes,
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
    add_faces(tet, u, shapes, residual);
    return solved(cell.stiffness, residual, modes);
  }

  // The energy r·K⁻¹r of each mode, with K the stiffness of the bubbles and r the residual.
  [[nodiscard]] Eigen::VectorXd solved(const BubbleIntegrals::Products& local,
                                       const Matrix& residual, Eigen::Index modes) const {
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
    return half.colwise().squaredNorm().transpose();
  }

  const mesh::TetMesh& body_;
  const std::vector<Material>& materials_;
  const DofMap& dofs_;
  Bubbles bubbles_;
  std::vector<std::int64_t> twin_;
  std::vector<char> straight_;
  std::vector<Eigen::Matrix<double, 9, 9>> elasticity_;
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
  error.tail(flexible) = 0.5 * energy.cwiseQuotient(lambda);
  return error;
}

}  // namespace chladni::fem
