#include "fem/element/bubbles.h"

#include <Eigen/Dense>
#include <algorithm>

#include "fem/element/element_matrices.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;
using Products = BubbleIntegrals::Products;

std::size_t place_of(const std::array<int, 3>& corner) {
  return static_cast<std::size_t>(16 * corner[0] + 4 * corner[1] + corner[2]);
}

// The full matrix from an array over pairs a >= b. `mirrored` holds the values for b > a.
Matrix square(Eigen::Index size, const Eigen::VectorXd& pairs, const Eigen::VectorXd& mirrored) {
  Matrix full(size, size);
  for (Eigen::Index a = 0, pair = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
      full(b, a) = mirrored(pair);
      full(a, b) = pairs(pair);
    }
  }
  return full;
}

// Stores products of derivatives in column `k`: bubble by bubble (a >= b) and bubble by node.
void keep(const Matrix& among, const Matrix& mixed, Eigen::Index k, BubbleIntegrals& to) {
  for (Eigen::Index a = 0, pair = 0; a < among.rows(); ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++pair) to.stiffness(pair, k) = among(a, b);
    for (Eigen::Index b = 0; b < mixed.cols(); ++b) {
      to.mixed(a * mixed.cols() + b, k) = mixed(a, b);
    }
  }
}

BubbleIntegrals sized(Eigen::Index bubbles, Eigen::Index nodes) {
  return {Products(bubbles * (bubbles + 1) / 2, 9), Products(bubbles * nodes, 9),
          Matrix(bubbles, nodes)};
}

BubbleIntegrals combined(const BubbleIntegrals& from, const Eigen::Matrix<double, 9, 9>& factors) {
  BubbleIntegrals to{Products(from.stiffness.rows(), 9), Products(from.mixed.rows(), 9), from.mass};
  combine(from.stiffness.data(), factors.data(), to.stiffness.data(), to.stiffness.rows());
  combine(from.mixed.data(), factors.data(), to.mixed.data(), to.mixed.rows());
  return to;
}

Matrix nodes_of(const mesh::TetMesh& body, Eigen::Index tet, int count) {
  Matrix nodes(count, 3);
  for (Eigen::Index a = 0; a < count; ++a) nodes.row(a) = body.points.row(body.tets(tet, a));
  return nodes;
}

// The bubbles of order 2, by the values at the nodes of order 3 (20×10): λaλb(λa − λb) of each
// edge, then λaλbλc of each face. Each is the same, but for its sign, from every corner of the cell
// and from every cell of its edge or face.
Matrix cubic_bubbles(const Element& higher) {
  const auto at = [&](int corner) { return higher.barycentric.col(corner).array(); };
  Matrix bubbles(higher.nodes, 10);
  Eigen::Index column = 0;
  for (const auto& [a, b] : mesh::kTetEdges) {
    bubbles.col(column++) = at(a) * at(b) * (at(a) - at(b));
  }
  for (const auto& [a, b, c] : kFaceCorners) bubbles.col(column++) = at(a) * at(b) * at(c);
  return bubbles;
}

// Some basis of the functions of `higher` that vanish at the nodes of `own`.
Matrix any_bubbles(const Element& own, const Element& higher) {
  Matrix at_nodes(own.nodes, higher.nodes);
  for (Eigen::Index a = 0; a < own.nodes; ++a) {
    at_nodes.row(a) = shape(higher, own.barycentric.row(a).transpose()).value.transpose();
  }
  return Eigen::FullPivLU<Matrix>(at_nodes).kernel();
}

}  // namespace

Bubbles::Bubbles(int order)
    : own_(element(order)), higher_(element(order + 1)), face_rule_(triangle_rule(2 * order)) {
  bubbles_ = order == 2 ? cubic_bubbles(higher_) : any_bubbles(own_, higher_);
  integrate_reference();
  prepare_faces();
  prepare_points();
}

ShapeValues Bubbles::bubble_shape(const Eigen::Vector4d& barycentric) const {
  const auto at = shape(higher_, barycentric);
  return {bubbles_.transpose() * at.value, bubbles_.transpose() * at.gradient};
}

void Bubbles::integrate_reference() {
  Matrix lifted(higher_.nodes, own_.nodes);  // the element's functions in terms of the higher ones
  for (Eigen::Index a = 0; a < higher_.nodes; ++a) {
    lifted.row(a) = shape(own_, higher_.barycentric.row(a).transpose()).value.transpose();
  }
  reference_ = sized(count(), own_.nodes);
  for (Eigen::Index k = 0; k < 9; ++k) {
    const Matrix g = square(higher_.nodes, higher_.gradient_products.col(k),
                            higher_.gradient_products.col(3 * (k % 3) + k / 3));
    keep(bubbles_.transpose() * g * bubbles_, bubbles_.transpose() * g * lifted, k, reference_);
  }
  reference_.mass = bubbles_.transpose() *
                    square(higher_.nodes, higher_.mass_products, higher_.mass_products) * lifted;
}

