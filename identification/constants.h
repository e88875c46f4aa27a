// What decides in this room: which poles are modes, what counts as noise, what is trusted.
// docs/reference/constants_identification.md has the same list, with what was seen when one was
// halved and doubled; a test compares both. Lengths are relative to the body, times to the band.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace chladni::identification {

/// Each comment says what the constant decides [unit] (source).
struct Constants {
  // Which poles are modes.
  /// Least worth of a pole, of a direction of a residue and of a rigid-body mode: the cost that it
  /// explains, per channel, over the level of the noise [1] (chosen, 979c0d7).
  static constexpr double least_worth = 25.0;
  /// Least size of the second direction of a residue over its first; with less, the pole is not
  /// tried as a repeated one [1] (chosen, 979c0d7).
  static constexpr double second_direction = 0.2;
  /// Damping of a pole over the usual damping from which it is taken for a satellite of a mode [1]
  /// (chosen, 58a3bbf).
  static constexpr double broad = 10.0;
  /// Damping of a pole over the usual damping, or the inverse, from which a fit is also tried
  /// without it, from modes above the lines instead [1] (chosen).
  static constexpr double unusual = 3.0;
  /// Worth of a satellite over that of its mode, at most [1] (chosen, 58a3bbf).
  static constexpr double satellite_worth = 0.01;
  /// Distance of a satellite from its mode, at most [bandwidths] (chosen, 58a3bbf).
  static constexpr double satellite_reach = 3.0;
  /// The same distance for resonances narrower than the lines [lines] (chosen, 3f66397).
  static constexpr double satellite_lines = 10.0;
  /// Distance within which only the strongest pole is kept for the fit of drifts [lines] (chosen,
  /// 3f66397).
  static constexpr double strongest_lines = 3.0;
  /// Largest damping ratio of a mode [1] (chosen, 979c0d7).
  static constexpr double most_damping = 0.4;
  /// Lowest frequency of a mode over that of the lowest line [1] (chosen, 979c0d7).
  static constexpr double below_band = 0.5;
  /// Damping ratio above which a mode has no resonance: its receptance has no peak [1] (1/sqrt 2).
  static constexpr double no_peak = 0.70710678;
  /// Modes above the lines with which a fit is tried that leaves more than noise [modes] (chosen).
  static constexpr Eigen::Index modes_above = 2;
  /// Frequency of the first of them over that of the highest line, and of each over the one before;
  /// also the ratio of the places that are tried for one more [1] (chosen).
  static constexpr double next_above = 1.5;
  /// Cost of such a trial after first_iterations over that of the fit, above which it is given up
  /// [1] (chosen).
  static constexpr double hopeless = 10.0;
  /// Part of the cost that modes above the lines leave, below which a drift is looked for again
  /// beside them [1] (chosen).
  static constexpr double above_explains = 0.5;
  /// Most rounds of such trials [rounds] (chosen).
  static constexpr int rounds_above = 3;
  /// Highest frequency of a mode over that of the highest line [1] (chosen, 979c0d7).
  static constexpr double above_band = 1.1;
  /// Cost above what noise leaves; below it no further mode is sought [deviations] (chosen,
  /// 979c0d7).
  static constexpr double enough_excess = 3.0;
  /// Least part of the cost that a further mode must take where the noise is not known [1] (chosen,
  /// 979c0d7).
  static constexpr double least_decrease = 0.02;
  /// Lines on each side of a candidate that say what it explains [bandwidths] (chosen, 979c0d7).
  static constexpr double missing_mode_reach = 8.0;
  /// Relative change of a frequency between two orders below which it is called stable [1] (chosen,
  /// 9b1d192).
  static constexpr double stable_frequency = 1e-3;
  /// The same for a damping ratio [1] (chosen, 9b1d192).
  static constexpr double stable_damping = 0.05;
  /// Squared correlation of the residues of two orders above which a shape is called stable [1]
  /// (chosen, 9b1d192).
  static constexpr double stable_shape = 0.98;
  /// Iterations of the vector fit of each order of the stabilisation diagram [iterations] (chosen,
  /// 9b1d192).
  static constexpr int stabilisation_iterations = 6;

