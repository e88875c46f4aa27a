// A study extended by the causes that were found; it can be used like any other study.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "study/study.h"

namespace chladni::steps {

struct ExtendedStudy {
  std::string text;
  std::vector<std::string> unexpressed;  ///< "frame: no key of a study says that ..."
};

/// What a diagnosis had of the study.
struct DiagnosedOn {
  /// Its channels. Empty: all those of the study; a cause on all sensors but those held out is then
  /// on all of them.
  std::vector<std::string> sensors, actuators;
  /// Height of the body's surface over the plane of the chart at u and v [m]; none or empty: 0.
  std::function<std::optional<double>(const Eigen::Vector2d& place)> height;
};

/// The study in `bytes`, with its comments and with the causes as entries. Attachments are
/// appended. Values of materials, geometry and channels are changed in place. A comment above each
/// change names the cause, its numbers and deviations, and the old value. Causes without a key are
/// named in a comment at the end and in `unexpressed`. The size of the body comes first, for places
/// of causes are those on the body as drawn and move with it; then the damping of all modes. Where
/// labels are exchanged, causes of the channels themselves come first, then the exchanges, then
/// causes of the records: so a name means what it means in the diagnosis.
///
/// @param file     of `bytes`: its folder is the base of relative paths in it
/// @param chart    gives the meaning of u and v of the causes
/// @param fits_variations  true if the chart's axes are those of [[variation]]
/// @param on       masses of the channels hang on its channels; a unit or quantity of all of them
///                 is that of all sensors of the study
/// @param folder   where the study will be written: its paths are changed to start there
/// @param allowed  as read_study
/// @throws InvalidInput  `bytes` is not a study, a cause names a missing channel, a number that the
///                       effect needs is missing, or a changed value is impossible (a negative
///                       modulus)
[[nodiscard]] ExtendedStudy extended_study(std::string_view bytes,
                                           const std::filesystem::path& file,
                                           const diagnosis::Surface& chart,
                                           const std::vector<diagnosis::Cause>& causes,
                                           const std::filesystem::path& folder,
                                           const std::vector<std::filesystem::path>& allowed = {},
                                           bool fits_variations = true, const DiagnosedOn& on = {});

}  // namespace chladni::steps