void Bubbles::prepare_faces() {
  const auto points = face_rule_.weights.size();
  for (auto corners : kFaceCorners) {
    do {
      auto& face = faces_[place_of(corners)];
      face = {corners, Matrix(3 * points, own_.nodes), Matrix(points, count())};
      for (Eigen::Index q = 0; q < points; ++q) {
        Eigen::Vector4d at = Eigen::Vector4d::Zero();
        for (std::size_t i = 0; i < 3; ++i) {
          at(corners[i]) = face_rule_.points(q, static_cast<Eigen::Index>(i));
        }
        face.gradients.middleRows(3 * q, 3) = shape(own_, at).gradient.transpose();
        face.bubbles.row(q) = bubble_shape(at).value.transpose();
      }
    } while (std::next_permutation(corners.begin(), corners.end()));
  }
}

void Bubbles::prepare_points() {
  const auto rule = tet_rule(2 * own_.order + 2);
  weights_ = rule.weights;
  for (const auto point : rule.points.rowwise()) {
    at_points_.push_back({shape(own_, point.transpose()), bubble_shape(point.transpose())});
  }
}

const Bubbles::OnFace& Bubbles::on_face(const mesh::TetMesh& body, Eigen::Index tet,
                                        std::size_t face) const {
  auto corner = kFaceCorners[face];
  std::sort(corner.begin(), corner.end(),
            [&](int a, int b) { return body.tets(tet, a) < body.tets(tet, b); });
  return faces_[place_of(corner)];
}

// The area vector of the face opposite corner f is −½ det J ∇λ_f.
FaceGeometry Bubbles::geometry(const mesh::TetMesh& body, Eigen::Index tet, std::size_t face,
                               bool straight) const {
  const auto area = [&](double determinant, const Eigen::Matrix3d& gradient) -> Eigen::Vector3d {
    const Eigen::RowVector3d slope =
        face == 0 ? Eigen::RowVector3d(-gradient.colwise().sum())
                  : Eigen::RowVector3d(gradient.row(static_cast<Eigen::Index>(face) - 1));
    return -0.5 * determinant * slope.transpose();
  };
  const auto points = face_rule_.weights.size();
  FaceGeometry result;
  if (straight) {
    const auto cell = straight_cell(body, tet);
    result.gradient.assign(static_cast<std::size_t>(points), cell.gradient);
    result.area.assign(static_cast<std::size_t>(points), area(6.0 * cell.volume, cell.gradient));
    return result;
  }
  const Matrix nodes = nodes_of(body, tet, own_.nodes);
  const Matrix slopes = on_face(body, tet, face).gradients * nodes;  // ∂x/∂ξ, transposed
  for (Eigen::Index q = 0; q < points; ++q) {
    const Eigen::Matrix3d jacobian = slopes.middleRows<3>(3 * q).transpose();
    result.gradient.emplace_back(jacobian.inverse());
    result.area.push_back(area(jacobian.determinant(), result.gradient.back()));
  }
  return result;
}

BubbleIntegrals Bubbles::integrals(const mesh::TetMesh& body, Eigen::Index tet, bool straight,
                                   const Material& material,
                                   const Eigen::Matrix<double, 9, 9>& elasticity) const {
  return straight ? straight_integrals(body, tet, material.density, elasticity)
                  : curved_integrals(body, tet, material.density, elasticity);
}

BubbleIntegrals Bubbles::straight_integrals(const mesh::TetMesh& body, Eigen::Index tet,
                                            double density,
                                            const Eigen::Matrix<double, 9, 9>& elasticity) const {
  const auto cell = straight_cell(body, tet);
  auto result = combined(reference_, stiffness_factors(cell, elasticity));
  result.mass *= density * cell.volume;
  return result;
}

BubbleIntegrals Bubbles::curved_integrals(const mesh::TetMesh& body, Eigen::Index tet,
                                          double density,
                                          const Eigen::Matrix<double, 9, 9>& elasticity) const {
  const Matrix nodes = nodes_of(body, tet, own_.nodes);
  const auto points = weights_.size();
  std::array<Matrix, 3> own_slope, bubble_slope;  // per axis; a column per point
  own_slope.fill(Matrix(own_.nodes, points));
  bubble_slope.fill(Matrix(count(), points));
  std::array<Matrix, 3> weighted = bubble_slope;
  BubbleIntegrals gradients = sized(count(), own_.nodes);
  gradients.mass.setZero();
  for (Eigen::Index q = 0; q < points; ++q) {
    const auto& at = at_points_[static_cast<std::size_t>(q)];
    const Eigen::Matrix3d jacobian = nodes.transpose() * at.own.gradient;
    const Eigen::Matrix3d inverse = jacobian.inverse();
    const double w = weights_(q) * jacobian.determinant() / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      own_slope[k].col(q) = at.own.gradient * inverse.col(axis);
      bubble_slope[k].col(q) = at.bubble.gradient * inverse.col(axis);
      weighted[k].col(q) = w * bubble_slope[k].col(q);
    }
    gradients.mass.noalias() += (density * w) * at.bubble.value * at.own.value.transpose();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t l = 0; l < 3; ++l) {
      keep(weighted[k] * bubble_slope[l].transpose(), weighted[k] * own_slope[l].transpose(),
           static_cast<Eigen::Index>(3 * k + l), gradients);
    }
  }
  return combined(gradients, elasticity);
}

}  // namespace chladni::fem
