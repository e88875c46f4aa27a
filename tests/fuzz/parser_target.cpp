// A libFuzzer target for one parser, CHLADNI_PARSER: anything but a result or InvalidInput is a
// find.
#include <cstdint>

#include "base/error.h"
#include "io/read.h"
#include "tests/fuzz/sound.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto body = chladni::io::CHLADNI_PARSER({reinterpret_cast<const char*>(data), size});
    if (!chladni::io::is_sound(body)) __builtin_trap();
  } catch (const chladni::InvalidInput&) {
    return 0;
  }
  return 0;
}
