// A worker that does what it should not: what is in the environment variable CHLADNI_PROBE, to the
// file in CHLADNI_PROBE_FILE. It prints how the system answers; its exit status is 1 where the
// system refused.
#include <asm/sockios.h>
#include <dirent.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <thread>

namespace {

std::string file() {
  const char* name = std::getenv("CHLADNI_PROBE_FILE");
  return name == nullptr ? "" : name;
}

int opened(const std::string& name, int flags) { return open(name.c_str(), flags, 0600); }

// Returns the number of files that can be open, less the three that are.
int most_files() {
  int count = 0;
  while (opened("/dev/null", O_RDONLY) >= 0) ++count;
  std::printf("%d files\n", count);
  return 0;
}

int more_files() {
  const rlimit more = {1000, 1000};
  return setrlimit(RLIMIT_NOFILE, &more);
}

// Limits for this process, which go to the system by an address whose low half is 0.
int limits_by_address() {
  void* const wanted = reinterpret_cast<void*>(std::uintptr_t{0x5500000000});
  void* const page = mmap(wanted, sizeof(rlimit), PROT_READ | PROT_WRITE,
                          MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
  if (page != wanted) return 0;  // no such test here: it looks like a success, and fails
  return prlimit(0, RLIMIT_MSGQUEUE, static_cast<rlimit*>(page), nullptr);
}

int limits_of_parent() {
  rlimit now = {};
  return prlimit(getppid(), RLIMIT_MSGQUEUE, nullptr, &now);
}

int own_limits() {
  rlimit now = {};
  return getrlimit(RLIMIT_NOFILE, &now) + prlimit(getpid(), RLIMIT_NOFILE, nullptr, &now);
}

int processors_of(pid_t process) {
  cpu_set_t all;
  return sched_getaffinity(0, sizeof all, &all) == 0 ? sched_setaffinity(process, sizeof all, &all)
                                                     : -1;
}

int scheduler_of(pid_t process) {
  const sched_param none = {};
  return sched_setscheduler(process, SCHED_OTHER, &none);
}

int owner_by_structure() {
  const f_owner_ex owner = {F_OWNER_PID, getppid()};
  return fcntl(STDOUT_FILENO, F_SETOWN_EX, &owner);
}

int owner_by_ioctl() {
  const pid_t owner = getppid();
  // A pipe has no such call; what matters is whether the system was asked.
  return ioctl(STDOUT_FILENO, FIOSETOWN, &owner) == 0 || errno == ENOTTY ? 0 : -1;
}

int thread() {
  std::thread([] { std::puts("a thread"); }).join();
  return 0;
}

const std::map<std::string, std::function<int()>> kDeeds{
    {"socket", [] { return socket(AF_INET, SOCK_STREAM, 0); }},
    {"local_socket", [] { return socket(AF_UNIX, SOCK_STREAM, 0); }},
    {"fork", [] { return fork(); }},
    {"shell", [] { return std::system("true"); }},
    {"signal", [] { return kill(getppid(), SIGTERM); }},
    {"read", [] { return opened(file(), O_RDONLY); }},
    {"write", [] { return opened(file(), O_WRONLY); }},
    {"create", [] { return opened(file(), O_WRONLY | O_CREAT | O_TRUNC); }},
    {"remove", [] { return unlink(file().c_str()); }},
    {"list", [] { return opendir(file().c_str()) == nullptr ? -1 : 0; }},
    {"environment",
     [] { return opened("/proc/" + std::to_string(getppid()) + "/environ", O_RDONLY); }},
    {"files", most_files},
    {"more_files", more_files},
    {"limits_by_address", limits_by_address},
    {"limits_of_parent", limits_of_parent},
    {"own_limits", own_limits},
    {"processors_of_parent", [] { return processors_of(getppid()); }},
    {"own_processors", [] { return processors_of(0) + processors_of(getpid()); }},
    {"scheduler_of_parent", [] { return scheduler_of(getppid()); }},
    {"own_scheduler", [] { return scheduler_of(0); }},
    {"owner_of_pipe", [] { return fcntl(STDOUT_FILENO, F_SETOWN, getppid()); }},
    {"owner_by_structure", owner_by_structure},
    {"owner_by_ioctl", owner_by_ioctl},
    {"signal_of_pipe", [] { return fcntl(STDOUT_FILENO, F_SETSIG, SIGTERM); }},
    {"no_waiting", [] { return fcntl(STDIN_FILENO, F_SETFL, O_NONBLOCK); }},
    {"thread", thread},
    {"abort", []() -> int { std::abort(); }},
};

}  // namespace

int main() {
  const char* name = std::getenv("CHLADNI_PROBE");
  const auto deed = kDeeds.find(name == nullptr ? "" : name);
  if (deed == kDeeds.end()) return 2;
  const int result = deed->second();
  if (result >= 0) {
    std::puts("done");
    return 0;
  }
  std::fprintf(stderr, "refused: %s\n", std::strerror(errno));
  return 1;
}
