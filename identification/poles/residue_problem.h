// Linear least squares for the residues of given poles, kept so that poles can be left out.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"
#include "identification/likelihood/complex_shapes.h"

namespace chladni::identification {

/// Residues of some poles, and what each of these poles is worth.
struct Residues {
  std::vector<Eigen::MatrixXd>
      of_pole;  ///< n, each p×q [rad/s]² …: times 1/(s² − 2 Re(p) s + |p|²); none if general
  std::vector<Eigen::MatrixXcd> general;  ///< n, each p×q: X of X/(s − p) and its conjugate
  Eigen::MatrixXd constant, rigid;        ///< p×q: beside them, and times 1/s²
  Eigen::MatrixXd rigid_worth;  ///< p×q: by how much the cost grows per square of `rigid` left out
  Eigen::VectorXd significance;  ///< n: by how much Σ |w error|² grows without the pole
  double cost = 0.0;             ///< Σ |w error|²
};

/// Real residues (complex ones X of X/(s − p) where the damping is general), a constant and, where
/// wanted, a term in 1/s².
class ResidueProblem {
 public:
  /// @param poles  [rad/s], Im > 0, Re < 0
  ResidueProblem(const FitData& data, const Eigen::VectorXcd& poles, bool rigid,
                 Damping damping = Damping::modal);

  /// With the chosen poles alone. Cost: pq·n³/3 (8 times that where the damping is general).
  [[nodiscard]] Residues residues(const std::vector<Eigen::Index>& chosen) const;
  [[nodiscard]] Residues residues() const;

 private:
  struct Response {
    Eigen::MatrixXd gram;  // functions: one or two of each pole, 1, 1/s²
    Eigen::VectorXd right;
  };
  // What the coefficients c of one response, scaled by `unit`, say of its residues.
  void put(std::size_t response, const std::vector<Eigen::Index>& chosen, const Eigen::VectorXd& c,
           const Eigen::MatrixXd& inverse, const Eigen::VectorXd& unit, Residues& result) const;

  Eigen::Index outputs_, inputs_, poles_;
  Eigen::Index per_pole_;  // functions
  bool rigid_;
  double scale_;            // [rad/s]
  double total_;            // Σ |w G|²
  Eigen::VectorXd factor_;  // residue over coefficient
  std::vector<Response> responses_;
};

}  // namespace chladni::identification
