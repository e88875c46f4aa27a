// Products of tall panels with a few vectors, on which the solves and the orthogonalisation spend
// their time. BLAS packs the panel first, which costs more than the product. Here the panel is read
// once.
#pragma once

#include "dense/blocks.h"

namespace chladni::dense {

/// X := L⁻¹ X and Y := Y − B X, where the strip is L over B and the front is X over Y.
/// @param strip  (k + m)×k, its upper triangle is not used. @param front  (k + m)×c
void sweep_up(Block strip, Block front);

/// X := L⁻ᵀ (X − Bᵀ Y), with the same strip and front as above.
void sweep_down(Block strip, Block front);

/// W := W − V H with H = Vᵀ X; returns H. V, X and W have the same number of rows. The bits are the
/// same on every run with the same number of threads.
Eigen::MatrixXd take_out(const Eigen::Ref<const Eigen::MatrixXd>& v, const Eigen::MatrixXd& x,
                         Eigen::MatrixXd& w);

}  // namespace chladni::dense
