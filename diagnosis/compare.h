// What is wrong, before any cause: a simulation beside what was measured.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "diagnosis/structure.h"
#include "identification/modal_fit.h"
#include "modal/frf_set.h"

namespace chladni::diagnosis {

/// A simulated flexible mode and the measured one that it is.
struct ModeDifference {
  Eigen::Index simulated = 0, measured = 0;  ///< columns of their models
  double simulated_hz = 0.0, measured_hz = 0.0, measured_std_hz = 0.0;
  double change = 0.0, change_std = 0.0;  ///< of frequency, relative to the simulated one
  double simulated_damping = 0.0, measured_damping = 0.0, measured_damping_std = 0.0;
  double mac = 0.0;  ///< over sensors and actuators; of repeated modes with their whole subspace
  /// The shape alone would have chosen this partner: no other simulated mode near enough in
  /// frequency is nearly as much alike. False: the frequency decided.
  bool by_shape = true;
};

/// A mode without a partner, or a pole of the fit that is no mode.
struct ModeAlone {
  Eigen::Index column = 0;  ///< of its model
  double frequency_hz = 0.0;
  std::string why;  ///< "damping ratio 0.6: no resonance"; empty where there is nothing to say
};

struct ModeComparison {
  std::vector<ModeDifference> pairs;   ///< ascending in the simulated modes
  double low_hz = NAN, high_hz = NAN;  ///< the band that was measured; NaN: nothing was compared
  std::vector<ModeAlone> simulated_alone;   ///< within the band
  std::vector<ModeAlone> simulated_unseen;  ///< within the band; the channels hardly see them
  std::vector<ModeAlone> measured_alone;
  std::vector<ModeAlone> no_modes;  ///< poles beside the band, or that the data do not support
  /// Mean of the MAC between different simulated modes at these channels, 1 where one channel sees
  /// all alike; above 0.5 shapes say nothing and the frequency alone decides (`shapes_tell` false).
  double confusion = 0.0;
  bool shapes_tell = true;
  std::vector<Eigen::Index> simulated_modes, measured_modes;  ///< rows and columns of `mac`
  std::vector<double> simulated_hz, measured_hz;              ///< of these
  Eigen::MatrixXd mac;  ///< MAC at the sensors times MAC at the actuators
  /// Per sensor and actuator over all pairs, each shape with unit norm on its side, in [0, 1].
  Eigen::VectorXd output_comac, input_comac;
};

/// p outputs, q inputs, k lines, b bands. NaN: not measured. "Relative": root of the sum of squares
/// over the lines, over that of the measured response.
struct ResponseComparison {
  std::vector<std::string> outputs, inputs;
  Eigen::VectorXd frequency_hz;  ///< k
  Eigen::MatrixXd error, noise;  ///< p×q, relative; noise NaN where no variance is stated
  double overall_error = 0.0, overall_noise = 0.0;  ///< over all responses together
  Eigen::MatrixXd frac;  ///< p×q: |Σ Ĝ* G|² / (Σ|G|² Σ|Ĝ|²), Heylen and Lammens 1996
  /// Per line, over all responses: shape, |ĝᴴg|² / (gᴴg ĝᴴĝ), and size, 2|ĝᴴg| / (gᴴg + ĝᴴĝ)
  /// (Zang, Grafe and Imregun 2001: GSC and GAC; for one response its CSAC and CSF).
  Eigen::VectorXd shape_alike, size_alike;
  Eigen::VectorXd band_edges_hz;      ///< b + 1, of equal ratios
  Eigen::VectorXd band_error;         ///< b, relative within the band
  Eigen::MatrixXd output_band_error;  ///< p×b
  Eigen::MatrixXd input_band_error;   ///< q×b

  /// Measured over simulated: medians over the lines of the magnitudes' ratio, all responses taken
  /// apart into level × sensor × actuator (median polish): a shifted resonance moves them little.
  double level = 1.0;
  Eigen::VectorXd output_gain, input_gain;  ///< p, q; the median channel is 1
  Eigen::VectorXd output_sign, input_sign;  ///< ±1; NaN where the phases do not say
  /// How alike measured channel i is to simulated channel k, in [0, 1], p×p and q×q: correlation
  /// of responses compressed to the root of their magnitude.
  Eigen::MatrixXd output_alike, input_alike;

