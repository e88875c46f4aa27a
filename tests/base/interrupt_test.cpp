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
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGHUP}) {
    catch_interrupts();
    EXPECT_NO_THROW(throw_if_interrupted());
    std::raise(signal);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
  }
  catch_interrupts();
  EXPECT_NO_THROW(throw_if_interrupted());
}

TEST(Interrupt, OfATerminalThatIsGoneStaysIgnoredUnderNohup) {
  std::signal(SIGHUP, SIG_IGN);
  catch_interrupts();
  std::raise(SIGHUP);
  EXPECT_NO_THROW(throw_if_interrupted());
  std::signal(SIGHUP, SIG_DFL);
}

volatile std::sig_atomic_t hosts_share = 0;

TEST(Interrupt, IsNotedForAHostThatGetsItsHandlerBack) {
  std::signal(SIGINT, [](int /*signal*/) { hosts_share = 1; });
  {
    const NotedInterrupts noted;
    EXPECT_NO_THROW(throw_if_interrupted());
    std::raise(SIGINT);
    std::raise(SIGINT);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
    forget_interrupt();
  }
  EXPECT_EQ(hosts_share, 0);
  std::raise(SIGINT);
  EXPECT_EQ(hosts_share, 1);
  hosts_share = 0;
  {
    const NotedInterrupts noted;
    std::raise(SIGINT);  // too late for the work to notice
    EXPECT_EQ(hosts_share, 0);
  }
  EXPECT_EQ(hosts_share, 1);
  EXPECT_NO_THROW(throw_if_interrupted());
  try {
    const NotedInterrupts noted;
    std::raise(SIGINT);
    hosts_share = 0;
    throw_if_interrupted();
  } catch (const Interrupted&) {
    EXPECT_EQ(hosts_share, 0);
  }
  std::signal(SIGINT, SIG_DFL);
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
