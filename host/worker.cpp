#include "host/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "base/interrupt.h"
#include "host/confinement.h"
#include "host/descriptor.h"
#include "host/held_signal.h"
#include "host/memory.h"
#include "host/unless_interrupted.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kErrorsKept = std::size_t{64} << 10U;
// The output limit is at least this size, even where little memory is left.
constexpr std::size_t kLeastOutput = std::size_t{1} << 20U;
constexpr int kLibrariesMissing = 127;  // exit status of the dynamic linker
// No wait status is −1: an end that the system did not tell, or told to another waiter.
constexpr int kUnknownEnd = -1;
static_assert(!WIFEXITED(kUnknownEnd) && !WIFSIGNALED(kUnknownEnd));

struct Pipe {
  Descriptor read_end, write_end;

  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw OutOfResources("no pipe to a worker: " + reason(errno));
    }
    read_end.hold(above_standard(ends[0]));
    write_end.hold(above_standard(ends[1]));
    if (read_end.number() < 0 || write_end.number() < 0) {
      throw OutOfResources("no pipe to a worker: " + reason(errno));
    }
  }
};

void shut(Descriptor& end) { static_cast<void>(end.close()); }

struct Pipes {
  Pipe input, output, errors;
  Pipe start;  // carries the error number of a failed exec; a successful exec closes it
};

// Sanitizers reserve terabytes of addresses, so a worker with a limit could not start.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// Between fork and exec only calls that are safe in a signal handler are allowed.
[[noreturn]] void become(char* const* arguments, const Pipes& pipes, const WorkerLimits& limits,
                         Confinement* confinement, pid_t parent) {
  setpgid(0, 0);  // so that the processes which the worker starts can be ended with it
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ, SIGXCPU, SIGCHLD})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const rlimit memory = {limits.memory_bytes, limits.memory_bytes};
  if (limits.memory_bytes > 0 && !kSanitized) setrlimit(RLIMIT_AS, &memory);
  dup2(pipes.input.read_end.number(), STDIN_FILENO);
  dup2(pipes.output.write_end.number(), STDOUT_FILENO);
  dup2(pipes.errors.write_end.number(), STDERR_FILENO);
  const bool is_confined = confinement == nullptr || confinement->apply();
  if (is_confined) execv(arguments[0], arguments);
  const int error = errno;
  static_cast<void>(!write(pipes.start.write_end.number(), &error, sizeof error));
  _exit(127);
}

// The worker process. At the end of the scope it is killed with all processes that it started, and
// waited for.
class Worker {
 public:
  Worker(const fs::path& program, const std::vector<std::string>& arguments, Pipes& pipes,
         const WorkerLimits& limits, Confinement* confinement)
      : grace_(limits.grace) {
    std::string name = program.string();
    std::vector<std::string> copies = arguments;
    std::vector<char*> pointers = {name.data()};
    for (auto& copy : copies) pointers.push_back(copy.data());
    pointers.push_back(nullptr);
    const pid_t parent = getpid();
    process_ = fork();
    if (process_ == 0) become(pointers.data(), pipes, limits, confinement, parent);
    if (process_ < 0) {
      throw WorkerDied(program.filename().string() +
                       " could not start: " + std::generic_category().message(errno));
    }
    shut(pipes.input.read_end);
    shut(pipes.output.write_end);
    shut(pipes.errors.write_end);
    shut(pipes.start.write_end);
    setpgid(process_, process_);  // both processes call this; either may be first
  }
  ~Worker() {
    if (status_) return;
    if (grace_.count() > 0) wait_for_own_end();
    if (status_) return;
    kill(-process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  Worker(Worker&&) = delete;
  Worker& operator=(Worker&&) = delete;

  // The wait status once the process has ended. Its remaining child processes are killed then.
  std::optional<int> status() {
    if (status_) return status_;
    int status = 0;
    const pid_t ended = waitpid(process_, &status, WNOHANG);
    if (ended == process_ || (ended < 0 && errno == ECHILD)) {
      status_ = ended == process_ ? status : kUnknownEnd;
      kill(-process_, SIGKILL);
    }
    return status_;
  }

 private:
  void wait_for_own_end() {
    kill(-process_, SIGTERM);
    for (const auto end = Clock::now() + grace_; !status() && Clock::now() < end;) {
      usleep(10'000);
    }
  }

  std::chrono::milliseconds grace_;
  pid_t process_ = -1;
  std::optional<int> status_;
};

void refuse_failed_start(const fs::path& program, int start) {
  int error = 0;
  const auto count = unless_interrupted([&] { return read(start, &error, sizeof error); });
  if (count != sizeof error) return;
  throw WorkerDied(program.filename().string() + " could not start (" + program.string() +
                   "): " + std::generic_category().message(error));
}

// The text without the colour sequences of a terminal (ESC [ ... letter).
std::string uncoloured(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\033') {
      plain += text[i];
      continue;
    }
    if (i + 1 < text.size() && text[i + 1] == '[') ++i;
    while (i + 1 < text.size() && (text[i + 1] < '@' || text[i + 1] > '~')) ++i;
    ++i;
  }
  return plain;
}

std::string last_line(std::string_view errors) {
  const std::string text = uncoloured(errors);
  const auto end = text.find_last_not_of(" \t\r\n");
  if (end == std::string::npos) return {};
  const auto before = text.find_last_of('\n', end);
  const auto begin = before == std::string::npos ? 0 : before + 1;
  return ": " + text.substr(begin, end + 1 - begin);
}

// Moves bytes through the pipes without waiting.
class Talk {
 public:
  Talk(const std::string& worker, Pipes& pipes, std::string_view input, std::size_t output_bytes)
      : worker_(worker), pipes_(pipes), left_(input), output_bytes_(output_bytes) {
    for (const auto* end :
         {&pipes.input.write_end, &pipes.output.read_end, &pipes.errors.read_end}) {
      fcntl(end->number(), F_SETFL, O_NONBLOCK);
    }
    if (left_.empty()) shut(pipes_.input.write_end);
  }

