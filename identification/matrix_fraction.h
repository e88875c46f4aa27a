// The thesis' own way to start values (4.2, steps 2 to 5): a left matrix fraction, by Sanathanan
// and Koerner, then Levenberg and Marquardt. modal_fit's default starts from vector_fit instead.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/progress.h"
#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Polynomials φ_0 … φ_d of s that are orthonormal on the lines with some weight. They follow
/// s φ_k = γ_{k+1} φ_{k+1} − γ_k φ_{k−1} (Forsythe 1957; on jω the middle term is 0).
struct PolynomialBasis {
  double first = 1.0;          ///< φ_0
  Eigen::VectorXd recurrence;  ///< γ_1 … γ_d

  [[nodiscard]] Eigen::Index degree() const { return recurrence.size(); }
};

/// Values at s = jx, K×(d+1).
[[nodiscard]] Eigen::MatrixXcd values(const PolynomialBasis& basis, const Eigen::VectorXd& x);

/// G = D⁻¹ N (4.7), D = φ_d I + Σ D_a φ_a, N = Σ N_a ψ_a; s in units of `scale`. Coefficients of
/// powers of s appear nowhere: at degree 34 they alone move poles by a bandwidth.
struct MatrixFraction {
  double scale = 1.0;  ///< [rad/s]
  PolynomialBasis denominator_basis, numerator_basis;
  std::vector<Eigen::MatrixXd> denominator;  ///< d, each p×p
  std::vector<Eigen::MatrixXd> numerator;    ///< degree + 1, each p×q
  double cost = 0.0;          ///< Σ |w (G − D⁻¹N)|²: of the output, not the equation
  std::vector<double> costs;  ///< after each iteration, both algorithms
};

struct MatrixFractionOptions {
  Eigen::Index degree = 2;            ///< of D: the fraction has p·degree poles
  Eigen::Index numerator_degree = 2;  ///< degree − 2 of a mechanical system, degree with a residual
  int sanathanan_koerner = 30;
  int levenberg_marquardt = 10;
  Progress progress = {};
};

/// Sanathanan and Koerner (1963): D of the last iteration divides the equation error; the iterate
/// of lowest output error is kept, which need not be the last. Then Levenberg-Marquardt on the
/// output error. Cost: per iteration 2 K p q (p² d + p n)².
/// @throws InvalidInput      fewer measured numbers than coefficients, more than 4000 of those of
/// D,
///                           degree < 1
/// @throws NumericalFailure  no iterate has a finite error
[[nodiscard]] MatrixFraction matrix_fraction(const FitData& data,
                                             const MatrixFractionOptions& options);

/// Roots of det D [rad/s]: eigenvalues of the comrade matrix of the basis (p·d of them).
[[nodiscard]] Eigen::VectorXcd poles(const MatrixFraction& fraction);

/// K×pq.
[[nodiscard]] Eigen::MatrixXcd responses(const MatrixFraction& fraction,
                                         const Eigen::VectorXd& frequency_hz);

struct ThesisOptions {
  Eigen::Index modes = 0;        ///< flexible ones, n; must be given
  Eigen::Index rigid_count = 0;  ///< at 0 Hz: two poles each, those nearest to 0, are put there
  bool residual = true;          ///< a constant for the modes above the band
  Eigen::Index degree = 0;       ///< of the fraction; 0: ⌈2 (n + rigid_count) / p⌉
  int sanathanan_koerner = 30;
  int levenberg_marquardt = 10;
  int modal_iterations = 10;
  Progress progress = {};
};

/// Steps 2 to 5: a fraction, its poles (turned into the left half plane), residues of (4.8) by
/// linear least squares at these poles, each cut to rank one by its singular vectors (5.1). Of more
/// than n resonances those worth most are kept. The least degree suffices where no combination of
/// the outputs sees more of the modes than others do; symmetric layouts are not so: four corners of
/// a table see its modes in four separate classes, and the largest class asks for a degree of twice
/// its size.
/// @throws InvalidInput      n < 1 without rigid-body modes, fewer measured numbers than parameters
/// @throws NumericalFailure  as matrix_fraction; no pole oscillates
[[nodiscard]] Start thesis_start(const FitData& data, const ThesisOptions& options);

/// Step 6 after it: modal_fit from that start, with so few iterations. A mode that the fraction did
/// not find stays missing; `notes` says so.
[[nodiscard]] ModalFit thesis_fit(const FitData& data, const ThesisOptions& options);

}  // namespace chladni::identification
