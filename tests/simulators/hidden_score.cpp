#include "simulators/hidden_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace chladni::simulators {
namespace {

constexpr std::array<std::string_view, 5> kVerdicts{"nothing", "named", "ambiguous", "partial",
                                                    "unexplained"};

bool same_channels(std::vector<std::string> a, std::vector<std::string> b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  return a == b;
}

bool is(const diagnosis::Cause& cause, const HiddenEffect& effect) {
  return cause.effect == effect_of_kind(effect.kind) &&
         same_channels(cause.channels, effect.channels);
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

// Of a patch only the product of factor and area is seen well; its deviation is left out.
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

bool of_truth(const diagnosis::Cause& cause, const HiddenCase& hidden) {
  return std::ranges::any_of(hidden.truth, [&](const auto& one) { return is(cause, one); });
}

// Every effect of the truth and nothing else.
bool is_truth(const HiddenCase& hidden, const diagnosis::Explanation& told) {
  return told.causes.size() == hidden.truth.size() &&
         std::ranges::all_of(told.causes,
                             [&](const auto& cause) { return of_truth(cause, hidden); });
}

Outcome outcome_of(const CaseScore& score, const HiddenCase& hidden,
                   const diagnosis::Diagnosis& told) {
  using diagnosis::Verdict;
  const auto found = static_cast<std::size_t>(
      std::ranges::count_if(score.effects, [](const EffectScore& one) { return one.named; }));
  if (told.verdict == Verdict::no_discrepancy) {
    return score.effects.empty() ? Outcome::right : Outcome::missed;
  }
  if (hidden.outside && told.verdict != Verdict::named) return Outcome::right;
  if (told.verdict == Verdict::named && is_truth(hidden, told.best)) return Outcome::right;
  const bool rival =
      told.verdict == Verdict::ambiguous && std::ranges::any_of(told.rivals, [&](const auto& one) {
        return told.best.log_evidence - one.log_evidence < 5.0 && is_truth(hidden, one);
      });
  if (rival || (found > 0 && found == score.effects.size())) return Outcome::among;
  if (found > 0) return Outcome::half;
  return told.verdict == Verdict::unexplained ? Outcome::unexplained : Outcome::wrong;
}

}  // namespace

std::string_view name(Outcome outcome) {
  constexpr std::array<std::string_view, 6> kNames{"right", "among",  "half",
                                                   "wrong", "missed", "unexplained"};
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
  score.outcome = outcome_of(score, hidden, told);
  score.told = kVerdicts[static_cast<std::size_t>(told.verdict)];
  score.told += ":";
  for (const auto& cause : told.best.causes) {
    score.told += " " + cause.effect;
    for (const auto& channel : cause.channels) score.told += "," + channel;
    score.confidently_wrong =
        score.confidently_wrong || (told.verdict == diagnosis::Verdict::named &&
                                    cause.probability > 0.9 && !of_truth(cause, hidden));
  }
  return score;
}

}  // namespace chladni::simulators
