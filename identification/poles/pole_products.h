// Weighted sums over all lines of products of partial fractions; each pole needs one sum only.
#pragma once

#include <Eigen/Core>

#include "identification/fit_data.h"

namespace chladni::identification {

/// Σ w² / ((s−a)(s−b)) = (m(a) − m(b)) / (a − b) with m(z) = Σ w² / (s−z). So the sums for all
/// pairs of poles in all responses cost K·n·pq instead of K·n²·pq. Poles in the left half plane
/// keep the differences away from 0.
///
/// Functions of s with real coefficients: for each of n poles f + f' and j(f − f'), where
/// f = 1/(s−p) and f' has the conjugate pole; then 1; then 1/s² if rigid-body modes are fitted.
/// of its conjugate; then 1; then 1/s² where rigid bodies are fitted.
class PoleProducts {
 public:
  /// @param x  K: ω in units of the poles' scale; @param rigid  whether 1/s² is one of the
  ///           functions
  PoleProducts(const FitData& data, const Eigen::VectorXd& x, bool rigid);

  /// Computes the sums for these poles (n, Im > 0, Re < 0). Cost: one product of 4n×K and K×7pq.
  void set_poles(const Eigen::VectorXcd& poles);

  /// Products of one response: of the functions with each other, and with the data.
  struct Products {
    Eigen::MatrixXd functions;  ///< N×N: Re Σ w² ψ̄ᵤ ψᵥ, N = 2n + 1 (+ 1)
    Eigen::MatrixXd mixed;      ///< N×(2n+1): Re Σ w² ψ̄ᵤ G ψᵥ; the last ψᵥ is 1
    Eigen::MatrixXd data;       ///< (2n+1)²: Re Σ w² |G|² ψ̄ᵤ ψᵥ
  };
  /// @param only_functions  computes neither `data` nor `mixed`, except the last column of `mixed`
  [[nodiscard]] Products of(Eigen::Index response, bool only_functions = false) const;

  /// 2n + 1: Σ Re ψ over the lines, without weight.
  [[nodiscard]] Eigen::VectorXd sums() const;

  [[nodiscard]] Eigen::Index response_count() const { return responses_; }
  [[nodiscard]] Eigen::Index denominator_count() const { return 2 * poles_.size() + 1; }
  [[nodiscard]] Eigen::Index function_count() const { return 2 * poles_.size() + 1 + rigid_; }

 private:
  // Fills the products that contain the data, from the moments of w² G and of w² Ḡ.
  void fill_with_data(Eigen::Index response, const Eigen::VectorXcd& m,
                      const Eigen::VectorXcd& conjugate_m, Products& result) const;
  [[nodiscard]] Eigen::VectorXcd moment(Eigen::Index kind, Eigen::Index response) const;

  Eigen::Index responses_, rigid_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd weights_;  // K×(kinds·pq + 1): the last column is 1
  Eigen::VectorXcd poles_;
  Eigen::MatrixXd moments_;  // 4n×…: real parts for p, for p̄, then the imaginary parts
};

}  // namespace chladni::identification
