// A class of symmetry of a mirrored system: the motions that are even or odd about each plane.
#pragma once

#include <vector>

#include "fem/mirrors.h"

namespace chladni::fem {

/// The coordinates of a class: each stands for the degrees of freedom that the mirrors exchange.
/// With P of the entries value(i) at (i, coordinate(i)), a motion of the class is u = P x.
struct SymmetryClass {
  Eigen::VectorXi coordinate;  ///< n: −1 where the class does not move
  Eigen::VectorXd value;       ///< n: ±1, or 0
  Eigen::VectorXi first;       ///< per coordinate: the first of its degrees of freedom
  Eigen::VectorXd members;     ///< per coordinate: their number, 1, 2, 4 or 8

  [[nodiscard]] Eigen::Index size() const { return first.size(); }
};

/// All classes that move, 2^p at most for p mirrors, even ones first.
/// @throws InvalidInput  no mirror, or more than three
[[nodiscard]] std::vector<SymmetryClass> symmetry_classes(const std::vector<Mirror>& mirrors);

/// P x.
[[nodiscard]] Eigen::MatrixXd expanded(const SymmetryClass& symmetry, const Eigen::MatrixXd& x);
/// Pᵀ u.
[[nodiscard]] Eigen::MatrixXd gathered(const SymmetryClass& symmetry, const Eigen::MatrixXd& u);

/// PᵀKP and PᵀMP, with the motions of the whole body that belong to the class.
[[nodiscard]] System block_of(const System& system, const SymmetryClass& symmetry);

}  // namespace chladni::fem
