// A worker that does what it should not: what is in the environment variable CHLADNI_PROBE, to the
// file in CHLADNI_PROBE_FILE. It prints how the system answers; its exit status is 1 where the
// system refused.
#include <dirent.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
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
