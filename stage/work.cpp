#include "stage/work.h"

namespace chladni::stage {

void Work::note(std::string_view) {}
void Work::warn(std::string_view) {}
void Work::show(std::string_view) {}

}  // namespace chladni::stage