  void wait(int milliseconds) {
    std::array<pollfd, 3> ends = {pollfd{pipes_.input.write_end.number(), POLLOUT, 0},
                                  pollfd{pipes_.output.read_end.number(), POLLIN, 0},
                                  pollfd{pipes_.errors.read_end.number(), POLLIN, 0}};
    poll(ends.data(), ends.size(), milliseconds);
  }

  // Returns whether any bytes moved.
  bool exchange() {
    const bool wrote = give();
    const bool read_output = take(pipes_.output.read_end, result_.output);
    if (result_.output.size() > output_bytes_) {
      throw UnusableReply(worker_ + " was stopped: it wrote more than the " +
                          std::to_string(output_bytes_) + " bytes that its reply may have" +
                          last_line(result_.errors));
    }
    const bool read_errors = take(pipes_.errors.read_end, result_.errors);
    if (result_.errors.size() > 2 * kErrorsKept) trim_errors();
    return wrote || read_output || read_errors;
  }

  [[nodiscard]] bool over() const {
    return pipes_.output.read_end.number() < 0 && pipes_.errors.read_end.number() < 0;
  }
  WorkerResult result() {
    trim_errors();
    return std::move(result_);
  }

 private:
  void trim_errors() {
    if (result_.errors.size() > kErrorsKept) {
      result_.errors.erase(0, result_.errors.size() - kErrorsKept);
    }
  }

  bool give() {
    if (pipes_.input.write_end.number() < 0) return false;
    const auto count = unless_interrupted(
        [&] { return ::write(pipes_.input.write_end.number(), left_.data(), left_.size()); });
    if (count > 0) left_.remove_prefix(static_cast<std::size_t>(count));
    // EPIPE: the worker does not read the rest. Its exit status shows whether that is an error.
    if (left_.empty() || (count < 0 && errno != EAGAIN)) {
      shut(pipes_.input.write_end);
    }
    return count > 0;
  }

  bool take(Descriptor& end, std::string& into) try {
    if (end.number() < 0) return false;
    const auto count =
        unless_interrupted([&] { return ::read(end.number(), block_.data(), block_.size()); });
    if (count < 0 && errno != EAGAIN) {
      throw WorkerDied("what " + worker_ + " writes cannot be read: " + reason(errno));
    }
    if (count > 0) into.append(block_.data(), static_cast<std::size_t>(count));
    if (count == 0) shut(end);
    return count > 0;
  } catch (const std::bad_alloc&) {
    throw OutOfResources("no memory for what " + worker_ + " writes after " +
                         std::to_string(into.size()) + " bytes");
  }

