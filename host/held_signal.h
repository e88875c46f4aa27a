// Turns a signal that a write raises in its own thread into an error number.
#pragma once

#include <csignal>
#include <ctime>

#include <pthread.h>

namespace chladni {

/// While an object of this class lives, a `signal` (SIGPIPE, SIGXFSZ) from this thread's writes
/// does not end the process; the write fails with EPIPE or EFBIG. A signal raised meanwhile is
/// discarded.
class HeldSignal {
 public:
  explicit HeldSignal(int signal) {
    sigemptyset(&held_);
    sigaddset(&held_, signal);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, signal) == 1;
    pthread_sigmask(SIG_BLOCK, &held_, &before_);
  }
  ~HeldSignal() {
    const timespec at_once = {};
    if (!was_pending_) sigtimedwait(&held_, nullptr, &at_once);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  HeldSignal(const HeldSignal&) = delete;
  HeldSignal& operator=(const HeldSignal&) = delete;
  HeldSignal(HeldSignal&&) = delete;
  HeldSignal& operator=(HeldSignal&&) = delete;

 private:
  sigset_t held_ = {};
  sigset_t before_ = {};
  bool was_pending_ = false;
};

}  // namespace chladni
