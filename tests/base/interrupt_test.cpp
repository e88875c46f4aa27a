#include "base/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>
#include <type_traits>

#include "base/error.h"

namespace chladni {
namespace {

// What tries another way after a failure must not go on after Ctrl-C.
static_assert(!std::is_base_of_v<NumericalFailure, Interrupted>);

TEST(Interrupt, IsThrownBetweenStepsUntilForgotten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    catch_interrupts();
    EXPECT_NO_THROW(throw_if_interrupted());
    std::raise(signal);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
  }
  catch_interrupts();
  EXPECT_NO_THROW(throw_if_interrupted());
}

TEST(InterruptDeathTest, EndsTheProcessTheSecondTime) {
  EXPECT_EXIT(
      {
        catch_interrupts();
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace chladni
