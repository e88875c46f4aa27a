#include "io/bytes/gzip.h"

#include <fmt/format.h>

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "base/error.h"

namespace chladni::io {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1F\x8B"); }

std::string unzipped(std::string_view bytes, std::size_t limit) {
  z_stream stream{};
  require(inflateInit2(&stream, 15 + 16) == Z_OK, "gzip: zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> ended(&stream, inflateEnd);
  std::string result;
  std::vector<char> room(1U << 18U);
  // zlib does not write to its input, and it counts at most 4 GiB at once.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  std::size_t left = bytes.size();
  for (int state = Z_OK; left > 0 || state != Z_STREAM_END;) {
    if (state == Z_STREAM_END) inflateReset(&stream);
    const auto fed =
        static_cast<uInt>(std::min<std::size_t>(left, std::numeric_limits<uInt>::max()));
    stream.avail_in = fed;
    stream.next_out = reinterpret_cast<Bytef*>(room.data());
    stream.avail_out = static_cast<uInt>(room.size());
    state = inflate(&stream, Z_NO_FLUSH);
    left -= fed - stream.avail_in;
    const std::size_t made = room.size() - stream.avail_out;
    require(state == Z_OK || state == Z_STREAM_END,
            "gzip: " + std::string(left == 0 ? "the file is cut off" : "the file is damaged"));
    require(made <= limit - result.size(),
            "gzip: more than " + fmt::to_string(limit >> 20U) + " MB when unpacked");
    result.append(room.data(), made);
  }
  return result;
}

}  // namespace chladni::io
