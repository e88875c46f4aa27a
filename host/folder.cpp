#include "host/folder.h"

#include <dirent.h>

#include <memory>
#include <string_view>

namespace chladni {

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  const std::unique_ptr<DIR, int (*)(DIR*)> open(opendir(folder.c_str()), closedir);
  while (open != nullptr) {
    const dirent* entry = readdir(open.get());
    if (entry == nullptr) break;
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") entries.push_back(folder / name);
  }
  return entries;
}

std::filesystem::path path_from(const std::filesystem::path& folder,
                                const std::filesystem::path& target) {
  const auto real = [](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
  };
  return real(target).lexically_relative(real(folder));
}

}  // namespace chladni
