#include "simulators/hidden/hidden_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulators/twins.h"

namespace chladni::simulators {
namespace {

constexpr std::array<std::string_view, 5> kVerdicts{"nothing", "named", "ambiguous", "partial",
                                                    "unexplained"};

// Whether the channels are the same. In a swap both channels are equal; in crosstalk the first
// channel is the disturbed one.
bool same_channels(const std::string& effect, std::vector<std::string> a,
                   std::vector<std::string> b) {
  if (effect.starts_with("swapped_")) {
    std::ranges::sort(a);
    std::ranges::sort(b);
  }
  return a == b;
}

bool is(const diagnosis::Cause& cause, const std::string& effect, const HiddenEffect& hidden) {
  return cause.effect == effect && same_channels(effect, cause.channels, hidden.channels);
}
bool is(const diagnosis::Cause& cause, const HiddenEffect& effect) {
  return is(cause, effect_of_kind(effect.kind), effect);
}

// The effect that has nearly the same result on the same channels; empty: none.
std::string twin_of(const std::string& kind) {
  const auto exchanged = [&](std::string_view from, std::string_view to) -> std::string {
    if (!kind.ends_with(from)) return "";
    return kind.substr(0, kind.size() - from.size()) + std::string(to);
  };
  for (const auto& [from, to] :
       {std::pair{"low_pass", "delay"}, {"delay", "low_pass"}, {"direction", "position"}}) {
    if (auto twin = exchanged(from, to); !twin.empty()) return twin;
  }
  return "";
}
bool is_or_twin(const diagnosis::Cause& cause, const HiddenEffect& effect) {
  return is(cause, effect) || is(cause, twin_of(effect.kind), effect);
}

const diagnosis::CauseParameter* parameter(const diagnosis::Cause& cause, const std::string& name) {
  const auto found = std::ranges::find(cause.parameters, name, &diagnosis::CauseParameter::name);
  return found == cause.parameters.end() ? nullptr : &*found;
}

void add_size(EffectScore& score, const diagnosis::Cause& cause, const std::string& size,
              double truth) {
  if (const auto* told = parameter(cause, size)) {
    score.sizes.push_back({size, truth, told->value, told->std});
  }
}

// Adds the score of a patch. Only the product of factor and area is well visible; its deviation is
// left out.
void add_patch(EffectScore& score, const diagnosis::Cause& cause, const HiddenEffect& effect) {
  const auto* factor = parameter(cause, "factor");
  const auto* radius = parameter(cause, "radius");
  if (factor == nullptr || radius == nullptr) return;
  const double truth = effect.size.at("factor") * std::pow(effect.size.at("radius"), 2);
  score.sizes.push_back({"factor_area", truth, factor->value * radius->value * radius->value, NAN});
}

EffectScore scored(const HiddenEffect& effect, const diagnosis::Explanation& best) {
  EffectScore score;
  score.kind = effect.kind;
  for (const auto& cause : best.causes) {
    if (!is(cause, effect)) continue;
    const bool nearer = effect.place && cause.place && score.placed &&
                        (*cause.place - *effect.place).norm() < score.place_error;
    if (score.named && !nearer) continue;
    score.named = true;
    score.sizes.clear();
    if (effect.kind.starts_with("local_")) {
      add_patch(score, cause, effect);
    } else {
      for (const auto& [size, truth] : effect.size) add_size(score, cause, size, truth);
    }
    if (!effect.place || !cause.place) continue;
    score.placed = true;
    score.place_error = (*cause.place - *effect.place).norm();
    add_size(score, cause, "u", effect.place->x());
    add_size(score, cause, "v", effect.place->y());
  }
  return score;
}

using IsOf = bool (*)(const diagnosis::Cause&, const HiddenEffect&);

bool of_truth(const diagnosis::Cause& cause, const HiddenCase& hidden, IsOf is_of) {
  return std::ranges::any_of(hidden.truth, [&](const auto& one) { return is_of(cause, one); });
}

// Whether the explanation has every effect of the truth and nothing else.
bool is_truth(const HiddenCase& hidden, const diagnosis::Explanation& told, IsOf is_of) {
  return told.causes.size() == hidden.truth.size() &&
         std::ranges::all_of(told.causes,
                             [&](const auto& cause) { return of_truth(cause, hidden, is_of); }) &&
         std::ranges::all_of(hidden.truth, [&](const auto& one) {
           return std::ranges::any_of(told.causes,
                                      [&](const auto& cause) { return is_of(cause, one); });
         });
}

// Whether the truth is among the rivals within 5 in log evidence.
bool is_rival(const HiddenCase& hidden, const diagnosis::Diagnosis& told) {
  return std::ranges::any_of(told.rivals, [&](const auto& one) {
    return told.best.log_evidence - one.log_evidence < 5.0 && is_truth(hidden, one, is);
  });
}

Outcome outcome_of(const CaseScore& score, const HiddenCase& hidden,
                   const diagnosis::Diagnosis& told, bool twins) {
  using diagnosis::Verdict;
  const auto found = static_cast<std::size_t>(
      std::ranges::count_if(score.effects, [](const EffectScore& one) { return one.named; }));
  if (told.verdict == Verdict::no_discrepancy) {
    return score.effects.empty() ? Outcome::right : Outcome::missed;
  }
  if (hidden.outside) return told.verdict == Verdict::named ? Outcome::wrong : Outcome::right;
  const bool sure = told.verdict == Verdict::named;
  const bool unsure = told.verdict == Verdict::ambiguous;
  if (sure && is_truth(hidden, told.best, is)) return Outcome::right;
  if (twins && (sure || unsure) && is_truth(hidden, told.best, is_or_twin)) return Outcome::twin;
  if (unsure && (is_truth(hidden, told.best, is) || is_rival(hidden, told))) return Outcome::among;
  if (is_truth(hidden, told.best, is)) return Outcome::open;
  if (found > 0) return found == score.effects.size() ? Outcome::phantom : Outcome::half;
  return told.verdict == Verdict::unexplained ? Outcome::unexplained : Outcome::wrong;
}

}  // namespace

std::string_view name(Outcome outcome) {
  constexpr std::array<std::string_view, 9> kNames{
      "right", "twin", "open", "phantom", "among", "half", "wrong", "missed", "unexplained"};
  return kNames[static_cast<std::size_t>(outcome)];
}

std::string effect_of_kind(const std::string& kind) {
  const auto& outside = outside_kinds();
  if (std::ranges::find(outside, kind) != outside.end()) return "";
  if (kind == "taper") return "thickness_field";
  if (kind.starts_with("local_")) return "local_stiffness";
  return kind;
}

CaseScore scored(const HiddenCase& hidden, const diagnosis::Diagnosis& told) {
  CaseScore score;
  for (const auto& effect : hidden.truth) score.effects.push_back(scored(effect, told.best));
  const bool twins = evidence_apart(hidden) < 5.0;
  score.outcome = outcome_of(score, hidden, told, twins);
  score.told = kVerdicts[static_cast<std::size_t>(told.verdict)];
  score.told += ":";
  for (const auto& cause : told.best.causes) {
    score.told += " " + cause.effect;
    for (const auto& channel : cause.channels) score.told += "," + channel;
    score.told += fmt::format(" {:.2f}", cause.probability);
    if (of_truth(cause, hidden, twins ? is_or_twin : IsOf{is})) continue;
    score.surest_phantom = std::max(score.surest_phantom, cause.probability);
    score.phantoms += (score.phantoms.empty() ? "" : ", ") + cause.effect;
    for (const auto& one : cause.parameters) {
      score.phantoms += fmt::format(" {}={:.3g}", one.name, one.value);
    }
  }
  return score;
}

}  // namespace chladni::simulators
