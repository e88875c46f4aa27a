#include "steps/diagnosis/responses_in_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/upper_median.h"
#include "diagnosis/constants.h"
#include "identification/constants.h"
#include "identification/fit_data.h"
#include "identification/identified.h"
#include "identification/trust.h"
#include "modal/stated_variances.h"
#include "steps/identification.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

constexpr Index kFarModes = 3;  // of a suspension and a frame
constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// Takes variances from the weights of a fit to the same data where `lacks` says so of a finite
// value, whose variance is 0. What these take for not measured is so here. Returns their number.
template <typename Lacks>
Index take_variances(modal::FrfSet& set, const Lacks& lacks) {
  const auto data = identification::fit_data(set);
  Index taken = 0;
  Index line = 0;
  for (Index k = 0; k < set.line_count(); ++k) {
    if (set.frequency_hz(k) <= 0.0) continue;
    const Eigen::MatrixXd weight =
        data.weight.row(line++).reshaped(set.output_count(), set.input_count());
    auto& value = set.value[static_cast<std::size_t>(k)];
    auto& variance = set.variance[static_cast<std::size_t>(k)];
    for (Index e = 0; e < value.size(); ++e) {
      if (!std::isfinite(std::abs(value(e))) || !lacks(variance(e))) continue;
      variance(e) = weight(e) > 0.0 ? 1.0 / (weight(e) * weight(e)) : kNotMeasured;
      if (!(weight(e) > 0.0)) value(e) = kNotMeasured;
      ++taken;
    }
  }
  return taken;
}

// Leaves out what exporters write where nothing was excited: a response of 0 beside a variance of
// 0, on single lines or on all of a response. Returns their number.
Index leave_out_unmeasured(modal::FrfSet& set) {
  Index left_out = 0;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    for (Index e = 0; e < set.value[k].size(); ++e) {
      if (set.value[k](e) != 0.0 || set.variance[k](e) != 0.0) continue;
      set.value[k](e) = kNotMeasured;
      set.variance[k](e) = kNotMeasured;
      ++left_out;
    }
  }
  return left_out;
}

// True if a measured value has a variance of 0.
bool lacks_some_variance(const modal::FrfSet& set) {
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    for (Index e = 0; e < set.value[k].size(); ++e) {
      if (set.variance[k](e) == 0.0 && std::isfinite(std::abs(set.value[k](e)))) return true;
    }
  }
  return false;
}

// A single variance of 0 is not stated: the line has that of its neighbours, as in an
// identification.
void complete_variances(modal::FrfSet& set, stage::Work& work) {
  if (const auto unmeasured = leave_out_unmeasured(set); unmeasured > 0) {
    work.note(
        fmt::format("{} measured values are 0 and so are their variances: left out as not "
                    "measured",
                    unmeasured));
  }
  if (!lacks_some_variance(set)) return;
  const auto taken = take_variances(set, [](double variance) { return variance == 0.0; });
  work.note(fmt::format("{} of the stated variances are 0: those of neighbouring lines are taken",
                        taken));
}

// Estimates variances that the file does not state from the scatter of the lines.
void state_variance(MeasuredFrfs& measured, stage::Work& work) {
  auto& set = measured.all;
  measured.variance_stated = modal::states_variances(set);
  if (measured.variance_stated) {
    complete_variances(set, work);
    return;
  }
  work.warn(
      "the measured responses state no variance: it is estimated from their scatter, and "
      "with it every probability");
  set.variance.assign(set.value.size(),
                      Eigen::MatrixXd::Zero(set.output_count(), set.input_count()));
  take_variances(set, [](double) { return true; });
}

// Modes with complex shapes, if these explain more of the data than the real ones. They are no more
// than those, but for a few far from the lines: with a complex residue each, modes fill any
// response that no modes explain, and others by the last bits.
std::optional<identification::ModalFit> with_complex_shapes(
    const identification::FitData& data, identification::IdentificationOptions options,
    const identification::ModalFit& real) {
  options.fit.damping = identification::Damping::general;
  options.far_modes = true;  // a suspension below the lines, a frame above them
  options.most_modes = real.flexible_count() + kFarModes;
  try {
    auto fit = identification::identified(data, options).fit;
    if (identification::explain_more(fit, real, data)) return fit;
  } catch (const InvalidInput&) {  // they explain nothing: real shapes stay
  } catch (const NumericalFailure&) {
  }
  return std::nullopt;
}

