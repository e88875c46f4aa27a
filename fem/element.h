// Tetrahedral Lagrange elements: shape functions and, for straight sides, matrices in closed form.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

namespace chladni::fem {

/// One kind of element. An integral over a straight-sided tetrahedron follows from the integral
/// over the reference tetrahedron, the volume and the constant gradients. No quadrature is needed.
struct Element {
  std::string_view name;     ///< as `chladni list elements` and a study show it: "tet10"
  std::string_view summary;  ///< one line
  std::string_view source;
  int order = 0;                ///< polynomial degree
  int nodes = 0;                ///< n
  Eigen::MatrixXd barycentric;  ///< n×4, node positions, in VTK's order
  /// Row of a pair (a, b), a >= b, at a(a+1)/2 + b; columns 3i + j: the mean over the element of
  /// ∂N_a/∂ξ_i ∂N_b/∂ξ_j, where ξ = (λ1, λ2, λ3).
  Eigen::Matrix<double, Eigen::Dynamic, 9> gradient_products;
  Eigen::VectorXd mass_products;  ///< per pair: the mean over the element of N_a N_b
};

/// The element of `order` 1, 2 or 3 (built once, then kept); order 4 serves the error estimate.
/// @throws InvalidInput  another order
[[nodiscard]] const Element& element(int order);

/// The elements that a study may ask for, by order.
[[nodiscard]] std::span<const Element* const> elements();

/// Shape functions and their derivatives by ξ = (λ1, λ2, λ3) at a point with barycentric
/// coordinates (λ0 ... λ3): n values, n×3 derivatives.
struct ShapeValues {
  Eigen::VectorXd value;
  Eigen::Matrix<double, Eigen::Dynamic, 3> gradient;
};
[[nodiscard]] ShapeValues shape(const Element& element, const Eigen::Vector4d& barycentric);

/// Points (barycentric, q×4) and weights (q, sum 1), exact for polynomials of `degree` on a
/// tetrahedron: Gauss-Jacobi in each direction of the collapsed cube (Stroud 1971). All weights are
/// positive.
struct TetRule {
  Eigen::Matrix<double, Eigen::Dynamic, 4> points;
  Eigen::VectorXd weights;
};
[[nodiscard]] TetRule tet_rule(int degree);

/// The rule on a triangle: points (barycentric, q×3) and weights (q, sum 1).
struct TriangleRule {
  Eigen::Matrix<double, Eigen::Dynamic, 3> points;
  Eigen::VectorXd weights;
};
[[nodiscard]] TriangleRule triangle_rule(int degree);

}  // namespace chladni::fem
