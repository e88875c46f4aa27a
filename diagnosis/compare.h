// Comparison of a simulation with a measurement, before any cause is named.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/structure.h"
#include "identification/modal_fit.h"
#include "modal/frf_set.h"

namespace chladni::diagnosis {

/// A simulated flexible mode and its measured partner.
struct ModeDifference {
  Eigen::Index simulated = 0, measured = 0;  ///< columns of their models
  double simulated_hz = 0.0, measured_hz = 0.0, measured_std_hz = 0.0;
  double change = 0.0, change_std = 0.0;  ///< of frequency, relative to the simulated one
  double simulated_damping = 0.0, measured_damping = 0.0, measured_damping_std = 0.0;
  double mac = 0.0;  ///< MAC over sensors and actuators; repeated modes use their whole subspace
  /// True: the shape alone would choose this partner, because no other simulated mode near enough
  /// in frequency has nearly the same MAC. False: the frequency decided.
  bool by_shape = true;
};

/// A mode without a partner, or a pole of the fit that is not a mode.
struct ModeAlone {
  Eigen::Index column = 0;  ///< index in its model
  double frequency_hz = 0.0;
  std::string why;  ///< "damping ratio 0.6: no resonance"; empty: nothing to say
};

struct ModeComparison {
  std::vector<ModeDifference> pairs;        ///< ascending in the simulated modes
  double low_hz = NAN, high_hz = NAN;       ///< the measured band; NaN: nothing was compared
  std::vector<ModeAlone> simulated_alone;   ///< within the band
  std::vector<ModeAlone> simulated_unseen;  ///< within the band; hardly visible to the channels
  std::vector<ModeAlone> measured_alone;
  std::vector<ModeAlone> no_modes;  ///< poles outside the band, or not supported by the data
  /// Mean MAC between different simulated modes at these channels. It is 1 where one channel sees
  /// all modes alike. Above 0.5 the frequency alone pairs the modes (`shapes_tell` false).
  double confusion = 0.0;
  bool shapes_tell = true;
  std::vector<Eigen::Index> simulated_modes, measured_modes;  ///< rows and columns of `mac`
  std::vector<double> simulated_hz, measured_hz;              ///< of these modes
  Eigen::MatrixXd mac;  ///< MAC at the sensors times MAC at the actuators
  /// For each sensor and actuator over all pairs, each shape of unit norm on its side, in [0, 1].
  Eigen::VectorXd output_comac, input_comac;
};

/// p outputs, q inputs, k lines, b bands. NaN: not measured. "Relative": root of the sum of squares
/// over the lines, divided by the same root of the measured response.
struct ResponseComparison {
  std::vector<std::string> outputs, inputs;
  Eigen::VectorXd frequency_hz;  ///< k
  Eigen::MatrixXd error, noise;  ///< p×q, relative; noise NaN where no variance is stated
  double overall_error = 0.0, overall_noise = 0.0;  ///< over all responses together
  Eigen::MatrixXd frac;  ///< p×q: |Σ Ĝ* G|² / (Σ|G|² Σ|Ĝ|²), Heylen and Lammens 1996
  /// For each line, over all responses: shape, |ĝᴴg|² / (gᴴg ĝᴴĝ), and size, 2|ĝᴴg| / (gᴴg + ĝᴴĝ)
  /// (Zang, Grafe and Imregun 2001: GSC and GAC; for one response these are CSAC and CSF).
  Eigen::VectorXd shape_alike, size_alike;
  Eigen::VectorXd band_edges_hz;      ///< b + 1, of equal ratios
  Eigen::VectorXd band_error;         ///< b, relative within the band
  Eigen::MatrixXd output_band_error;  ///< p×b
  Eigen::MatrixXd input_band_error;   ///< q×b

  /// Measured over simulated magnitude: the median of this ratio over the lines, for each response.
  /// Median polish splits it into level × sensor × actuator. A shifted resonance changes it little.
  double level = 1.0;
  Eigen::VectorXd output_gain, input_gain;  ///< p, q; the median channel is 1
  Eigen::VectorXd output_sign, input_sign;  ///< ±1; NaN where the phases do not decide
  /// Likeness of measured channel i to simulated channel k, in [0, 1], p×p and q×q: correlation of
  /// the responses, each divided by the square root of its magnitude.
  Eigen::MatrixXd output_alike, input_alike;