  // Where the search for poles begins and ends.
  /// Damping ratio of the first poles that are spread over the band [1] (chosen, 979c0d7).
  static constexpr double even_damping = 0.01;
  /// Damping ratio of the first poles that are at peaks [1] (chosen, 979c0d7).
  static constexpr double peak_damping = 0.005;
  /// Relative change of the cost of the vector fit at its end [1] (chosen, a649f2a).
  static constexpr double settled_cost = 0.05;
  /// Cost of a higher order over that of a lower one from which no higher order is tried [1]
  /// (chosen, 979c0d7).
  static constexpr double hardly_less = 0.7;
  /// Cost over that of noise alone below which no higher order is tried [1] (chosen, 979c0d7).
  static constexpr double noise_left = 1.3;
  /// Power of a peak over that of the valleys beside it, at least, where no noise is stated [1]
  /// (chosen, 3f66397).
  static constexpr double prominence = 2.0;
  /// Power of a peak over the median around it, at least [1] (chosen, 979c0d7).
  static constexpr double peak_height = 3.0;
  /// Lines on each side that a peak must exceed [lines] (chosen, 979c0d7).
  static constexpr int peak_reach = 3;
  /// Least number of poles beyond the peaks [poles] (chosen, 979c0d7).
  static constexpr Eigen::Index spare_order = 5;
  /// Combinations of channels on each side from which poles are found where there are many
  /// responses [channels] (chosen, ec2bd87).
  static constexpr Eigen::Index sketch = 14;
  /// Above this number channels are combined, and no closer fit is tried where the stated error of
  /// the model is an upper limit [responses] (chosen, ec2bd87).
  static constexpr Eigen::Index many_responses = 200;
  /// Least delay of the scan [periods of the highest line] (chosen, 17ad960).
  static constexpr double delay_low = -0.5;
  /// Largest delay of the scan [periods of the highest line] (chosen, 17ad960).
  static constexpr double delay_high = 2.5;
  /// Intervals of the scan [1] (chosen, 17ad960).
  static constexpr int delay_intervals = 75;
  /// Longest delay that is looked for in the phases alone [periods of the highest line] (chosen).
  static constexpr double delay_reach = 500.0;
  /// Distance to the end of the scan from which a delay in the phases makes that the poles are also
  /// sought without it [periods of the highest line] (chosen).
  static constexpr double delay_margin = 1.0;
  /// Delay below 0 over its deviation, at most, that a model for control takes for none
  /// [deviations] (chosen: 95 % of none).
  static constexpr double no_delay = 2.0;

