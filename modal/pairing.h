// Pairs the modes of one set with those of another.
#pragma once

#include <utility>
#include <vector>

#include "modal/modes.h"
#include "modal/repeated.h"

namespace chladni::modal {

struct PairingOptions {
  double repeated_gap = kSplitByManufacture;  ///< modes of one set within this relative band are
                                              ///< compared by the subspace they span, since their
                                              ///< single shapes are arbitrary
  double least_mac = 0.5;                     ///< modes of a lower MAC stay alone
  double frequency_weight = 1.0;              ///< weight of ln²(f_b / f_a) relative to 1 − MAC
};

struct ModePair {
  Eigen::Index a = 0, b = 0;      ///< columns
  double mac = 0.0;               ///< of repeated modes: with the other set's subspace
  double frequency_change = 0.0;  ///< f_b / f_a − 1; 0 between rigid-body modes
};

struct Pairing {
  std::vector<ModePair> pairs;                 ///< by ascending a
  std::vector<Eigen::Index> alone_a, alone_b;  ///< modes without a partner, ascending
};

/// Part of mode j of b that lies in the span of mode i of a and its repeated modes, or the reverse
/// (the larger counts): m_a×m_b in [0, 1]. Without repeated modes it is the MAC.
/// @throws InvalidInput  the number of places differs, or a shape is zero or not finite
[[nodiscard]] Eigen::MatrixXd alike(const Modes& a, const Modes& b, double repeated_gap);

/// The pairing of least total cost (Hungarian method, Kuhn 1955; Munkres 1957). Each mode has at
/// most one partner; rigid-body modes pair only with rigid-body modes. A mode without a partner
/// costs as much as a pair of the least MAC, so modes that nothing is like change no other pair.
/// Pairs far apart in frequency cost less than that too: they are made where no nearer one is. Both
/// sets have the same places in the same order. Cost: cubic in the modes, milliseconds for a
/// hundred.
/// @throws InvalidInput  the number of places differs, or a shape is zero or not finite
[[nodiscard]] Pairing pairing(const Modes& a, const Modes& b, const PairingOptions& options = {});

/// Pairs rows and columns, each in at most one pair, with least total cost. A row or column without
/// a partner costs nothing; a pair saves `alone` less its cost. So a pair that costs `alone` or
/// more is never made and does not block others (Hungarian method). Ascending in the rows.
/// @param cost  n×m; for equal sums any solution is returned
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> assigned(
    const Eigen::MatrixXd& cost, double alone);

}  // namespace chladni::modal
