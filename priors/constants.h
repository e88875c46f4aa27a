// What decides in this room: length scales, amplitudes, what a simulation may be wrong by.
// docs/reference/constants_identification.md has the same list, with what was seen when one was
// halved and doubled; a test compares both. Lengths are relative to the body, times to the band.
#pragma once

#include <Eigen/Core>
#include <array>

namespace chladni::priors {

/// Each comment says what the constant decides [unit] (source).
struct Constants {
  // Length scales.
  /// Points of the surface from which the length scale of a simulated mode is learned; more change
  /// it little, thesis figure 5.12 [points] (chosen, 64f1e34; thesis figure 5.12).
  static constexpr Eigen::Index length_samples = 400;
  /// Points that stand for the surface where the expected error gives the length [points] (chosen,
  /// 64f1e34).
  static constexpr Eigen::Index expected_samples = 300;
  /// Frequency of a measured mode over that of a flexible simulated one below which it is taken for
  /// a rigid one [1] (chosen, 64f1e34).
  static constexpr double rigid_frequency = 0.25;
  /// Motion of the surface in a mode over that of the strongest below which no length is learned
  /// from it [1] (chosen, 64f1e34).
  static constexpr double still = 0.01;
  /// Frequency of a simulated mode over the highest measured one up to which its length counts [1]
  /// (chosen, c369a77).
  static constexpr double length_band = 2.0;
  /// First grid of the search of one hyper-parameter [lengths] (chosen, 6f4d1d2).
  static constexpr int length_grid = 16;
  /// Most refinements of a maximum on that grid, for each shape [evaluations] (chosen, 6f4d1d2).
  static constexpr int line_steps = 40;
  /// Least noise over the size of the values; with less, rounding would choose the length [1]
  /// (chosen, 6f4d1d2).
  static constexpr double least_noise_ratio = 1e-8;
  /// Grid of the lengths along a surface [lengths] (chosen, c102b84).
  static constexpr int surface_lengths = 32;
  /// Smoothness of shapes that have a slope across the free rims of their surface [1] (chosen,
  /// 46eeb1f).
  static constexpr double rim_smoothness = 1.0;

  // Amplitudes.
  /// Intervals of the scan for the amplitude of a Gaussian process [1] (chosen, 09623d9).
  static constexpr int process_intervals = 60;
  /// Reach of the scan for the amplitude of coefficients, about the estimate from the values [ln
  /// a²] (chosen, 09623d9).
  static constexpr double amplitude_reach = 17.0;
  /// Intervals of this scan [1] (chosen, 09623d9).
  static constexpr int amplitude_intervals = 34;
  /// Amplitude below that estimate at which the values count as noise [ln a²] (chosen, 09623d9).
  static constexpr double vanishing = -15.5;
  /// Points of the scan for the smoothing of a spline [1 / decade] (chosen, 535b746).
  static constexpr double smoothing_per_decade = 8.0;

  // Places.
  /// Distance below which two places are one, and a sensor is collocated with an actuator
  /// [diagonals of the places] (chosen, e9c982c).
  static constexpr double same_place = 1e-6;
  /// Distance along the direction of a channel, at most, of two places that are one for it: the two
  /// faces of a plate [diagonals of the surface] (chosen).
  static constexpr double through_body = 0.05;
  /// Angle between two directions below which they are one [rad] (chosen, 64f1e34).
  static constexpr double same_direction = 1e-6;
  /// Difference of two values of one place above which a channel is at fault [deviations] (chosen,
  /// e9c982c).
  static constexpr double same_value = 8.0;
  /// Directions of a thin plate spline are parallel below it; 1.4 mrad [1 - cos] (chosen, 535b746).
  static constexpr double parallel = 1e-6;
  /// Extent of the places across over that along below which they are on a line [1] (chosen,
  /// 535b746).
  static constexpr double on_a_line = 1e-4;
  /// Extent of the places over the widest one below which a trend has no slope along it [1]
  /// (chosen, bdb40b1).
  static constexpr double no_extent = 1e-6;

