// The tests of all rooms find the workers of this build, and share no meshes or modes with each
// other or with the user.
#include <cstdlib>

#include "host/worker.h"

namespace {

[[maybe_unused]] const bool kFound = [] {
  chladni::add_worker_folder(CHLADNI_BINARY_DIR "/bin");
  setenv("CHLADNI_CACHE", "off", 1);
  return true;
}();

}  // namespace
