#include "fem/error_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "fem/element_matrices.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;
using Products = Eigen::Matrix<double, Eigen::Dynamic, 9>;
constexpr std::array<std::array<int, 3>, 4> kFaceCorners{
    {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

// A face as one of its cells sees it: its corners ascending in number, so that both cells put the
// points of the rule at the same places.
struct FaceView {
  std::array<int, 3> corner;  // local numbers
};

FaceView face_view(const mesh::TetMesh& body, Eigen::Index tet, std::size_t face) {
  auto corner = kFaceCorners[face];
  std::sort(corner.begin(), corner.end(),
            [&](int a, int b) { return body.tets(tet, a) < body.tets(tet, b); });
  return {corner};
}

// Reference integrals of the element and of the functions one order higher that vanish at its
// nodes ("bubbles"), and all that is needed on its faces.
class Reference {
 public:
  explicit Reference(int order)
      : own(element(order)), higher(element(order + 1)), rule(triangle_rule(2 * order)) {
    Matrix at_nodes(own.nodes, higher.nodes);
    for (Eigen::Index a = 0; a < own.nodes; ++a) {
      at_nodes.row(a) = shape(higher, own.barycentric.row(a).transpose()).value.transpose();
    }
    Matrix lifted(higher.nodes, own.nodes);  // the element's functions among the higher ones
    for (Eigen::Index a = 0; a < higher.nodes; ++a) {
      lifted.row(a) = shape(own, higher.barycentric.row(a).transpose()).value.transpose();
    }
    bubbles_ = Eigen::FullPivLU<Matrix>(at_nodes).kernel();
    bubbles = bubbles_.cols();
    stiffness_bubbles.resize(bubbles * (bubbles + 1) / 2, 9);
    stiffness_mixed.resize(bubbles * own.nodes, 9);
    for (Eigen::Index k = 0; k < 9; ++k) {
      const Matrix g = square(higher.gradient_products.col(k),
                              higher.gradient_products.col(3 * (k % 3) + k / 3));
      const Matrix bb = bubbles_.transpose() * g * bubbles_;
      const Matrix mixed = bubbles_.transpose() * g * lifted;
      for (Eigen::Index a = 0, pair = 0; a < bubbles; ++a) {
        for (Eigen::Index b = 0; b <= a; ++b, ++pair) stiffness_bubbles(pair, k) = bb(a, b);
        for (Eigen::Index b = 0; b < own.nodes; ++b) {
          stiffness_mixed(a * own.nodes + b, k) = mixed(a, b);
        }
      }
    }
    mass_mixed = bubbles_.transpose() * square(higher.mass_products, higher.mass_products) * lifted;
  }

  // 3q×n: the element's derivatives by ξ at the face's points; q×b: the bubbles there.
  struct OnFace {
    Matrix gradients, bubbles;
  };
  [[nodiscard]] const OnFace& on_face(const FaceView& view) const {
    auto& found =
        faces_[static_cast<std::size_t>(16 * view.corner[0] + 4 * view.corner[1] + view.corner[2])];
    return found;
  }

  // Before the first use of on_face, so that threads only read.
  void prepare_faces() {
    for (auto corners : kFaceCorners) {
      do {
        auto& face =
            faces_[static_cast<std::size_t>(16 * corners[0] + 4 * corners[1] + corners[2])];
        face.gradients.resize(3 * rule.weights.size(), own.nodes);
        face.bubbles.resize(rule.weights.size(), bubbles);
        for (Eigen::Index q = 0; q < rule.weights.size(); ++q) {
          Eigen::Vector4d at = Eigen::Vector4d::Zero();
          for (std::size_t i = 0; i < 3; ++i) {
            at(corners[i]) = rule.points(q, static_cast<Eigen::Index>(i));
          }
          face.gradients.middleRows(3 * q, 3) = shape(own, at).gradient.transpose();
          face.bubbles.row(q) = shape(higher, at).value.transpose() * bubbles_;
        }
      } while (std::next_permutation(corners.begin(), corners.end()));
    }
  }

  const Element& own;
  const Element& higher;
  TriangleRule rule;
  Eigen::Index bubbles = 0;
  Products stiffness_bubbles, stiffness_mixed;
  Matrix mass_mixed;

 private:
  // Both triangles of an array over pairs a >= b; `mirrored` holds the values for b > a.
  [[nodiscard]] Matrix square(const Eigen::VectorXd& pairs, const Eigen::VectorXd& mirrored) const {
    Matrix full(higher.nodes, higher.nodes);
    for (Eigen::Index a = 0, pair = 0; a < higher.nodes; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
        full(b, a) = mirrored(pair);
        full(a, b) = pairs(pair);
      }
    }
    return full;
  }

  Matrix bubbles_;
  std::array<OnFace, 64> faces_;
};

// For each cell's face (4·cell + face) the same face of the cell behind it, −1 on the boundary.
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

// Outward normal times area of a face [m^2].
Eigen::Vector3d area_vector(const mesh::TetMesh& body, Eigen::Index tet, std::size_t face) {
  const auto at = [&](int i) -> Eigen::Vector3d { return body.points.row(body.tets(tet, i)); };
  const auto& c = kFaceCorners[face];
  Eigen::Vector3d normal = 0.5 * (at(c[1]) - at(c[0])).cross(at(c[2]) - at(c[0]));
  const Eigen::Vector3d inward = at(static_cast<int>(face)) - at(c[0]);
  return normal.dot(inward) > 0.0 ? Eigen::Vector3d(-normal) : normal;
}

class Estimate {
 public:
  Estimate(const mesh::TetMesh& body, const std::vector<Material>& materials, const DofMap& dofs)
      : body_(body),
        materials_(materials),
        dofs_(dofs),
        reference_(body.order()),
        twin_(twins(body)) {
    reference_.prepare_faces();
    for (const auto& material : materials) elasticity_.push_back(elasticity(material));
  }

  // Energy of the error of each mode; shapes on all nodes, 3·nodes×modes.
  Eigen::VectorXd energy(const Matrix& shapes, const Eigen::VectorXd& lambda) {
    const auto modes = shapes.cols();
    const auto points = reference_.rule.weights.size();
    // Force per point, axis and mode on each face, outward.
    tractions_.resize(3 * points * modes, 4 * body_.tet_count());
    parallel_ranges(static_cast<std::size_t>(body_.tet_count()), [&](auto begin, auto end) {
      for (auto t = begin; t < end; ++t) find_tractions(static_cast<Eigen::Index>(t), shapes);
    });
    throw_if_interrupted();
    Matrix per_cell(modes, body_.tet_count());
    parallel_ranges(static_cast<std::size_t>(body_.tet_count()), [&](auto begin, auto end) {
      for (auto t = begin; t < end; ++t) {
        const auto tet = static_cast<Eigen::Index>(t);
        per_cell.col(tet) = cell_energy(tet, shapes, lambda);
      }
    });
    return per_cell.rowwise().sum();
  }

 private:
  // n×3·modes: column 3·mode + axis.
  [[nodiscard]] Matrix displacements(Eigen::Index tet, const Matrix& shapes) const {
    Matrix u(reference_.own.nodes, 3 * shapes.cols());
    for (Eigen::Index a = 0; a < u.rows(); ++a) {
      const Eigen::Index row = 3 * Eigen::Index{body_.tets(tet, a)};
      for (Eigen::Index mode = 0; mode < shapes.cols(); ++mode) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          u(a, 3 * mode + axis) = shapes(row + axis, mode);
        }
      }
    }
    return u;
  }

  void find_tractions(Eigen::Index tet, const Matrix& shapes) {
    const auto cell = straight_cell(body_, tet);
    const auto& c = materials_[static_cast<std::size_t>(body_.region(tet))].stiffness;
    const Matrix u = displacements(tet, shapes);
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& on_face = reference_.on_face(face_view(body_, tet, f));
      const Eigen::Vector3d n = area_vector(body_, tet, f);
      const Matrix slopes = on_face.gradients * u;  // 3q×3·modes, by ξ
      Eigen::Index row = 0;
      auto to = tractions_.col(4 * tet + static_cast<Eigen::Index>(f));
      for (Eigen::Index q = 0; q < reference_.rule.weights.size(); ++q) {
        for (Eigen::Index mode = 0; mode < shapes.cols(); ++mode, row += 3) {
          const Eigen::Matrix3d h =  // ∂u_i/∂x_k at row i
              slopes.block<3, 3>(3 * q, 3 * mode).transpose() * cell.gradient;
          Eigen::Matrix<double, 6, 1> strain;
          strain << h(0, 0), h(1, 1), h(2, 2), h(1, 2) + h(2, 1), h(0, 2) + h(2, 0),
              h(0, 1) + h(1, 0);
          const Eigen::Matrix<double, 6, 1> s = c * strain;
          to(row) = s(0) * n(0) + s(5) * n(1) + s(4) * n(2);
          to(row + 1) = s(5) * n(0) + s(1) * n(1) + s(3) * n(2);
          to(row + 2) = s(4) * n(0) + s(3) * n(1) + s(2) * n(2);
        }
      }
    }
  }

  [[nodiscard]] bool is_held(Eigen::Index tet, std::size_t face, Eigen::Index axis) const {
    return std::all_of(kFaceCorners[face].begin(), kFaceCorners[face].end(), [&](int corner) {
      return dofs_.free_dof(3 * Eigen::Index{body_.tets(tet, corner)} + axis) < 0;
    });
  }

  // Adds ∫ t·v over the faces: the mean of both sides' tractions; none on a free surface, the
  // cell's own where a support pushes back.
  void add_faces(Eigen::Index tet, Eigen::Index modes, Matrix& residual) const {
    for (std::size_t f = 0; f < 4; ++f) {
      const auto place = 4 * tet + static_cast<Eigen::Index>(f);
      const auto twin = twin_[static_cast<std::size_t>(place)];
      const auto& on_face = reference_.on_face(face_view(body_, tet, f));
      std::array<double, 3> own_part{0.5, 0.5, 0.5};
      if (twin < 0) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          own_part[static_cast<std::size_t>(axis)] = is_held(tet, f, axis) ? 1.0 : 0.0;
        }
      }
      Eigen::Index row = 0;
      for (Eigen::Index q = 0; q < reference_.rule.weights.size(); ++q) {
        for (Eigen::Index mode = 0; mode < modes; ++mode) {
          for (Eigen::Index axis = 0; axis < 3; ++axis, ++row) {
            double t = own_part[static_cast<std::size_t>(axis)] * tractions_(row, place);
            if (twin >= 0) t -= 0.5 * tractions_(row, twin);
            if (t == 0.0) continue;
            residual.col(3 * mode + axis) +=
                (reference_.rule.weights(q) * t) * on_face.bubbles.row(q).transpose();
          }
        }
      }
    }
  }

  [[nodiscard]] Eigen::VectorXd cell_energy(Eigen::Index tet, const Matrix& shapes,
                                            const Eigen::VectorXd& lambda) const {
    const auto region = static_cast<std::size_t>(body_.region(tet));
    const auto cell = straight_cell(body_, tet);
    const auto factors = stiffness_factors(cell, elasticity_[region]);
    const auto b = reference_.bubbles;
    const auto n = Eigen::Index{reference_.own.nodes};
    Products local(reference_.stiffness_bubbles.rows(), 9);
    combine(reference_.stiffness_bubbles.data(), factors.data(), local.data(), local.rows());
    Products mixed(reference_.stiffness_mixed.rows(), 9);
    combine(reference_.stiffness_mixed.data(), factors.data(), mixed.data(), mixed.rows());

    const Matrix u = displacements(tet, shapes);
    const auto modes = shapes.cols();
    const double mass = materials_[region].density * cell.volume;
    Matrix residual = mass * (reference_.mass_mixed * u);  // b×3·modes
    for (Eigen::Index mode = 0; mode < modes; ++mode) {
      residual.middleCols(3 * mode, 3) *= lambda(mode);
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        const Eigen::Map<
            const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
            k(mixed.col(3 * i + j).data(), b, n);
        for (Eigen::Index mode = 0; mode < modes; ++mode) {
          residual.col(3 * mode + i).noalias() -= k * u.col(3 * mode + j);
        }
      }
    }
    add_faces(tet, modes, residual);
    return solved(local, residual, modes);
  }

  // r·K⁻¹r of the bubbles, per mode.
  [[nodiscard]] Eigen::VectorXd solved(const Products& local, const Matrix& residual,
                                       Eigen::Index modes) const {
    const auto b = reference_.bubbles;
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
  Reference reference_;
  std::vector<std::int64_t> twin_;
  std::vector<Eigen::Matrix<double, 9, 9>> elasticity_;
  Matrix tractions_;
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
  Estimate estimate(body, materials, system.dofs);
  // Tractions of all faces are kept: a few modes at a time, up to about 200 MB.
  const double bytes_per_mode = 8.0 * 3.0 * 12.0 * 4.0 * static_cast<double>(body.tet_count());
  const auto at_once =
      std::clamp<Eigen::Index>(static_cast<Eigen::Index>(2e8 / bytes_per_mode), 1, flexible);
  for (Eigen::Index first = 0; first < flexible; first += at_once) {
    const auto count = std::min(at_once, flexible - first);
    const Matrix shapes = on_nodes(system.dofs, modes.shapes.middleCols(rigid + first, count));
    const Eigen::VectorXd energy = estimate.energy(shapes, lambda.segment(first, count));
    error.segment(rigid + first, count) = 0.5 * energy.cwiseQuotient(lambda.segment(first, count));
  }
  return error;
}

}  // namespace chladni::fem
