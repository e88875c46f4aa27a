// Tall panels times a few vectors: what the solves and the orthogonalisation spend their time on.
// BLAS packs the panel first, which costs more than the product; here it is read once.
#pragma once

#include "dense/blocks.h"

namespace chladni::dense {

/// X := L⁻¹ X and Y := Y − B X for a strip L over B, front = X over Y.
/// @param strip  (k + m)×k, its upper triangle not looked at. @param front  (k + m)×c
void sweep_up(Block strip, Block front);

/// X := L⁻ᵀ (X − Bᵀ Y), as above.
void sweep_down(Block strip, Block front);

/// W := W − V H with H = Vᵀ X; returns H. All with as many rows.
Eigen::MatrixXd take_out(const Eigen::Ref<const Eigen::MatrixXd>& v, const Eigen::MatrixXd& x,
                         Eigen::MatrixXd& w);

}  // namespace chladni::dense
