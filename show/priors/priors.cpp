// Learned hyper-parameters as a table and JSON.
#include <fmt/format.h>

#include <cmath>

#include "show/priors.h"
#include "steps/priors.h"

namespace chladni::show {
namespace {

Eigen::Index length_count(const steps::LearnedPriors& result) {
  Eigen::Index count = 0;
  for (const auto& one : result.kernel.parameters()) count += one.unit == "m" ? 1 : 0;
  return count;
}

std::string lengths_text(const steps::LearnedPriors& result, const priors::Learned& one) {
  std::string text;
  for (Eigen::Index k = 0; k < length_count(result); ++k) {
    text += fmt::format("{}{:.1f}", k > 0 ? " / " : "", 1e3 * one.parameters(k));
  }
  return text;
}

std::string bound_text(const std::vector<std::string>& at_bound) {
  std::string text;
  for (const auto& name : at_bound) text += (text.empty() ? "at bound: " : ", ") + name;
  return text;
}

io::JsonObject learned_json(const steps::LearnedPriors& result, const priors::Learned& one,
                            Eigen::Index samples, double noise_dependence) {
  io::JsonObject parameters;
  for (std::size_t k = 0; k < result.kernel.parameters().size(); ++k) {
    const auto& known = result.kernel.parameters()[k];
    parameters.emplace_back(known.name + (known.unit == "m" ? "_m" : ""),
                            one.parameters(static_cast<Eigen::Index>(k)));
  }
  const auto lengths = length_count(result);
  return {
      {"kernel", result.kernel.name()},
      {"length_scale_m", lengths == 1 ? io::Json(one.parameters(0))
                                      : io::Json(Eigen::VectorXd(one.parameters.head(lengths)))},
      {"sigma", one.sigma},
      {"noise", one.noise},
      {"log_marginal_likelihood", one.log_likelihood},
      {"samples", static_cast<long long>(samples)},
      {"parameters", parameters},
      {"at_bound", io::Json::texts(one.at_bound)},
      {"noise_dependence", noise_dependence},
      {"evaluations", one.evaluations}};
}

io::JsonObject mode_json(const stage::Solution& solution, const steps::LearnedPriors& result,
                         const steps::LearnedAt& at, std::size_t i) {
  const auto column = result.columns[i];
  const auto row = static_cast<Eigen::Index>(i);
  io::JsonObject object = {
      {"mode", static_cast<long long>(column - solution.modes.rigid_count + 1)},
      {"frequency_hz", solution.modes.frequency_hz(column)},
      {"rms_kg_m05", result.rms(row)}};
  for (auto& pair : learned_json(result, at.per_mode[i], at.samples, at.noise_dependence(row))) {
    object.push_back(std::move(pair));
  }
  return object;
}

io::Json at_json(const stage::Solution& solution, const steps::LearnedPriors& result,
                 const steps::LearnedAt& at) {
  io::JsonArray modes;
  for (std::size_t i = 0; i < at.per_mode.size(); ++i) {
    modes.push_back(mode_json(solution, result, at, i));
  }
  const double dependence = at.noise_dependence(at.noise_dependence.size() - 1);
  return io::JsonObject{{"samples", static_cast<long long>(at.samples)},
                        {"modes", modes},
                        {"shared", learned_json(result, at.shared, at.samples, dependence)},
                        {"channel_error", io::Json(at.channel_error)}};
}

std::string modes_text(const stage::Solution& solution, const steps::LearnedPriors& result) {
  const auto& last = result.last();
  const bool has_matched = result.matched_length.size() > 0;
  std::string text = fmt::format("{:<22}{:>12}{:>12}{:>12}{:>16}", "mode", "length [mm]",
                                 "sigma / rms", "noise / rms", "log likelihood");
  if (has_matched) text += fmt::format("{:>20}{:>16}", "at channels [mm]", "expected error");
  text += "\n";
  for (std::size_t i = 0; i < last.per_mode.size(); ++i) {
    const auto& one = last.per_mode[i];
    const auto row = static_cast<Eigen::Index>(i);
    const auto column = result.columns[i];
    text +=
        fmt::format("{:<22}{:>12}{:>12.3f}{:>12.1e}{:>16.1f}",
                    fmt::format("{} ({:.2f} Hz)", column + 1, solution.modes.frequency_hz(column)),
                    lengths_text(result, one), one.sigma / result.rms(row),
                    one.noise / result.rms(row), one.log_likelihood);
    if (has_matched) {
      text += fmt::format("{:>20.1f}{:>14.2g} %", 1e3 * result.matched_length(row),
                          100.0 * result.expected_error(row));
    }
    auto at_bound = one.at_bound;
    if (has_matched && result.matched_at_bound[i]) at_bound.emplace_back("length at channels");
    text += "  " + bound_text(at_bound) + "\n";
  }
  text += fmt::format("{:<22}{:>12}{:>12.3f}{:>12.1e}{:>16.1f}  {}\n", "all together",
                      lengths_text(result, last.shared), last.shared.sigma, last.shared.noise,
                      last.shared.log_likelihood, bound_text(last.shared.at_bound));
  return text;
}

}  // namespace

std::string priors_table(const stage::Solution& solution, const steps::LearnedPriors& result) {
  std::string text;
  for (const auto& warning : result.warnings) text += "! " + warning + "\n";
  const auto& plan = result.plan;
  text += fmt::format(
      "{} by {}, {} samples per mode, noise ratio {}\n", result.kernel.name(),
      plan.by == "leave_one_out" ? "leave-one-out" : "marginal likelihood", result.last().samples,
      plan.learn_noise ? std::string("learned") : fmt::format("{:.1g}", plan.noise_ratio));
  text += modes_text(solution, result);
  if (result.by_samples.size() < 2) return text;
  const auto i = static_cast<std::size_t>(result.most_complex);
  const double rms = result.rms(result.most_complex);
  const bool has_channels = result.last().channel_error.size() > 0;
  text += fmt::format(
      "\nmode {}, the most complex one, and all together by number of samples\n"
      "{:>8}{:>14}{:>14}{}{:>14}{:>14}\n",
      result.columns[i] + 1, "samples", "length [mm]", "sigma / rms",
      has_channels ? "  error from channels" : "", "length [mm]", "sigma / rms");
  for (const auto& at : result.by_samples) {
    const std::string error =
        has_channels ? fmt::format("{:>19.3g} %", 100.0 * at.channel_error(result.most_complex))
                     : "";
    text += fmt::format("{:>8}{:>14}{:>14.3f}{}{:>14}{:>14.3f}\n", at.samples,
                        lengths_text(result, at.per_mode[i]), at.per_mode[i].sigma / rms, error,
                        lengths_text(result, at.shared), at.shared.sigma);
  }
  for (const auto& [name, error] : result.spline_error) {
    text += fmt::format("{:<36}{:>19.3g} %\n", name, 100.0 * error(result.most_complex));
  }
  return text;
}

io::JsonObject priors_json(const stage::Solution& solution, const steps::LearnedPriors& result) {
  const auto& last = result.last();
  io::JsonArray modes;
  for (std::size_t i = 0; i < last.per_mode.size(); ++i) {
    auto one = mode_json(solution, result, last, i);
    if (result.matched_length.size() > 0) {
      const auto row = static_cast<Eigen::Index>(i);
      one.emplace_back("matched_length_m", result.matched_length(row));
      one.emplace_back("matched_at_bound", static_cast<bool>(result.matched_at_bound[i]));
      one.emplace_back("expected_error", result.expected_error(row));
    }
    modes.push_back(std::move(one));
  }
  io::JsonArray by_samples;
  for (const auto& at : result.by_samples) by_samples.push_back(at_json(solution, result, at));
  io::JsonObject splines;
  for (const auto& [name, error] : result.spline_error) splines.emplace_back(name, io::Json(error));
  const auto complex = result.columns[static_cast<std::size_t>(result.most_complex)];
  return {{"by", result.plan.by},
          {"noise_ratio", result.plan.learn_noise ? io::Json() : result.plan.noise_ratio},
          {"modes", modes},
          {"shared", learned_json(result, last.shared, last.samples,
                                  last.noise_dependence(last.noise_dependence.size() - 1))},
          {"most_complex_mode", static_cast<long long>(complex - solution.modes.rigid_count + 1)},
          {"by_samples", by_samples},
          {"spline_error", splines},
          {"notes", io::Json::texts(result.notes)},
          {"warnings", io::Json::texts(result.warnings)}};
}

}  // namespace chladni::show
