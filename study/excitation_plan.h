// The experiment that a study wants to make: limits of the rig, and what is to be known afterwards.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "study/place.h"

namespace chladni::study {

/// [design]: for `chladni experiment`. What the rig's clock and sensors are stands in [experiment].
struct ExcitationPlan {
  std::string kind = "multisine";             ///< or "hammer"
  std::optional<double> force, stroke;        ///< peak limits [N], [m]
  std::optional<double> voltage;              ///< peak limit [V]
  std::optional<double> force_per_volt;       ///< of every actuator with its amplifier [N/V]
  double margin = 0.8;                        ///< part of each limit that is used
  std::optional<double> frequency_deviation;  ///< wanted of every mode [Hz]
  double damping_deviation = 0.05;            ///< wanted, relative
  int realisations = 4;                       ///< of the random phases
  double longest = 1800.0;                    ///< [s], of the whole experiment
  double longest_period = 120.0;              ///< [s], or of the record of a blow
  std::string phases = "random";              ///< or "low_crest"
  double simulation_error = 0.03;             ///< relative deviation of simulated frequencies
  std::optional<double> pulse;                ///< [s], of a blow
  FacePlan on;                                ///< faces that can be hit
  std::vector<std::string> files = {"csv", "mat", "wav"};  ///< of the signals

  /// [N], the lower of force and voltage; infinite: neither is stated.
  [[nodiscard]] double force_limit() const {
    const double infinite = std::numeric_limits<double>::infinity();
    const double by_voltage = voltage ? *voltage * force_per_volt.value_or(infinite) : infinite;
    return std::min(force.value_or(infinite), by_voltage);
  }
};

}  // namespace chladni::study
