#include "recordings/closed_loop.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/finite.h"
#include "recordings/constants.h"

namespace chladni::recordings {
namespace {

// Inputs that equal their reference in every record, to the last bit of the spectra.
std::vector<bool> uncontrolled(const SpectraSource& spectra) {
  std::vector<bool> result(spectra.head.inputs.size(), true);
  for (std::size_t i = 0; i < spectra.records.size(); ++i) {
    for (std::size_t p = 0; p < spectra.records[i].periods; ++p) {
      const auto period = spectra.period(i, p);
      for (std::size_t j = 0; j < result.size(); ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        if (period.inputs->col(column) != period.references->col(column)) result[j] = false;
      }
    }
  }
  return result;
}

TransferPlan plan_of(const Spectra& spectra, Eigen::Index drop) {
  TransferPlan plan{.to = {}, .from = {}, .drop = drop};
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(spectra.outputs.size()); ++i) {
    plan.to.push_back({Side::outputs, i});
  }
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(spectra.inputs.size()); ++j) {
    plan.to.push_back({Side::inputs, j});
    plan.from.push_back({Side::references, j});
  }
  return plan;
}

// Adds one note for each difficulty of the inversion, with its number of lines.
void warn(const std::vector<Eigen::MatrixXd>& variance, ClosedLoopEstimate& result) {
  Eigen::Index stiff = 0;
  Eigen::Index unclear = 0;
  for (Eigen::Index k = 0; k < result.condition.size(); ++k) {
    if (result.condition(k) > Constants::hard_to_invert) ++stiff;
    if (variance.empty()) continue;
    const auto line = static_cast<std::size_t>(k);
    const double deviation = std::sqrt(variance[line].maxCoeff());
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(finite(result.sensitivity[line], "sensitivity"));
    if (svd.singularValues().minCoeff() < Constants::clear_sensitivity * deviation) ++unclear;
  }
  const auto of = " of " + fmt::to_string(result.condition.size()) + " lines";
  if (stiff > 0) {
    result.estimate.notes.push_back("the sensitivity is hard to invert (condition above 1000) on " +
                                    fmt::to_string(stiff) + of);
  }
  if (unclear > 0) {
    result.estimate.notes.push_back(
        "the sensitivity is within three deviations of singular on " + fmt::to_string(unclear) +
        of + ": the loop takes the excitation away there; the estimate is biased");
  }
}

// Computes S on each line with its exact rows, its condition, and G = P S⁻¹. Returns S⁻¹.
std::vector<Eigen::MatrixXcd> inverted(const Transfer& mean, const std::vector<bool>& exact,
                                       Eigen::Index p, ClosedLoopEstimate& result) {
  const auto q = static_cast<Eigen::Index>(exact.size());
  result.condition.resize(static_cast<Eigen::Index>(mean.value.size()));
  std::vector<Eigen::MatrixXcd> inverse;
  for (std::size_t k = 0; k < mean.value.size(); ++k) {
    Eigen::MatrixXcd s = mean.value[k].bottomRows(q);
    for (Eigen::Index j = 0; j < q; ++j) {
      if (exact[static_cast<std::size_t>(j)]) s.row(j) = Eigen::RowVectorXcd::Unit(q, j);
    }
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(finite(s, "sensitivity"));
    result.condition(static_cast<Eigen::Index>(k)) =
        svd.singularValues()(0) / svd.singularValues()(q - 1);
    inverse.emplace_back(s.partialPivLu().inverse());
    result.estimate.set.value.emplace_back(mean.value[k].topRows(p) * inverse.back());
    result.sensitivity.push_back(std::move(s));
  }
  return inverse;
}

void check_references(const Spectra& spectra) {
  require(spectra.references.size() == spectra.inputs.size(),
          "closed loop: " + fmt::to_string(spectra.references.size()) + " references for " +
              fmt::to_string(spectra.inputs.size()) +
              " inputs; expected one for each (of an input that is not controlled: the input)");
}

}  // namespace

ClosedLoopEstimate closed_loop_estimate(const Spectra& all, const FrfEstimateOptions& options) {
  require(!all.records.empty(), "closed loop: no record");
  check_references(all);
  const auto spectra = excited_part(all, options);
  return closed_loop_of_excited(source_of(spectra), options);
}

ClosedLoopEstimate closed_loop_of_excited(const SpectraSource& spectra,
                                          const FrfEstimateOptions& options) {
  check_references(spectra.head);
  ClosedLoopEstimate result;
  auto& estimate = result.estimate;
  estimate.transient = transient(spectra);
  estimate.dropped = options.drop.value_or(estimate.transient.drop);
  const auto plan = plan_of(spectra.head, estimate.dropped);
  const auto mean = transfer(spectra, plan);
  estimate.periods = mean.periods;
  estimate.realisations = mean.realisations;
  estimate.set.outputs = spectra.head.outputs;
  estimate.set.inputs = spectra.head.inputs;
  const auto p = estimate.set.output_count();
  const auto q = estimate.set.input_count();
  const auto inverse = inverted(mean, uncontrolled(spectra), p, result);
  using Deviation = Eigen::MatrixXcd;
  const auto of_g = [&](std::size_t k, const Deviation& d) -> Deviation {
    return (d.topRows(p) - estimate.set.value[k] * d.bottomRows(q)) * inverse[k];
  };
  const auto of_s = [&](std::size_t, const Deviation& d) -> Deviation { return d.bottomRows(q); };
  fill(spectra.head, variances(spectra, plan, mean, of_g), options, estimate);
  warn(variances(spectra, plan, mean, of_s).total, result);
  return result;
}

ClosedLoopEstimate closed_loop_estimate(const TimeData& data, const FrfEstimateOptions& options) {
  TransientReport about;
  const auto [all, own] = prepared(data, options, about);
  auto result = closed_loop_estimate(all, own);
  if (options.remove_transient) tell_removed(data, about, result.estimate);
  return result;
}

}  // namespace chladni::recordings
