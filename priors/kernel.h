// Covariance functions: the correlation of a shape's values at two places.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/arrays.h"

namespace chladni::priors {

/// One contiguous column per axis, for the loops of kernels; Points converts to it.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using CoordinatesView = Eigen::Ref<const Coordinates>;  ///< rows of Coordinates, not copied

/// One length for all axes, or one per axis (x, y, z).
enum class Scales { isotropic, per_axis };

/// A positive number that shapes a kernel.
struct Hyperparameter {
  std::string name;
  std::string unit;            ///< "m" for a length, with a range from the points; else "1"
  double least = 0, most = 0;  ///< useful range, for unit "1"
};

/// k(x_i, x') of n points x_i with one point x', and derivatives with respect to the natural
/// logarithm of each of the p hyper-parameters.
struct KernelColumn {
  Eigen::ArrayXd value;      ///< n
  Eigen::ArrayXXd gradient;  ///< n×p, computed on request
  bool wants_gradient = false;
};

/// An entry of the table kernels(). Stationary kernels are 1 at distance 0.
struct KernelFamily {
  std::string_view name;     ///< as a study writes it: kernel = "matern_5_2"
  std::string_view summary;  ///< one line, with the formula
  std::string_view source;
  bool is_stationary;  ///< depends only on x − x'
  bool is_isotropic;   ///< with one scale for all axes it depends only on |x − x'|
  std::vector<Hyperparameter> (*parameters)(Scales scales);
  void (*evaluate)(const CoordinatesView& points, const Eigen::RowVector3d& other,
                   const Eigen::VectorXd& parameters, KernelColumn& column);
};

/// All families, the default first.
[[nodiscard]] std::span<const KernelFamily* const> kernels();
/// @throws InvalidInput  no family has this name; the message lists the names
[[nodiscard]] const KernelFamily& kernel_family(std::string_view name);

/// Orthogonal maps x → centre + Q (x − centre) that form a group, and their effect on a shape with
/// the symmetry: +1 keeps the shape, −1 changes its sign.
struct Symmetry {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();  ///< [m]
  std::vector<Eigen::Matrix3d> operations;                 ///< with the identity
  std::vector<double> characters;                          ///< ±1, one for each operation
};

/// A covariance function of p hyper-parameters. Each call gives their values, so that one Kernel
/// serves a whole search. A Kernel is a value: cheap to copy, and it never changes.
class Kernel {
 public:
  class Part;

  Kernel(const KernelFamily& family, Scales scales = Scales::isotropic);
  explicit Kernel(std::shared_ptr<const Part> part) : part_(std::move(part)) {}

  [[nodiscard]] const std::vector<Hyperparameter>& parameters() const;
  [[nodiscard]] Eigen::Index parameter_count() const;
  [[nodiscard]] const std::string& name() const;  ///< "squared_exponential + linear"
  [[nodiscard]] bool is_stationary() const;
  [[nodiscard]] bool is_isotropic() const;  ///< unchanged when both points are rotated or mirrored

  /// @param parameters  p, positive, in the units of parameters()
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& parameters, KernelColumn& column) const;

  /// k₁ + k₂; the parameters of the first, then those of the second.
  friend Kernel operator+(const Kernel& a, const Kernel& b);
  /// k₁ k₂
  friend Kernel operator*(const Kernel& a, const Kernel& b);

 private:
  std::shared_ptr<const Part> part_;
};

/// w k with the weight w as the last hyper-parameter: the share of a part in a sum.
[[nodiscard]] Kernel weighted(const Kernel& kernel);

/// (1 − ρ) Σ_g χ_g k(x, g x') + ρ k(x, x'): shapes that have the symmetry, except for an asymmetric
/// part of the variance, ρ (Duvenaud, thesis, Cambridge 2014, 2.6).
/// @throws InvalidInput  `kernel` is not isotropic, the operations with their characters form no
///                       group, ρ is outside [0, 1]
[[nodiscard]] Kernel symmetrised(const Kernel& kernel, const Symmetry& symmetry,
                                 double asymmetric = 0.0);

/// Lower triangle of k(x_i, x_j), zeros above; cost n² / 2 evaluations.
[[nodiscard]] Eigen::MatrixXd covariance(const Kernel& kernel, const Eigen::VectorXd& parameters,
                                         const Points& points);
/// k(x_i, x'_j), n×m.
[[nodiscard]] Eigen::MatrixXd covariance(const Kernel& kernel, const Eigen::VectorXd& parameters,
                                         const Points& points, const Points& others);
/// k(x_i, x_i), n.
[[nodiscard]] Eigen::VectorXd variances(const Kernel& kernel, const Eigen::VectorXd& parameters,
                                        const Points& points);

/// Contractions of ∂K/∂ ln θ_k for gradients of a likelihood, without forming these matrices.
struct Contractions {
  Eigen::VectorXd weighted;  ///< p: Σ_ij W_ij ∂K_ij
  Eigen::MatrixXd forms;     ///< p×m: a_iᵀ ∂K a_i
};

/// @param weights  n×n symmetric, its lower triangle is read
/// @param vectors  n×m
[[nodiscard]] Contractions contractions(const Kernel& kernel, const Eigen::VectorXd& parameters,
                                        const Points& points, const Eigen::MatrixXd& weights,
                                        const Eigen::MatrixXd& vectors);

}  // namespace chladni::priors
