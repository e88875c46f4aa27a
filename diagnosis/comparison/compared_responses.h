// Responses for a comparison: each on the lines where it was measured.
#pragma once

#include <limits>

#include "diagnosis/compare.h"

namespace chladni::diagnosis {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// One response on its measured lines within the band.
struct ComparedResponse {
  Eigen::VectorXd frequency_hz;
  Eigen::VectorXcd measured, simulated;
  Eigen::VectorXd variance;  // empty: not stated

  [[nodiscard]] Eigen::Index count() const { return measured.size(); }
};

/// All responses, (i, j) at i + p j.
struct ComparedResponses {
  Eigen::Index outputs = 0, inputs = 0;
  std::vector<ComparedResponse> all;

  [[nodiscard]] const ComparedResponse& operator()(Eigen::Index i, Eigen::Index j) const {
    return all[static_cast<std::size_t>(i + outputs * j)];
  }
};

/// @throws InvalidInput  as compared
[[nodiscard]] ComparedResponses responses_of(const modal::FrfSet& measured,
                                             const std::vector<Eigen::MatrixXcd>& simulated,
                                             const ComparisonOptions& options);

[[nodiscard]] inline bool in_band(double frequency_hz, const ComparisonOptions& options) {
  return frequency_hz >= options.low_hz && frequency_hz <= options.high_hz;
}

/// The `value` of each response, p×q; NaN where nothing was measured.
template <typename Value>
[[nodiscard]] Eigen::MatrixXd per_response(const ComparedResponses& of, const Value& value) {
  Eigen::MatrixXd result(of.outputs, of.inputs);
  for (Eigen::Index j = 0; j < of.inputs; ++j) {
    for (Eigen::Index i = 0; i < of.outputs; ++i) {
      result(i, j) = of(i, j).count() > 0 ? value(of(i, j)) : kNotMeasured;
    }
  }
  return result;
}

/// Sets the effect of the channels on the responses: gains and signs.
void set_gains(const ComparedResponses& of, ResponseComparison& result);
void set_signs(const ComparedResponses& of, ResponseComparison& result);
/// Likeness of measured channel i to simulated channel k of one side.
[[nodiscard]] Eigen::MatrixXd channels_alike(const ComparedResponses& of, bool outputs);

}  // namespace chladni::diagnosis
