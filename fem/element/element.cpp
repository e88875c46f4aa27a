#include "fem/element.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {
namespace {

// A polynomial in the four barycentric coordinates: exponents -> coefficient.
using Exponents = std::array<int, 4>;
using Polynomial = std::map<Exponents, double>;

Polynomial product(const Polynomial& p, const Polynomial& q) {
  Polynomial result;
  for (const auto& [i, a] : p) {
    for (const auto& [j, b] : q) {
      result[{i[0] + j[0], i[1] + j[1], i[2] + j[2], i[3] + j[3]}] += a * b;
    }
  }
  return result;
}

Polynomial derivative(const Polynomial& p, std::size_t axis) {
  Polynomial result;
  for (const auto& [exponents, a] : p) {
    if (exponents[axis] == 0) continue;
    Exponents lower = exponents;
    --lower[axis];
    result[lower] += a * exponents[axis];
  }
  return result;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

// Mean over a tetrahedron: 3! α! / (|α| + 3)!.
double mean(const Polynomial& p) {
  double sum = 0.0;
  for (const auto& [e, a] : p) {
    sum += a * 6.0 * factorial(e[0]) * factorial(e[1]) * factorial(e[2]) * factorial(e[3]) /
           factorial(e[0] + e[1] + e[2] + e[3] + 3);
  }
  return sum;
}

// The Lagrange polynomial that is 1 at the node n/p of the equidistant lattice and 0 at the others:
// Π_i Π_{m < n_i} (p λ_i − m) / (m + 1)  (Silvester 1969).
Polynomial lagrange(const Exponents& node, int order) {
  Polynomial result{{{0, 0, 0, 0}, 1.0}};
  for (std::size_t i = 0; i < 4; ++i) {
    for (int m = 0; m < node[i]; ++m) {
      Exponents linear{};
      linear[i] = 1;
      result = product(result, {{linear, order / (m + 1.0)}, {{0, 0, 0, 0}, -m / (m + 1.0)}});
    }
  }
  return result;
}

// Barycentric coordinates of the nodes. The mesh has no cell type of order 4, so order 4 lists the
// corners first and then the other nodes in loop order.
Eigen::MatrixXd lattice(int order) {
  if (order <= 3) return mesh::tet_node_barycentric(order);
  Eigen::MatrixXd nodes((order + 1) * (order + 2) * (order + 3) / 6, 4);
  nodes.topRows(4).setIdentity();
  Eigen::Index row = 4;
  for (int i = 0; i <= order; ++i) {
    for (int j = 0; i + j <= order; ++j) {
      for (int k = 0; i + j + k <= order; ++k) {
        const Eigen::RowVector4d at =
            Eigen::RowVector4d(order - i - j - k, i, j, k) / static_cast<double>(order);
        if (at.maxCoeff() < 1.0) nodes.row(row++) = at;
      }
    }
  }
  return nodes;
}

std::vector<Polynomial> basis(const Eigen::MatrixXd& barycentric, int order) {
  std::vector<Polynomial> functions;
  for (Eigen::Index a = 0; a < barycentric.rows(); ++a) {
    Exponents node{};
    for (std::size_t i = 0; i < 4; ++i) {
      node[i] = static_cast<int>(std::lround(order * barycentric(a, static_cast<Eigen::Index>(i))));
    }
    functions.push_back(lagrange(node, order));
  }
  return functions;
}

// ∂/∂ξ_i at fixed ξ_j = ∂/∂λ_i − ∂/∂λ_0, because λ_0 = 1 − ξ_1 − ξ_2 − ξ_3.
std::array<Polynomial, 3> gradient(const Polynomial& p) {
  std::array<Polynomial, 3> result;
  const Polynomial by_first = derivative(p, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = derivative(p, i + 1);
    for (const auto& [e, a] : by_first) result[i][e] -= a;
  }
  return result;
}

Element build(std::string_view name, std::string_view summary, std::string_view source, int order) {
  Element e;
  e.name = name;
  e.summary = summary;
  e.source = source;
  e.order = order;
  e.barycentric = lattice(order);
  e.nodes = static_cast<int>(e.barycentric.rows());
  const auto functions = basis(e.barycentric, order);
  std::vector<std::array<Polynomial, 3>> gradients;
  for (const auto& f : functions) gradients.push_back(gradient(f));
  const Eigen::Index pairs = Eigen::Index{e.nodes} * (e.nodes + 1) / 2;
  e.gradient_products.resize(pairs, 9);
  e.mass_products.resize(pairs);
  Eigen::Index pair = 0;
  for (std::size_t a = 0; a < functions.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++pair) {
      e.mass_products(pair) = mean(product(functions[a], functions[b]));
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          e.gradient_products(pair, static_cast<Eigen::Index>(3 * i + j)) =
              mean(product(gradients[a][i], gradients[b][j]));
        }
      }
    }
  }
  return e;
}

constexpr std::string_view kSource =
    "Zienkiewicz, Taylor and Zhu (2013), The Finite Element Method";

