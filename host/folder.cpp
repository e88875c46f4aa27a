#include "host/folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string_view>

#include "host/descriptor.h"

namespace chladni {
namespace {

bool is_way(std::string_view name) { return name == "." || name == ".."; }

void remove_below(int folder) noexcept;

// Whether it was there and is gone.
bool removed(int folder, const char* name) noexcept {
  if (unlinkat(folder, name, 0) == 0) return true;
  const Descriptor inner(openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (inner.number() < 0) return false;
  remove_below(inner.number());
  return unlinkat(folder, name, AT_REMOVEDIR) == 0;
}

// Removes what is in a folder. opendir would take memory.
void remove_below(int folder) noexcept {
  alignas(dirent64) std::array<char, 4096> room;
  bool any = true;  // removing may hide entries from the pass that removes
  while (any) {
    any = false;
    if (lseek(folder, 0, SEEK_SET) < 0) return;
    ssize_t size = 0;
    while ((size = getdents64(folder, room.data(), room.size())) > 0) {
      for (ssize_t at = 0; at < size;) {
        const auto* entry = reinterpret_cast<const dirent64*>(room.data() + at);
        at += entry->d_reclen;
        if (!is_way(entry->d_name) && removed(folder, entry->d_name)) any = true;
      }
    }
  }
}

}  // namespace

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  const std::unique_ptr<DIR, int (*)(DIR*)> open(opendir(folder.c_str()), closedir);
  while (open != nullptr) {
    const dirent* entry = readdir(open.get());
    if (entry == nullptr) break;
    if (!is_way(entry->d_name)) entries.push_back(folder / entry->d_name);
  }
  return entries;
}

void remove_whole(const std::filesystem::path& path) noexcept {
  static_cast<void>(removed(AT_FDCWD, path.c_str()));
}

std::filesystem::path path_from(const std::filesystem::path& folder,
                                const std::filesystem::path& target) {
  const auto real = [](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
  };
  return real(target).lexically_relative(real(folder));
}

}  // namespace chladni