  // The fit of modes.
  /// Iterations of a fit whose poles are still to be chosen, or whose data are still to be
  /// corrected [iterations] (chosen, ec2bd87).
  static constexpr int first_iterations = 12;
  /// Most modes closer than a bandwidth that are fitted as one block [modes] (chosen, 979c0d7).
  static constexpr Eigen::Index largest_block = 3;
  /// Most rigid-body modes that a fit accepts [modes] (chosen, a649f2a).
  static constexpr Eigen::Index most_rigid = 12;
  /// Part of the cost that single modes may add to that of a block and still replace it [1]
  /// (chosen, 979c0d7).
  static constexpr double single_modes_cost = 0.01;
  /// Iterations that turn blocks into single modes [iterations] (chosen, 69b48ff).
  static constexpr int single_iterations = 8;
  /// Difference of two costs that noise may explain [noise levels] (chosen, 69b48ff).
  static constexpr double same_cost = 5.0;
  /// Decrease of the cost in an iteration below which a fit ends [noise levels] (chosen, 4e93688).
  static constexpr double enough_decrease = 1e-3;
  /// Damping of Levenberg and Marquardt below which a step counts as one of Gauss and Newton: one
  /// small step of this kind ends a fit, else two [1] (chosen, 69b48ff).
  static constexpr double undamped = 1e-3;
  /// Damping of Levenberg and Marquardt above which a fit ends without a better step [1] (chosen,
  /// 979c0d7).
  static constexpr double largest_step_damping = 1e8;
  /// Part of a damping that one step leaves, at least [1] (chosen, 9a86da1).
  static constexpr double damping_left = 0.1;
  /// Least over largest singular value of the shapes of a block below which it is not resolved into
  /// modes [1] (chosen, 979c0d7).
  static constexpr double dependent_shapes = 1e-3;
  /// Relative deviation above which a shape counts as unknown: with a neighbour within a bandwidth,
  /// the mode then forms a group [1] (chosen, 979c0d7).
  static constexpr double unknown_shape = 0.15;
  /// Rms by which the logarithms of the weights may differ from a sum over outputs, inputs and
  /// lines for channels to be combined [1] (chosen, ec2bd87).
  static constexpr double separable = 0.1;
  /// Eigenvalue of a combination of channels over the largest one of noise alone, at least [1]
  /// (chosen, ec2bd87).
  static constexpr double above_noise = 1.05;
  /// Most combinations of channels on each side [channels] (chosen, ec2bd87).
  static constexpr Eigen::Index most_directions = 48;
  /// Alternations between outputs and inputs when combinations of channels are resolved [rounds]
  /// (chosen, ec2bd87).
  static constexpr int expansion_rounds = 3;
  /// Largest error of the last half of the iterates of a matrix fraction over the least, above
  /// which the iteration is said not to settle [1] (chosen).
  static constexpr double unsettled = 10.0;
  /// Most coefficients of the denominator of a matrix fraction [coefficients] (chosen, 46dbdd8).
  static constexpr Eigen::Index most_denominator = 4000;

  // Noise and model error.
  /// A larger difference is not chance: of a cost, of modes with and without outliers, of drifts,
  /// of pairs from the others and of delays [deviations] (chosen, 9a86da1).
  static constexpr double no_chance = 5.0;
  /// Lines on each side of the local polynomial that gives the noise where none is stated [lines]
  /// (chosen, 979c0d7).
  static constexpr int polynomial_reach = 4;
  /// Degree of this polynomial [1] (chosen, 979c0d7).
  static constexpr int polynomial_degree = 3;
  /// Lines on each side whose median is the variance of a line [lines] (chosen, 979c0d7).
  static constexpr int variance_reach = 12;
  /// Lines on each side over which the error of a model is averaged [lines] (chosen, 06e9850).
  static constexpr Eigen::Index error_reach = 12;
  /// Change of the responses by drifts of the resonances above which the drifts are taken out [1]
  /// (chosen, 3f66397).
  static constexpr double drift_matters = 0.05;
  /// Most alternations between drifts and modes [rounds] (chosen, ec2bd87).
  static constexpr int drift_rounds = 10;
  /// Relative change of the drifts that ends the alternation [1] (chosen, a649f2a).
  static constexpr double drift_settled = 1e-3;

