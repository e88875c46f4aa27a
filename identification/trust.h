// How far an identified model is to be trusted, in words.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identification/fit_data.h"
#include "identification/identified.h"

namespace chladni::identification {

enum class Trust {
  to_noise,    ///< what is left is the stated noise
  good,        ///< what is left is within the noise and what the model was allowed to be off by
  systematic,  ///< more is left; what it may be off by is in the deviations
  none,        ///< the modes are not what the data show: `reasons` say why
};

/// One value that its neighbours contradict.
struct OutlyingValue {
  Eigen::Index line = 0, response = 0;
  double residual = 0.0;    ///< |G − Ĝ| in deviations, Ĝ of a fit without it
  double neighbours = 0.0;  ///< median of that beside it
};

/// A mode whose frequency, damping or shape deviates by the order of itself.
struct DoubtfulMode {
  Eigen::Index mode = 0;
  std::string why;
};

struct Judgement {
  Trust trust = Trust::good;
  double level = 1.0;           ///< noise_level: squares of what is left over those of the noise
  double relative_error = 0.0;  ///< |G − Ĝ| over |G|, all responses and lines
  double unexplained = 0.0;     ///< part of Σ|G|² that is neither fitted nor noise
  double doubtful_part = 0.0;   ///< of what all modes explain, each by itself
  std::vector<OutlyingValue> outlying;
  std::vector<DoubtfulMode> doubtful;
  std::vector<std::string> reasons;  ///< not to be trusted: one or more sentences
};

/// "down to the noise", "good", "systematic errors", "not to be trusted".
[[nodiscard]] const char* word(Trust trust);

/// Not to be trusted is a fit
/// - that leaves a quarter of the data's power unexplained by itself or noise,
/// - half of whose modes' power is in doubtful modes,
/// - that outlying values decide: the same identification without them has other modes, by number
///   or by more than five deviations. Where no variance is stated only if a mode lives of them, or
///   the fit leaves ten times the noise.
/// Outlying is a value whose residual is beyond what noise has once in a million records of that
/// size and eight times the median of its neighbours', to the fit without it. Where no variance
/// explains what is left, an error of the model as large as the response usually has, and as
/// Ĝ changes from line to line, is no outlier. Lines that carry a third
/// of a mode's power are tried too, and where the fit leaves ten times the noise values that jump
/// beside their neighbours.
/// Cost: little; one more identification where values may be outlying.
/// @param data   that `found` was fitted to
/// @param again  how to identify without outlying values; none, or more than 200 responses: they
///               are named from the fit itself, and decide nothing
[[nodiscard]] Judgement judged(const Identified& found, const FitData& data,
                               const std::optional<IdentificationOptions>& again);

}  // namespace chladni::identification
