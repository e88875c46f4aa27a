#include "simulators/rigs/rig_score.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chladni::simulators {
namespace {

using diagnosis::Cause;

constexpr std::array<std::string_view, 5> kVerdicts{"nothing", "named", "ambiguous", "partial",
                                                    "unexplained"};
constexpr double kNear = 0.2;  // of the body's size

bool both(const std::string& a, const std::string& b, std::string_view one, std::string_view two) {
  return (a == one && b == two) || (a == two && b == one);
}

bool is_scale(std::string_view effect) {
  constexpr std::array<std::string_view, 4> kScales{"youngs_modulus", "density", "thickness",
                                                    "size_error"};
  return std::ranges::find(kScales, effect) != kScales.end();
}

// Effects that differ so little that either name is true of both.
bool are_kin(const std::string& a, const std::string& b, bool scaled) {
  if (both(a, b, "point_mass", "mass_with_inertia")) return true;
  if (both(a, b, "ground_spring", "elastic_pad")) return true;
  return !scaled && is_scale(a) && is_scale(b);
}

// Whether a mass that was added is told as one that is missing, or the like.
bool is_opposite(const Cause& cause, const HiddenEffect& effect) {
  return std::ranges::any_of(effect.size, [&](const auto& size) {
    const auto told =
        std::ranges::find(cause.parameters, size.first, &diagnosis::CauseParameter::name);
    return told != cause.parameters.end() && told->value * size.second < 0.0;
  });
}

bool is(const Cause& cause, const HiddenEffect& effect, const RealRigCase& rig) {
  if (cause.place && effect.place) {
    const bool near = (*cause.place - *effect.place).norm() < kNear * rig.body.size();
    if (!near || is_opposite(cause, effect)) return false;
  }
  if (cause.effect != effect.kind) return are_kin(cause.effect, effect.kind, rig.scaled);
  auto told = cause.channels;
  auto hidden = effect.channels;
  std::ranges::sort(told);
  std::ranges::sort(hidden);
  return told == hidden;
}

// Whether the cause is what the rig has: a resonator of this frequency, or a gain or a place of
// this channel within three stated deviations.
bool is_present(const Cause& cause, const HiddenEffect& effect) {
  constexpr double kSameFrequency = 0.05;
  constexpr double kSameSize = 3.0;
  if (cause.effect != effect.kind || cause.channels != effect.channels) return false;
  const bool has_frequency = effect.size.contains("frequency");
  std::size_t told = 0;
  for (const auto& parameter : cause.parameters) {
    const auto size = effect.size.find(parameter.name);
    if (size == effect.size.end() || (has_frequency && parameter.name != "frequency")) continue;
    const double within = has_frequency ? kSameFrequency * size->second : kSameSize * parameter.std;
    if (!(std::abs(parameter.value - size->second) < within)) return false;
    ++told;
  }
  return told > 0;
}

// The coordinates of a place; of a slender body only that along it.
void add_place(EffectScore& score, const Cause& cause, const Eigen::Vector2d& truth,
               const RealRigCase& rig) {
  using Role = diagnosis::Parameter::Role;
  for (const auto& told : cause.parameters) {
    const bool is_u = told.role == Role::place_u;
    if (!is_u && (told.role != Role::place_v || rig.body.rig.is_slender())) continue;
    score.sizes.push_back(
        {is_u ? "place_u" : "place_v", is_u ? truth.x() : truth.y(), told.value, told.std});
  }
}

bool is_place(const SizeScore& size) { return size.name.starts_with("place_"); }

Coverage coverage(const RigScore& score, bool places) {
  Coverage all;
  for (const auto& effect : score.effects) {
    for (const auto& size : effect.sizes) {
      if (is_place(size) != places) continue;
      ++all.count;
      all.good += std::abs(size.z()) <= 2.0 ? 1 : 0;
    }
  }
  return all;
}

void add_size(EffectScore& score, const Cause& cause, const std::string& size, double truth) {
  const auto told = std::ranges::find(cause.parameters, size, &diagnosis::CauseParameter::name);
  if (told != cause.parameters.end()) score.sizes.push_back({size, truth, told->value, told->std});
}

// The score of an effect. Of a patch and a pad the radius is hardly visible: sizes that go with it
// are left out.
EffectScore scored(const HiddenEffect& effect, const Cause* cause, const RealRigCase& rig) {
  EffectScore score;
  score.kind = effect.kind;
  if (cause == nullptr) return score;
  score.named = true;
  const bool same = cause->effect == effect.kind;
  for (const auto& [size, truth] : effect.size) {
    if (same && effect.kind != "local_stiffness" && size != "radius") {
      add_size(score, *cause, size, truth);
    }
  }
  if (!effect.place || !cause->place) return score;
  score.placed = true;
  score.place_error = (*cause->place - *effect.place).norm();
  add_place(score, *cause, *effect.place, rig);
  return score;
}

// The surest cause that is this effect; null: none above kFound.
const Cause* found(const HiddenEffect& effect, const diagnosis::Diagnosis& told,
                   const RealRigCase& rig) {
  const Cause* best = nullptr;
  for (const auto& cause : told.best.causes) {
    if (cause.probability <= kFound || !is(cause, effect, rig)) continue;
    if (best == nullptr || cause.probability > best->probability) best = &cause;
  }
  return best;
}

// One scale of the body was hidden, and the explanations by one scale are nearly all there is.
bool is_told_as_class(const RealRigCase& rig, const diagnosis::Diagnosis& told) {
  if (rig.truth.size() != 1 || !is_scale(rig.truth.front().kind)) return false;
  double all = 0.0;
  double true_one = 0.0;
  const auto add = [&](const diagnosis::Explanation& one) {
    if (one.causes.size() != 1 || !is_scale(one.causes.front().effect)) return;
    all += one.probability;
    if (one.causes.front().effect == rig.truth.front().kind) true_one += one.probability;
  };
  add(told.best);
  for (const auto& rival : told.rivals) add(rival);
  return all >= kClass && true_one >= kOfClass;
}

RigVerdict verdict_of(const RigScore& score, bool nothing_to_name) {
  const bool false_sure = std::ranges::any_of(score.statements, [](const Statement& one) {
    return !one.is_true && one.probability > kSure;
  });
  if (nothing_to_name) return false_sure ? RigVerdict::wrong_sure : RigVerdict::right;
  const auto count = std::ranges::count_if(score.effects, &EffectScore::named);
  const bool all = count == std::ssize(score.effects);
  if (false_sure) return count > 0 ? RigVerdict::phantom : RigVerdict::wrong_sure;
  if (count == 0) return RigVerdict::missed;
  return all ? RigVerdict::right : RigVerdict::half;
}

}  // namespace

