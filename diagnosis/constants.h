// The numbers that decide a diagnosis, each with its unit, what it decides and its source; "methods"
// are the rules on which the room was built. A test compares docs/reference/constants.md with them.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "diagnosis/mode_constants.h"

namespace chladni::diagnosis {

/// Those of measured modes are its base.
struct Constants : ModeConstants {
  // What a cause needs.
  /// [ln] A cause needs this evidence beyond the fit without it. Methods.
  double least_evidence = 8.0;
  /// [ln] The verdict is ambiguous if a rival is nearer than this. Methods.
  double rival_within = 5.0;
  /// [1] A cause stays if it brings this part of the total gain. Methods.
  double least_share = 0.01;
  /// [z] A cause stays if this excess is left without it. Methods, as a gate of names.
  double least_excess = 5.0;
  /// [ln] A cause stays with this evidence if that also exceeds the errors of the others. Chosen.
  double sure_evidence = 12.0;
  /// [1] Explanations have this many causes at most. Chosen.
  int most_causes = 3;

  // The verdict.
  /// [1] Prior probability that one cause and noise are all there is. Chosen.
  double one_cause_prior = 0.7;
  /// [1] Each further cause multiplies this prior by so much. Chosen.
  double further_cause_prior = 0.25;
  /// [1] Prior probability of an effect outside the catalogue. Chosen.
  double outside_prior = 0.1;
  /// [z] Such an effect leaves any excess up to this one. Chosen.
  double outside_excess = 60.0;
  /// [1] Causes are all there is above this probability. It limits causes in doubt, too. Chosen.
  double believed = 0.5;
  /// [width] Changes of the whole body up to so many widths of their priors are this body's. Chosen.
  double usual_body = 3.0;
  /// [1] Prior odds that the data are of another body. Chosen: a slip once in a hundred studies.
  double another_body = 0.01;
  /// [1] Cosine to the normal beyond which a channel is stated against it. Chosen.
  double against_normal = 0.5;
  /// [1] The causes explain little if more than this part of the misfit is left. Chosen.
  double left_at_most = 0.2;
  /// [1] Probability at most of a cause beside something unnamed. Chosen.
  double beside_unnamed = 0.9;
  /// [1] Weight of the ln likelihood that is left against the gain of such a cause. Chosen.
  double weight_of_unnamed = 3.0;
  /// [1] Prior odds of one extended cause against one more cause of a kind. Chosen.
  double extended_prior = 0.1;
  /// [1] A note says that causes of one kind are nearer than chance below this probability. Chosen.
  double near_by_chance = 0.05;
  /// [1] Part of what model errors lost in ln likelihood that widens one number. Chosen: 1/200.
  double error_per_number = 0.005;
  /// [1] Standard deviations of a number at which the misfit is looked at, to tell whether it rises
  /// as a square. Chosen: what users take for the range of nearly all values.
  double deviations_looked_at = 2.0;
  /// [1] Looks at most, each further out than the last, where it rises less. Chosen.
  int deviation_looks = 3;
  /// [1] A deviation grows by this factor at most. Derived: a coordinate known by its square alone
  /// reaches 0 within twice as far, or the square is known better than to two deviations.
  double longest_deviation = 2.0;
  /// [1] Iterations of the fit of all other numbers there. Chosen.
  int steps_beside = 3;
  /// [z] A note says that the stated variances are too large below this excess. Chosen.
  double too_little = -4.0;
  /// [1] A note says that the structure is not linear above this share of the variance. Chosen.
  double nonlinear_share = 0.5;
  /// [σ] What differs from zero by more than this is not noise. Chosen: the usual three deviations.
  double significant = 3.0;
  /// [1] Relative change of the modes for a second search. Chosen: last bits of another solver.
  double last_bits = 1e-9;
  /// [1] Bands into which lines are divided for errors and residuals. Chosen.
  int bands = 8;
  /// [1] Parts of sensors that are held out in turn, at most. Chosen.
  Eigen::Index sensor_parts = 8;
  /// [1] Blocks of lines that are held out in turn, at most. Chosen.
  Eigen::Index line_parts = 5;
  /// [1] Steps at most to the deviations that suit a part that is held out. Chosen.
  int part_steps = 6;
  /// [1] Upper part of the band that is held out. Methods.
  double upper_part = 0.4;
  /// [1] Largest loss on held-out sensors, over the gain on lines, or the reverse. Chosen.
  double held_out_loss = 0.5;

