#include "base/interrupt.h"

#include <atomic>
#include <csignal>

#include "base/error.h"

namespace chladni {
namespace {

std::atomic<int> noted_signal = 0;  // lock-free, so the handler may write it
static_assert(std::atomic<int>::is_always_lock_free);

void note(int signal) {
  if (noted_signal.exchange(signal) == 0) return;
  std::signal(signal, SIG_DFL);  // the second one: delivered again, and final, on return
  std::raise(signal);
}

}  // namespace

void catch_interrupts() {
  noted_signal = 0;
  struct sigaction action = {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return noted_signal != 0; }

void forget_interrupt() { noted_signal = 0; }

void throw_if_interrupted() {
  switch (noted_signal) {
    case 0:
      return;
    case SIGTERM:
      throw Interrupted("stopped by SIGTERM");
    default:
      throw Interrupted("stopped by Ctrl-C");
  }
}

}  // namespace chladni