  const std::string& worker_;
  Pipes& pipes_;
  std::string_view left_;
  std::size_t output_bytes_;
  WorkerResult result_;
  std::array<char, 65536> block_;
};

void refuse_bad_end(const std::string& name, int status, const std::string& errors) {
  if (status == kUnknownEnd) {
    throw WorkerDied("how " + name +
                     " ended is not known: the process that started it ignores SIGCHLD, or "
                     "something in it waits for the children of others" +
                     last_line(errors));
  }
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGSYS) {
      throw ForbiddenCall(
          name +
          " was stopped: it tried what no reader of a file may do, such as to reach "
          "the network or to start another program" +
          last_line(errors));
    }
    if (signal == SIGXCPU) throw WorkerDied(name + " was stopped: it used all its processor time");
    if (signal == SIGXFSZ) throw ForbiddenCall(name + " was stopped: it tried to write to a file");
    throw WorkerDied(name + " died: signal " + std::to_string(signal) + " (" + strsignal(signal) +
                     ")" + last_line(errors));
  }
  if (WEXITSTATUS(status) != 0) {
    throw WorkerDied(name + " failed: exit status " + std::to_string(WEXITSTATUS(status)) +
                     last_line(errors));
  }
}

// All processors may work for it during its whole time.
std::chrono::seconds processor_time(const WorkerLimits& limits) {
  return limits.time * std::max(1U, std::thread::hardware_concurrency());
}

struct Ended {
  WorkerResult result;
  int status = 0;  // from waitpid, or kUnknownEnd
};

Ended ended_worker(const fs::path& program, const std::vector<std::string>& arguments,
                   std::string_view input, const WorkerLimits& limits) {
  const HeldSignal held(SIGPIPE);
  const auto deadline = Clock::now() + limits.time;
  const std::string name = program.filename().string();
  const std::size_t room = std::max(available_memory() / 4, kLeastOutput);
  std::optional<Confinement> confinement;
  if (limits.confined) confinement.emplace(program, limits.files, processor_time(limits));
  Pipes pipes;
  Worker worker(program, arguments, pipes, limits, confinement ? &*confinement : nullptr);
  refuse_failed_start(program, pipes.start.read_end.number());
  Talk talk(name, pipes, input, std::min(limits.output_bytes, room));
  const auto refuse_late = [&] {
    if (Clock::now() < deadline) return;
    throw WorkerDied(name + " was stopped: not done within " + std::to_string(limits.time.count()) +
                     " s" + last_line(talk.result().errors));
  };
  std::optional<int> status;
  while (!status) {
    throw_if_interrupted();
    refuse_late();
    // Closed pipes cannot wake this thread. The worker is then about to end, so check often.
    talk.wait(talk.over() ? 1 : 50);
    talk.exchange();
    status = worker.status();
  }
  while (talk.exchange()) refuse_late();  // the bytes that it wrote just before its end
  return {talk.result(), *status};
}

}  // namespace

WorkerResult run_worker(const fs::path& program, const std::vector<std::string>& arguments,
                        std::string_view input, const WorkerLimits& limits) {
  Ended ended = ended_worker(program, arguments, input, limits);
  refuse_bad_end(program.filename().string(), ended.status, ended.result.errors);
  return std::move(ended.result);
}

WorkerResult run_program(const fs::path& program, const std::vector<std::string>& arguments,
                         int& status, const WorkerLimits& limits) {
  Ended ended = ended_worker(program, arguments, "", limits);
  if (!WIFEXITED(ended.status)) {
    refuse_bad_end(program.filename().string(), ended.status, ended.result.errors);
  }
  status = WEXITSTATUS(ended.status);
  return std::move(ended.result);
}

void try_worker(const fs::path& program, bool confined) {
  const Ended ended =
      ended_worker(program, {}, "", {.time = std::chrono::seconds(10), .confined = confined});
  const bool answered = WIFEXITED(ended.status) && WEXITSTATUS(ended.status) != kLibrariesMissing;
  if (!answered) refuse_bad_end(program.filename().string(), ended.status, ended.result.errors);
}

}  // namespace chladni
