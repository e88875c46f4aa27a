#include "stage/work.h"

namespace chladni::stage {

void Work::note(std::string_view) {}
void Work::note_once(const std::string& line) {
  if (told_once_.insert(line).second) note(line);
}
void Work::warn(std::string_view) {}
void Work::show(std::string_view) {}

}  // namespace chladni::stage
