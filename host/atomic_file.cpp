#include "host/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <new>
#include <streambuf>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "host/descriptor.h"
#include "host/held_signal.h"
#include "host/input_file.h"
#include "host/unless_interrupted.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;

// Writes to a descriptor and keeps the first error, which a std::ofstream would lose.
class DescriptorBuffer : public std::streambuf {
 public:
  explicit DescriptorBuffer(int descriptor) : descriptor_(descriptor) {
    setp(block_.data(), block_.data() + block_.size());
  }
  [[nodiscard]] int error() const { return error_; }

 protected:
  int_type overflow(int_type next) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
    return traits_type::not_eof(next);
  }
  int sync() override {
    const bool whole = write_whole(pbase(), pptr() - pbase());
    setp(block_.data(), block_.data() + block_.size());
    return whole ? 0 : -1;
  }
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (count < epptr() - pptr()) return std::streambuf::xsputn(bytes, count);
    return sync() == 0 && write_whole(bytes, count) ? count : 0;
  }

 private:
  bool write_whole(const char* bytes, std::streamsize count) {
    while (count > 0 && error_ == 0) {
      const auto written = unless_interrupted(
          [&] { return ::write(descriptor_, bytes, static_cast<std::size_t>(count)); });
      if (written < 0) error_ = errno;
      bytes += written;
      count -= written;
    }
    return error_ == 0;
  }

  int descriptor_;
  int error_ = 0;
  std::array<char, 65536> block_;
};

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

[[noreturn]] void refuse(const fs::path& file, int error) {
  const std::string text = file.string() + ": cannot be written: " + reason(error);
  if (is_shortage(error)) throw OutOfResources(text + "; the old file, if any, is untouched");
  std::error_code ignored;
  if (!fs::exists(folder_of(file), ignored)) {
    throw InvalidInput(file.string() + ": the folder " + folder_of(file).string() +
                       " does not exist; expected one that does");
  }
  throw InvalidInput(text + "; expected a name in a folder that exists and can be written");
}

// The new file under its temporary name. The destructor removes it unless it was moved into place.
class NewFile {
 public:
  explicit NewFile(const fs::path& file) : file_(file) {
    std::error_code ignored;
    const auto status = fs::status(file, ignored);
    require(file.has_filename() && (!fs::exists(status) || fs::is_regular_file(status)),
            file.string() + ": not a regular file, so it cannot be replaced by one");
    static std::atomic<unsigned> made = 0;
    do {
      temporary_ = folder_of(file) / ("." + file.stem().string() + "." + std::to_string(getpid()) +
                                      "-" + std::to_string(made++) + file.extension().string());
      const int number =
          open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
      if (number >= 0) {
        ::close(number);
        return;
      }
    } while (errno == EEXIST);
    refuse(file, errno);
  }
  ~NewFile() {
    if (!moved_) unlink(temporary_.c_str());
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  NewFile(NewFile&&) = delete;
  NewFile& operator=(NewFile&&) = delete;

  [[nodiscard]] const fs::path& temporary() const { return temporary_; }

  // The bytes reach the disk before the name does, and the name before this function returns.
  void move_into_place() {
    Descriptor content(open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
    if (content.number() < 0 || fsync(content.number()) != 0 || content.close() != 0) {
      refuse(file_, errno);
    }
    if (std::rename(temporary_.c_str(), file_.c_str()) != 0) refuse(file_, errno);
    moved_ = true;
    const Descriptor folder(open(folder_of(file_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.number() >= 0) fsync(folder.number());
  }

 private:
  fs::path file_;
  fs::path temporary_;
  bool moved_ = false;
};

}  // namespace

void write_atomically(const fs::path& file, const std::function<void(std::ostream&)>& fill) {
  const HeldSignal held(SIGXFSZ);
  NewFile made(file);
  Descriptor content(open(made.temporary().c_str(), O_WRONLY | O_CLOEXEC));
  if (content.number() < 0) refuse(file, errno);
  DescriptorBuffer buffer(content.number());
  std::ostream stream(&buffer);
  fill(stream);
  stream.flush();
  if (buffer.error() != 0) refuse(file, buffer.error());
  if (!stream) throw OutOfResources(file.string() + ": its content could not be written whole");
  if (content.close() != 0) refuse(file, errno);
  made.move_into_place();
}

void write_atomically(const fs::path& file, std::string_view content) {
  write_atomically(file, [content](std::ostream& stream) { stream << content; });
}

void write_atomically_at(const fs::path& file, const std::function<void(const fs::path&)>& fill) {
  const HeldSignal held(SIGXFSZ);
  NewFile made(file);
  fill(made.temporary());
  made.move_into_place();
}

std::string read_whole(const fs::path& file, std::size_t limit) {
  InputFile source(file);
  const auto too_long = [&] {
    return InvalidInput(file.string() + ": more than " + std::to_string(limit) +
                        " bytes; expected a file that can be read");
  };
  const auto size = source.size();
  if (size > limit) throw too_long();
  std::string content;
  try {
    content.resize(size + 1);  // one more byte: a read of 0 bytes shows the end
    std::size_t used = 0;
    for (;;) {
      const auto count = source.read(content.data() + used, content.size() - used);
      if (count == 0) break;
      used += count;
      if (used > limit) throw too_long();
      if (used == content.size()) content.resize(2 * used);
    }
    content.resize(used);
  } catch (const std::bad_alloc&) {
    throw OutOfResources(file.string() + ": no memory for its " + std::to_string(size) + " bytes");
  }
  return content;
}

}  // namespace chladni
