#include "rotation/turn.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>

namespace chladni::rotation {

namespace {

std::uint32_t kind_of(std::string_view test) {
  std::uint32_t sum = 2166136261U;
  for (const char letter : test) sum = (sum ^ static_cast<unsigned char>(letter)) * 16777619U;
  return sum >> 16;
}

std::string skipped_unless(bool (*has)(std::string_view, const DrawnSample&)) {
  static const DrawnSample sample = [] {
    const char* asked = std::getenv("CHLADNI_STUDIES");
    return drawn_sample(asked == nullptr ? "" : asked, tree_state(CHLADNI_SOURCE_DIR));
  }();
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto name = fmt::format("{}.{}", test->test_suite_name(), test->name());
  if (has(name, sample)) return "";
  return fmt::format("runs at another landing than number {} ({}): CHLADNI_STUDIES=all runs it",
                     sample.eighth(), sample.from);
}

}  // namespace

bool has_turn(std::string_view test, const DrawnSample& sample) {
  return sample.has(kind_of(test));
}

bool has_rare_turn(std::string_view test, const DrawnSample& sample) {
  return sample.has_half(kind_of(test));
}

std::string why_skipped() { return skipped_unless(has_turn); }

std::string why_skipped_mostly() { return skipped_unless(has_rare_turn); }

}  // namespace chladni::rotation