  // Errors of the simulation.
  /// Modes above the computed ones whose residual is estimated [modes] (chosen, 09623d9).
  static constexpr Eigen::Index modes_beyond = 200;
  /// Distance of a learned error or correction from the plausible one above which a doubt is noted
  /// [deviations] (chosen, 09623d9).
  static constexpr double doubtful = 2.5;
  /// Least remaining error of the simulation with corrections over that without [1] (chosen,
  /// 7631604).
  static constexpr double least_error_left = 0.35;
  /// Plausible errors of the mass against those of the stiffness, with corrections [1] (chosen,
  /// 7631604).
  static constexpr double middle_kappa = 1.0;
  /// Deviation of the same [ln] (chosen, 7631604).
  static constexpr double kappa_spread = 0.05;
  /// Steps from the error without corrections to the least one [1] (chosen, 7631604).
  static constexpr int correction_stages = 3;
  /// Largest correction that is sought [deviations] (chosen, 7631604).
  static constexpr double farthest_correction = 5.0;
  /// Deviations between the frequencies of a model and of the real shape that are tried [ln f]
  /// (chosen, c369a77).
  static constexpr std::array ensemble_widths{0.02, 0.05, 0.15};
  /// What an ensemble of models leaves, tried with each of them [of the mean square] (chosen,
  /// c369a77).
  static constexpr std::array ensemble_residuals{0.003, 0.01, 0.03, 0.1, 0.3, 1.0};
  /// Reach of the scan for the gain, about the value that the sizes of both sides give [ln β]
  /// (chosen, c369a77).
  static constexpr double gain_reach = 8.25;
  /// Intervals of this scan [1] (chosen, c369a77).
  static constexpr int gain_intervals = 66;
  /// Step of Newton from the gain of one simulation to that of another, at most; beyond it the
  /// highest point is sought [deviations] (chosen).
  static constexpr double gain_move = 3.0;
  /// Curvature of the evidence over that of the first simulation, at least, for such a step [1]
  /// (chosen).
  static constexpr double gain_bend = 0.25;
  /// Height of that highest point over both ends of the scan, at least; else the simulation tells
  /// no gain [ln evidence] (chosen: two deviations).
  static constexpr double gain_peak = 2.0;

  // One scale.
  /// Deviation of a shape's mean square at few places from the one scale of all modes [ln a²]
  /// (chosen, df6c4db).
  static constexpr double amplitude_spread = 0.4;
  /// Plausible deviation of a value at a place from the shape of the structure [root mean squares]
  /// (chosen, df6c4db).
  static constexpr double place_deviation = 0.05;
  /// Deviation of the same [ln] (chosen, df6c4db).
  static constexpr double place_spread = 1.5;
  /// Deviation of the one scale from the size of the values [ln] (chosen, df6c4db).
  static constexpr double scale_spread = 1.0;

  // Orthogonal shapes.
  /// Plausible product of two unit shapes [1] (chosen, 3142b42).
  static constexpr double middle_product = 0.1;
  /// Least product of two unit shapes that is learned [1] (chosen, 3142b42).
  static constexpr double least_product = 0.01;
  /// Largest product of two unit shapes that is learned [1] (chosen, 3142b42).
  static constexpr double most_product = 1.0;
  /// Intervals of the grid between them [1] (chosen, 3142b42).
  static constexpr int product_intervals = 60;
  /// Least tolerance of orthogonality after learned corrections [1] (chosen, eb9c49e).
  static constexpr double least_tolerance = 0.1;

  // Bands.
  /// Parts of the places that are left out in turn to scale a band [1] (chosen, eb9c49e).
  static constexpr Eigen::Index parts = 4;
  /// Fewest places from which a band is scaled [places] (chosen, eb9c49e).
  static constexpr Eigen::Index fewest_places = 8;
  /// Least factor of a band [1] (chosen, eb9c49e).
  static constexpr double narrowest = 0.75;
  /// Largest factor of a band [1] (chosen, eb9c49e).
  static constexpr double widest = 4.0;
  /// Part of the left-out values that a scaled band holds [1] (chosen, eb9c49e).
  static constexpr double held = 0.95;
  /// The same for a field along the surface [1] (chosen, c369a77).
  static constexpr double unseen = 0.5;

  // Symmetry and expansion.
  /// Points of the surface that are mapped [points] (chosen, 64f1e34).
  static constexpr Eigen::Index symmetry_samples = 500;
  /// Distance from an image to the next point, at most [mean point distances] (chosen, 64f1e34).
  static constexpr double image_reach = 0.75;
  /// Part of the points with an image, at least [1] (chosen, 64f1e34).
  static constexpr double mapped = 0.98;
  /// Correlation of a shape and its image from which it keeps the symmetry [1] (chosen, 64f1e34).
  static constexpr double same_shape = 0.95;
  /// Relative distance of frequencies within which simulated modes are one group [1] (chosen,
  /// 64f1e34).
  static constexpr double repeated_frequency = 0.01;
  /// Part of a symmetrised shape that is not symmetric [of the variance] (chosen, 64f1e34).
  static constexpr double asymmetric = 0.15;
  /// Prior deviation of a rigid-body mode: large enough to be free [deviations of a value] (chosen,
  /// c369a77).
  static constexpr double free_rigid = 1e3;
  /// Frequency of a simulated mode over the highest measured one up to which SEREP takes it [1]
  /// (chosen, c369a77).
  static constexpr double serep_band = 1.3;
  /// Values of a mode at the places over those of the strongest below which it is left out [1]
  /// (chosen, c369a77).
  static constexpr double unseen_mode = 1e-6;
};

}  // namespace chladni::priors
