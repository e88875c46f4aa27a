// The space in which the error of an element is computed: polynomials of one order higher that
// vanish at the element's nodes ("bubbles").
#pragma once

#include <array>
#include <vector>

#include "fem/element.h"
#include "fem/material.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// Corners of each face of a tetrahedron. Face f is opposite corner f.
inline constexpr std::array<std::array<int, 3>, 4> kFaceCorners{
    {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Integrals over one cell with b bubbles and n nodes.
struct BubbleIntegrals {
  using Products = Eigen::Matrix<double, Eigen::Dynamic, 9>;
  Products stiffness;    ///< b(b+1)/2×9, as ElementMatrices: energy among bubbles [N/m]
  Products mixed;        ///< b·n×9, row a·n + c, column 3i + j: bubble a with node c [N/m]
  Eigen::MatrixXd mass;  ///< b×n [kg]
};

/// Geometry of one side of a face, at the points of the rule.
struct FaceGeometry {
  std::vector<Eigen::Matrix3d> gradient;  ///< row m: ∇ξ_m [1/m]
  std::vector<Eigen::Vector3d> area;      ///< outward normal times the area that belongs to the
                                          ///< point for a weight of 1 [m^2]
};

/// The bubbles of one element, with their integrals and values on the reference tetrahedron.
class Bubbles {
 public:
  /// @param order  of the element, 1 to 3
  explicit Bubbles(int order);

  /// Shape functions on a face. The face's corners are in ascending order of their nodes, so that
  /// both cells of the face have the points at the same places.
  struct OnFace {
    std::array<int, 3> corner{};
    Eigen::MatrixXd gradients;  ///< 3q×n: derivatives of the element's functions by ξ
    Eigen::MatrixXd bubbles;    ///< q×b
  };
  [[nodiscard]] const OnFace& on_face(const mesh::TetMesh& body, Eigen::Index tet,
                                      std::size_t face) const;
  [[nodiscard]] FaceGeometry geometry(const mesh::TetMesh& body, Eigen::Index tet, std::size_t face,
                                      bool straight) const;

  /// The integrals over one cell, in closed form on straight cells and by quadrature on curved
  /// ones.
  /// Cost: about 10^5 operations on a straight tet10, 10^6 on a curved one.
  [[nodiscard]] BubbleIntegrals integrals(const mesh::TetMesh& body, Eigen::Index tet,
                                          bool straight, const Material& material,
                                          const Eigen::Matrix<double, 9, 9>& elasticity) const;

  [[nodiscard]] const Element& own() const { return own_; }
  [[nodiscard]] Eigen::Index count() const { return bubbles_.cols(); }
  [[nodiscard]] const Eigen::VectorXd& face_weights() const { return face_rule_.weights; }

 private:
  struct AtPoint {
    ShapeValues own, bubble;
  };
  void integrate_reference();
  void prepare_faces();
  void prepare_points();
  [[nodiscard]] ShapeValues bubble_shape(const Eigen::Vector4d& barycentric) const;
  [[nodiscard]] BubbleIntegrals straight_integrals(
      const mesh::TetMesh& body, Eigen::Index tet, double density,
      const Eigen::Matrix<double, 9, 9>& elasticity) const;
  [[nodiscard]] BubbleIntegrals curved_integrals(
      const mesh::TetMesh& body, Eigen::Index tet, double density,
      const Eigen::Matrix<double, 9, 9>& elasticity) const;

  const Element& own_;
  const Element& higher_;
  TriangleRule face_rule_;
  Eigen::MatrixXd bubbles_;    // higher.nodes×b: coefficients of the higher functions
  BubbleIntegrals reference_;  // means over the reference element, derivatives by ξ
  std::vector<AtPoint> at_points_;
  Eigen::VectorXd weights_;
  std::array<OnFace, 64> faces_;
};

}  // namespace chladni::fem
