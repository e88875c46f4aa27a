// The numbers that decide a diagnosis of measured modes. They are part of Constants (constants.h).
#pragma once

#include <Eigen/Core>

namespace chladni::diagnosis {

struct ModeConstants {
  /// [ln] Deviation of the frequency of a measured mode that the model lacks. Chosen.
  double alone_frequency = 0.3;
  /// [ln] Penalty of a measured mode that the model lacks. Chosen.
  double alone = 3.0;
  /// [ln] Penalty of a mode of the model within the band that was not measured. Chosen.
  double unmeasured = 2.0;
  /// [1] Part of the level of phases that each channel has by itself. Chosen.
  double own_phase = 0.7;
  /// [1] Part of the level of phases that neighbouring channels share. Chosen.
  double smooth_phase = 0.7;
  /// [ln] Modes nearer than this mix by errors of the model. Chosen.
  double nearby = 0.15;
  /// [ln] Modes nearer than this mix as if they were so far apart. Chosen.
  double least_gap = 0.02;
  /// [1] Damping that two modes share, over their own: sqrt(c_kk c_ll) at most. Chosen: half.
  double damping_coupling = 0.5;
  /// [1] Gains or places may scatter so many times less without one bad channel. Chosen.
  double scattered = 4.0;
  /// [1] Levels that are lower, but by no less than this, are not looked at by themselves. Chosen.
  double levels_alike = 0.7;
  /// [1] A start whose changes over their deviations have a smaller sum of squares is none. Chosen.
  double start_seen = 1.0;
  /// [ln] Deviation of the size of a residue that a side of channels does not see. Chosen.
  double unseen_size = 1.0;
  /// [1] Error of the part by which a complex mode's residue is larger. Chosen: of few channels.
  double excess_error = 0.5;
  /// [1] Least part of a shape in phase that counts there. Chosen.
  double least_in_phase = 0.1;
  /// [ln] Deviation of a residue that is not believed. Chosen.
  double unknown_scale = 3.0;
  /// [size] Length of smooth errors of a shape. Chosen.
  double smooth_over = 0.2;
  /// [band] Modes from this part of the lowest measured frequency are compared. Chosen.
  double modes_below = 0.4;
  /// [band] Modes up to this multiple of the highest measured frequency are compared. Chosen.
  double modes_above_band = 2.0;
  /// [band] Modes up to this multiple are coordinates of a first look. Chosen.
  double quick_modes = 1.6;
  /// [ln] A fit of modes ends when a round gains less. Chosen.
  double enough_fall = 0.01;
  /// [ln] Largest deviation of a size that the data show. Chosen.
  double determined = 0.333;
  /// [1] A smaller change of all numbers is none. Chosen.
  double unchanged = 1e-9;
  /// [1] Prior probability that modes have no cause. Chosen.
  double nothing_prior = 0.5;
  /// [1] Prior probability that modes have one cause. Chosen.
  double one_prior = 0.3;
  /// [1] Prior probability that modes have two causes. Chosen.
  double two_prior = 0.08;
  /// [1] Prior probability that modes have three causes. Chosen.
  double three_prior = 0.02;
  /// [1] Prior probability that a mode or a channel is not to be believed. Chosen.
  double disturbed_prior = 0.1;
  /// [1] Power of the evidence beside learned errors. Seen: of 50 sound rigs 8 had a cause above
  /// 0.9 at 1, none at 0.6.
  double evidence_power = 0.6;
  /// [1] Probability at which a cause of modes is named. Chosen.
  double sure = 0.8;
  /// [ln] A further cause that brings this, but not least_evidence, makes an unnamed rival. Chosen.
  double rival_evidence = 4.0;
  /// [ln] Frequencies of what hangs on the body that differ by more are two starts. Chosen.
  double same_frequency = 0.03;
  /// [ln] Distance of the stiffnesses from which a spring is sought where a mode is alone: the
  /// modes of neighbours are less than twice the reach of a pair apart. Chosen.
  double near_size = 0.9;
  /// [1] Part of the measured modes that must have a partner. Chosen.
  double few_partners = 0.5;
  /// [1] Part of the largest believed level at which nothing is believed. Chosen.
  double at_the_limit = 0.8;
  /// [1] Frequencies that scatter so many tolerances are no deviations within these. Chosen.
  double beyond_tolerance = 4.0;
  /// [1] The same of shapes over the tolerance of responses. Chosen: they are less certain.
  double beyond_response = 10.0;
  /// [1] A level that fewer errors determine is mostly its prior. Chosen.
  double errors_of_a_level = 3.0;
  /// [1] Error of shapes beside which neighbouring modes turn into each other. Chosen.
  double shape_error = 0.05;
  /// [1] Likeness of a shape that the channels do not see. Chosen.
  double unseen_likeness = 0.8;
  /// [1] Error of a shape value at which it tells little. Chosen.
  double blind_error = 0.2;
  /// [ln] Modes nearer than this turn into each other. Chosen.
  double neighbours = 0.05;
  /// [1] Error of a shape value over that of the body, at most. Chosen.
  double blindest = 10.0;
  /// [1] Error of a predicted change of a mode, over that change. Chosen: of a shape 5 % off.
  double change_error = 0.1;
  /// [ln] Usual difference of a frequency in two measurements of one structure. Chosen: in a day.
  double repeated_frequency = 2e-4;
  /// [ln] The same of a damping ratio. Chosen.
  double repeated_damping = 0.05;
  /// [1] The same of a shape, and of a residue. Chosen.
  double repeated_shape = 3e-3;
  /// [1] The same of a shape's phases, which follow cables and joints. Chosen.
  double repeated_phase = 1e-2;
  /// [1] The same of a channel's gain. Chosen: drift of amplifiers and sensors.
  double repeated_gain = 2e-3;
  /// [m] The same of a channel's place. Chosen: nothing is mounted anew.
  double repeated_place = 1e-4;
  /// [1] The same of the modulus. Chosen: aluminium and steel by half a kelvin.
  double repeated_modulus = 2e-4;
  /// [1] A larger multiple of these differences is a change of the structure. Chosen.
  double repeated_at_most = 16.0;
  /// [ln] Width of the levels of these differences. Chosen: narrower than a model's levels.
  double repeated_width = 1.0;
  /// [1] Modes that turn into each other keep this part of their independence. Chosen.
  double least_turned = 0.3;
  /// [1] Part of the largest eigenvalue below which a motion has no stiffness. Chosen.
  double no_stiffness = 1e-9;
  /// [1] Multiple of the largest eigenvalue at which a mass moves as the modes do. Chosen.
  double far_above = 1e6;
  /// [ln] Deviation of a constant that is not known: a factor of two. Chosen.
  double unknown_constant = 0.693;
  /// [1] Part of its prior variance that a constant keeps where the data say nothing. Chosen.
  double not_determined = 0.8;
  /// [1] Correlation of two constants that is told. Chosen.
  double strong_correlation = 0.9;
  /// [1] Frequencies off by this part are far off, where a scale of all is sought. Chosen.
  double far_off = 0.02;
  /// [1] Step of that scale. Chosen.
  double scale_step = 0.01;
  /// [1] Share of a constant in a direction that the data do not determine. Chosen.
  double share_told = 0.3;
  /// [1] Error of a shape value beside which labels are put right, in units of its rms. Chosen.
  double label_error = 0.1;
  /// [1] Labels as they are explain the shapes if the usual error is below this. Chosen.
  double explained_by_labels = 0.25;
  /// [ln] Penalty of a record that is turned as well. Chosen.
  double turned_record = 4.0;
  /// [1] Prior probability that three or more labels of a side are mixed. Chosen.
  double mixed_prior = 0.01;

  // Modes of responses.
  /// [1] Probability of a cause of modes that goes into the extended study. Chosen.
  double extended_cause = 0.5;
  /// [tolerance] Modes of responses that scatter more are diagnosed before these. Chosen.
  double scattered_modes = 2.0;
  /// [1] Shapes at fewer channels tell no error of the model from a cause. Chosen: three ratios.
  Eigen::Index channels_that_tell = 4;
  /// [1] Part of the excess that one cause may leave to be worth a search. Chosen.
  double promising = 0.7;
  /// [1] Largest error of frequencies that is called the model's. Chosen: 1 to 5 % are usual.
  double real_frequency = 0.05;
  /// [1] Largest error of shapes that is called the model's. Chosen: 5 to 20 % are usual.
  double real_shape = 0.2;
  /// [1] A level of fewer errors is not told. Chosen.
  double told_errors = 0.5;
  /// [1] Part of the largest residue of a response below which a mode is weak. Chosen.
  double weak_residue = 0.1;
  /// [1] Damping over the median above which a pole is a filling. Chosen.
  double too_damped = 3.0;
  /// [1] Responses of which modes are identified, at most. Chosen.
  Eigen::Index most_fitted = 200;
};

}  // namespace chladni::diagnosis
