// Mode shapes on the whole body, from measurements at a few places.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/laplace_spectrum.h"
#include "identification/spatio_temporal.h"
#include "placement/sites.h"
#include "priors/interpolator.h"
#include "stage/ensemble.h"
#include "stage/solution.h"
#include "steps/identification.h"

namespace chladni::steps {

/// The measured shapes of a study.
struct Measured {
  /// The identified model, if the shapes come from responses; else null.
  std::shared_ptr<const IdentifiedModel> identified;
  std::vector<Eigen::Index> fitted_mode;  ///< for each shape its mode in the identified model
  std::vector<std::string> channels, hidden_channels;
  priors::MeasuredShapes shapes;  ///< at `channels`
  priors::MeasuredShapes hidden;  ///< at `hidden_channels`, which are held out of every fit
  Eigen::VectorXd damping_ratio;  ///< per mode; 0: unknown
  /// The simulation's shapes at the identified model's sensors and actuators; empty without a
  /// model.
  Eigen::MatrixXd sensor_shapes, input_shapes;
  Eigen::MatrixXd truth;       ///< on the surface, without noise; empty: not known
  Eigen::VectorXd truth_area;  ///< [m²] of the surface's points; 0: outside the real body
};

/// One interpolation method and its results.
struct Interpolation {
  const priors::Interpolator* method = nullptr;
  std::unique_ptr<priors::ModeField> field;
  /// Field of the shapes of steps::with_scale_off; null where the scale is certain or in `field`.
  std::unique_ptr<priors::ModeField> with_scale_off;
  priors::Field surface, hidden, points;
  priors::Field unmeasured;          ///< at Interpolated::unmeasured
  Eigen::VectorXd error, covered;    ///< per mode on the surface, if the truth is known
  Eigen::VectorXd hidden_error;      ///< relative error of the shape values, per held-out channel
  Eigen::VectorXd hidden_frf_error;  ///< the same of its FRFs to all measured channels
  Eigen::VectorXd hidden_covered;    ///< part of its values within the 95 % band
};

struct Interpolated {
  placement::Surface surface;
  std::optional<Eigen::Vector3d> direction;  ///< of the motion; none: the surface's normals
  priors::Simulation simulation;
  fem::LaplaceSpectrum harmonics;  ///< of the body; empty if no method needs them
  Measured measured;
  std::vector<std::string> points;  ///< names
  priors::Places point_places;
  std::vector<std::string> unmeasured;  ///< sensors of the study outside the fit
  priors::Places unmeasured_places;
  /// For each mode of the simulation: expected part of its mean square that stays unknown with
  /// these channels, before any measurement; NaN for rigid-body modes.
  Eigen::VectorXd expected_error;
  std::vector<Interpolation> methods;  ///< the first one is shown
};

/// What to do with an identified model before its shapes are used; it may be empty.
using OnIdentified = std::function<void(const IdentifiedModel& model)>;

/// True if it gives shapes: a table, or a study that stands for the real body.
[[nodiscard]] bool has_shapes(const study::MeasurementPlan& plan);

/// @throws InvalidInput  nothing measured, channels that the table lacks, patches that do not
///                       exist, a requested method that cannot be used here
/// @param on_identified  gets the model as soon as it is fitted, before its shapes are interpolated
[[nodiscard]] Interpolated interpolated(const study::Study& study, const stage::Solution& solution,
                                        stage::Work& work, const OnIdentified& on_identified = {});

/// The step of `interpolated` for one method. All its fields have the deviation of the scale
/// between sensors and actuators, as `field_at`.
/// @param result  what was measured, where the fields are wanted, and the simulation
/// @throws InvalidInput  the method cannot be used here
[[nodiscard]] Interpolation interpolated_by(const priors::Interpolator& method,
                                            const Interpolated& result);

/// The step of `interpolated` that reads a table, or a study that stands for the real body.
[[nodiscard]] Measured measured(const study::Study& study, const stage::Solution& solution,
                                const priors::Simulation& simulation,
                                const fem::LaplaceSpectrum& harmonics, stage::Work& work,
                                const OnIdentified& on_identified);

/// The step of `measured` that identifies the shapes from responses.
[[nodiscard]] Measured measured_by_responses(const study::Study& study,
                                             const stage::Solution& solution,
                                             const fem::LaplaceSpectrum& harmonics,
                                             stage::Work& work, const OnIdentified& on_identified);

/// Shapes of responses at places, from a field (mean and deviation per fitted shape). Rigid-body
/// rows come from the geometry, the residual from the simulation's modes above the band.
/// @throws InvalidInput  nothing was identified
[[nodiscard]] identification::PlacesOfInterest places_of_interest(const Interpolated& result,
                                                                  const priors::Places& places,
                                                                  const priors::Field& field);

/// The measured shapes that a held-out channel is scored by: those of modes beyond the lines of the
/// fit are not known one by one. All of a table.
[[nodiscard]] std::vector<Eigen::Index> scored_modes(const Measured& measured);

/// The shapes with all actuator rows changed by one standard deviation of the scale between them
/// and the sensor rows; none if no scale is uncertain.
[[nodiscard]] std::optional<priors::MeasuredShapes> with_scale_off(const Measured& measured);

/// For each held-out channel: error of the prediction over the measured response, over all lines of
/// the band.
[[nodiscard]] Eigen::VectorXd held_out_frf_errors(const Interpolated& result,
                                                  const Interpolation& one);

/// The field at places; its deviation holds that of the scale between sensors and actuators.
[[nodiscard]] priors::Field field_at(const Interpolation& interpolation,
                                     const priors::Places& places);

/// A sensor or actuator of the study at its place on the body.
struct ChannelSite {
  std::string name;
  mesh::Site site;
  Eigen::Vector3d direction;  ///< unit
};

/// The sensors, then the actuators.
[[nodiscard]] std::vector<ChannelSite> channel_sites(const study::Study& study,
                                                     const stage::Model& model);

/// Places with the simulation's modes along `directions`, n×3, and the body's harmonics.
[[nodiscard]] priors::Places places_at(const std::vector<mesh::Site>& sites,
                                       const Points& directions, const modal::Modes& modes,
                                       const fem::LaplaceSpectrum& harmonics = {});
[[nodiscard]] priors::Places places_at(const std::vector<ChannelSite>& channels,
                                       const modal::Modes& modes,
                                       const fem::LaplaceSpectrum& harmonics = {});

}  // namespace chladni::steps
