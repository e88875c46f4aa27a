#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/coordinates.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

using Eigen::Index;

Tolerances believable(Tolerances tolerances, bool learned) {
  if (!learned) return tolerances;
  tolerances.modulus = std::max(tolerances.modulus, 0.01);
  tolerances.density = std::max(tolerances.density, 0.01);
  tolerances.thickness = std::max(tolerances.thickness, 0.003);
  tolerances.orthotropy = std::max(tolerances.orthotropy, 0.01);
  return tolerances;
}

namespace {

// A constant that is calibrated is no error of the body.
std::vector<BodyError> body_errors_beside(const Structure& structure,
                                          const std::vector<HeldConstant>& constants,
                                          const Tolerances& tolerances) {
  const auto left = tolerances_left(constants, tolerances);
  return body_errors(structure, left.tolerances, left.uniform_thickness);
}

Index coordinates_below(const Structure& structure, double hz) {
  Index count = 0;
  while (count < structure.mode_count() && structure.frequency_hz(count) <= hz) ++count;
  return std::max<Index>(count, std::min<Index>(structure.mode_count(), 12));
}

}  // namespace

ModesProblem::ModesProblem(const Structure& structure, const MeasuredModes& measured,
                           const Tolerances& tolerances, bool learned,
                           std::vector<HeldConstant> constants)
    : ModesProblem(structure, measured, believable(tolerances, learned),
                   level_prior(tolerances, learned), std::move(constants)) {}

ModesProblem::ModesProblem(const Structure& structure, const MeasuredModes& measured,
                           const Tolerances& tolerances, const LevelPrior& prior,
                           std::vector<HeldConstant> constants)
    : structure_(structure),
      measured_(measured),
      constants_(std::move(constants)),
      tolerances_(tolerances),
      prior_(prior),
      units_(shape_units(structure)),
      smooth_(smooth_factor(structure)),
      body_(body_errors_beside(structure, constants_, tolerances_)),
      solver_(state_of(structure), structure.mode_count()),
      quick_(
          state_of(structure),
          coordinates_below(structure, kConstants.quick_modes * measured.frequency_hz.maxCoeff())),
      low_hz_(kConstants.modes_below * measured.frequency_hz.minCoeff()),
      high_hz_(kConstants.modes_above_band * measured.frequency_hz.maxCoeff()) {}

State ModesProblem::with(const ModesFit& fit) const {
  State state = state_of(structure_);
  for (const auto& cause : supposed(constants_, fit.constants, fit.causes))
    cause.effect->apply(state, structure_, cause.option, cause.x);
  return state;
}

std::optional<BodyModes> ModesProblem::body_modes(const State& state, bool quick) const {
  try {
    auto body = (quick ? quick_ : solver_).body_modes(state, low_hz_, high_hz_);
    if (body.frequency_hz.size() == 0) return std::nullopt;
    return body;
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

std::optional<RecordedModes> ModesProblem::modes(const State& state, bool quick) const {
  const auto body = body_modes(state, quick);
  return body ? modes(state, *body) : std::nullopt;
}

std::optional<RecordedModes> ModesProblem::modes(const State& state, const BodyModes& body) {
  auto model = recorded(state, body);
  if (!model.outputs.allFinite() || !model.inputs.allFinite()) return std::nullopt;
  return model;
}

std::vector<Matching> ModesProblem::matchings(const RecordedModes& model) const {
  std::vector<Matching> all{matched(measured_, model, units_, PairBy::shape)};
  auto by_frequency = matched(measured_, model, units_, PairBy::frequency);
  if (by_frequency.model != all.front().model) all.push_back(std::move(by_frequency));
  return all;
}

ModeErrors ModesProblem::errors(const ModesFit& hypothesis, const RecordedModes& model,
                                const Matching& matching, bool with_shared) const {
  return errors(hypothesis, model, matching, std::vector<bool>(at(measured_.count()), with_shared));
}

ModeErrors ModesProblem::errors(const ModesFit& hypothesis, const RecordedModes& model,
                                const Matching& matching, const std::vector<bool>& shares) const {
  return mode_errors(structure_, measured_, model, units_, matching, body_, smooth_,
                     hypothesis.disturbed, shares);
}

}  // namespace chladni::diagnosis
