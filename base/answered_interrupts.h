// Ctrl-C for a host that decides itself what it means.
#pragma once

#include <csignal>
#include <functional>

namespace chladni {

/// For a host such as Python whose user has set a handler of his own. While an object of this class
/// lives, SIGINT is noted, and the host is asked what it means when the work next looks for a
/// signal in the thread that made the object: throw_if_interrupted() and interrupted(). Other
/// threads go on until the host has answered. Afterwards the handler before is back; it gets a
/// signal that came too late to be asked about. Objects may be nested.
class AnsweredInterrupts {
 public:
  /// Whether the work stops. It may not throw. It is called once for each signal that was noted,
  /// where two that come before it is called are one.
  using Stops = std::function<bool()>;

  explicit AnsweredInterrupts(Stops stops);
  ~AnsweredInterrupts();
  AnsweredInterrupts(const AnsweredInterrupts&) = delete;
  AnsweredInterrupts& operator=(const AnsweredInterrupts&) = delete;
  AnsweredInterrupts(AnsweredInterrupts&&) = delete;
  AnsweredInterrupts& operator=(AnsweredInterrupts&&) = delete;

 private:
  Stops stops_;
  const Stops* asked_before_ = nullptr;
  bool waits_before_ = false;
  struct sigaction before_ = {};
};

}  // namespace chladni
