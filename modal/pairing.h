// Which mode of one set is which of another.
#pragma once

#include <utility>
#include <vector>

#include "modal/modes.h"
#include "modal/repeated.h"

namespace chladni::modal {

struct PairingOptions {
  double repeated_gap = kSplitByManufacture;  ///< modes of one set within this relative band are
                                              ///< compared by the subspace they span: their single
                                              ///< shapes mean nothing
  double least_mac = 0.5;                     ///< less alike ones stay alone
  double frequency_weight = 1.0;              ///< of ln²(f_b / f_a) against 1 − MAC
};

struct ModePair {
  Eigen::Index a = 0, b = 0;      ///< columns
  double mac = 0.0;               ///< of repeated ones: of the shape with the other set's subspace
  double frequency_change = 0.0;  ///< f_b / f_a − 1; 0 between rigid-body modes
};

struct Pairing {
  std::vector<ModePair> pairs;                 ///< by ascending a
  std::vector<Eigen::Index> alone_a, alone_b;  ///< those without a partner, ascending
};

/// How much of mode j of b lies in the span of mode i of a or of a's modes repeated with it, or the
/// other way round: m_a×m_b in [0, 1]; the MAC where no mode is repeated.
/// @throws InvalidInput  the places differ in number, or a shape is zero or not finite
[[nodiscard]] Eigen::MatrixXd alike(const Modes& a, const Modes& b, double repeated_gap);

/// The pairing of least total cost (Hungarian method, Kuhn 1955; Munkres 1957): each mode has one
/// partner at most, rigid-body modes only rigid-body ones. Both sets hold the same places in the
/// same order. Cost: cubic in the modes, milliseconds for a hundred.
/// @throws InvalidInput  the places differ in number, or a shape is zero or not finite
[[nodiscard]] Pairing pairing(const Modes& a, const Modes& b, const PairingOptions& options = {});
/// Rows and columns, each in one pair at most, of least total cost where a row or column without a
/// partner costs nothing and a pair saves `alone` less its cost: one that costs `alone` or more is
/// never made, and does not keep others apart (Hungarian method). Ascending in the rows.
/// @param cost  n×m; of equal sums any
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> assigned(
    const Eigen::MatrixXd& cost, double alone);

}  // namespace chladni::modal
