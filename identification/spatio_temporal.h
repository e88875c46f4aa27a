// Responses at places without a sensor: identified modes with shape rows from a field.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/gain_match.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// n places of interest, m modes of the fit, q actuators.
struct PlacesOfInterest {
  Eigen::MatrixXd shapes;     ///< n×m [kg^-1/2], of the same scale as GainMatch::shapes
  Eigen::MatrixXd deviation;  ///< n×m: standard deviations; infinite or NaN: not known
  /// n×q: of the modes above the band, with the signs of the data; zero where it is not known
  Eigen::MatrixXd residual;
  /// n×m, of complex shapes (general damping); empty of real ones
  Eigen::MatrixXd imaginary = {}, imaginary_deviation = {};
  Eigen::MatrixXd residual_deviation = {};  ///< n×q: standard deviations; empty: 0
  /// Standard deviation of the gain of a sensor there, relative: of all modes at once.
  double gain_deviation = 0.0;
};

/// G(ρ, s) = [Σ φ_m(ρ) r_m / (s² + 2ζ_m ω_m s + ω_m²) + residual] e^{−sτ} with its deviation.
struct PredictedResponses {
  std::vector<Eigen::MatrixXcd> value;  ///< [k], each n×q
  /// [k], each n×q: √E|δG|² from the poles and input vectors (covariance of the fit),
  /// the shapes, the residual, the gain of the sensor and the delay. The rigid-body modes are one
  /// part: with a body both of their factors err together. The other modes are independent of each
  /// other. Of each, the scale of all its shapes errs together with its input vector and its pole,
  /// as the fit says; what the shape has beside its scale is independent of them. The error of Re G
  /// and of Im G is within 1.96/√2 of it in 95 % of the cases, |δG| within 1.73. Infinite where a
  /// part is not known.
  std::vector<Eigen::MatrixXd> deviation;
};

/// The signs are those of the measured responses (driving_shapes). With general damping the
/// response has the form of ComplexShapes. Cost: k n q m.
/// @throws InvalidInput  sizes differ; 0 Hz with rigid-body modes
[[nodiscard]] PredictedResponses predicted(const ModalFit& fit, const GainMatch& match,
                                           const PlacesOfInterest& places,
                                           const Eigen::VectorXd& frequency_hz);

/// The part of the error of a mode's scale that the deviation of one of its shapes holds: 1 where
/// the shapes at the channels tell the place, less where other knowledge makes it surer than their
/// scale is.
[[nodiscard]] double part_of_scale(double shape, double deviation, double scale_std);

/// q [s]: by how much the responses to each actuator are late at a place without a sensor: delays
/// of outputs enter by their mean.
[[nodiscard]] Eigen::VectorXd input_delays(const ModalFit& fit);

/// The model from the actuators to the places, without the delays (input_delays). Complex shapes
/// enter with their real parts.
[[nodiscard]] modal::ReducedModel model_at(const ModalFit& fit, const GainMatch& match,
                                           const PlacesOfInterest& places);

/// Complex shapes at the places and at the actuators. @pre the fit has general damping
[[nodiscard]] ComplexShapes complex_shapes_at(const GainMatch& match,
                                              const PlacesOfInterest& places);

/// The shape row of one further sensor, estimated from its responses: φ_m by linear least
/// squares, with poles and input vectors of the fit without it. For complex shapes it holds the
/// real parts. For scoring.
struct FittedRow {
  Eigen::RowVectorXd shape, deviation;  ///< m; infinite where no response tells it, its shape is 0
  Eigen::RowVectorXd residual;          ///< q
};
/// @param data  of that sensor alone, with the actuators in the order of the fit
/// @throws InvalidInput  the number of actuators differs, or the data have several outputs
[[nodiscard]] FittedRow fitted_row(const ModalFit& fit, const GainMatch& match,
                                   const FitData& data);

}  // namespace chladni::identification
