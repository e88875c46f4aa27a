#include "steps/diagnosis/diagnosis_gain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/percent.h"
#include "diagnosis/constants.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

constexpr double kRounding = 1e-6;  // relative change of the squares: rounding of another solution

// Sums over some responses and lines.
struct Sums {
  double error = 0.0, size = 0.0, noise = 0.0;
  [[nodiscard]] double relative() const {
    return size > 0.0 ? std::sqrt(error / size) : Gain::kNone;
  }
  [[nodiscard]] double floor() const { return size > 0.0 ? std::sqrt(noise / size) : Gain::kNone; }
};

Sums sums_of(const MeasuredFrfs& measured, const study::DiagnosisPlan& plan,
             const std::vector<Eigen::MatrixXcd>& response, bool held_out) {
  const auto& set = measured.all;
  Sums sums;
  for (std::size_t k = 0; k < response.size(); ++k) {
    const bool line = line_held_out(plan, set.frequency_hz(static_cast<Index>(k)));
    for (Index j = 0; j < response[k].cols(); ++j) {
      for (Index i = 0; i < response[k].rows(); ++i) {
        const bool seen = !line && std::ranges::binary_search(measured.outputs, i) &&
                          std::ranges::binary_search(measured.inputs, j);
        const auto value = set.value[k](i, j);
        if (seen == held_out || !std::isfinite(std::abs(value))) continue;
        sums.error += std::norm(value - response[k](i, j));
        sums.size += std::norm(value);
        sums.noise += set.variance[k](i, j);
      }
    }
  }
  return sums;
}

std::vector<std::string> names_at(const std::vector<modal::MeasuredChannel>& channels,
                                  const std::vector<Index>& rows) {
  std::vector<std::string> names;
  for (const auto row : rows) names.push_back(channels[static_cast<std::size_t>(row)].name);
  return names;
}

MeasuredPart fitted_part(const MeasuredFrfs& measured, const study::DiagnosisPlan& plan) {
  MeasuredPart part{names_at(measured.all.outputs, measured.outputs),
                    names_at(measured.all.inputs, measured.inputs),
                    {},
                    0};
  bool within = false;
  for (const double f : measured.all.frequency_hz) {
    const bool out = line_held_out(plan, f);
    if (!out && !within) part.bands_hz.emplace_back(f, f);
    if (!out) part.bands_hz.back().second = f;
    part.lines += out ? 0 : 1;
    within = !out;
  }
  return part;
}

bool worse(double after, double before) { return std::isfinite(before) && !(after < before); }

std::string band_text(const std::pair<double, double>& band) {
  return fmt::format("{:.6g} to {:.6g} Hz", band.first, band.second);
}

// The values held out are those of the parts that were held out in turn.
void take_parts(const diagnosis::CrossValidation& tested, Gain& gain) {
  const auto errors = tested.errors();
  gain.in_turn = true;
  gain.held_out_before = errors.relative(errors.before);
  gain.held_out_after = errors.relative(errors.after);
  gain.held_out_noise = errors.relative(errors.noise);
  gain.held_out_extended = Gain::kNone;
  for (const auto& part : tested.parts) {
    if (part.kind != diagnosis::HeldOutPart::Kind::upper_band) gain.held_out.push_back(words(part));
  }
  if (gain.pays) gain.pays = tested.pays() && !worse(gain.fit_extended, gain.fit_before);
  if (gain.fitted_pays) gain.fitted_pays = tested.pays() && !worse(gain.fit_after, gain.fit_before);
}

}  // namespace

std::string_view name(GainFrom from) {
  constexpr std::array<std::string_view, 3> kNames{"nothing", "extended_study", "fitted_model"};
  return kNames[static_cast<std::size_t>(from)];
}

bool line_held_out(const study::DiagnosisPlan& plan, double frequency_hz) {
  return plan.hold_out_high_hz > 0.0 && frequency_hz >= plan.hold_out_low_hz &&
         frequency_hz <= plan.hold_out_high_hz;
}

