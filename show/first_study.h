// The text of a first study, with comments that say what to change.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/study.h"

namespace chladni::show {

/// A dimension of a body, with what a first study has.
struct FirstDimension {
  std::string_view key;
  std::string_view value;  ///< as in TOML: "400 mm", [9, 9]
  std::string_view si_unit = "m";
};
/// A body that is given by its dimensions.
struct FirstBody {
  std::string_view kind;  ///< "plate", "beam", "disc", "wafer_table"
  std::vector<FirstDimension> dimensions;
};

[[nodiscard]] const std::vector<FirstBody>& first_bodies();

/// What somebody chose for a first study.
struct FirstChoices {
  std::string kind;                                             ///< of the body, or "file"
  std::vector<std::pair<std::string, std::string>> dimensions;  ///< key, value as in TOML
  std::filesystem::path part;                                   ///< the body's file
  std::string unit;  ///< of its lengths; empty: the file states it
  std::string material = "aluminium 6061";
};

/// The study that `chladni new` writes to `file`. Sensors and actuators stand on what looks up. Of
/// a body from a file the size, the patches and the face that looks up are told in comments.
/// @throws InvalidInput  the choices are no study that `chladni check` accepts; the part is not
///                       below the folder of `file`
[[nodiscard]] std::string first_study(const FirstChoices& choices,
                                      const std::filesystem::path& file);

}  // namespace chladni::show
