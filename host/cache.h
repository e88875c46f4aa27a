// Results of long steps, kept in a folder from one run to the next.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "host/descriptor.h"

namespace chladni {

/// Where results are kept, by the environment.
struct CachePlace {
  std::filesystem::path folder;   ///< empty: nothing is kept
  std::uintmax_t most_bytes = 0;  ///< of all entries together
  std::string note;               ///< what in the environment cannot be used; empty: nothing
};
/// The folder is $CHLADNI_CACHE, or chladni below $XDG_CACHE_HOME or below ~/.cache; the word "off"
/// in CHLADNI_CACHE keeps nothing. The size is 4 GB or $CHLADNI_CACHE_GB.
[[nodiscard]] CachePlace cache_place();

/// Entries under names that say all that they depend on (a fingerprint). An entry appears whole or
/// not at all, and its bytes are compared with their SHA-256 when they are read. Several processes
/// may share a folder, also one of a file server.
class Cache {
 public:
  Cache(std::filesystem::path folder, std::uintmax_t most_bytes);

  /// The content of an entry; none where there is no such entry, where it cannot be read, or where
  /// its bytes are not those that were kept. It counts as used now.
  [[nodiscard]] std::optional<std::string> content(const std::string& name) const;

  /// Keeps an entry. Then the least recently used ones go until all together take no more than the
  /// limit. A failure is no error: the reason is returned, and nothing is returned where it went
  /// well. @throws Interrupted
  [[nodiscard]] std::string keep(const std::string& name, std::string_view content) const;

  /// Removes an entry, where there is one: for content that cannot be what its name says.
  void drop(const std::string& name) const;

  /// Names of the entries that begin with `beginning`, in alphabetical order.
  [[nodiscard]] std::vector<std::string> names(const std::string& beginning) const;

  struct Size {
    std::uintmax_t entries = 0, bytes = 0;
  };
  [[nodiscard]] Size size() const;
  /// Removes all entries and nothing else. Returns what was removed.
  /// @throws InvalidInput  one cannot be removed
  Size clear() const;

  /// While it exists, no other object of this kind exists for `name`, in any process: who waited
  /// finds what the other one kept. A process that dies holds nothing. Where the folder allows no
  /// locks it holds nothing either, and two may compute the same.
  class Hold {
   public:
    /// Tells `progress` that it waits. @throws Interrupted
    Hold(const Cache& cache, const std::string& name, const Progress& progress);

   private:
    Descriptor lock_;
  };

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& name) const;
  void shrink(const std::filesystem::path& newest) const;

  std::filesystem::path folder_;
  std::uintmax_t most_bytes_;
};

}  // namespace chladni
