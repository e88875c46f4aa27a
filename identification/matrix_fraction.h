// The thesis' own start values (4.2, steps 2 to 5): a left matrix fraction by Sanathanan and
// Koerner, then by Levenberg and Marquardt. By default modal_fit starts from vector_fit instead.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/progress.h"
#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Polynomials φ_0 … φ_d of s that are orthonormal on the lines for some weight. Their recurrence
/// is s φ_k = γ_{k+1} φ_{k+1} − γ_k φ_{k−1} (Forsythe 1957; on jω the middle term is 0).
struct PolynomialBasis {
  double first = 1.0;          ///< φ_0
  Eigen::VectorXd recurrence;  ///< γ_1 … γ_d

  [[nodiscard]] Eigen::Index degree() const { return recurrence.size(); }
};

/// Values at s = jx, K×(d+1).
[[nodiscard]] Eigen::MatrixXcd values(const PolynomialBasis& basis, const Eigen::VectorXd& x);

/// G = D⁻¹ N (4.7), D = φ_d I + Σ D_a φ_a, N = Σ N_a ψ_a; s in units of `scale`. The code never
/// uses coefficients of powers of s: at degree 34 their rounding alone moves poles by a bandwidth.
struct MatrixFraction {
  double scale = 1.0;  ///< [rad/s]
  PolynomialBasis denominator_basis, numerator_basis;
  std::vector<Eigen::MatrixXd> denominator;  ///< d, each p×p
  std::vector<Eigen::MatrixXd> numerator;    ///< degree + 1, each p×q
  double cost = 0.0;  ///< Σ |w (G − D⁻¹N)|²: the output error, not the equation error
  std::vector<double> costs;  ///< after each iteration, both algorithms
  /// Largest output error of the last half of Sanathanan and Koerner's iterates over the least of
  /// all, or over what noise leaves if that is more; infinite where an error is not finite, which
  /// ends the iteration. Far above 1 the iteration does not settle: the last bits of the sums may
  /// decide which iterate is the best, and all that follows from it.
  double unrest = 1.0;
};

struct MatrixFractionOptions {
  Eigen::Index degree = 2;            ///< of D: the fraction has p·degree poles
  Eigen::Index numerator_degree = 2;  ///< degree − 2 of a mechanical system, degree with a residual
  int sanathanan_koerner = 30;
  int levenberg_marquardt = 10;
  Progress progress = {};
};

/// Sanathanan and Koerner (1963): the D of the last iteration divides the equation error. The
/// iterate with the lowest output error is kept; it may not be the last. Then Levenberg-Marquardt
/// lowers the output error. The equations take values that were not measured from vector fits of
/// rising order; the output error does without them. Cost: per iteration 2 K p q (p² d + p n)².
/// @throws InvalidInput      fewer measured numbers than coefficients, more than 4000 coefficients
///                           of D, degree < 1
/// @throws NumericalFailure  no iterate has a finite error
/// @throws as vector_fit, where something was not measured
[[nodiscard]] MatrixFraction matrix_fraction(const FitData& data,
                                             const MatrixFractionOptions& options);

/// Roots of det D [rad/s]: eigenvalues of the comrade matrix of the basis (p·d of them).
[[nodiscard]] Eigen::VectorXcd poles(const MatrixFraction& fraction);

/// K×pq.
[[nodiscard]] Eigen::MatrixXcd responses(const MatrixFraction& fraction,
                                         const Eigen::VectorXd& frequency_hz);

struct ThesisOptions {
  Eigen::Index modes = 0;        ///< number of flexible modes, n; must be given
  Eigen::Index rigid_count = 0;  ///< modes at 0 Hz: the two poles nearest to 0 of each move there
  bool residual = true;          ///< a constant for the modes above the band
  Eigen::Index degree = 0;       ///< of the fraction; 0: ⌈2 (n + rigid_count) / p⌉, measured p
  int sanathanan_koerner = 30;
  int levenberg_marquardt = 10;
  int modal_iterations = 10;
  Progress progress = {};
};

/// Steps 2 to 5: a fraction, its poles (turned into the left half plane), and residues of (4.8) by
/// linear least squares at these poles. The singular vectors cut each residue to rank one (5.1). Of
/// more than n resonances, those worth most are kept. Channels of which nothing was measured take
/// no part. The least degree suffices only if no combination of the outputs sees more modes than
/// the others do. Symmetric layouts break this: four corners of a table see its modes in four
/// separate classes, and the largest class needs a degree of twice its size.
/// @throws InvalidInput      n < 1 without rigid-body modes, fewer measured numbers than parameters
/// @throws NumericalFailure  as matrix_fraction; no pole oscillates
[[nodiscard]] Start thesis_start(const FitData& data, const ThesisOptions& options);

/// Step 6: modal_fit from that start with `modal_iterations` iterations. A mode that the fraction
/// did not find stays missing; `notes` says so, and where the fraction may turn on the last bits.
[[nodiscard]] ModalFit thesis_fit(const FitData& data, const ThesisOptions& options);

}  // namespace chladni::identification
