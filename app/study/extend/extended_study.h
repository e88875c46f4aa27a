// A study with the causes of what was wrong with it: a study like any other.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/study/study.h"
#include "diagnosis/diagnosed.h"

namespace chladni::app {

struct ExtendedStudy {
  std::string text;
  std::vector<std::string> unexpressed;  ///< "frame: no key of a study says that ..."
};

/// The study in `bytes`, its comments kept, with the causes as entries: attachments appended,
/// values of materials, geometry and channels changed in place, each below a comment that names the
/// cause with its numbers and deviations and what stood there before. Causes that no key can
/// express are said in a comment at the end and in `unexpressed`.
///
/// @param file     of `bytes`: its folder is where paths in it are looked up
/// @param chart    where u and v of the causes are
/// @param fits_variations  whether the chart's axes are those of [[variation]]
/// @param folder   where the study will be written: paths are made to lead there and back
/// @param allowed  as read_study
/// @throws InvalidInput  `bytes` is no study, a cause names a channel that it lacks, a number that
///                       the effect needs is missing, or a changed value cannot be (a negative
///                       modulus)
[[nodiscard]] ExtendedStudy extended_study(
    std::string_view bytes, const std::filesystem::path& file, const diagnosis::Surface& chart,
    const std::vector<diagnosis::Cause>& causes, const std::filesystem::path& folder,
    const std::vector<std::filesystem::path>& allowed = {}, bool fits_variations = true);

}  // namespace chladni::app