  // The location of the unknown, and the next measurement.
  /// [1] A superclass explains at least this part of the excess. Chosen.
  double least_explained = 0.1;
  /// [1] Deviation of free frequencies, relative. Chosen.
  double free_frequency = 0.03;
  /// [ln] Deviation of free dampings. Chosen.
  double free_damping = 0.7;
  /// [band] Modes up to this multiple of the band are free. Chosen.
  double free_modes = 1.5;
  /// [1] Iterations of the fit with free modes. Chosen.
  int free_iterations = 6;
  /// [ln] Another sensor is proposed if it separates two explanations by this much. Chosen.
  double next_evidence = 3.0;
  /// [1] Places that are tried for it, about. Chosen.
  Eigen::Index next_places = 100;
  /// [1] Lines that are computed for it, at most. Chosen.
  Eigen::Index next_lines = 60;
  /// [1] Relative noise of that sensor if no response states one. Chosen.
  double next_noise = 0.01;
  /// [ln] A measurement that brings more is worth no more. Chosen: as sure_evidence.
  double next_enough = 12.0;
  /// [1] Explanations that it is to tell apart, at most. Chosen.
  std::size_t next_rivals = 6;
  /// [1] Part of the body's mass of a known mass that is proposed. Chosen.
  double next_mass = 0.01;
  /// [1] Frequencies with and without it are repeatable to this. Chosen.
  double next_repeat = 3e-4;
  /// [1] Error of scales. Chosen.
  double next_scales = 1e-3;
  /// [1] Error of callipers on a dimension. Chosen.
  double next_callipers = 1e-3;
  /// [1] A mode that the sensors see less, of their usual shape, gives no number. Chosen.
  double next_seen = 0.1;
  /// [1] Part of the doubt that the least rivals share, for which no measurement is sought. Chosen.
  double next_tail = 0.1;
  /// [σ] Step along each axis of the covariance of an explanation. Chosen.
  double next_step = 0.1;
  /// [1] Rigid-body modes that are no translation to this have no mass to weigh. Chosen.
  double next_flat = 0.05;

  // The data.
  /// [1] Lines of the search, at most. Chosen.
  int lines_of_search = 320;
  /// [1] The last fit takes so many times the lines of the search. Chosen.
  int last_fit_lines = 2;
  /// [1] Lines of a scene and of the score test, at most. Chosen.
  int lines_of_scene = 120;
  /// [1] A diagnosis needs this many lines. Chosen.
  std::size_t least_lines = 8;
  /// [1] Part of the density of thinned lines that follows the length of the curves. Chosen.
  double lines_by_length = 0.5;
  /// [1] Lines up to this multiple of the highest mode's frequency are used. Chosen.
  double highest_line = 0.9;

  // The model and its errors.
  /// [1] Error of a cause over Tolerances::response. Chosen: the ratio in models of other elements.
  double cause_over_response = 10.0;
  /// [band] Modes up to this multiple have their own frequencies and dampings. Chosen.
  double own_frequencies = 3.0;
  /// [band] Modes up to this multiple have their own errors of shape. Chosen.
  double own_shapes = 1.6;
  /// [ζ] Modes nearer than this share their deviations. Chosen: two half-power bandwidths.
  double one_cluster = 4.0;
  /// [1] The damping ratio counts as at least this for it. Chosen.
  double least_damping = 1e-4;
  /// [1] A cell keeps at least this part of its thickness. Chosen.
  double thinnest = 0.05;

