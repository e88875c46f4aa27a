// An observer of a study: a Kalman filter on the identified model, and its trial on recordings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identification/observed_plant.h"
#include "modal/kalman_filter.h"
#include "modal/learned_noise.h"
#include "recordings/time_data.h"
#include "steps/interpolation.h"

namespace chladni::steps {

/// Recordings on the channels of an observer, in their order and with the study's directions.
struct Recordings {
  struct Record {
    Eigen::MatrixXd inputs, sensors, judges;  ///< N×q, N×p, N×j
  };
  std::string file;
  double sample_time_s = 0.0;
  std::vector<std::string> judges;  ///< sensors that are held out of the fit and of the filter
  std::vector<Record> records;
  /// p+j: rms of the noise of sensors and judges: the study's, else that of differences between
  /// successive periods which does not change slowly; NaN: the recordings have no two periods
  Eigen::VectorXd noise;
};

/// The points of an observer, first those of the study, then the held-out sensors.
struct Observer {
  std::shared_ptr<const Interpolated> shapes;  ///< the model and its field of shapes
  double sample_time_s = 0.0;
  Eigen::Index judges = 0;  ///< the last points
  identification::ObservedPlaces places;
  std::vector<Eigen::Vector3d> force_directions;  ///< of each of places.forces
  std::vector<modal::Disturbance> disturbances;
  modal::ControlModel plant;    ///< continuous: actuators, forces, floor to sensors, points
  Eigen::MatrixXd coordinates;  ///< m×n: modal coordinates [kg^1/2 m] of the plant's states
  modal::KalmanFilter filter;
  modal::NoiseFactors noise;  ///< of the filter, over what the study states
  /// Per sensor: modal::left_out_errors of recordings; empty: the noise is not learned.
  Eigen::VectorXd left_out;
  double band_factor = 1.0;    ///< on the filter's own deviations: the largest of left_out
  Eigen::VectorXd deviation;   ///< per point, of the estimate with this sample's sensors
  Eigen::VectorXd prediction;  ///< of the estimate from the samples before
  Eigen::VectorXd without;     ///< of the motion under the disturbances alone; infinite: drifts
  /// Per point: what the uncertain shape there adds under the disturbances alone; infinite: a mode
  /// drifts, or a shape is not known.
  Eigen::VectorXd shape_deviation;
  /// Per mode: deviation of its coordinate given the earlier samples over that without sensors; 0
  /// of a mode that drifts.
  Eigen::VectorXd unknown_part;
  std::vector<std::string> notes;  ///< limits of the estimate, a sentence each

  [[nodiscard]] std::vector<std::string> names() const { return places.points; }
};

/// True if the study names recordings for its observer.
[[nodiscard]] bool has_recordings(const study::Study& study);

/// @throws InvalidInput  no such file; a channel of the fit is not in it
[[nodiscard]] Recordings recordings(const study::Study& study, const IdentifiedModel& model,
                                    stage::Work& work);

/// Designs the filter that [observer] asks for.
/// @param recorded  gives the sample rate and the noise where the study does not; may be null
/// @throws InvalidInput  as recordings, interpolated, identification::observed_plant and
///                       modal::kalman_filter; a point off the body; no sample rate; no noise
[[nodiscard]] Observer observer(const study::Study& study, const stage::Solution& solution,
                                std::shared_ptr<const Interpolated> shapes,
                                const Recordings* recorded, stage::Work& work);

/// The observer whose disturbances and sensors have the noise that the recordings ask for
/// (modal::learned_noise, over 200 000 samples at most); where these do not determine it, the
/// observer as it is, with a note.
/// @throws InvalidInput  every record is shorter than the filter settles
[[nodiscard]] Observer with_learned_noise(const study::Study& study, Observer observer,
                                          const Recordings& recordings);

/// Deviation of each point at each sample, N×z: that of the filter, and of the shape there times
/// the motion of the modes.
/// @param states  N×n, of modal::estimate
[[nodiscard]] Eigen::MatrixXd band(const Observer& observer, const Eigen::MatrixXd& states);

}  // namespace chladni::steps