Gain gain_of(const MeasuredFrfs& measured, const study::DiagnosisPlan& plan,
             const std::vector<std::string>& held_out_channels, const Predictions& predictions,
             const diagnosis::CrossValidation* tested) {
  const auto error = [&](const std::vector<Eigen::MatrixXcd>& response, bool held_out) {
    return sums_of(measured, plan, response, held_out).relative();
  };
  Gain gain;
  const auto seen = sums_of(measured, plan, predictions.before, false);
  const auto held = sums_of(measured, plan, predictions.before, true);
  gain.fit_before = gain.fit_after = seen.relative();
  gain.held_out_before = gain.held_out_after = held.relative();
  gain.noise_floor = seen.floor();
  gain.held_out_noise = held.floor();
  gain.fit_extended = error(predictions.extended, false);
  gain.held_out_extended = error(predictions.extended, true);
  const bool is_fitted = !predictions.fitted.empty();
  const bool is_extended = !predictions.extended.empty();
  if (is_fitted || is_extended) {
    const auto& after = is_fitted ? predictions.fitted : predictions.extended;
    gain.from = is_fitted ? GainFrom::fitted_model : GainFrom::extended_study;
    gain.fit_after = error(after, false);
    gain.held_out_after = error(after, true);
  }
  const auto pays = [&](double fit, double held_out) {
    return !worse(held_out, gain.held_out_before) && !worse(fit, gain.fit_before);
  };
  if (is_extended) gain.pays = pays(gain.fit_extended, gain.held_out_extended);
  if (is_fitted) gain.fitted_pays = pays(gain.fit_after, gain.held_out_after);
  gain.fitted = fitted_part(measured, plan);
  gain.held_out = held_out_channels;
  if (plan.hold_out_high_hz > 0.0) {
    gain.held_out_band_hz.emplace_back(plan.hold_out_low_hz, plan.hold_out_high_hz);
    gain.held_out.push_back(band_text(gain.held_out_band_hz.front()));
  }
  if (tested != nullptr && gain.held_out.empty()) take_parts(*tested, gain);
  return gain;
}

namespace {

// Sums of squares over the modes that have partners before: of frequencies, and of shapes.
struct ModeSums {
  double count = 0.0, frequencies_before = 0.0, frequencies_after = 0.0;
  double shapes_before = 0.0, shapes_after = 0.0;
};

ModeSums mode_sums(const std::vector<diagnosis::ModeTold>& modes) {
  ModeSums sums;
  for (const auto& mode : modes) {
    const double was = mode.before_hz / mode.measured_hz - 1.0;
    const double is = mode.after_hz / mode.measured_hz - 1.0;
    if (!std::isfinite(was)) continue;
    // A mode that loses its partner is further off than a pair may be.
    const double lost = std::max(std::abs(was), diagnosis::kConstants.apart_alone);
    sums.count += 1.0;
    sums.frequencies_before += was * was;
    sums.frequencies_after += std::pow(std::isfinite(is) ? is : lost, 2);
    sums.shapes_before += 1.0 - mode.mac_before;
    sums.shapes_after += 1.0 - mode.mac_after;
  }
  return sums;
}

bool is_changed(double after, double before) {
  return std::abs(after - before) > kRounding * before;
}

}  // namespace

void judge_by_modes(const std::vector<diagnosis::ModeTold>& modes, Gain& gain) {
  const auto sums = mode_sums(modes);
  if (!gain.pays || sums.count < 1.0) return;
  const auto judge = [&](double before, double after, double& told_before, double& told_after) {
    if (!is_changed(after, before)) return false;
    told_before = std::sqrt(before / sums.count);
    told_after = std::sqrt(after / sums.count);
    gain.pays = after < before || *gain.pays;
    return true;
  };
  if (judge(sums.frequencies_before, sums.frequencies_after, gain.frequencies_before,
            gain.frequencies_after)) {
    return;
  }
  judge(sums.shapes_before, sums.shapes_after, gain.shapes_before, gain.shapes_after);
}

std::string advice_against(const Gain& gain) {
  const bool extended = gain.pays.has_value();
  if (gain.from == GainFrom::nothing) return "";
  const bool by_frequencies = std::isfinite(gain.frequencies_after);
  if (extended && (by_frequencies || std::isfinite(gain.shapes_after))) {
    if (*gain.pays) return "";
    return fmt::format(
        "The extended study predicts neither the responses nor the {0} of the modes better than "
        "before ({0} off by {1}, before by {2}): it is not recommended.",
        by_frequencies ? "frequencies" : "shapes",
        percent(by_frequencies ? gain.frequencies_after : gain.shapes_after),
        percent(by_frequencies ? gain.frequencies_before : gain.shapes_before));
  }
  const double held = extended ? gain.held_out_extended : gain.held_out_after;
  const double seen = extended ? gain.fit_extended : gain.fit_after;
  const char* who = extended ? "The extended study" : "The simulation with these causes";
  const auto says = [&](const char* what, double after, double before) {
    return fmt::format(
        "{} predicts the responses that {} no better than before (off by {}, before by {}): it is "
        "not recommended.",
        who, what, percent(after), percent(before));
  };
  if (!gain.in_turn && worse(held, gain.held_out_before)) {
    return says("were held out", held, gain.held_out_before);
  }
  if (worse(seen, gain.fit_before)) return says("the fit saw", seen, gain.fit_before);
  return "";
}

std::string words(const diagnosis::HeldOutPart& part) {
  if (part.kind != diagnosis::HeldOutPart::Kind::sensors) {
    return band_text({part.low_hz, part.high_hz});
  }
  return fmt::format("{}", fmt::join(part.sensors, ", "));
}

std::string words(const MeasuredPart& part) {
  std::string bands;
  for (const auto& band : part.bands_hz) bands += ", " + band_text(band);
  return fmt::format("{} by {}; {} lines{}", fmt::join(part.sensors, ", "),
                     fmt::join(part.actuators, ", "), part.lines, bands);
}

}  // namespace chladni::steps
