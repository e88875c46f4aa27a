// Which state of a study, and of the files that it names, a result comes from.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/study/study.h"

namespace chladni::app {

/// A file that a study names: as the study says it, relative to its folder, and where it is.
struct NamedFile {
  std::string name;
  std::filesystem::path file;
};

/// The file of the body; with `measured` those of what was measured as well: responses, recordings,
/// shapes, tolerances, the truth and what that names. Only those that are there.
[[nodiscard]] std::vector<NamedFile> named_files(const Study& study, bool measured);

/// The fingerprints in a result: of the study, and of the files that it stands on.
struct Origin {
  std::string study;
  std::map<std::string, std::string> inputs;  ///< by name
};

/// Of a JSON file that `Run::leave` wrote or of a report; none of any other file.
[[nodiscard]] std::optional<Origin> origin_of(const std::filesystem::path& result);

/// Whether two results cannot be of one state: other studies, or a file in both that differs.
[[nodiscard]] bool differ(const Origin& one, const Origin& other);

/// The results in `folder` whose origin is not `now`, by name, ascending.
[[nodiscard]] std::vector<std::string> outdated(const std::filesystem::path& folder,
                                                const Origin& now);

}  // namespace chladni::app
