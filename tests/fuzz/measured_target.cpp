// A libFuzzer target for one parser of measured data, CHLADNI_PARSER: anything but a sound result
// or InvalidInput is a find.
#include <cstdint>

#include "base/error.h"
#include "tests/fuzz/measured.h"
#include "tests/fuzz/pieces.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (!chladni::io::is_sound(chladni::io::CHLADNI_PARSER(bytes))) __builtin_trap();
  } catch (const chladni::InvalidInput&) {
    return 0;
  }
  return 0;
}
