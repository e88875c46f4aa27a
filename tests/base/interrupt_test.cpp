#include "base/interrupt.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <type_traits>

#include "base/answered_interrupts.h"
#include "base/error.h"

namespace chladni {
namespace {

// What tries another way after a failure must not go on after Ctrl-C.
static_assert(!std::is_base_of_v<NumericalFailure, Interrupted>);

TEST(Interrupt, IsThrownBetweenStepsUntilForgotten) {
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGHUP}) {
    std::signal(signal, SIG_DFL);  // ignored under nohup, or behind a shell
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

TEST(Interrupt, IsAskedOfAHostThatDecides) {
  std::signal(SIGINT, [](int /*signal*/) { hosts_share = 1; });
  hosts_share = 0;
  int asked = 0;
  bool stop = false;
  {
    const AnsweredInterrupts host([&] { return ++asked > 0 && stop; });
    EXPECT_NO_THROW(throw_if_interrupted());
    std::raise(SIGINT);
    std::raise(SIGINT);
    std::thread([] { EXPECT_NO_THROW(throw_if_interrupted()); }).join();
    EXPECT_EQ(asked, 0) << "only the thread of the host asks it";
    EXPECT_NO_THROW(throw_if_interrupted());
    EXPECT_FALSE(interrupted());
    EXPECT_EQ(asked, 1);
    stop = true;
    std::raise(SIGINT);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
    EXPECT_TRUE(interrupted());
    EXPECT_EQ(asked, 2);
    std::thread([] { EXPECT_THROW(throw_if_interrupted(), Interrupted); }).join();
  }
  EXPECT_EQ(hosts_share, 0) << "it was answered";
  EXPECT_NO_THROW(throw_if_interrupted());
  std::signal(SIGINT, SIG_DFL);
}

TEST(Interrupt, ThatComesTooLateToBeAskedAboutIsTheHosts) {
  std::signal(SIGINT, [](int /*signal*/) { hosts_share = 1; });
  hosts_share = 0;
  try {
    const AnsweredInterrupts host([] { return true; });
    std::raise(SIGINT);
    throw InvalidInput("of the work");
  } catch (const InvalidInput&) {
    EXPECT_EQ(hosts_share, 1);
  }
  EXPECT_FALSE(interrupted());
  std::signal(SIGINT, SIG_DFL);
}

// Code of the host that is called in a step may take a step of its own.
TEST(Interrupt, IsAskedOfTheInnerHostFirst) {
  std::signal(SIGINT, [](int /*signal*/) { hosts_share = 1; });
  hosts_share = 0;
  int outer = 0;
  int inner = 0;
  {
    const AnsweredInterrupts host([&] { return ++outer < 0; });
    {
      const AnsweredInterrupts guest([&] { return ++inner < 0; });
      std::raise(SIGINT);
      EXPECT_FALSE(interrupted());
      std::raise(SIGINT);
    }
    EXPECT_EQ(inner, 1);
    EXPECT_FALSE(interrupted());
    EXPECT_EQ(outer, 1);
  }
  EXPECT_EQ(hosts_share, 0);
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

// Another standard error for as long as it exists.
class OtherStderr {
 public:
  explicit OtherStderr(int there) : before_(dup(STDERR_FILENO)) { dup2(there, STDERR_FILENO); }
  ~OtherStderr() {
    dup2(before_, STDERR_FILENO);
    close(before_);
  }
  OtherStderr(const OtherStderr&) = delete;
  OtherStderr& operator=(const OtherStderr&) = delete;
  OtherStderr(OtherStderr&&) = delete;
  OtherStderr& operator=(OtherStderr&&) = delete;

 private:
  int before_;
};

// What is written to `to`, and can be read at `from`, when a signal comes.
std::string said_at(int signal, int to, int from) {
  {
    const OtherStderr other(to);
    catch_interrupts();
    std::raise(signal);
    forget_interrupt();
  }
  std::array<char, 512> text{};
  pollfd ready = {from, POLLIN, 0};
  if (poll(&ready, 1, 200) != 1) return "";
  return {text.data(), static_cast<std::size_t>(read(from, text.data(), text.size()))};
}

TEST(Interrupt, SaysOnATerminalWhatASecondCtrlCDoes) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal), 0);
  ASSERT_EQ(unlockpt(terminal), 0);
  const int inside = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  ASSERT_GE(inside, 0);
  EXPECT_NE(said_at(SIGINT, inside, terminal).find("Ctrl-C again stops at once"),
            std::string::npos);
  EXPECT_EQ(said_at(SIGTERM, inside, terminal), "");
  std::array<int, 2> pipe = {};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  EXPECT_EQ(said_at(SIGINT, pipe[1], pipe[0]), "") << "a file is no person";
  for (const int file : {terminal, inside, pipe[0], pipe[1]}) close(file);
  catch_interrupts();
}

// Seconds after which a process that sleeps in a long step ends by Ctrl-C.
void sleep_in_a_long_step() {
  catch_interrupts();
  const LongStep step;
  std::raise(SIGINT);
  for (int i = 0; i < 200; ++i) usleep(100'000);
  std::exit(0);  // NOLINT(concurrency-mt-unsafe)
}

TEST(InterruptDeathTest, ThatALongStepDoesNotAnswerEndsTheProcess) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EXIT(sleep_in_a_long_step(), testing::KilledBySignal(SIGINT), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

// What is answered in time ends in order, however long the rest takes.
void tidy_up_after_a_long_step() {
  catch_interrupts();
  try {
    {
      const LongStep step;
      std::raise(SIGINT);
    }
    throw_if_interrupted();
  } catch (const Interrupted&) {
    for (int i = 0; i < 45; ++i) usleep(100'000);
    std::exit(7);  // NOLINT(concurrency-mt-unsafe)
  }
}

TEST(InterruptDeathTest, ThatIsAnsweredAfterALongStepLetsTheRestBeDone) {
  EXPECT_EXIT(tidy_up_after_a_long_step(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace chladni
