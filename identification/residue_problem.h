// Linear least squares for the residues of given poles, kept so that poles can be left out.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"

namespace chladni::identification {

/// Residues of some poles, and what each of these poles is worth.
struct Residues {
  std::vector<Eigen::MatrixXd>
      of_pole;  ///< n, each p×q [rad/s]² …: times 1/(s² − 2 Re(p) s + |p|²)
  Eigen::MatrixXd constant, rigid;  ///< p×q: beside them, and times 1/s²
  Eigen::MatrixXd rigid_worth;  ///< p×q: by how much the cost grows per square of `rigid` left out
  Eigen::VectorXd significance;  ///< n: by how much Σ |w error|² grows without the pole
  double cost = 0.0;             ///< Σ |w error|²
};

/// Real residues, a constant and, where wanted, a term in 1/s².
class ResidueProblem {
 public:
  /// @param poles  [rad/s], Im > 0, Re < 0
  ResidueProblem(const FitData& data, const Eigen::VectorXcd& poles, bool rigid);

  /// With the chosen poles alone. Cost: pq·n³/3.
  [[nodiscard]] Residues residues(const std::vector<Eigen::Index>& chosen) const;
  [[nodiscard]] Residues residues() const;

 private:
  struct Response {
    Eigen::MatrixXd gram;  // functions: of each pole, 1, 1/s²
    Eigen::VectorXd right;
  };
  Eigen::Index outputs_, inputs_, poles_;
  bool rigid_;
  double scale_;            // [rad/s]
  double total_;            // Σ |w G|²
  Eigen::VectorXd factor_;  // residue over coefficient
  std::vector<Response> responses_;
};

}  // namespace chladni::identification
