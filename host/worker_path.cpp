// Where worker programs are.
#include <unistd.h>

#include <cstdlib>
#include <system_error>

#include "host/worker.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path>& added_folders() {
  static std::vector<fs::path> folders;
  return folders;
}

// The folders that may hold a worker, in the order in which they are tried.
std::vector<fs::path> worker_folders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("CHLADNI_LIBEXEC"); chosen != nullptr && *chosen != '\0') {
    folders.emplace_back(chosen);
  }
  folders.insert(folders.end(), added_folders().begin(), added_folders().end());
  std::error_code ignored;
  const fs::path here = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  if (!here.empty()) {
    folders.push_back(here);
    folders.push_back(here.parent_path() / "libexec" / "chladni");
  }
  folders.emplace_back(CHLADNI_INSTALLED_LIBEXEC);
  return folders;
}

}  // namespace

std::optional<fs::path> program_on_path(const std::string& name) {
  const auto runs = [](const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    return runs(name) ? std::optional<fs::path>(name) : std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty() && !name.empty()) {
    const auto end = rest.find(':');
    const auto candidate = fs::path(rest.substr(0, end)) / name;
    if (runs(candidate)) return candidate;
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  return std::nullopt;
}

void add_worker_folder(const fs::path& folder) { added_folders().push_back(folder); }

fs::path worker_path(std::string_view name) {
  std::string tried;
  for (const auto& folder : worker_folders()) {
    const fs::path candidate = folder / name;
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
    tried += (tried.empty() ? "" : ", ") + folder.string();
  }
  throw WorkerDied(std::string(name) + " was not found in " + tried +
                   "; build it, or set CHLADNI_LIBEXEC to its folder");
}

}  // namespace chladni
