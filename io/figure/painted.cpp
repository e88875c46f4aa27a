// Sends requests to the painter.
#include "io/figure/painted.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "host/worker.h"

namespace chladni::io {
namespace {

constexpr std::size_t kLargestPicture = std::size_t{256} << 20U;

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

// Where Xvfb is installed, the painter uses Mesa's software renderer on an Xvfb, so the pixels are
// the same with any display and graphics card. Otherwise it uses the existing display.
std::string painted(const Message& request) {
  const std::filesystem::path painter = worker_path("chladni-painter");
  const WorkerLimits limits{
      .time = std::chrono::seconds(120), .memory_bytes = 0, .output_bytes = kLargestPicture};
  const std::filesystem::path xvfb = program_on_path("Xvfb");
  const char* display = std::getenv("DISPLAY");
  if (xvfb.empty() && (display == nullptr || *display == '\0')) {
    throw WorkerDied("the painter has no display; install the package xvfb");
  }
  const std::vector<std::string> arguments =
      xvfb.empty() ? std::vector<std::string>() : std::vector{xvfb.string()};
  std::string png = run_worker(painter, arguments, bytes(request), limits).output;
  if (!png.starts_with("\x89PNG")) {
    throw UnusableReply(
        "chladni-painter gave a reply that cannot be used: " + fmt::to_string(png.size()) +
        " bytes that are no PNG; is it of this build? (" + painter.string() + ")");
  }
  return png;
}

}  // namespace chladni::io
