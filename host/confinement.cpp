#include "host/confinement.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/descriptor.h"
#include "host/limits/call_filter.h"

namespace chladni {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kCallsAreOfSanitizer = true;
#else
constexpr bool kCallsAreOfSanitizer = false;
#endif

constexpr rlim_t kMostOpenFiles = 64;

// Landlock's rights by the version that brought them; the headers of Debian 12 know two.
constexpr std::uint64_t kReadFile = LANDLOCK_ACCESS_FS_READ_FILE;
constexpr std::uint64_t kReadFolder = kReadFile | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kRunFolder = kReadFolder | LANDLOCK_ACCESS_FS_EXECUTE;

std::uint64_t file_rights(int version) {
  const int count = version >= 5 ? 16 : version >= 3 ? 15 : version == 2 ? 14 : 13;
  return (std::uint64_t{1} << static_cast<unsigned>(count)) - 1;
}

// struct landlock_ruleset_attr of version 6. A kernel takes it if what it does not know is 0.
struct Rights {
  std::uint64_t files = 0, network = 0, scoped = 0;
};

int landlock_version() {
  const long version =
      syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

bool filter_is_there() {
  const std::uint32_t action = SECCOMP_RET_KILL_PROCESS;
  return kHasCallFilter && syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

// Allows what is at the path, if it is there.
void allow(int rules, const std::filesystem::path& path, std::uint64_t rights) {
  const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0) return;
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored))
    rights &= ~std::uint64_t{LANDLOCK_ACCESS_FS_READ_DIR};
  const landlock_path_beneath_attr rule{rights, place};
  syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  close(place);
}

void allow_programs(int rules, const std::filesystem::path& program) {
  for (const char* folder : {"/usr", "/lib", "/lib32", "/lib64", "/bin"}) {
    allow(rules, folder, kRunFolder);
  }
  allow(rules, program, kReadFile | LANDLOCK_ACCESS_FS_EXECUTE);
  allow(rules, std::filesystem::absolute(program).parent_path(), kRunFolder);
  const char* libraries = std::getenv("LD_LIBRARY_PATH");
  for (std::string_view rest = libraries == nullptr ? "" : libraries; !rest.empty();) {
    const auto end = std::min(rest.find(':'), rest.size());
    if (end > 0) allow(rules, rest.substr(0, end), kReadFolder);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (const char* file :
       {"/etc/ld.so.cache", "/etc/ld.so.preload", "/etc/localtime", "/proc/cpuinfo",
        "/proc/meminfo", "/proc/stat", "/dev/null", "/dev/urandom", "/dev/zero"}) {
    allow(rules, file, kReadFile);
  }
  allow(rules, "/sys/devices/system", kReadFolder);
}

// Leaves `rules` without a number where the kernel refuses.
void make_file_rules(Descriptor& rules, int version, const std::filesystem::path& program,
                     const std::vector<std::filesystem::path>& files) {
  Rights handled{.files = file_rights(version)};
  if (version >= 4) handled.network = 3;  // bind and connect of TCP
  if (version >= 6) handled.scoped = 3;   // abstract local sockets and signals
  rules.hold(above_standard(
      static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0))));
  if (rules.number() < 0) return;
  allow_programs(rules.number(), program);
  for (const auto& file : files) allow(rules.number(), file, kReadFile);
}

// Lowers a limit of this process. One that its parent has set lower stays as it is: without a
// privilege no process may raise it.
bool limit(decltype(RLIMIT_CPU) what, rlim_t soft, rlim_t hard) {
  rlimit now = {};
  if (getrlimit(what, &now) != 0) return false;
  const rlim_t most = std::min(hard, now.rlim_max);
  const rlimit lower = {std::min({soft, most, now.rlim_cur}), most};
  return setrlimit(what, &lower) == 0;
}

}  // namespace

ConfinementSupport confinement_support() {
  if (kCallsAreOfSanitizer) return {};
  return {landlock_version(), filter_is_there()};
}

std::string ConfinementSupport::text() const {
  const std::string files = landlock > 0 ? "no files but theirs" : "";
  const std::string calls = has_filter ? "no network, no other processes" : "";
  const std::string missing = landlock == 0 && !has_filter ? "Landlock and seccomp"
                              : landlock == 0              ? "Landlock"
                                                           : "seccomp";
  const std::string held = calls + (calls.empty() || files.empty() ? "" : ", ") + files;
  if (landlock > 0 && has_filter) return held;
  return (held.empty() ? "limits of time, memory and size alone" : held) + "; this system has no " +
         missing;
}

Confinement::Confinement(const std::filesystem::path& program,
                         const std::vector<std::filesystem::path>& files,
                         std::chrono::seconds processor_time)
    : processor_time_(processor_time) {
  const auto support = confinement_support();
  if (support.landlock > 0) make_file_rules(files_, support.landlock, program, files);
  if (support.has_filter) filter_ = call_filter();
}

bool Confinement::apply() noexcept {
  const auto seconds = static_cast<rlim_t>(processor_time_.count());
  syscall(SYS_close_range, 3, ~0U, CLOSE_RANGE_CLOEXEC);  // what the parent has open
  bool holds =
      prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && limit(RLIMIT_CPU, seconds, seconds + 1);
  if (kCallsAreOfSanitizer) return holds;
  holds =
      holds && limit(RLIMIT_NOFILE, kMostOpenFiles, kMostOpenFiles) && limit(RLIMIT_FSIZE, 0, 0);
  if (files_.number() >= 0)
    holds = holds && syscall(SYS_landlock_restrict_self, files_.number(), 0) == 0;
  if (filter_.empty()) return holds;
  set_own_process(filter_, static_cast<std::uint32_t>(getpid()));
  const sock_fprog program{static_cast<unsigned short>(filter_.size()), filter_.data()};
  return holds && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

}  // namespace chladni
