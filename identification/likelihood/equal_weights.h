// Normal equations for responses that all have the same weights.
#pragma once

#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {

/// Whether every response has the weights of the first one and normal_equations_of_equal_weights is
/// cheaper than the products of each response.
[[nodiscard]] bool equal_weights_pay(const BlockModel& model, const Target& target);

/// The same as normal_equations, for blocks of every kind. F and F' are two functions
/// (block_functions.h); ⟨F, F'⟩ is their sum over the lines, without the part that the residual's
/// constant takes. The entries have closed forms:
///   l_ia,  l'_i'a'  δ_ii' Σ_bb' ⟨H_ab, H'_a'b'⟩ (R R'ᵀ)_bb'
///   l_ia,  r'_b'j   Σ_ba' l'_ia' ⟨H_ab, H'_a'b'⟩ r_bj
///   l_ia,  θ'       Σ_bb'a' l'_ia' ⟨H_ab, F'_a'b'⟩ (R R'ᵀ)_bb'
///   θ,     θ'       Σ ⟨F_ab, F'_a'b'⟩ (Lᵀ L')_aa' (R R'ᵀ)_bb'
/// and the same with exchanged sides.
/// Cost: 4 M·K·pq + 2 M²·K operations for functions that span M dimensions (3 of a single mode, 12
/// of a pair, 16 of three), twice the first with delays, and the entries of the matrix.
/// @pre the first response's weights are those of all
[[nodiscard]] NormalEquations normal_equations_of_equal_weights(const BlockModel& model,
                                                                const Misfit& misfit,
                                                                const Target& target,
                                                                const Fitted& fitted);

}  // namespace chladni::identification