// Strings, cables and frames couple the modes of a real structure by damping. Real shapes then
// need modes that are not there, and miss some that are. One response has no shapes: a phase of its
// residues tells nothing that other modes do not tell as well.
identification::ModalFit fitted_modes(const identification::FitData& data,
                                      const study::Study& study) {
  identification::IdentificationOptions options;
  options.rigid_count = -1;
  take_support(study, options);
  options.fit.delay = true;
  auto fit = identification::identified(data, options).fit;
  const double level = identification::noise_level(fit, data);
  if (level < identification::Constants::good_level || data.response_count() < 2) return fit;
  auto complex = with_complex_shapes(data, options, fit);
  return complex ? *std::move(complex) : fit;
}

}  // namespace

study::DiagnosisPlan plan_of(const study::Study& study) {
  return study.diagnosis.value_or(study::DiagnosisPlan{});
}

MeasuredFrfs within_band(MeasuredFrfs measured, const study::Study& study,
                         const study::DiagnosisPlan& plan, double highest_hz, stage::Work& work) {
  auto& set = measured.all;
  set = modal::converted(set, modal::FrfKind::receptance);
  const double high = plan.high_hz > 0.0 ? plan.high_hz : highest_hz;
  const double last_hz = std::min(high, highest_hz);
  const double first_hz = std::max(plan.low_hz, 1e-9);
  const auto within =
      (set.frequency_hz.array() >= first_hz && set.frequency_hz.array() <= last_hz).count();
  require(within >= 16,
          fmt::format("{}: {} measured lines ({:.6g} to {:.6g} Hz were measured) lie within the "
                      "band of the diagnosis and below {:.6g} Hz, where the simulation's modes "
                      "end; at least 16 are expected",
                      study.file.string(), within, set.frequency_hz.minCoeff(),
                      set.frequency_hz.maxCoeff(), highest_hz));
  set = modal::band(set, first_hz, last_hz);
  state_variance(measured, work);
  return measured;
}

std::optional<identification::ModalFit> modes_of(const modal::FrfSet& seen, bool variance_stated,
                                                 const study::Study& study, stage::Work& work) {
  if (seen.output_count() * seen.input_count() > diagnosis::kConstants.most_fitted)
    return std::nullopt;
  const auto none = [&](const std::exception& why) {
    work.note(std::string("no modes were identified for the comparison: ") + why.what());
    return std::nullopt;
  };
  tell(work.progress(), "identifying modes");
  try {
    identification::FitDataOptions how;
    if (!variance_stated) how.model_error = kAssumedModelError;
    auto data = identification::fit_data(seen, how);
    if (!variance_stated) data.error_share = 1.0;  // of the scatter that stands for the noise, too
    return fitted_modes(data, study);
  } catch (const InvalidInput& e) {
    return none(e);
  } catch (const NumericalFailure& e) {
    return none(e);
  }
}

diagnosis::MeasuredModes clear_modes(const diagnosis::MeasuredModes& all, stage::Work& work) {
  require(all.count() > 0, "no mode can be identified from its responses");
  Eigen::VectorXd strength = Eigen::VectorXd::Zero(all.count());
  for (Index i = 0; i < all.output_shapes.rows(); ++i) {
    for (Index j = 0; j < all.input_shapes.rows(); ++j) {
      const Eigen::VectorXd residue =
          (all.output_shapes.row(i).array() * all.input_shapes.row(j).array()).abs().matrix();
      strength = strength.cwiseMax(residue / std::max(residue.maxCoeff(), 1e-300));
    }
  }
  std::vector<Index> kept;
  std::vector<double> damping;
  for (Index k = 0; k < all.count(); ++k) {
    if (!(strength(k) >= diagnosis::kConstants.weak_residue)) continue;
    kept.push_back(k);
    if (std::isfinite(all.damping_ratio(k))) damping.push_back(all.damping_ratio(k));
  }
  if (kept.empty() || damping.empty()) return all;
  const double most = diagnosis::kConstants.too_damped * upper_median(damping);
  std::erase_if(kept, [&](Index k) { return all.damping_ratio(k) > most; });
  if (static_cast<Index>(kept.size()) < all.count()) {
    work.note(fmt::format("{} of {} identified modes are weak or damped as no other is: left out",
                          all.count() - static_cast<Index>(kept.size()), all.count()));
  }
  return diagnosis::part(all, kept);
}

}  // namespace chladni::steps
