// The version of a study, and of its files, from which a result comes.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/study.h"

namespace chladni::study {

/// A file that a study names: its name in the study, relative to the study's folder, and its path.
struct NamedFile {
  std::string name;
  std::filesystem::path file;
};

/// The bases and the file of the body. With `measured` also all others that the study names:
/// responses, recordings, shapes, tolerances, truths and specimens with the files of theirs. Only
/// files that exist.
/// @param allowed  folders outside the study's from which files may be read
[[nodiscard]] std::vector<NamedFile> named_files(
    const Study& study, bool measured, const std::vector<std::filesystem::path>& allowed = {});

/// The sha256 of files, each of which is read once. Safe to share between threads.
class Fingerprints {
 public:
  /// @throws InvalidInput  the file cannot be read
  [[nodiscard]] std::string of(const std::filesystem::path& file);

 private:
  std::mutex mutex_;
  std::map<std::filesystem::path, std::string> known_;
};

/// The fingerprints in a result: of the study, and of the files that it uses.
struct Origin {
  std::string study;
  std::map<std::string, std::string> inputs;  ///< by name
};

/// The origin of a JSON file that `Run::leave` wrote, or of a report; none for any other file.
[[nodiscard]] std::optional<Origin> origin_of(const std::filesystem::path& result);

/// True if two results cannot be of one state: the studies differ, or a common file differs.
[[nodiscard]] bool differ(const Origin& one, const Origin& other);

/// The results in `folder` whose origin is not `now`, by name, ascending.
[[nodiscard]] std::vector<std::string> outdated(const std::filesystem::path& folder,
                                                const Origin& now);

}  // namespace chladni::study
