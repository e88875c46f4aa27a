#include "io/bytes/room.h"

#include <fmt/format.h>

#include "base/error.h"
#include "host/memory.h"

namespace chladni::io {
namespace {

// Bytes of a matrix beside its numbers: the object and the overhead of the allocator.
constexpr double kMatrix = 56.0;
constexpr double kCopies = 2.0;  // the user of a set copies a part of it

std::string megabytes(double bytes) {
  return fmt::to_string(static_cast<long long>(bytes / 1048576.0) + 1) + " MB";
}

}  // namespace

std::size_t reading_limit() { return available_memory() / 2; }

std::size_t text_limit(std::size_t limit) { return limit / 4; }

std::size_t mat_limit(std::size_t limit) { return limit / 6; }

void require_room(double bytes, std::size_t limit, const std::string& what) {
  require(bytes <= static_cast<double>(limit),
          what + " need " + megabytes(bytes) + " of memory, there are " +
              fmt::to_string(limit >> 20U) + " MB for them; read fewer at a time");
}

void require_room(const modal::FrfSet& set, Eigen::Index lines, int parts, std::size_t limit) {
  const double cells =
      static_cast<double>(set.output_count()) * static_cast<double>(set.input_count());
  const double each = kMatrix + 16.0 * cells + parts * (kMatrix + 8.0 * cells);
  require_room(kCopies * each * static_cast<double>(lines), limit,
               fmt::to_string(set.output_count()) + " outputs by " +
                   fmt::to_string(set.input_count()) + " inputs on " + fmt::to_string(lines) +
                   " lines");
}

void require_channels(Eigen::Index count, const std::string& side) {
  require(count <= kMostChannels, fmt::to_string(count) + " " + side + ", expected at most " +
                                      fmt::to_string(kMostChannels));
}

}  // namespace chladni::io
