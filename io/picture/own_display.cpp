#include "io/picture/own_display.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace chladni::picture {
namespace {

constexpr int kPatience = 30'000;  // [ms]

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::generic_category().message(errno));
}

std::string counted(std::string_view bytes) {
  const auto size = static_cast<unsigned>(bytes.size());
  return {std::string{static_cast<char>(size >> 8U), static_cast<char>(size & 0xffU)} +
          std::string(bytes)};
}

// One entry of an Xauthority file: family "any", no address, any display, a random cookie.
std::string admission() {
  std::array<char, 16> cookie{};
  if (getrandom(cookie.data(), cookie.size(), 0) != static_cast<ssize_t>(cookie.size())) {
    fail("no random bytes");
  }
  return "\xff\xff" + counted("") + counted("") + counted("MIT-MAGIC-COOKIE-1") +
         counted({cookie.data(), cookie.size()});
}

// Makes a file without a name, which exists as long as a process has it open. Returns its path,
// which is the same in a child process.
std::string nameless_file(const std::string& content, Descriptor& file) {
  file.hold(memfd_create("xauthority", 0));
  if (file.number() < 0) fail("no memory for the display's cookie");
  if (write(file.number(), content.data(), content.size()) !=
      static_cast<ssize_t>(content.size())) {
    fail("the display's cookie cannot be written");
  }
  return "/proc/self/fd/" + std::to_string(file.number());
}

// Runs between fork and exec. The server gets its own process group: a signal that kills the
// painter's group must not kill the server before it has removed its lock.
[[noreturn]] void become_server(const char* xvfb, const char* number_to, const char* cookie,
                                pid_t parent) {
  setpgid(0, 0);
  std::signal(SIGTERM, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  execl(xvfb, "Xvfb", "-displayfd", number_to, "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
        "-auth", cookie, nullptr);
  _exit(127);
}

// The line that the server writes when it is ready: the number of its display.
std::string line_from(int end) {
  std::string line;
  while (!line.ends_with('\n')) {
    pollfd ready{end, POLLIN, 0};
    char next = 0;
    const int count = poll(&ready, 1, kPatience);
    if (count < 0 && errno == EINTR) continue;
    if (count != 1 || read(end, &next, 1) != 1) {
      throw std::runtime_error("Xvfb gave no display; is its package whole (xvfb)?");
    }
    line.push_back(next);
  }
  line.pop_back();
  return line;
}

}  // namespace

OwnDisplay::OwnDisplay(const std::string& xvfb) {
  const std::string cookie = nameless_file(admission(), cookie_);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) fail("no pipe to Xvfb");
  const Descriptor from_server(ends[0]);
  Descriptor to_us(ends[1]);
  const std::string number_to = std::to_string(ends[1]);
  const pid_t parent = getpid();
  server_ = fork();
  if (server_ == 0) become_server(xvfb.c_str(), number_to.c_str(), cookie.c_str(), parent);
  if (server_ < 0) fail("Xvfb could not start");
  static_cast<void>(to_us.close());
  try {
    setenv("DISPLAY", (":" + line_from(from_server.number())).c_str(), 1);
  } catch (...) {
    end();
    throw;
  }
  setenv("XAUTHORITY", cookie.c_str(), 1);
}

OwnDisplay::~OwnDisplay() { end(); }

void OwnDisplay::end() const {
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
}

}  // namespace chladni::picture
