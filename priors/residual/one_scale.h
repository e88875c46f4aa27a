// Shapes of one body at few places: one scale for all modes, because the body's mass fixes it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "priors/methods/modal_field.h"

namespace chladni::priors {

/// Errors of a simulation and of the places, pooled over all shapes.
struct OneScaleErrors {
  DynamicResidual prior;
  double scale = 1.0;  ///< of the shapes, in their unit over kg^-1/2: the same for all modes
  /// Standard deviation of a value at a place from the shape of the structure (errors of the place,
  /// what is fixed there), for the highest measured mode, over the root mean square of the
  /// simulation's shapes. It grows with the fourth root of the frequency.
  double deviation = 0.05;
};

/// The values of one shape are D a (Ψ c + e) + noise:
///
///     c ~ N(0, diag q / Σ q)   q the dynamic residual's variances, of the modes beyond too
///     a = scale e^(ω x / 2)    x ~ N(0, 1), ω = Constants::amplitude_spread: a part of a mode's
///                              mass may not be in the simulated body
///     e ~ N(0, τ²)             independent at each place
///     D = e^δ at the sensors, e^−δ at the actuators, δ ~ N(0, log_deviation²)
///
/// With an amplitude of its own, a shape whose values are all small would be told as nothing. With
/// one scale it is told as unknown: its places may lie on its nodes.
/// @pre measured.sides; the arguments outlive the object
class OneScale {
 public:
  OneScale(const MeasuredShapes& measured, const ModalBasis& basis);

  /// Σ ln p(y_i) over the shapes, x and δ integrated. Cost: per shape up to 31 eigenvalue
  /// decompositions of s rows.
  [[nodiscard]] double log_evidence(const OneScaleErrors& errors) const;

  /// The most likely errors under log-normal priors. Cost: some 200 times log_evidence.
  [[nodiscard]] OneScaleErrors learned() const;

  /// Errors about the likeliest, with their posterior probabilities: few values leave the size of
  /// the simulation's error open. Along ln η alone, the others as they are likeliest.
  struct Plausible {
    OneScaleErrors errors;
    double probability = 0.0;
  };
  [[nodiscard]] std::vector<Plausible> about(const OneScaleErrors& likeliest) const;

  /// Mean and covariance of e^δ a c of one shape: its coefficients on the sensors' side. `beyond`
  /// contains the deviation e at a place that is not measured.
  [[nodiscard]] ShapeCoefficients shape(Eigen::Index mode, const OneScaleErrors& errors) const;
  /// The same of a mixture.
  [[nodiscard]] ShapeCoefficients shape(Eigen::Index mode,
                                        const std::vector<Plausible>& errors) const;

 private:
  // Prior covariance of Ψ c + e: the variances of c, and what stands beside Ψ c.
  struct UnitPrior {
    Eigen::VectorXd variance;  // r
    double own = 0.0;          // at each place
  };
  // The whitened covariance of the values is 1 + a² V Λ Vᵀ, for all amplitudes a.
  struct AtScale {
    double delta = 0.0;
    Eigen::VectorXd factor;      // s: diagonal of D over the noise
    Eigen::MatrixXd directions;  // s×s: V
    Eigen::VectorXd strength;    // s: Λ
    Eigen::VectorXd along;       // s: whitened values along the directions
  };
  // The posterior of δ and x on a grid.
  struct Grid {
    UnitPrior prior;
    std::vector<AtScale> scales;
    Eigen::ArrayXd amplitude;     // a², per node of x
    Eigen::ArrayXXd log_density;  // scales × amplitudes, with the weights of the grid
    double log_evidence = 0.0;
  };

  [[nodiscard]] UnitPrior unit_prior(Eigen::Index mode, const OneScaleErrors& errors) const;
  [[nodiscard]] AtScale at_scale(Eigen::Index mode, const Eigen::MatrixXd& covariance,
                                 double delta) const;
  [[nodiscard]] Grid grid(Eigen::Index mode, const OneScaleErrors& errors) const;

  const MeasuredShapes& measured_;
  const ModalBasis& basis_;
  double mean_square_ = 0.0;  // of the simulation's shapes over the surface
};

}  // namespace chladni::priors
