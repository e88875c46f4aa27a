// The tests of all rooms find the workers of this build.
#include "base/worker.h"

namespace {

[[maybe_unused]] const bool kFound = [] {
  chladni::add_worker_folder(CHLADNI_BINARY_DIR "/bin");
  return true;
}();

}  // namespace
