// The trust that an identified model deserves, in words.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identification/fit_data.h"
#include "identification/identified.h"

namespace chladni::identification {

enum class Trust {
  to_noise,    ///< the residual is the stated noise
  good,        ///< the residual is within the noise and the allowed model error, or within what
               ///< variances of an unknown number of averages may leave; where the weights are no
               ///< deviations: it is within that error, or neighbouring lines do not share it
  systematic,  ///< the residual is larger; the deviations contain the model error
  none,        ///< the modes are not those of the data: `reasons` say why
};

/// One value that its neighbours contradict.
struct OutlyingValue {
  Eigen::Index line = 0, response = 0;
  double residual = 0.0;    ///< |G − Ĝ| in deviations; Ĝ of a fit without this value
  double neighbours = 0.0;  ///< median of the same quantity of its neighbours
};

/// A mode whose frequency, damping or shape has a deviation as large as the order of its value.
struct DoubtfulMode {
  Eigen::Index mode = 0;
  std::string why;
};

/// What complex shapes leave of data that real ones do not explain.
struct ComplexAlternative {
  double level = 1.0;        ///< noise_level of the fit with general damping
  Eigen::Index modes = 0;    ///< its modes that are not rigid
  Eigen::Index instead = 0;  ///< those of the fit with real shapes
};

struct Judgement {
  Trust trust = Trust::good;
  double level = 1.0;           ///< noise_level: squared residual over squared noise
  double relative_error = 0.0;  ///< |G − Ĝ| over |G|, all responses and lines
  double unexplained = 0.0;     ///< part of Σ|G|² neither fitted nor noise: mean of all responses
  double doubtful_part = 0.0;   ///< their part of the power of all modes, each mode taken by itself
  std::vector<OutlyingValue> outlying;
  std::vector<DoubtfulMode> doubtful;
  /// Modes above or below the lines of which frequency, damping or shape is not known: with the
  /// residual they stand for all that is there, and are no modes that were measured.
  std::vector<Eigen::Index> beyond_lines;
  std::vector<std::string> reasons;  ///< why the fit is not to be trusted: one or more sentences
  std::optional<ComplexAlternative> with_complex_shapes;  ///< where they explain the data with no
                                                          ///< more modes
};

/// Whether complex shapes explain the data better than real ones, so that they are proposed: they
/// leave less than a part of what real ones leave, or they alone reach the noise, with no more
/// modes.
/// @param complex, real  fits to these data
[[nodiscard]] bool explain_more(const ModalFit& complex, const ModalFit& real, const FitData& data);

/// "down to the noise", "good", "systematic errors", "not to be trusted".
[[nodiscard]] const char* word(Trust trust);

/// A fit is not to be trusted if
/// - it leaves a quarter of the responses' power unexplained by itself or noise, each by its own,
/// - half of its modes' power is in doubtful modes, or no mode but those beyond the lines is left;
///   doubtful modes beyond the lines are not counted, since they cancel each other within,
/// - no variance is stated, and the modes within the lines explain less than is left, where
///   neighbouring lines share what is left: then no mode stands out of the fit's own error,
/// - outlying values decide it: the same identification without them has another number of modes,
///   or a mode that moves by more than five deviations. Where no variance is stated, this counts
///   only if a mode depends on them or the fit leaves ten times the noise.
/// A value is outlying if its residual to a fit without it exceeds two limits: the one that noise
/// exceeds once in a million records of that size, and eight times the median of its neighbours.
/// Where no variance explains the residual, the limits also allow a model error: the usual one
/// relative to the response, and the change of Ĝ from line to line. Lines that carry a third of a
/// mode's power are tried too. Where the fit leaves ten times the noise or a quarter of the power,
/// values that jump beside their neighbours are also tried.
/// Where more than noise is left of a fit with real shapes, one with complex shapes is tried: a
/// dashpot at one place couples the modes, and real shapes then need modes that are not there.
/// Cost: little; one more identification where values may be outlying, one where more than noise is
/// left.
/// @param data   the data that `found` was fitted to
/// @param again  options for the identification without outlying values. Without them, or above 200
///               responses, the values are only named, from the fit itself, and decide nothing
[[nodiscard]] Judgement judged(const Identified& found, const FitData& data,
                               const std::optional<IdentificationOptions>& again);

}  // namespace chladni::identification
