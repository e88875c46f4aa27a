// Labels of channels that are mixed, put right before any cause is sought.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/measured_modes.h"

namespace chladni::diagnosis {

/// What was found about the labels of a measurement.
struct Labels {
  MeasuredModes measured;     ///< with the labels put right
  std::vector<Cause> causes;  ///< permuted_sensors, permuted_actuators; empty: as they are
  double log_evidence = 0.0;  ///< gain of all of them, of the structure as it is
  std::vector<ErrorLevel> levels_before;  ///< with the labels as they are; empty without a cause
  std::vector<ModeTold> modes_before;     ///< likewise
  std::vector<std::string> notes;
};

/// Permutations of three or more labels of a side, which the shapes show beyond any error of the
/// model. Each order that label_orders finds, and each that differs from the best one by two
/// labels, has the evidence of the structure as it is (ModesProblem::nothing) on data so
/// relabelled, and its prior (log_prior). The labels are put right if the best order has the least
/// evidence of a cause beyond the labels as they are, and is likelier than Constants::sure among
/// all orders looked at. Where others are as likely (a symmetry of the body, too few modes), or the
/// shapes fit in no order, a note says so and nothing is put right; fewer than three modes are not
/// asked. A permutation of two labels is left to swapped_sensors, a turned record to sensor_sign.
/// Cost: milliseconds where labels are right; 1 to 4 s for 12 modes at 13 channels where they are
/// not.
/// @pre  structure and measurement have the same channels in the same order
[[nodiscard]] Labels labels_of(const Structure& structure, const MeasuredModes& measured,
                               const DiagnosisOptions& options);

/// Adds the causes to each explanation of the relabelled data, and what was there before. A cause
/// of a record (a gain, a sign, a unit) then names the record as the measurement labels it. A cause
/// of a channel (its place or direction, crosstalk, an exchange) names the channel.
void add(const Labels& labels, Diagnosis& diagnosis);

}  // namespace chladni::diagnosis
