#include "base/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <exception>
#include <string_view>
#include <utility>

#include "base/answered_interrupts.h"
#include "base/error.h"

namespace chladni {
namespace {

std::atomic<int> noted_signal = 0;  // lock-free, so the handler may write it
static_assert(std::atomic<int>::is_always_lock_free);

std::atomic<bool> has_terminal = false;
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr unsigned kPatience = 3;  // s: how long a signal waits for the end of a long step
std::atomic<int> long_steps = 0;
std::atomic<bool> has_alarm = false;  // whether SIGALRM comes to `end`

// Whether a noted signal stops the work only after a host has said so, and the host that is asked
// in this thread.
std::atomic<bool> waits_for_host = false;
thread_local const AnsweredInterrupts::Stops* asked_host = nullptr;

// Whether a signal has come and stops the work.
bool stops() {
  if (noted_signal == 0) return false;
  if (!waits_for_host) return true;
  if (asked_host == nullptr) return false;
  const int signal = noted_signal.exchange(0);  // a further one is asked about anew
  if (signal == 0 || !(*asked_host)()) return false;
  waits_for_host = false;  // all threads stop from now on
  noted_signal = signal;
  return true;
}

// For the one who pressed Ctrl-C and sees nothing happen: a long step may still be at work.
void say_what_a_second_does() {
  constexpr std::string_view line =
      "\nstopping after this step of the work; Ctrl-C again stops at once\n";
  const int before = errno;
  static_cast<void>(!write(STDERR_FILENO, line.data(), line.size()));
  errno = before;
}

// Raised again, the signal ends the process, as its kind does by default.
void end_by(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void note(int signal) {
  if (noted_signal.exchange(signal) != 0) return end_by(signal);
  if (signal == SIGINT && has_terminal) say_what_a_second_does();
  if (long_steps > 0) alarm(kPatience);
}

// Nothing has answered a signal.
void end(int /*alarm*/) {
  const int signal = noted_signal;
  if (signal != 0 && long_steps > 0) end_by(signal);
}

void note_only(int signal) { noted_signal = signal; }

struct sigaction action_of(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  return action;
}

}  // namespace

void catch_interrupts() {
  noted_signal = 0;
  has_terminal = isatty(STDERR_FILENO) == 1;
  const struct sigaction action = action_of(note);
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT}) sigaction(signal, &action, nullptr);
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  const struct sigaction at_alarm = action_of(end);
  sigaction(SIGALRM, &at_alarm, nullptr);
  has_alarm = true;
}

LongStep::LongStep() {
  ++long_steps;
  if (has_alarm && noted_signal != 0) alarm(kPatience);
}

LongStep::~LongStep() {
  if (--long_steps == 0 && has_alarm) alarm(0);
}

NotedInterrupts::NotedInterrupts() {
  noted_signal = 0;
  const struct sigaction action = action_of(note_only);
  sigaction(SIGINT, &action, &before_);
}

NotedInterrupts::~NotedInterrupts() {
  sigaction(SIGINT, &before_, nullptr);
  const bool unanswered = noted_signal != 0 && std::uncaught_exceptions() == 0;
  noted_signal = 0;
  if (unanswered) std::raise(SIGINT);
}

AnsweredInterrupts::AnsweredInterrupts(Stops stops) : stops_(std::move(stops)) {
  asked_before_ = std::exchange(asked_host, &stops_);
  waits_before_ = waits_for_host.exchange(true);
  noted_signal = 0;
  const struct sigaction action = action_of(note_only);
  sigaction(SIGINT, &action, &before_);
}

AnsweredInterrupts::~AnsweredInterrupts() {
  sigaction(SIGINT, &before_, nullptr);
  const bool is_answered = !waits_for_host;
  asked_host = asked_before_;
  waits_for_host = waits_before_;
  if (noted_signal.exchange(0) != 0 && !is_answered) std::raise(SIGINT);
}

bool interrupted() { return stops(); }

void forget_interrupt() { noted_signal = 0; }

void throw_if_interrupted() {
  if (!stops()) return;
  switch (noted_signal) {
    case SIGTERM:
      throw Interrupted("stopped by SIGTERM");
    case SIGQUIT:
      throw Interrupted("stopped by SIGQUIT");
    case SIGHUP:
      throw Interrupted("stopped: the terminal is gone (SIGHUP)");
    default:
      throw Interrupted("stopped by Ctrl-C");
  }
}

}  // namespace chladni