  // The search.
  /// [1] Candidates fitted in full per explanation, without hints. Methods: 4 to 7.
  int fits_per_level = 5;
  /// [1] Hints fitted in full per explanation, at most. Chosen.
  int hints_per_level = 4;
  /// [1] Fits at once, so that later ones meet the same bar on any number of threads. Chosen.
  std::size_t fits_at_once = 2;
  /// [1] Explanations carried to the next level, at most. Chosen; methods have 3.
  int beam = 2;
  /// [ln] These are no further from the best than this. Chosen.
  double beam_within = 20.0;
  /// [half-power bandwidth] Loaded modes nearer than about this share their damping ratios. Chosen.
  double pair_width = 0.1;
  /// [1] The same of their frequency, at least. Chosen: above the rounding of repeated frequencies.
  double least_pair_width = 1e-6;
  /// [z] A residual below this excess is noise. Chosen: its deviation is 1.
  double noise_excess = 1.0;
  /// [z] No hints beside a large cause and no exchanges above this excess. Chosen.
  double hopeless_excess = 1000.0;
  /// [1] The first cause is large if the mean square of the tolerances exceeds this. Chosen.
  double large_stretch = 2.0;
  /// [z] The first cause is large only if the excess exceeds this too. Chosen.
  double large_excess = 20.0;
  /// [1] Above this mean square the first cause is sought with tolerances at 0 too. Chosen.
  double small_stretch = 0.1;
  /// [ln] An exchanged cause must bring more than this. Chosen.
  double exchange_gain = 1.0;
  /// [1] Misfit over the data's power above which channels get free gains. Chosen.
  double lost_power = 0.3;
  /// [ln] Deviation of these gains. Chosen.
  double free_gain = 1.0;
  /// [1] Candidates that a first look fits. Chosen.
  int look_fits = 3;
  /// [1] Iterations of each of its fits. Chosen.
  int look_iterations = 8;
  /// [1] Fits that the last fit repeats. Chosen.
  std::size_t last_fits = 3;

  // Fits.
  /// [1] Iterations of a fit. Chosen.
  int fit_iterations = 30;
  /// [ln] A fit ends if a step promises less. Chosen.
  double fit_tolerance = 0.05;
  /// [1] Iterations of a candidate's fit. Chosen.
  int quick_iterations = 16;
  /// [ln] A candidate's fit ends if a step promises less. Chosen.
  double quick_tolerance = 0.3;
  /// [1] Iterations of the fit of the tolerances alone. Chosen.
  int nothing_iterations = 25;
  /// [ln] A fit has converged if one more step promises less. Chosen.
  double nothing_more = 0.5;
  /// [1] Part of a bandwidth to which a start takes a measured frequency. Chosen.
  double start_bandwidth = 0.1;
  /// [ln] Deviation to which it takes a measured damping ratio. Chosen.
  double start_damping = 0.2;
  /// [ln] A promise counts up to this, where the quadratic model is reliable. Chosen.
  double promise_at_most = 8.0;
  /// [ln] A fit this much lower in density may still have more evidence. Chosen.
  double occam_margin = 60.0;
  /// [ln] After a smaller fall the quadratic model of the step before is kept. Chosen.
  double small_fall = 0.1;
  /// [1] Part of the surface's size within which two places are one. Chosen.
  double same_place = 0.05;
  /// [1] A simpler attachment is fitted if its force differs by less than this part. Chosen.
  double alike_force = 0.5;

