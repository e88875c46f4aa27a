#include "rotation/turn.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>

namespace chladni::rotation {

bool has_turn(std::string_view test, const DrawnSample& sample) {
  std::uint32_t sum = 2166136261U;
  for (const char letter : test) sum = (sum ^ static_cast<unsigned char>(letter)) * 16777619U;
  return sample.has(sum >> 16);
}

std::string why_skipped() {
  static const DrawnSample sample = [] {
    const char* asked = std::getenv("CHLADNI_STUDIES");
    return drawn_sample(asked == nullptr ? "" : asked, tree_state(CHLADNI_SOURCE_DIR));
  }();
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto name = fmt::format("{}.{}", test->test_suite_name(), test->name());
  if (has_turn(name, sample)) return "";
  return fmt::format("runs at another landing than number {} ({}): CHLADNI_STUDIES=all runs it",
                     sample.number, sample.from);
}

}  // namespace chladni::rotation