  // How far a fit is trusted.
  /// Part of the power that modes and noise may leave unexplained, a relative error of a half;
  /// above it a fit is not to be trusted [1] (chosen, cc38859).
  static constexpr double most_unexplained = 0.25;
  /// Part of the modes' power that may be in doubtful modes; above it a fit is not to be trusted
  /// [1] (chosen, cc38859).
  static constexpr double most_doubtful = 0.5;
  /// Correlation of what is left at neighbouring lines above which it is no noise [1] (chosen:
  /// half).
  static constexpr double smooth_remainder = 0.5;
  /// Relative deviation of a frequency, a damping ratio or a shape that makes a mode doubtful [1]
  /// (chosen, cc38859).
  static constexpr double doubtful = 0.5;
  /// Level above which a fit has systematic errors where the noise is estimated from the data
  /// [noise levels] (chosen, cc38859).
  static constexpr double good_level = 1.5;
  /// Level above which outliers may have distorted a fit [noise levels] (chosen, cc38859).
  static constexpr double bad_level = 10.0;
  /// Two complex modes nearer than this are one pole twice [half bandwidths] (chosen).
  static constexpr double doubled = 0.2;
  /// Least imaginary part of the pole of a complex mode over its size. Its residue is over 2jω_d,
  /// and ω_d from a damping ratio of nearly 1 has lost its digits [1] (chosen: ω_d then has ten).
  static constexpr double least_turning = 1e-3;
  /// A mode so many times below the lowest line or above the highest is none of the data's [1]
  /// (chosen).
  static constexpr double far_beyond = 10.0;
  /// What complex shapes leave over what real ones leave, below which they are proposed [1]
  /// (chosen).
  static constexpr double complex_pays = 0.3;
  /// Chance of noise alone to hold a value that is called outlying [per record] (chosen, cc38859).
  static constexpr double false_alarm = 1e-6;
  /// Residual of an outlying value over the median around it, at least [1] (chosen, cc38859).
  static constexpr double beside_neighbours = 8.0;
  /// Jump of the data over the median around it, at least, to be tried as an outlying value [1]
  /// (chosen, cc38859).
  static constexpr double jump = 20.0;
  /// Lines on each side of these medians [lines] (chosen, 979c0d7).
  static constexpr Eigen::Index outlier_reach = 12;
  /// Part of the values above which they are no outliers [1] (chosen, cc38859).
  static constexpr double most_outlying = 0.05;
  /// Above this number no fit is repeated without the outlying values [responses] (chosen,
  /// cc38859).
  static constexpr Eigen::Index most_refitted = 200;
  /// Largest power of noise but for a hundredth; 4.6 for exact variances, 6.2 for 8 degrees of
  /// freedom [mean powers] (chosen, cc38859).
  static constexpr double noise_tail = 12.0;
  /// Largest median of powers that still are noise [median powers] (chosen, cc38859).
  static constexpr double noise_median = 1.5;
  /// Relative error of every model [1] (chosen, 7b82043).
  static constexpr double always_off = 0.002;
  /// Part of the change from line to line that is allowed for drift where noise explains the rest
  /// [1] (chosen, 7b82043).
  static constexpr double steep_off = 0.02;
  /// Part of the power of a mode in one line from which the line may be all that supports it [1]
  /// (chosen, 4e93688).
  static constexpr double sole_line = 0.3;
  /// Part of the power of that line from which a response supports it [1] (chosen, cc38859).
  static constexpr double sole_response = 0.01;

  // Gains.
  /// Distance along their line, at most, of a sensor and an actuator at one place: on the two faces
  /// of a plate [diagonals of the body] (chosen).
  static constexpr double through_place = 0.05;
  /// The same of a pair that nobody names; the ends of a bar are none [diagonals of the body]
  /// (chosen).
  static constexpr double through_pair = 0.25;
  /// Distance across their line, at most, of a sensor and an actuator at one place; also the extent
  /// of places on a line across it [diagonals of the body] (chosen: 1 mm of half a metre).
  static constexpr double beside_place = 0.002;
  /// Probability of a sign from which it is sure for a band of 95 % [1] (chosen).
  static constexpr double sure_sign = 0.95;
  /// Part of an imaginary shape that damping between modes need not explain [1] (chosen, fa3f565).
  static constexpr double imaginary_slack = 0.02;
  /// Frequency of the next mode over that of a suspended one, at least [1] (chosen, fd8154b).
  static constexpr double suspended_apart = 3.0;
  /// Part of the rms of a suspended mode that is not rigid, at most [1] (chosen, fd8154b).
  static constexpr double suspended_bent = 0.2;
};

}  // namespace chladni::identification
