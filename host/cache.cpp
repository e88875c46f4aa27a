#include "host/cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <new>
#include <system_error>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "host/folder.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "chladni cache 1\n";
constexpr const char* kEnding = ".kept";
constexpr std::uintmax_t kGigabyte = 1000000000;
constexpr std::uintmax_t kMostBytes = 4 * kGigabyte;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// The head of an entry: whose it is and what its bytes are.
std::string head_of(const std::string& name, std::string_view content) {
  return fmt::format("{}{}\n{}\n{}\n", kMagic, name, content.size(), sha256(content));
}

struct Kept {
  fs::path file;
  std::uintmax_t bytes = 0;
  fs::file_time_type used;
};

// Temporary files of a process that was killed while it wrote.
bool is_left_over(const fs::path& file, fs::file_time_type written) {
  constexpr auto long_ago = std::chrono::hours(24);
  return file.filename().string().starts_with(".") &&
         fs::file_time_type::clock::now() - written > long_ago;
}

// The files with our ending; files that vanish meanwhile are left out.
std::vector<Kept> kept_in(const fs::path& folder) {
  std::vector<Kept> list;
  for (const auto& file : entries_of(folder)) {
    if (file.extension() != kEnding) continue;
    std::error_code gone;
    Kept one{file, fs::file_size(file, gone), {}};
    if (!gone) one.used = fs::last_write_time(file, gone);
    if (!gone && fs::is_regular_file(file, gone)) list.push_back(std::move(one));
  }
  return list;
}

bool is_entry(const Kept& one) { return !one.file.filename().string().starts_with("."); }

void make_private_folder(const fs::path& folder) {
  if (fs::is_directory(folder)) return;
  fs::create_directories(folder);
  fs::permissions(folder, fs::perms::owner_all);
}

}  // namespace

CachePlace cache_place() {
  CachePlace place{.folder = {}, .most_bytes = kMostBytes, .note = {}};
  const auto size = variable("CHLADNI_CACHE_GB");
  double gigabytes = 0.0;
  const auto [end, fault] = std::from_chars(size.data(), size.data() + size.size(), gigabytes);
  const bool is_size = fault == std::errc() && end == size.data() + size.size() &&
                       gigabytes > 0.0 && gigabytes < 1e9;
  if (is_size) {
    place.most_bytes = static_cast<std::uintmax_t>(gigabytes * static_cast<double>(kGigabyte));
  } else if (!size.empty()) {
    place.note = "CHLADNI_CACHE_GB is \"" + size + "\", expected a number of GB; 4 are used";
  }
  const auto chosen = variable("CHLADNI_CACHE");
  if (chosen == "off") return place;
  if (!chosen.empty()) {
    if (fs::path(chosen).is_absolute()) {
      place.folder = chosen;
    } else {
      place.note = "CHLADNI_CACHE is \"" + chosen +
                   "\", expected an absolute path or \"off\"; nothing is kept for later runs";
    }
    return place;
  }
  const fs::path xdg = variable("XDG_CACHE_HOME");
  const fs::path home = variable("HOME");
  if (xdg.is_absolute()) {  // a relative one is to be ignored, says the XDG specification
    place.folder = xdg / "chladni";
  } else if (home.is_absolute()) {
    place.folder = home / ".cache" / "chladni";
  }
  return place;
}

Cache::Cache(fs::path folder, std::uintmax_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {}

fs::path Cache::file_of(const std::string& name) const { return folder_ / (name + kEnding); }

std::optional<std::string> Cache::content(const std::string& name) const {
  const auto file = file_of(name);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  try {
    std::string bytes = read_whole(file);
    const auto head = bytes.find('\n', bytes.find('\n', bytes.find('\n', kMagic.size()) + 1) + 1);
    if (head != std::string::npos && head < 4096) {
      const std::string_view content = std::string_view(bytes).substr(head + 1);
      if (std::string_view(bytes).substr(0, head + 1) == head_of(name, content)) {
        bytes.erase(0, head + 1);
        fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
        return bytes;
      }
    }
  } catch (const InvalidInput&) {
    return {};  // removed or made unreadable meanwhile
  } catch (const OutOfResources&) {
    return {};
  } catch (const std::bad_alloc&) {
    return {};
  }
  drop(name);
  return {};
}

std::string Cache::keep(const std::string& name, std::string_view content) const {
  const auto file = file_of(name);
  try {
    const auto head = head_of(name, content);
    if (head.size() + content.size() > most_bytes_) {
      return fmt::format("{:.1f} GB is more than the limit of {:.1f} GB (CHLADNI_CACHE_GB)",
                         1e-9 * static_cast<double>(content.size()),
                         1e-9 * static_cast<double>(most_bytes_));
    }
    make_private_folder(folder_);
    write_atomically(file, [&](std::ostream& stream) { stream << head << content; });
    shrink(file);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

void Cache::drop(const std::string& name) const {
  std::error_code ignored;
  fs::remove(file_of(name), ignored);
}

void Cache::shrink(const fs::path& newest) const {
  auto list = kept_in(folder_);
  std::ranges::sort(list, {}, &Kept::used);
  std::uintmax_t all = 0;
  for (const auto& one : list) all += one.bytes;
  std::error_code ignored;
  for (const auto& one : list) {
    const bool left_over = is_left_over(one.file, one.used);
    if (!left_over && (all <= most_bytes_ || one.file == newest || !is_entry(one))) continue;
    if (fs::remove(one.file, ignored)) all -= one.bytes;
  }
}

std::vector<std::string> Cache::names(const std::string& beginning) const {
  std::vector<std::string> list;
  for (const auto& one : kept_in(folder_)) {
    auto name = one.file.stem().string();
    if (is_entry(one) && name.starts_with(beginning)) list.push_back(std::move(name));
  }
  std::ranges::sort(list);
  return list;
}

Cache::Size Cache::size() const {
  Size size;
  for (const auto& one : kept_in(folder_)) {
    size.entries += is_entry(one) ? 1 : 0;
    size.bytes += one.bytes;
  }
  return size;
}

Cache::Size Cache::clear() const {
  Size size;
  for (const auto& one : kept_in(folder_)) {
    std::error_code fault;
    if (!fs::remove(one.file, fault) && fault) {
      throw InvalidInput(one.file.string() + ": cannot be removed: " + fault.message());
    }
    size.entries += is_entry(one) ? 1 : 0;
    size.bytes += one.bytes;
  }
  return size;
}

// One byte of one file stands for each name; locks of an open file description end with it.
Cache::Hold::Hold(const Cache& cache, const std::string& name, const Progress& progress) {
  try {
    make_private_folder(cache.folder_);
  } catch (const fs::filesystem_error&) {
    return;
  }
  lock_.hold(
      open((cache.folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (lock_.number() < 0) return;
  std::uint32_t place = 0;
  const auto digits = sha256(name).substr(0, 8);
  std::from_chars(digits.data(), digits.data() + digits.size(), place, 16);
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(place);
  lock.l_len = 1;
  while (fcntl(lock_.number(), F_OFD_SETLK, &lock) != 0) {
    if (errno != EAGAIN && errno != EACCES && errno != EINTR) return;
    throw_if_interrupted();
    tell(progress, "waiting for another run that solves the same");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace chladni
