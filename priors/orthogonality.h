// Mode shapes are orthogonal: what each of them says of the others.
#pragma once

#include <vector>

#include "priors/modal_field.h"

namespace chladni::priors {

struct OrthogonalityOptions {
  double tolerance =
      0.1;  ///< relative error of the simulation's mass: how far from 0 a product may be
  int sweeps = 3;
};

/// In mass-normalised coordinates two different real shapes have c_iᵀ c_j = 0 up to what the
/// simulation's mass gets wrong. Each shape is given, for every other one j, the observation
/// 0 = (m_j/|m_j|)ᵀ c_i with the variance (τ |m_i|)² + m_iᵀ V_j m_i / |m_j|², m and V being means
/// and covariances before the sweep. Cost: per sweep m (r k m + k³).
[[nodiscard]] std::vector<ShapeCoefficients> orthogonal_shapes(
    const std::vector<ShapeCoefficients>& shapes, const OrthogonalityOptions& options = {});

}  // namespace chladni::priors
