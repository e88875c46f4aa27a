// Model-form errors of classes whose levels are inferred, and the likelihood of modal data under
// them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// Classes of errors that a sound model has. Each class has one level: the standard deviation of
/// its errors.
enum class ErrorClass {
  frequency,  ///< of ln f of each mode
  damping,    ///< of ln ζ of each mode
  shape,      ///< of each shape value, over the mode's root mean square
  phase,      ///< of the imaginary part of each shape value, likewise
  residue,    ///< of ln residue of each mode, real and imaginary part
  gain,       ///< of each channel, relative
  place,      ///< [m] of each channel along each axis
  field,      ///< of the thickness in smooth waves, relative
  /// of each mode's shape, smooth over the body: neighbouring channels share it
  smooth_shape,
};
inline constexpr std::size_t kErrorClasses = 9;
/// "frequency", "shape", ...
[[nodiscard]] std::string_view name(ErrorClass of);

/// A number for each class.
using PerClass = Eigen::Array<double, kErrorClasses, 1>;

/// What is known of the levels beforehand: ln s ~ N(ln usual, width²), s at most `at_most`.
struct LevelPrior {
  PerClass usual, at_most;
  double width = 0.0;  ///< of ln s; 0: the levels are `usual`
};
/// The usual levels are the tolerances, but at least what models of real structures have.
[[nodiscard]] LevelPrior level_prior(const Tolerances& tolerances, bool learned);

/// The numbers of one measured mode.
struct ModeBlock {
  Eigen::VectorXd error;       ///< n: measured less model
  Eigen::VectorXd noise;       ///< n: standard deviations of the measurement
  std::vector<int> of;         ///< n: class of the number's own error; −1: none
  std::vector<double> weight;  ///< n: the number's own error, over the level of its class
  Eigen::MatrixXd free;  ///< n×c: errors of unit deviation: the mode's scale, what damping mixes
  /// n×d: share of the modes nearby in this one, for an error of frequency of 1.
  Eigen::MatrixXd mixed;
  /// n×d: smooth errors of the shape, for a level of 1; the class of each column.
  Eigen::MatrixXd smooth;
  std::vector<int> smooth_of;
  Eigen::MatrixXd shared;  ///< n×k: errors of the channels and the body, for a deviation of 1

  [[nodiscard]] Eigen::Index count() const { return error.size(); }
};

/// All numbers of a measurement under one hypothesis: N of them, in blocks.
struct ModeErrors {
  std::vector<ModeBlock> blocks;
  std::vector<int> shared_of;  ///< k: class of each shared error; −1: its deviation is 1
  double penalty = 0.0;        ///< ln of the probability of the pairing, with sign changed
};

/// The Gaussian likelihood of the errors at given levels.
/// Covariance: diag(noise² + s²) + free freeᵀ + s_f² mixed mixedᵀ + s² smooth smoothᵀ within a
/// block, and shared sharedᵀ across blocks. Cost: N k² + Σ n³.
class LevelLikelihood {
 public:
  LevelLikelihood(ModeErrors errors, const PerClass& levels);

  [[nodiscard]] const ModeErrors& errors() const { return errors_; }
  [[nodiscard]] const PerClass& levels() const { return levels_; }

  /// −ln of the density of the errors.
  [[nodiscard]] double negative_log() const;
  /// AᵀC⁻¹B of columns that are stacked as the blocks are.
  [[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const;
  /// eᵀC⁻¹e of columns e that are stacked as the blocks are.
  [[nodiscard]] Eigen::VectorXd squares(const Eigen::MatrixXd& columns) const;
  /// −ln of the density of other errors with the same covariance and pairing: of the errors, or of
  /// their square.
  [[nodiscard]] double negative_log(const Eigen::VectorXd& stacked) const;
  [[nodiscard]] double negative_log(double square) const;
  /// −ln of the density of the errors of another hypothesis. A block with `kept` has as many
  /// numbers as the block here, and keeps its covariance; another one has its own, at the same
  /// levels. Cost: k³, and n k² for each block that is not kept.
  /// @pre  as many blocks as here, and as many shared errors in those that are not kept
  [[nodiscard]] double negative_log(const ModeErrors& other, const std::vector<bool>& kept) const;
  /// For each class Σ η² / s² of the posterior means of its errors, and γ, the number of errors
  /// that the data determine (MacKay, Neural Computation 4, 1992). Frequencies alone teach their
  /// level: `mixed` follows it, and is no number of errors.
  struct Evidence {
    PerClass size, determined;
  };
  [[nodiscard]] Evidence evidence() const;
  /// For each block eᵀC⁻¹e of what the shared errors leave of it: about as much as it has numbers,
  /// and much more where it does not belong to the others.
  [[nodiscard]] Eigen::VectorXd block_squares() const;

 private:
  [[nodiscard]] Eigen::MatrixXd whitened(Eigen::MatrixXd columns) const;
  // What a block shares with others, times the levels, whitened by the block's own factor.
  [[nodiscard]] Eigen::MatrixXd shared_of(const ModeBlock& block,
                                          const Eigen::MatrixXd& factor) const;
  // Posterior means of the shared errors, over their levels.
  [[nodiscard]] Eigen::VectorXd shared_means() const;

  ModeErrors errors_;
  PerClass levels_;
  std::vector<Eigen::Index> first_;      // first number of each block
  std::vector<Eigen::MatrixXd> factor_;  // Cholesky factor of each block's own covariance
  Eigen::VectorXd error_;                // stacked, whitened by the blocks
  Eigen::MatrixXd shared_;               // likewise, times its levels
  Eigen::MatrixXd gram_;                 // 1 + sharedᵀ shared, lower triangle
  Eigen::MatrixXd capacitance_;          // its factor
  double log_determinant_ = 0.0;
};

/// Covariance of the numbers of a block by themselves, with its part of the shared errors: n×n.
[[nodiscard]] Eigen::MatrixXd covariance_of(const ModeBlock& block,
                                            const std::vector<int>& shared_of,
                                            const PerClass& levels);
/// Its Cholesky factor, in the lower triangle. Of `covariance` only that is read.
/// @throws NumericalFailure  it is not positive
[[nodiscard]] Eigen::MatrixXd covariance_factor(Eigen::MatrixXd covariance);
/// Number of errors of all blocks.
[[nodiscard]] Eigen::Index numbers(const ModeErrors& errors);
/// The errors of all blocks in one vector.
[[nodiscard]] Eigen::VectorXd stacked(const ModeErrors& errors);

/// One round of MacKay's update with the prior of the levels.
[[nodiscard]] PerClass updated(const PerClass& levels, const LevelPrior& prior,
                               const LevelLikelihood::Evidence& evidence);
/// −ln of the prior density of the levels, and of the volume of their posterior (Laplace).
[[nodiscard]] double negative_log_prior(const PerClass& levels, const LevelPrior& prior,
                                        const LevelLikelihood::Evidence& evidence);

}  // namespace chladni::diagnosis
