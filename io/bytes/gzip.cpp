#include "io/bytes/gzip.h"

#include <fmt/format.h>

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace chladni::io {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18U;

}  // namespace

/// zlib on its way through one gzip file, or through several one after the other.
class Inflation {
 public:
  Inflation() { require(inflateInit2(&stream_, 15 + 16) == Z_OK, "gzip: zlib does not start"); }
  ~Inflation() { inflateEnd(&stream_); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;
  Inflation(Inflation&&) = delete;
  Inflation& operator=(Inflation&&) = delete;

  /// Whether nothing is open: the last of the files has ended.
  [[nodiscard]] bool is_over() const { return state_ == Z_STREAM_END; }

  /// Unpacks the begin of `packed`, which it takes away. Returns the number of bytes made: none of
  /// the zeros with which the end may be padded.
  /// @throws InvalidInput  damaged; cut off, where `packed` is empty; its end is followed by bytes
  ///                       of another kind
  std::size_t unpack(std::string_view& packed, char* room, std::size_t size) {
    if (is_over()) {
      packed.remove_prefix(std::min(packed.find_first_not_of('\0'), packed.size()));
      if (packed.empty()) return 0;
      begin_another(packed.front());
    }
    // zlib does not write to its input, and it counts at most 4 GiB at once.
    constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
    const auto fed = static_cast<uInt>(std::min(packed.size(), kMost));
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream_.avail_in = fed;
    stream_.next_out = reinterpret_cast<Bytef*>(room);
    const auto most = static_cast<uInt>(std::min(size, kMost));
    stream_.avail_out = most;
    state_ = inflate(&stream_, Z_NO_FLUSH);
    packed.remove_prefix(fed - stream_.avail_in);
    if (state_ != Z_OK && state_ != Z_STREAM_END) fail();
    return most - stream_.avail_out;
  }

 private:
  static constexpr uLong kMark = 2;  // bytes by which a gzip file is known

  [[noreturn]] static void fail_after_end() {
    throw InvalidInput("gzip: the file has bytes after its end that are no gzip file");
  }

  void begin_another(char first) {
    if (first != '\x1F') fail_after_end();
    inflateReset(&stream_);
    is_another_ = true;
  }

  // zlib makes no progress where the bytes have ended before the file.
  [[noreturn]] void fail() const {
    if (state_ == Z_BUF_ERROR) throw InvalidInput("gzip: the file is cut off");
    if (is_another_ && stream_.total_in <= kMark) fail_after_end();
    throw InvalidInput("gzip: the file is damaged");
  }

  z_stream stream_{};
  int state_ = Z_OK;
  bool is_another_ = false;  // not the first of several files
};

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1F\x8B"); }

std::string unzipped(std::string_view bytes, std::size_t limit) {
  Inflation inflation;
  std::string result;
  std::vector<char> room(kPiece);
  while (!bytes.empty() || !inflation.is_over()) {
    const auto made = inflation.unpack(bytes, room.data(), room.size());
    require(made <= limit - result.size(),
            "gzip: more than " + fmt::to_string(limit >> 20U) + " MB when unpacked");
    result.append(room.data(), made);
  }
  return result;
}

UnpackedFile::UnpackedFile(const std::filesystem::path& file)
    : name_(file.string()), in_(file), packed_(kPiece) {
  refill();
  if (is_gzip(left_)) inflation_ = std::make_unique<Inflation>();
}

UnpackedFile::~UnpackedFile() = default;

void UnpackedFile::refill() { left_ = {packed_.data(), in_.read(packed_.data(), packed_.size())}; }

std::size_t UnpackedFile::read(char* room, std::size_t size) {
  if (is_packed()) return read_packed(room, size);
  std::size_t done = 0;
  while (done < size) {
    if (left_.empty()) refill();
    if (left_.empty()) break;
    const auto count = left_.copy(room + done, size - done);
    left_.remove_prefix(count);
    done += count;
  }
  return done;
}

std::size_t UnpackedFile::read_packed(char* room, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    if (left_.empty()) refill();
    if (left_.empty() && inflation_->is_over()) break;
    try {
      done += inflation_->unpack(left_, room + done, size - done);
    } catch (const InvalidInput& e) {
      throw InvalidInput(name_ + ": " + e.what());
    }
  }
  return done;
}

std::uint32_t checksum(std::string_view bytes) {
  const auto* first = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(crc32_z(0, first, bytes.size()));
}

}  // namespace chladni::io
