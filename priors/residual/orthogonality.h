// Orthogonality of mode shapes: each shape gives information on the others.
#pragma once

#include <vector>

#include "priors/methods/modal_field.h"

namespace chladni::priors {

struct OrthogonalityOptions {
  double tolerance = 0.1;  ///< expected distance from 0 of the product of two unit shapes
  int sweeps = 3;
};

/// Twice the most likely spread of the products of different shapes, given their uncertainty, under
/// a log-normal prior about 0.1. The factor 2 covers the few large products (of shapes that a mass
/// at a corner couples) when the others are near 0. Cost: m² r k.
[[nodiscard]] double learned_tolerance(const std::vector<ShapeCoefficients>& shapes);

/// In mass-normalised coordinates two different real shapes have c_iᵀ c_j = 0, up to the errors of
/// the simulation's mass. For every other shape j, shape i gets the observation 0 = (m_j/|m_j|)ᵀ
/// c_i with the variance (τ |m_i|)² + m_iᵀ V_j m_i / |m_j|². m and V are the means and covariances
/// before the sweep. Cost: per sweep m (r k m + k³).
[[nodiscard]] std::vector<ShapeCoefficients> orthogonal_shapes(
    const std::vector<ShapeCoefficients>& shapes, const OrthogonalityOptions& options = {});

}  // namespace chladni::priors