std::string_view name(RigVerdict verdict) {
  constexpr std::array<std::string_view, 6> kNames{"right",   "class",      "half",
                                                   "phantom", "wrong-sure", "missed"};
  return kNames[static_cast<std::size_t>(verdict)];
}

double RigScore::worst_z() const {
  double worst = NAN;
  for (const auto& effect : effects) {
    for (const auto& size : effect.sizes) worst = std::fmax(worst, std::abs(size.z()));
  }
  return worst;
}

double RigScore::place_error() const {
  double worst = NAN;
  for (const auto& effect : effects) {
    if (effect.placed) worst = std::fmax(worst, effect.place_error);
  }
  return worst;
}

Coverage RigScore::sizes() const { return coverage(*this, false); }

Coverage RigScore::places() const { return coverage(*this, true); }

RigScore scored(const RealRigCase& rig, const diagnosis::Diagnosis& told) {
  RigScore score;
  score.told = kVerdicts[static_cast<std::size_t>(told.verdict)];
  for (const auto& effect : rig.truth) {
    score.effects.push_back(scored(effect, found(effect, told, rig), rig));
  }
  for (const auto& cause : told.best.causes) {
    Statement one{cause.effect, cause.probability, false};
    for (const auto& channel : cause.channels) one.cause += "," + channel;
    one.is_true = std::ranges::any_of(
        rig.truth, [&](const HiddenEffect& effect) { return is(cause, effect, rig); });
    one.is_true = one.is_true || std::ranges::any_of(rig.present, [&](const HiddenEffect& effect) {
                    return is_present(cause, effect);
                  });
    score.statements.push_back(std::move(one));
  }
  score.verdict = verdict_of(score, rig.truth.empty() || rig.outside);
  if (score.verdict == RigVerdict::missed && is_told_as_class(rig, told)) {
    score.verdict = RigVerdict::as_class;
  }
  return score;
}

}  // namespace chladni::simulators
