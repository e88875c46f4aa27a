#include "show/diagnosis/verdict_card.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/percent.h"
#include "show/diagnosis.h"
#include "show/diagnosis/detectable_text.h"
#include "show/diagnosis/modes_told.h"

namespace chladni::show {
namespace {

using diagnosis::Verdict;

std::string heading(const steps::Diagnosed& one) {
  switch (one.result.verdict) {
    case Verdict::no_discrepancy:
      return verdict_text(one.result);
    case Verdict::named:
      return steps::is_of_modes(one)
                 ? "The cause is named."
                 : "The cause is named: within the tolerances only noise is left.";
    case Verdict::ambiguous:
      return "Other explanations are not ruled out. The likeliest:";
    case Verdict::partial:
      return "Much of it is explained, not all. Something more is at work.";
    case Verdict::unexplained:
      break;
  }
  return "None of the known causes explains it.";
}

std::string cause_line(const diagnosis::Cause& cause) {
  return fmt::format("{} (probability {:.3f})", cause_text(cause), cause.probability);
}

// Root of the mean square of the relative differences of frequency; NaN: no pair.
double frequencies_off(const std::vector<diagnosis::ModeTold>& modes,
                       double diagnosis::ModeTold::*simulated) {
  double sum = 0.0, count = 0.0;
  for (const auto& mode : modes) {
    const double change = mode.*simulated / mode.measured_hz - 1.0;
    if (!std::isfinite(change)) continue;
    sum += change * change;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : std::nan("");
}

std::vector<io::Card::Figure> figures_of(const steps::Diagnosed& one) {
  std::vector<io::Card::Figure> figures;
  const auto add = [&](double value, const char* label) {
    if (std::isfinite(value)) figures.push_back({percent(value), label});
  };
  const bool by_cause = !one.result.best.causes.empty();
  if (one.modes) {
    add(frequencies_off(one.result.modes, &diagnosis::ModeTold::before_hz),
        "frequencies off, as simulated");
    if (changes_modes(one.result)) {
      add(frequencies_off(one.result.modes, &diagnosis::ModeTold::after_hz),
          by_cause ? "frequencies off, with the cause" : "frequencies off, calibrated");
    }
    return figures;
  }
  add(one.gain.fit_before, "responses off, as simulated");
  if (one.gain.from != steps::GainFrom::nothing) {
    add(one.gain.fit_after, "responses off, with the cause");
  }
  add(one.gain.noise_floor, "noise of the measurement");
  return figures;
}

// What held-out data say of the causes; empty: nothing was held out.
std::string held_out_line(const steps::Gain& gain) {
  if (gain.held_out.empty() || gain.from == steps::GainFrom::nothing) return "";
  return fmt::format("Data that no fit saw: off by {} before, by {} with the cause; noise {}.",
                     percent(gain.held_out_before), percent(gain.held_out_after),
                     percent(gain.held_out_noise));
}

std::vector<std::string> next_steps(const steps::Diagnosed& one) {
  std::vector<std::string> steps;
  if (!one.result.measure_next.empty())
    steps.push_back("measure next: " + one.result.measure_next + ".");
  const auto verdict = one.result.verdict;
  const bool believed = steps::advice_against(one.gain).empty();
  if (verdict == Verdict::named && believed) {
    const bool has_place = one.result.best.causes.front().place.has_value();
    std::string line = has_place ? "look at the marked place" : "check what the cause names";
    if (one.extended) line += "; extended.toml is the study with the cause in it";
    steps.push_back(line + ".");
  }
  if (verdict == Verdict::no_discrepancy) {
    auto sizes = detectable_sentence(one);
    const bool calibrated = !one.result.constants.empty() && one.extended;
    if (calibrated)
      steps.emplace_back("take the calibrated constants, which are in extended.toml.");
    if (!calibrated) steps.emplace_back("nothing has to be changed.");
    if (!sizes.empty()) steps.push_back(std::move(sizes));
  }
  if (verdict == Verdict::partial || verdict == Verdict::unexplained) {
    steps.emplace_back("see below where the difference lies: in which channels, at which lines.");
  }
  return steps;
}

}  // namespace

io::Card verdict_card(const steps::Diagnosed& one) {
  const auto verdict = one.result.verdict;
  const auto advice = steps::advice_against(one.gain);
  const bool good = verdict == Verdict::named || verdict == Verdict::no_discrepancy;
  io::Card card;
  card.tone = good && advice.empty() ? io::Note::Tone::good : io::Note::Tone::warning;
  card.heading = heading(one);
  for (const auto& cause : one.result.best.causes) card.lines.push_back(cause_line(cause));
  if (!advice.empty()) card.lines.push_back(advice);
  if (auto line = held_out_line(one.gain); !line.empty()) card.lines.push_back(std::move(line));
  card.figures = figures_of(one);
  card.next = next_steps(one);
  return card;
}

std::vector<io::Marker> cause_markers(const steps::Diagnosed& one) {
  std::vector<io::Marker> markers;
  const auto& surface = one.structure.surface;
  for (const auto& cause : one.result.best.causes) {
    if (!cause.place) continue;
    markers.push_back({cause.effect, "cause", surface.in_body(*cause.place),
                       surface.axis_u.cross(surface.axis_v)});
  }
  return markers;
}

std::vector<std::string> marked_names(const steps::Diagnosed& one) {
  std::vector<std::string> names;
  for (const auto& cause : one.result.best.causes) {
    if (cause.place) names.push_back(cause.effect);
    names.insert(names.end(), cause.channels.begin(), cause.channels.end());
  }
  return names;
}

}  // namespace chladni::show
