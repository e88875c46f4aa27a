// How the painter is asked.
#include "io/painted.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "base/error.h"
#include "base/worker.h"

namespace chladni::io {
namespace {

// The file that the shell would run for `name`; empty where there is none.
std::filesystem::path program_on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::string_view folders = path != nullptr ? path : "/usr/bin:/bin";
  while (!folders.empty()) {
    const std::size_t end = std::min(folders.find(':'), folders.size());
    const std::filesystem::path candidate = std::filesystem::path(folders.substr(0, end)) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    folders.remove_prefix(std::min(end + 1, folders.size()));
  }
  return {};
}

}  // namespace

// The same pixels wherever it runs: Mesa's software renderer under Xvfb where that is installed,
// whatever display and graphics card there are; else the display that there is.
std::string painted(const Message& request) {
  const std::filesystem::path painter = worker_path("chladni-painter");
  const WorkerLimits limits{.time = std::chrono::seconds(120), .memory_bytes = 0};
  const std::filesystem::path xvfb = program_on_path("xvfb-run");
  if (!xvfb.empty() && !program_on_path("xauth").empty()) {
    return run_worker(xvfb, {"-a", painter.string()}, bytes(request), limits).output;
  }
  if (std::getenv("DISPLAY") == nullptr) {
    throw WorkerDied("the painter has no display; install the packages xvfb and xauth");
  }
  return run_worker(painter, {}, bytes(request), limits).output;
}

}  // namespace chladni::io