  /// (Measured − simulated) over its standard deviation: these are 1 and 0 if only white noise is
  /// left.
  Eigen::MatrixXd chi_square;  ///< p×q, per number measured; NaN where no variance is stated
  Eigen::MatrixXd lag_one;     ///< p×q: correlation of neighbouring lines, in [−1, 1]
};

/// A reciprocity test of two collocated pairs: does G_ab agree with G_ba?
struct Reciprocity {
  Eigen::Index output_a = 0, input_a = 0, output_b = 0, input_b = 0;
  double difference = 0.0;  ///< |G_ab − G_ba| over their mean size, over the lines
  double noise = 0.0;       ///< the part that the stated deviations explain; NaN: none stated
  double ratio = 1.0;       ///< G_ab / G_ba as one number by least squares; 1 where gains agree
  double left = 0.0;        ///< difference that remains after this scaling, relative to G_ab
};

/// Two channels of one side whose labels seem to be exchanged.
struct Swap {
  bool outputs = true;
  Eigen::Index first = 0, second = 0;
  double alike = 0.0, alike_exchanged = 0.0;  ///< means of the two, as labelled and exchanged
};

struct Comparison {
  ModeComparison modes;  ///< empty without a modal model of what was measured
  ResponseComparison responses;
  std::vector<Reciprocity> reciprocity;
  std::vector<Swap> swaps;
};

struct ComparisonOptions {
  double low_hz = 0.0, high_hz = std::numeric_limits<double>::infinity();
  int bands = kConstants.bands;
  /// Smallest MAC − (ln(frequency ratio) / apart)² of a pair.
  double least_mac = kConstants.least_mac;
  double apart = kConstants.apart;  ///< equal shapes pair up to e^±0.25 in frequency
  /// The same where shapes do not decide: up to e^±0.1.
  double apart_alone = kConstants.apart_alone;
  /// Relative; closer modes are compared by their subspace.
  double repeated_gap = kConstants.repeated_gap;
};

/// The structure in its modes at its channels, with its dashpots.
[[nodiscard]] modal::ReducedModel reduced_model(const Structure& structure);

/// @param simulated  [k], each p×q: arranged as measured.value
/// @throws InvalidInput  sizes differ, no line in the band
[[nodiscard]] ResponseComparison compared(const modal::FrfSet& measured,
                                          const std::vector<Eigen::MatrixXcd>& simulated,
                                          const ComparisonOptions& options = {});

/// Pairs simulated and measured flexible modes at least total cost (modal::assigned). The cost of a
/// pair is 1 − MAC at sensors and actuators, plus (ln(frequency ratio) / apart)². A pole of the fit
/// is not a mode if it lies outside the band (`low_hz` to `high_hz` of the options), or if the data
/// do not support it: damping ratio of a half or more; frequency deviation above the larger of ζ f
/// and 1 % of f; shape within three deviations of zero on one side; unknown deviations. The
/// channels of `fit` are those of the simulation, in the same order. Channels that were not
/// measured (infinite deviation of the shape) take no part.
/// @throws InvalidInput  the channels differ in number
[[nodiscard]] ModeComparison compared(const modal::ReducedModel& simulated,
                                      const identification::ModalFit& fit,
                                      const ComparisonOptions& options = {});

/// The reason why pole m of the fit is not a mode, by the rules above; empty if it is one.
[[nodiscard]] std::string why_no_mode(const identification::ModalFit& fit, Eigen::Index m,
                                      const ComparisonOptions& options = {});

/// Collocated pairs: a sensor and an actuator whose shapes agree in all modes, up to the sign.
[[nodiscard]] std::vector<Reciprocity> reciprocity(const modal::FrfSet& measured,
                                                   const modal::ReducedModel& simulated,
                                                   const ComparisonOptions& options = {});

/// Channels that are more alike after an exchange, the clearest first. Each search comes after the
/// earlier swaps are corrected, because one swap on one side of a symmetric body looks like several
/// on the other side. @throws as compared
[[nodiscard]] std::vector<Swap> swaps(const modal::FrfSet& measured,
                                      const std::vector<Eigen::MatrixXcd>& simulated,
                                      const ComparisonOptions& options = {});

/// The whole comparison, on the channels that structure and measurement share by name.
/// @param measured  of any kinds; converted to receptances
/// @param fit       for the channels of the measured set, in its order; or null
/// @throws InvalidInput  no channel in common, no line in the band above 0 Hz
[[nodiscard]] Comparison compared(const Structure& structure, const modal::FrfSet& measured,
                                  const identification::ModalFit* fit = nullptr,
                                  const ComparisonOptions& options = {});

}  // namespace chladni::diagnosis
