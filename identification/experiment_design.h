// The experiment that measures given modes well enough: signals, periods, and what to expect.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "base/progress.h"
#include "modal/frf.h"
#include "modal/reduced_model.h"
#include "recordings/excitation.h"

namespace chladni::identification {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// What is to be measured, as the simulation has it. The first outputs are the sensors; any others
/// are places whose motion is limited and that nobody measures.
struct DesignModel {
  modal::ReducedModel model;          ///< displacements by forces, with dashpots if there are any
  std::vector<modal::FrfKind> kinds;  ///< p: what each sensor measures
  Eigen::VectorXd largest;            ///< m [kg^-1/2]: of each mode anywhere on the body
};

/// What the rig bears, what is wanted, and how good its sensors are.
struct DesignPlan {
  double sample_time_s = 0.0;
  double low_hz = 0.0, high_hz = 0.0;  ///< the band, with both ends
  recordings::ExcitedLines lines = recordings::ExcitedLines::all;
  recordings::InputScheme scheme = recordings::InputScheme::one_at_a_time;
  Eigen::VectorXd sensor_noise;  ///< p: rms per sample, white, in the sensor's unit
  double noise_ratio = 0.0;      ///< instead: rms over that of the sensor's response
  double process_noise_n = 0.0;  ///< rms per sample on each actuator, not recorded

  double force_limit_n = kNoLimit;   ///< peak of every force
  double stroke_limit_m = kNoLimit;  ///< peak of the displacement at every output
  double margin = 0.8;               ///< part of each limit that is used

  double frequency_std_hz = kNoLimit;  ///< wanted of every mode in the band
  double damping_std = 0.05;           ///< wanted, relative
  double longest_s = 1800.0;           ///< of the whole experiment
  double longest_period_s = 120.0;
  int realisations = 4;
  double lines_per_bandwidth = 4.0;  ///< excited, in the half-power bandwidth of the narrowest mode
  double simulation_error = 0.03;    ///< relative deviation of the simulated frequencies
  int crest_iterations = 0;          ///< 0: random phases
};

/// A mode in the band, before it is measured.
struct ExpectedMode {
  Eigen::Index mode = 0;  ///< of the model
  double frequency_hz = 0.0, damping_ratio = 0.0;
  double frequency_std_hz = kNoLimit;  ///< after the experiment
  double damping_std = kNoLimit;       ///< relative
  double seconds_needed = kNoLimit;    ///< of recording, for the wanted deviations
  bool reached = false;
  double drive = 0.0, sight = 0.0;  ///< motion at the best actuator and sensor over the largest
  std::string why;                  ///< it is not reached; else empty
};

/// How well one response will be seen: coherence of one period.
struct ExpectedCoherence {
  Eigen::Index output = 0, input = 0;
  double median = 0.0, lowest = 0.0, lowest_hz = 0.0;
};

struct Force {
  double rms_n = 0.0, peak_n = 0.0;
  bool limited_by_stroke = false;
};

struct ExperimentDesign {
  Eigen::Index period = 0;  ///< samples
  double sample_time_s = 0.0;
  Eigen::VectorXd line_hz;                              ///< K, of the first realisation
  double spacing_hz = 0.0;                              ///< from one of them to the next
  Eigen::MatrixXd amplitude;                            ///< K×q [N]: of the sine on each line
  std::vector<recordings::ExperimentSet> realisations;  ///< signals [N], one period each
  Eigen::Index settle = 1;                              ///< periods before those recorded
  Eigen::Index periods = 2;                             ///< recorded in each experiment
  Eigen::Index ramp = 0;  ///< samples in which the force rises at the start and falls at the end
  double crest_factor = 0.0;
  double low_crest_factor = 0.0;  ///< that optimised phases have, first realisation; 0: not tried
  double duration_s = 0.0;
  double flat_seconds = 0.0;    ///< of recording that an even spectrum needs
  double shaped_seconds = 0.0;  ///< that this one needs
  std::vector<Force> forces;    ///< q
  Eigen::VectorXd stroke_m;     ///< p and further places: peak
  std::vector<ExpectedMode> modes;
  std::vector<ExpectedCoherence> coherence;
  std::vector<std::string> notes;

  [[nodiscard]] double period_s() const { return static_cast<double>(period) * sample_time_s; }
};

/// The period resolves the narrowest mode in the band. Amplitudes follow the simulated modes,
/// within the limits; the number of periods follows from the Cramér-Rao bound of expected_fit.
/// Deterministic. Cost: Fourier transforms of all signals and responses, and one fit.
/// @throws InvalidInput  no limit, no noise, no mode in the band, a mode in it without damping, the
///                       band beyond half the sampling frequency
[[nodiscard]] ExperimentDesign experiment_design(const DesignModel& model, const DesignPlan& plan,
                                                 unsigned seed, const Progress& progress = {});

/// What is played in one experiment, samples×q [N]: the signal fades in over `ramp` samples and
/// settles, is recorded for `periods`, and fades out.
[[nodiscard]] Eigen::MatrixXd sequence(const ExperimentDesign& design,
                                       const Eigen::MatrixXd& one_period);

/// The first sample that is recorded.
[[nodiscard]] Eigen::Index first_recorded(const ExperimentDesign& design);

}  // namespace chladni::identification
