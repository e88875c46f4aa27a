// Sends requests to the painter.
#include "io/figure/painted.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "host/worker.h"
#include "io/bytes/gzip.h"

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

void append_word(std::string& bytes, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    bytes += static_cast<char>((value >> shift) & 0xFFU);
  }
}

// The PNG with its resolution (chunk pHYs), which stands behind the header of 33 bytes.
std::string with_resolution(std::string png, double dpi) {
  constexpr std::size_t kHeader = 33;
  require(png.size() > kHeader, "a PNG without a header");
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
  std::string content = "pHYs";
  append_word(content, per_metre);
  append_word(content, per_metre);
  content += '\1';  // the unit is the metre
  std::string chunk;
  append_word(chunk, 9);
  chunk += content;
  append_word(chunk, checksum(content));
  return png.insert(kHeader, chunk);
}

void require_paintable(const Drawing& drawing, const Print& print, double finer) {
  const Eigen::Vector2d exact = finer * drawing.pixels();
  const Eigen::Vector2d size = drawing.pixels(finer);
  if (size.maxCoeff() <= kLongestPicture && exact.prod() <= kMostPixels) return;
  const double part =
      std::min(kLongestPicture / size.maxCoeff(), std::sqrt(kMostPixels / exact.prod()));
  throw InvalidInput(fmt::format(
      "a picture of {:.0f} x {:.0f} px, expected at most {:.0f} along a side and {:.0f} "
      "million in all: at {:.6g} mm at most {:.0f} dpi",
      size.x(), size.y(), kLongestPicture, kMostPixels / 1e6, print.width_mm,
      std::floor(part * print.dpi)));
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

void leave_drawing(const PictureFile& file, const Drawing& drawing) {
  const auto& print = file.print();
  const double finer = print ? print->width_mm / 25.4 * print->dpi / drawing.width() : 1.0;
  if (print && print->png) require_paintable(drawing, *print, finer);
  file.leave_vectors([&] { return drawing.svg(print ? print->width_mm : 0.0); });
  if (!print) {
    file.paint([request = drawing.request()] { return painted(request); });
  } else if (print->png) {
    file.paint([request = drawing.request(finer), dpi = print->dpi] {
      return with_resolution(painted(request), dpi);
    });
  }
}

}  // namespace chladni::io
