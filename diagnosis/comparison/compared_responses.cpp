#include "diagnosis/comparison/compared_responses.h"

#include <cmath>
#include <complex>

#include "base/error.h"

namespace chladni::diagnosis {
namespace {

ComparedResponse response_of(const modal::FrfSet& measured,
                             const std::vector<Eigen::MatrixXcd>& simulated, Eigen::Index i,
                             Eigen::Index j, const ComparisonOptions& options) {
  std::vector<Eigen::Index> lines;
  for (Eigen::Index k = 0; k < measured.line_count(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const std::complex<double> value = measured.value[at](i, j);
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) continue;
    if (in_band(measured.frequency_hz(k), options)) lines.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(lines.size());
  ComparedResponse one{measured.frequency_hz(lines), Eigen::VectorXcd(n), Eigen::VectorXcd(n), {}};
  if (!measured.variance.empty()) one.variance.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = static_cast<std::size_t>(lines[static_cast<std::size_t>(k)]);
    one.measured(k) = measured.value[at](i, j);
    one.simulated(k) = simulated[at](i, j);
    if (!measured.variance.empty()) one.variance(k) = measured.variance[at](i, j);
  }
  return one;
}

}  // namespace

ComparedResponses responses_of(const modal::FrfSet& measured,
                               const std::vector<Eigen::MatrixXcd>& simulated,
                               const ComparisonOptions& options) {
  ComparedResponses result{measured.output_count(), measured.input_count(), {}};
  Eigen::Index lines = 0;
  for (Eigen::Index j = 0; j < result.inputs; ++j) {
    for (Eigen::Index i = 0; i < result.outputs; ++i) {
      result.all.push_back(response_of(measured, simulated, i, j, options));
      lines += result.all.back().count();
    }
  }
  require(lines > 0, "comparison: nothing was measured in the band");
  return result;
}

}  // namespace chladni::diagnosis
