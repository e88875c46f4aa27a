// Responses at any place of a structure: G(ρ, s) of a modal model of measured responses, whose
// shapes are interpolated between the channels with the modes of a simulation.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identification/channel_gains.h"
#include "identification/identified.h"
#include "identification/spatio_temporal.h"
#include "priors/interpolator.h"

namespace chladni::identification {

/// Rows of the match whose channels were measured: the deviation in some mode above 0 Hz is known.
[[nodiscard]] std::vector<Eigen::Index> measured_rows(const ModalFit& fit, const GainMatch& match);

/// Modes of the fit that have a scale of known deviation, known at all of those rows, and are not
/// rigid-body modes; others take no part in what is predicted between the channels.
[[nodiscard]] std::vector<Eigen::Index> modes_with_scale(const ModalFit& fit,
                                                         const GainMatch& match);

/// The measured rows at which a mode above 0 Hz that has a scale is not known: those of parts of
/// the channels that no response connects with the part that sees the mode best. None of a mode
/// without a scale.
[[nodiscard]] std::vector<Eigen::Index> rows_without(const ModalFit& fit, const GainMatch& match,
                                                     Eigen::Index mode);

/// Why no mode is left for predictions between the channels, and what helps.
[[nodiscard]] std::string why_none_has_scale(const ModalFit& fit, const GainMatch& match);

/// The shapes of those modes at those rows of the match. Their noise has the deviation of the fit
/// and what the two sides of the pairs still differ by: errors of gains, places and neighbours,
/// which the fit does not know.
/// @param rows  places of all rows of the match
[[nodiscard]] priors::MeasuredShapes measured_shapes(const ModalFit& fit, const ChannelGains& gains,
                                                     const priors::Places& rows);

/// The same shapes with all actuator rows changed by one standard deviation of the scale between
/// them and the sensor rows; none if no scale is uncertain, or the shapes do not say their sides.
/// The ratio of both is proportional to the square of the scale.
/// @throws InvalidInput  the deviation of a scale is not known
[[nodiscard]] std::optional<priors::MeasuredShapes> with_scale_off(
    const GainMatch& match, const std::vector<Eigen::Index>& modes, priors::MeasuredShapes shapes);

/// The simulation of a fit, r modes: at its channels, and at the rows of its match.
struct FieldSimulation {
  SimulatedChannels channels;
  Eigen::MatrixXd rows;     ///< n_z×r [kg^-1/2]
  double highest_hz = 0.0;  ///< of the lines of the fit; modes above 1.05 of it are residual
};

/// Fitted residual over that of the simulation's modes above the band, where responses were
/// measured (GainMatch::residual_known). 0 if these do not explain three tenths of it.
[[nodiscard]] double residual_factor(const GainMatch& match, const FieldSimulation& simulation);

/// Standard deviation of the gain of a sensor that is in no pair, relative to that of the sensors
/// that are: by how much the gains of the pairs differ beyond their deviations. 0 where they do not
/// and the plan has no faulty side; with one, 10 % is taken for as much as two pairs say.
[[nodiscard]] double gain_deviation(const ChannelGains& gains);

/// Along z, of whose motion alone the rigid-body modes of a match tell.
[[nodiscard]] bool moves_along_z(const Eigen::RowVector3d& direction);

/// Shapes of responses at places, from a field of the shapes of `modes`. Rigid-body rows come from
/// the geometry with the deviations of the body's mass, the residual from the simulation's modes
/// above the band; its deviation is what these do not explain of it at the sensors. A mode that is
/// not among `modes`, and rigid-body modes without a body or at places that do not move along z,
/// are 0 with their size at the channels as deviation.
[[nodiscard]] PlacesOfInterest places_of_interest(const ModalFit& fit, const ChannelGains& gains,
                                                  const std::vector<Eigen::Index>& modes,
                                                  const FieldSimulation& simulation,
                                                  const priors::Places& places,
                                                  const priors::Field& field);

/// What a field of responses is computed from, beside the responses.
struct ResponseFieldPlan {
  double low_hz = 0.0, high_hz = 0.0;  ///< the band; high 0: all lines
  IdentificationOptions fit;
  GainPlan gains;
  std::string method = "dynamic_residual";  ///< of priors::interpolators()
};

/// G(ρ, s) of one structure.
class ResponseField {
 public:
  [[nodiscard]] const ModalFit& fit() const { return fit_; }
  [[nodiscard]] const ChannelGains& gains() const { return gains_; }
  /// The shapes that are interpolated, at the channels that were measured.
  [[nodiscard]] const priors::MeasuredShapes& shapes() const { return shapes_; }

  /// The responses from all actuators, with their deviations.
  /// @param places  with the simulation's modes along the direction of motion
  /// @throws InvalidInput  `places` lack what the method needs; 0 Hz with rigid-body modes
  [[nodiscard]] PredictedResponses at(const priors::Places& places,
                                      const Eigen::VectorXd& frequency_hz) const;

 private:
  friend ResponseField response_field(const modal::FrfSet& responses,
                                      const priors::Simulation& simulation,
                                      const priors::Places& outputs, const priors::Places& inputs,
                                      const ResponseFieldPlan& plan);
  ModalFit fit_;
  ChannelGains gains_;
  FieldSimulation simulation_;
  std::vector<Eigen::Index> modes_;
  priors::MeasuredShapes shapes_;
  std::shared_ptr<const priors::ModeField> field_;
  std::shared_ptr<const priors::ModeField> field_with_scale_off_;  // null: the scale is certain
};

/// Identifies the responses, gives both sides one scale, and interpolates the shapes.
/// @param responses   with places and directions of all channels
/// @param simulation  of the structure; its corrections may be empty
/// @param outputs, inputs  the channels of the responses with the simulation's modes, along the
///                         channels' directions
/// @throws as `identified`, `channel_gains` and `priors::mode_field`; InvalidInput: no mode has a
///         known scale, or places do not fit the channels
[[nodiscard]] ResponseField response_field(const modal::FrfSet& responses,
                                           const priors::Simulation& simulation,
                                           const priors::Places& outputs,
                                           const priors::Places& inputs,
                                           const ResponseFieldPlan& plan = {});

}  // namespace chladni::identification
