#include "stage/work.h"

#include <algorithm>

namespace chladni::stage {

void Work::note(std::string_view) {}
void Work::note_once(const std::string& line) {
  if (told_once_.insert(line).second) note(line);
}
void Work::warn(std::string_view) {}
void Work::show(std::string_view) {}

void Work::store(const std::string& name, double seconds) {
  const auto known = std::ranges::find(seconds_, name, &std::pair<std::string, double>::first);
  if (known != seconds_.end()) {
    known->second += seconds;
  } else {
    seconds_.emplace_back(name, seconds);
  }
}

}  // namespace chladni::stage