// To add an element, add a function here and list it in `element` and `elements`. The property
// suite in tests/fem/element_test.cpp then tests it automatically.
const Element& tet4() {
  static const Element e =
      build("tet4", "linear tetrahedron, far too stiff: for comparison", kSource, 1);
  return e;
}
const Element& tet10() {
  static const Element e = build("tet10", "quadratic tetrahedron", kSource, 2);
  return e;
}
const Element& tet20() {
  static const Element e = build("tet20", "cubic tetrahedron, for plates and ribs", kSource, 3);
  return e;
}
const Element& tet35() {
  static const Element e = build("tet35", "quartic tetrahedron, for error estimates", kSource, 4);
  return e;
}

// λ^k by repeated products: k is at most 4.
double power(double x, int k) {
  double result = 1.0;
  for (; k > 0; --k) result *= x;
  return result;
}

double value(const Polynomial& p, const Eigen::Vector4d& at) {
  double sum = 0.0;
  for (const auto& [e, a] : p) {
    sum += a * power(at(0), e[0]) * power(at(1), e[1]) * power(at(2), e[2]) * power(at(3), e[3]);
  }
  return sum;
}

// Nodes on (0, 1) and weights (sum 1) for ∫ (1−x)^k f(x) dx · (k+1), by Golub and Welsch (1969).
std::pair<Eigen::VectorXd, Eigen::VectorXd> gauss_jacobi(int points, int k) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
  for (int n = 0; n < points; ++n) {
    const double s = 2.0 * n + k;
    jacobi(n, n) = n == 0 && k == 0 ? 0.0 : -1.0 * k * k / (s * (s + 2.0));
    if (n > 0) {
      const double c = 4.0 * n * n * (n + k) * (n + k) / (s * s * (s + 1.0) * (s - 1.0));
      jacobi(n, n - 1) = jacobi(n - 1, n) = std::sqrt(c);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  Eigen::VectorXd x = (solver.eigenvalues().array() + 1.0) / 2.0;
  Eigen::VectorXd w = solver.eigenvectors().row(0).array().square();
  return {std::move(x), std::move(w)};
}

}  // namespace

const Element& element(int order) {
  switch (order) {
    case 1:
      return tet4();
    case 2:
      return tet10();
    case 3:
      return tet20();
    case 4:
      return tet35();
    default:
      throw InvalidInput("element: order is " + fmt::to_string(order) + ", expected 1, 2 or 3");
  }
}

std::span<const Element* const> elements() {
  static const std::array<const Element*, 3> elements{&tet4(), &tet10(), &tet20()};
  return elements;
}

ShapeValues shape(const Element& element, const Eigen::Vector4d& barycentric) {
  static const std::array<std::vector<Polynomial>, 4> functions{
      basis(lattice(1), 1), basis(lattice(2), 2), basis(lattice(3), 3), basis(lattice(4), 4)};
  const auto& own = functions[static_cast<std::size_t>(element.order - 1)];
  ShapeValues result{Eigen::VectorXd(element.nodes),
                     Eigen::Matrix<double, Eigen::Dynamic, 3>(element.nodes, 3)};
  for (Eigen::Index a = 0; a < element.nodes; ++a) {
    const auto& f = own[static_cast<std::size_t>(a)];
    result.value(a) = value(f, barycentric);
    const auto slopes = gradient(f);
    for (std::size_t i = 0; i < 3; ++i) {
      result.gradient(a, static_cast<Eigen::Index>(i)) = value(slopes[i], barycentric);
    }
  }
  return result;
}

TetRule tet_rule(int degree) {
  const int n = degree / 2 + 1;
  const auto [u, wu] = gauss_jacobi(n, 2);
  const auto [v, wv] = gauss_jacobi(n, 1);
  const auto [t, wt] = gauss_jacobi(n, 0);
  TetRule rule{Eigen::Matrix<double, Eigen::Dynamic, 4>(n * n * n, 4), Eigen::VectorXd(n * n * n)};
  Eigen::Index q = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k, ++q) {
        const double a = u(i);
        const double b = v(j) * (1.0 - a);
        const double c = t(k) * (1.0 - a - b);
        rule.points.row(q) << 1.0 - a - b - c, a, b, c;
        rule.weights(q) = wu(i) * wv(j) * wt(k);
      }
    }
  }
  return rule;
}

TriangleRule triangle_rule(int degree) {
  const int n = degree / 2 + 1;
  const auto [u, wu] = gauss_jacobi(n, 1);
  const auto [v, wv] = gauss_jacobi(n, 0);
  TriangleRule rule{Eigen::Matrix<double, Eigen::Dynamic, 3>(n * n, 3), Eigen::VectorXd(n * n)};
  Eigen::Index q = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j, ++q) {
      const double a = u(i);
      const double b = v(j) * (1.0 - a);
      rule.points.row(q) << 1.0 - a - b, a, b;
      rule.weights(q) = wu(i) * wv(j);
    }
  }
  return rule;
}

}  // namespace chladni::fem
