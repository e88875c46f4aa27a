// Mode shapes are orthogonal: what each of them says of the others.
#pragma once

#include <vector>

#include "priors/methods/modal_field.h"

namespace chladni::priors {

struct OrthogonalityOptions {
  double tolerance = 0.1;  ///< how far from 0 the product of two unit shapes may be
  int sweeps = 3;
};

/// Twice the likeliest spread of the products of different shapes, given how well each is known,
/// under a log-normal prior about 0.1. Twice, since few products are far out (those of shapes that
/// a mass at a corner couples) where the others are near 0. Cost: m² r k.
[[nodiscard]] double learned_tolerance(const std::vector<ShapeCoefficients>& shapes);

/// In mass-normalised coordinates two different real shapes have c_iᵀ c_j = 0 up to what the
/// simulation's mass gets wrong. Each shape is given, for every other one j, the observation
/// 0 = (m_j/|m_j|)ᵀ c_i with the variance (τ |m_i|)² + m_iᵀ V_j m_i / |m_j|², m and V being means
/// and covariances before the sweep. Cost: per sweep m (r k m + k³).
[[nodiscard]] std::vector<ShapeCoefficients> orthogonal_shapes(
    const std::vector<ShapeCoefficients>& shapes, const OrthogonalityOptions& options = {});

}  // namespace chladni::priors
