// Tests that take longer than some five seconds run at every fourth landing, a quarter at each;
// those of more than some 25 s at every eighth.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "rotation/drawn_sample.h"

namespace chladni::rotation {

/// Whether a test of this name (Suite.Test, Suite.Test/0) runs beside this sample. Its quarter is
/// the rest by four of a sum over its letters (FNV-1a).
[[nodiscard]] bool has_turn(std::string_view test, const DrawnSample& sample);
/// The same for an eighth.
[[nodiscard]] bool has_rare_turn(std::string_view test, const DrawnSample& sample);

/// Why the test that runs now is skipped; empty where it has its turn. CHLADNI_STUDIES decides, or
/// git (`drawn_sample`).
[[nodiscard]] std::string why_skipped();
/// The same for a test that runs at every eighth landing.
[[nodiscard]] std::string why_skipped_mostly();

}  // namespace chladni::rotation

/// The first line of such a test. A fixture's set-up has run before it.
#define EVERY_FOURTH_LANDING()                                                             \
  if (const auto why_skipped = ::chladni::rotation::why_skipped(); !why_skipped.empty()) { \
    GTEST_SKIP() << why_skipped;                                                           \
  }                                                                                        \
  static_assert(true)

/// The same for a test of more than some 25 s.
#define EVERY_EIGHTH_LANDING()                                                                    \
  if (const auto why_skipped = ::chladni::rotation::why_skipped_mostly(); !why_skipped.empty()) { \
    GTEST_SKIP() << why_skipped;                                                                  \
  }                                                                                               \
  static_assert(true)
