#include "host/limits/control_group.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace chladni {
namespace {

using std::filesystem::path;

// The first number in a file; kUnlimited for "max" or no file.
std::size_t number_in(const path& file) {
  std::ifstream in(file);
  std::size_t value = kUnlimited;
  return in >> value ? value : kUnlimited;
}

// The number behind `key` in a file of lines "key number"; 0 where there is none.
std::size_t number_of(const std::string& key, const path& file) {
  std::ifstream in(file);
  std::string name;
  for (std::size_t value = 0; in >> name >> value;) {
    if (name == key) return value;
  }
  return 0;
}

// The folders of the process's group and of all groups above it, up to the root.
std::vector<path> folders(const ControlGroupFiles& files) {
  std::ifstream in(files.membership);
  path group;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("0::/")) group = line.substr(4);
  }
  std::vector<path> all{files.root};
  path folder = files.root;
  for (const auto& name : group) {
    if (name == "..") return {files.root};  // the process cannot see this group
    if (name.empty() || name == ".") continue;
    folder /= name;
    all.push_back(folder);
  }
  return all;
}

std::size_t memory_left_in(const path& folder) {
  const auto limit = number_in(folder / "memory.max");
  const auto used = number_in(folder / "memory.current");
  if (limit == kUnlimited || used == kUnlimited) return kUnlimited;
  const auto held = used - std::min(used, number_of("inactive_file", folder / "memory.stat"));
  return limit > held ? limit - held : 0;
}

// cpu.max contains "200000 100000" (microseconds of work per microseconds of time) or "max 100000".
std::size_t processors_in(const path& folder) {
  std::ifstream in(folder / "cpu.max");
  std::size_t quota = 0;
  std::size_t period = 0;
  if (!(in >> quota >> period) || period == 0) return kUnlimited;
  return std::max<std::size_t>(1, (quota + period - 1) / period);
}

template <typename Of>
std::size_t least(const ControlGroupFiles& files, const Of& of) {
  std::size_t result = kUnlimited;
  for (const auto& folder : folders(files)) result = std::min(result, of(folder));
  return result;
}

}  // namespace

std::size_t memory_left_in_group(const ControlGroupFiles& files) {
  return least(files, memory_left_in);
}

std::size_t processors_of_group(const ControlGroupFiles& files) {
  return least(files, processors_in);
}

}  // namespace chladni