  // Places and starts.
  /// [1] Maxima of a scan that are kept. Chosen.
  std::size_t peaks = 8;
  /// [1] Places at which the score test tries a cause. Chosen.
  Eigen::Index places_of_score = 144;
  /// [ln] Largest loss of evidence between two neighbouring places of these. Chosen.
  double lost_between_places = 6.0;
  /// [1] Another place is tried if it promises this part of the own place's evidence. Chosen.
  double as_promising = 0.8;
  /// [1] Other places that are tried, at most. Chosen.
  std::size_t other_places = 2;
  /// [step] A place is off the rim if the surface goes on for so many such steps. Chosen.
  double rim_steps = 10.0;
  /// [1] Frequencies of a probe without a place. Chosen.
  std::size_t probe_frequencies = 12;
  /// [1] Frequencies of a probe at each place. Chosen.
  std::size_t frequencies_at_place = 2;
  /// [width] A difference of this many widths of its prior is nearly zero. Chosen.
  double faint = 1e-3;
  /// [ln] A strength this far below its usual size is nearly zero. Chosen: a millionth.
  double faint_strength = 14.0;
  /// [1] Least relative step of a frequency search, which is the mean damping ratio. Chosen.
  double least_frequency_step = 5e-4;
  /// [1] Largest relative step of a frequency search. Chosen.
  double most_frequency_step = 2e-2;
  /// [1] Starts of an effect that are improved. Chosen.
  std::size_t starts_moved = 6;
  /// [1] Starts of an effect that become candidates. Chosen.
  std::size_t starts_kept = 2;
  /// [1] Starts with more misfit per number than this are moved by direct search. Chosen.
  double far_misfit = 20.0;
  /// [1] Misfits of the direct search for each of these starts. Chosen.
  int moves_first = 80;
  /// [1] Further misfits for the best of them. Chosen.
  int moves_further = 170;
  /// [1] The steps of a direct search are halved so often. Chosen.
  int halvings = 6;
  /// [pitch] First step of a place, in distances of the scan. Chosen.
  double stride_of_place = 0.5;
  /// [1] First relative step of a difference. Chosen.
  double stride_of_difference = 0.3;
  /// [ln] First step of a logarithm. Chosen.
  double stride_of_logarithm = 0.35;
  /// [1] Gauss-Newton steps of a start. Chosen.
  int start_iterations = 8;
  /// [1] A start is good if a step lowers its misfit by less than this. Chosen.
  double start_fall = 0.5;
  /// [1] This part of the misfit is added to that fall. Chosen.
  double start_fall_part = 1e-4;

  // What an experiment can detect.
  /// [1] Fraction of the experiments in which a detectable effect is found. Chosen.
  double power = 0.99;
  /// [1] Places at which its size is computed. Chosen.
  Eigen::Index detectable_places = 12;

  // The comparison of modes and responses.
  /// [1] Smallest MAC of a pair, less the penalty of its frequencies. Chosen.
  double least_mac = 0.3;
  /// [ln] Unit of distance of two frequencies: equal shapes pair up to e^±0.25. Chosen.
  double apart = 0.3;
  /// [ln] The same where shapes do not decide: up to e^±0.1. Chosen.
  double apart_alone = 0.1;
  /// [1] Modes with a smaller relative gap are compared by their subspace. Chosen.
  double repeated_gap = 5e-3;
  /// [1] A mode below this part of the largest shape is not seen by the channels. Chosen.
  double in_view = 1e-4;
  /// [1] The band ends at this multiple of the last measured mode, if none is given. Chosen.
  double beyond_last = 1.05;
  /// [band] Simulated modes up to this multiple of the band may be partners. Chosen.
  double reach = 1.3;
  /// [ζ] No mode above this damping ratio: the resonance is as wide as its frequency. Chosen.
  double no_resonance = 0.5;
  /// [1] Relative deviation that the frequency of a mode may always have. Chosen.
  double frequency_known = 0.01;
  /// [1] Lead in MAC with which the shape alone chooses a partner. Chosen.
  double clear_mac = 0.2;
  /// [1] Frequencies alone pair the modes above this mean MAC of different modes. Chosen.
  double confused = 0.5;
  /// [1] Smallest correlation that decides a sign. Chosen.
  double phases_say = 0.2;
  /// [1] Smallest gain in likeness by an exchange of channels. Chosen.
  double exchange_better = 0.05;
  /// [1] Smallest likeness of channels after the exchange. Chosen.
  double same_channel = 0.5;
  /// [1] Largest relative difference of the shapes of a collocated pair. Chosen.
  double one_place = 1e-3;
};

inline constexpr Constants kConstants{};

}  // namespace chladni::diagnosis
