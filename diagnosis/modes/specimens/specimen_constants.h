// The numbers that decide in a diagnosis of several specimens (docs/reference/specimens.md).
#pragma once

namespace chladni::diagnosis {

struct SpecimenConstants {
  /// [ln] Deviation of an entry that is wrong. Chosen: 10 to 20 % are blunders that happen.
  double blunder = 0.12;
  /// [1] Usual scatter of a constant between specimens, at most half of what is stated of it.
  /// Chosen: materials as they are bought.
  double spread = 0.05;
  /// [ln] Width of the prior of that scatter. Chosen.
  double spread_width = 1.1;
  /// [1] Scatter inside a group over that between groups. Chosen.
  double within_group = 0.5;
  /// [ln] Width of the prior of this ratio. Chosen.
  double within_group_width = 0.7;
  /// [1] Usual error of the model in a frequency that all specimens share. Chosen.
  double shared_error = 0.01;
  /// [1] Usual error that each mode of a specimen has by itself. Chosen.
  double own_error = 0.004;
  /// [ln] Width of both priors: a factor of four, as that of other levels.
  double error_width = 1.386;
  /// [1] Larger errors are not believed of a model of the design. As the level of frequencies.
  double error_at_most = 0.1;
  /// [1] A frequency measured twice on one specimen repeats to this. Chosen.
  double repeated = 1e-3;
  /// [ln] Constants of a specimen that is not of this design. Chosen.
  double unlike_constants = 0.3;
  /// [1] Prior probability that one of the specimens is not of this design. Chosen.
  double unlike_prior = 0.02;
  /// [ln] Frequencies of a specimen that is not of this design. Chosen.
  double unlike_modes = 0.05;
  /// [ln] A frequency that is not believed. Chosen.
  double stray = 0.2;
  /// [1] Prior probability that a frequency is not to be believed. Chosen.
  double stray_prior = 0.01;
  /// [1] Part of the frequencies that may be strays. Chosen.
  double strays_at_most = 0.15;
  /// [1] Single entries that are fitted in full; the others by their score. Chosen.
  int in_full = 12;
  /// [1] Explanations that are carried to one entry more. Chosen.
  int carried = 4;
  /// [1] Linearisations. Chosen: the third one changes nothing.
  int rounds = 3;
  /// [ln] Usual error of the frequency of a pair, where ways of pairing are compared. Chosen.
  double pair_error = 0.02;
  /// [1] Of the squares of such an error: a pair that is farther apart counts as a stray. Chosen.
  double pair_at_most = 4.0;
  /// [1] Of a simulated mode in the band that was not measured, likewise. Chosen.
  double unseen_mode = 1.0;
  /// [1] Shapes at so few channels tell no modes apart.
  int few_channels = 2;
  /// [ln] Of a constant, from the median of the others, where ways of pairing are compared. Chosen.
  double far_from_others = 0.1;
  /// [1] Weight of frequencies beside shapes where modes of specimens are numbered. Chosen.
  double apart_at_all = 0.01;
  /// [ln] Step of a constant in the slopes of frequencies. Chosen.
  double slope_step = 1e-4;
  /// [1] Variance of numbers that are known exactly: it keeps K definite. Chosen.
  double least_variance = 1e-12;
  /// [1] Probability of an entry that is told beside the best. Chosen.
  double told_rival = 0.05;
  /// [1] Worth of measuring an entry that the answer rests on: more than any other has. Chosen.
  double named_first = 10.0;
  /// [1] Least likeness of the shapes of a mode in two specimens. As in comparisons.
  double same_mode = 0.3;
};

inline constexpr SpecimenConstants kSpecimens{};

}  // namespace chladni::diagnosis
