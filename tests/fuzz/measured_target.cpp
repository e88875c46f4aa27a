// A libFuzzer target for one parser of measured data, CHLADNI_PARSER: anything but a sound result
// or InvalidInput is a find.
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "io/frf_uff.h"
#include "io/time_uff.h"

namespace chladni::io {
namespace {

constexpr std::size_t kLimit = std::size_t{32} << 20U;

bool is_sound(const FrfFile& file) {
  modal::check(file.set);
  return file.set.line_count() > 0;
}

bool is_sound(const TimeFile& file) {
  const auto& data = file.data;
  if (!(data.sample_time_s > 0.0) || data.records.empty()) return false;
  for (const auto& record : data.records) {
    const auto n = record.outputs.rows();
    if (n == 0 || record.inputs.rows() != n || record.references.rows() != n) return false;
    if (static_cast<std::size_t>(record.outputs.cols()) != data.outputs.size()) return false;
    if (static_cast<std::size_t>(record.inputs.cols()) != data.inputs.size()) return false;
  }
  return true;
}

FrfFile read_frf_csv(std::string_view bytes) {
  FrfOptions options;
  options.limit_bytes = kLimit;
  return parse_frf_csv(bytes, "f.csv", options);
}

FrfFile read_frf_uff(std::string_view bytes) {
  FrfOptions options;
  options.limit_bytes = kLimit;
  return parse_frf_uff(bytes, "f.uff", options);
}

TimeFile read_time_csv(std::string_view bytes) {
  TimeOptions options;
  options.sample_time_s = 0.1;
  return parse_time_csv(bytes, "f.csv", options);
}

TimeFile read_time_uff(std::string_view bytes) { return parse_time_uff(bytes, "f.uff", {}); }

}  // namespace
}  // namespace chladni::io

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (!chladni::io::is_sound(chladni::io::CHLADNI_PARSER(bytes))) __builtin_trap();
  } catch (const chladni::InvalidInput&) {
    return 0;
  }
  return 0;
}
