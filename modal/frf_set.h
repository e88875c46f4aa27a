// Measured frequency responses between named channels, with the known noise.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "modal/frf.h"

namespace chladni::modal {

/// One end of a measured response.
struct MeasuredChannel {
  std::string name;                                     ///< "y1"; not empty, unique on its side
  std::optional<long long> node;                        ///< its number in a UFF file
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit; zero: not stated
  std::optional<Eigen::Vector3d> position;              ///< [m]
  std::string unit;                    ///< unit of the values: "m", "m/s^2", "N"; empty: not stated
  FrfKind kind = FrfKind::receptance;  ///< quantity of an output; inputs are forces
};

/// p outputs, q inputs, k lines. Values are in SI where the units are stated, with e^{+jωt}. Values
/// that were not measured are NaN. A response is measured on all lines or on none, but single lines
/// may be NaN as well.
struct FrfSet {
  std::vector<MeasuredChannel> outputs, inputs;
  Eigen::VectorXd frequency_hz;         ///< k, ascending, 0 or more
  std::vector<Eigen::MatrixXcd> value;  ///< [k], each p×q, row i of the kind of outputs[i]
  /// [k], each p×q: E|G − G₀|² of the estimate in its own unit squared, all causes; or empty.
  std::vector<Eigen::MatrixXd> variance;
  /// [k], each p×q: the noise part of it; the rest is stochastic nonlinear. Or empty.
  std::vector<Eigen::MatrixXd> noise_variance;
  std::vector<Eigen::MatrixXd> coherence;  ///< [k], each p×q in [0, 1]; or empty
  double averages = 0.0;                   ///< degrees of freedom of `variance`; 0: not known

  [[nodiscard]] Eigen::Index line_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index output_count() const {
    return static_cast<Eigen::Index>(outputs.size());
  }
  [[nodiscard]] Eigen::Index input_count() const {
    return static_cast<Eigen::Index>(inputs.size());
  }
};

/// @throws InvalidInput  sizes differ, a name is empty or occurs twice on one side, frequencies are
///                       not ascending; the message names the place
void check(const FrfSet& set);

/// The names of channels, in their order.
[[nodiscard]] std::vector<std::string> names_of(const std::vector<MeasuredChannel>& channels);

/// The same set with every output as `kind`. A line at 0 Hz is left out if it cannot be integrated.
/// Variances are converted, the coherence stays.
[[nodiscard]] FrfSet converted(const FrfSet& set, FrfKind kind);

/// The given rows and columns, or the lines in [low_hz, high_hz].
[[nodiscard]] FrfSet part(const FrfSet& set, const std::vector<Eigen::Index>& outputs,
                          const std::vector<Eigen::Index>& inputs);
[[nodiscard]] FrfSet band(const FrfSet& set, double low_hz, double high_hz);

/// The lines that `band` leaves out.
/// @throws InvalidInput  there are none
[[nodiscard]] FrfSet outside_band(const FrfSet& set, double low_hz, double high_hz);

}  // namespace chladni::modal