  /// Measured less simulated over its deviation: 1 and 0 where only white noise is left.
  Eigen::MatrixXd chi_square;  ///< p×q, per number measured; NaN where no variance is stated
  Eigen::MatrixXd lag_one;     ///< p×q: correlation of neighbouring lines, in [−1, 1]
};

/// Two collocated pairs, and whether the one answers to the other as the other to the one.
struct Reciprocity {
  Eigen::Index output_a = 0, input_a = 0, output_b = 0, input_b = 0;
  double difference = 0.0;  ///< |G_ab − G_ba| over their mean size, over the lines
  double noise = 0.0;       ///< what their deviations explain of it; NaN where none is stated
  double ratio = 1.0;       ///< G_ab / G_ba, one number by least squares: 1 where gains agree
  double left = 0.0;        ///< of the difference when one is scaled by it
};

/// Two channels of one side whose labels seem exchanged.
struct Swap {
  bool outputs = true;
  Eigen::Index first = 0, second = 0;
  double alike = 0.0, alike_exchanged = 0.0;  ///< means of the two, as they are and exchanged
};

struct Comparison {
  ModeComparison modes;  ///< empty without a modal model of what was measured
  ResponseComparison responses;
  std::vector<Reciprocity> reciprocity;
  std::vector<Swap> swaps;
};

struct ComparisonOptions {
  double low_hz = 0.0, high_hz = std::numeric_limits<double>::infinity();
  int bands = 8;
  double least_mac = 0.3;      ///< of a pair, less (ln of its frequencies' ratio / apart)²
  double apart = 0.3;          ///< shapes that are equal pair up to e^±0.25 in frequency
  double apart_alone = 0.1;    ///< the same where shapes say nothing
  double repeated_gap = 5e-3;  ///< relative; nearer modes are compared by their subspace
};

/// The structure on its modes at its channels, its dashpots with it.
[[nodiscard]] modal::ReducedModel reduced_model(const Structure& structure);

/// @param simulated  [k], each p×q: as measured.value
/// @throws InvalidInput  sizes differ, no line in the band
[[nodiscard]] ResponseComparison compared(const modal::FrfSet& measured,
                                          const std::vector<Eigen::MatrixXcd>& simulated,
                                          const ComparisonOptions& options = {});

/// Simulated flexible modes and measured ones of least total cost (modal::assigned): 1 − MAC at
/// sensors and actuators, and the square of how far apart the frequencies are. Poles of the fit
/// beside the band (`low_hz` to `high_hz` of the options) and poles that the data do not support
/// are no modes: damping ratio of a half or more, a frequency less sure than the resonance is wide
/// (or 1
/// %), shapes within three deviations of zero on one side, deviations that are not known. Channels
/// of `fit` are those of the simulation, in its order; what was not measured (its shape's deviation
/// is infinite) takes no part.
/// @throws InvalidInput  the channels differ in number
[[nodiscard]] ModeComparison compared(const modal::ReducedModel& simulated,
                                      const identification::ModalFit& fit,
                                      const ComparisonOptions& options = {});

/// Sensors and actuators whose shapes agree in all modes are collocated (or opposite).
[[nodiscard]] std::vector<Reciprocity> reciprocity(const modal::FrfSet& measured,
                                                   const modal::ReducedModel& simulated,
                                                   const ComparisonOptions& options = {});

/// Channels that are more alike when they are exchanged, the clearest first; each is looked for
/// after those before it were put right, since an exchange on one side of a symmetric body looks
/// like several on the other. @throws as compared
[[nodiscard]] std::vector<Swap> swaps(const modal::FrfSet& measured,
                                      const std::vector<Eigen::MatrixXcd>& simulated,
                                      const ComparisonOptions& options = {});

/// All of it, on the channels that structure and measurement share by name.
/// @param measured  of any kinds; compared as receptances
/// @param fit       of the measured set's channels, in its order; or null
/// @throws InvalidInput  no channel in common, no line in the band above 0 Hz
[[nodiscard]] Comparison compared(const Structure& structure, const modal::FrfSet& measured,
                                  const identification::ModalFit* fit = nullptr,
                                  const ComparisonOptions& options = {});

}  // namespace chladni::diagnosis
