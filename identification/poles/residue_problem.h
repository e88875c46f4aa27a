// Linear least squares for the residues of given poles. Poles can be left out without new sums.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"
#include "identification/likelihood/complex_shapes.h"

namespace chladni::identification {

/// Residues of some poles, with the significance of each pole.
struct Residues {
  std::vector<Eigen::MatrixXd>
      of_pole;  ///< n, each p×q: times 1/(s² − 2 Re(p) s + |p|²); empty if general
  std::vector<Eigen::MatrixXcd> general;  ///< n, each p×q: X of X/(s − p) and its conjugate
  Eigen::MatrixXd constant, rigid;        ///< p×q: the constant, and the factor of 1/s²
  Eigen::MatrixXd rigid_worth;  ///< p×q: growth of the cost without `rigid`, per square of it
  Eigen::VectorXd significance;  ///< n: growth of Σ |w error|² without the pole
  double cost = 0.0;             ///< Σ |w error|²
};

/// Fits real residues (complex X of X/(s − p) for general damping), a constant and, on
/// request, a term in 1/s².
class ResidueProblem {
 public:
  /// @param poles  [rad/s], Im > 0, Re < 0
  ResidueProblem(const FitData& data, const Eigen::VectorXcd& poles, bool rigid,
                 Damping damping = Damping::modal);

  /// Only with the chosen poles. Cost: pq·n³/3 (8 times that for general damping).
  [[nodiscard]] Residues residues(const std::vector<Eigen::Index>& chosen) const;
  [[nodiscard]] Residues residues() const;

 private:
  struct Response {
    Eigen::MatrixXd gram;  // functions: one or two of each pole, 1, 1/s²
    Eigen::VectorXd right;
  };
  // Puts the residues of one response into `result`, from its coefficients c in units of `unit`.
  void put(std::size_t response, const std::vector<Eigen::Index>& chosen, const Eigen::VectorXd& c,
           const Eigen::MatrixXd& inverse, const Eigen::VectorXd& unit, Residues& result) const;

  Eigen::Index outputs_, inputs_, poles_;
  Eigen::Index per_pole_;  // functions per pole
  bool rigid_;
  double scale_;            // [rad/s]
  double total_;            // Σ |w G|²
  Eigen::VectorXd factor_;  // residue over coefficient
  std::vector<Response> responses_;
};

}  // namespace chladni::identification
