// Writes .mat files with libmatio.
#include "io/mat.h"

#include <fmt/format.h>

#include <matio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.h"
#include "host/atomic_file.h"
#include "host/descriptor.h"
#include "host/held_signal.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

bool is_name(const std::string& name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= 63 && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

std::vector<std::size_t> sizes(const std::vector<Eigen::Index>& dims) {
  return {dims.begin(), dims.end()};
}

matvar_t* made(const std::string& name, const MatValue& value);

matvar_t* made_number(const std::string& name, const MatValue& value) {
  auto dims = sizes(value.dims);
  const auto rank = static_cast<int>(dims.size());
  auto* real = const_cast<double*>(value.real.data());  // libmatio copies
  if (value.imag.size() == 0) {
    return Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, rank, dims.data(), real, 0);
  }
  mat_complex_split_t parts{real, const_cast<double*>(value.imag.data())};
  return Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, rank, dims.data(), &parts,
                       MAT_F_COMPLEX);
}

// The text in MATLAB's encoding, UTF-16. Bytes that are not UTF-8 count as Latin-1.
std::vector<std::uint16_t> letters_of(std::string_view text) {
  std::vector<std::uint16_t> letters;
  for (std::size_t at = 0; at < text.size();) {
    const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[at + n]); };
    const auto follows = [&](std::size_t n) {
      return at + n < text.size() && (byte(n) & 0xC0U) == 0x80U;
    };
    std::uint32_t code = byte(0);
    std::size_t size = 1;
    if ((code & 0xE0U) == 0xC0U && follows(1)) {
      code = (code & 0x1FU) << 6U | (byte(1) & 0x3FU);
      size = 2;
    } else if ((code & 0xF0U) == 0xE0U && follows(1) && follows(2)) {
      code = (code & 0x0FU) << 12U | (byte(1) & 0x3FU) << 6U | (byte(2) & 0x3FU);
      size = 3;
    }
    letters.push_back(static_cast<std::uint16_t>(code));
    at += size;
  }
  return letters;
}

matvar_t* made_text(const std::string& name, const MatValue& value) {
  auto letters = letters_of(value.text.empty() ? std::string_view() : value.text.front());
  std::array<std::size_t, 2> dims{letters.empty() ? std::size_t{0} : 1, letters.size()};
  return Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UINT16, 2, dims.data(), letters.data(), 0);
}

// Makes a cell array. libmatio takes ownership of the cells.
matvar_t* made_cells(const std::string& name, const MatValue& value) {
  auto dims = sizes(value.dims);
  std::vector<matvar_t*> cells;
  for (const auto& cell : value.cells) cells.push_back(made("", cell));
  return Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, static_cast<int>(dims.size()),
                       dims.data(), cells.data(), 0);
}

matvar_t* made_structure(const std::string& name, const MatValue& value) {
  std::array<std::size_t, 2> dims{1, 1};
  std::vector<const char*> names;
  for (const auto& [field, ignored] : value.fields) {
    require(is_name(field), "MAT: a field cannot be called " + shown(field));
    names.push_back(field.c_str());
  }
  matvar_t* result = Mat_VarCreateStruct(name.c_str(), 2, dims.data(), names.data(),
                                         static_cast<unsigned>(names.size()));
  for (const auto& [field, of] : value.fields) {
    Mat_VarSetStructFieldByName(result, field.c_str(), 0, made(field, of));
  }
  return result;
}

matvar_t* made(const std::string& name, const MatValue& value) {
  switch (value.kind) {
    case MatValue::Kind::number:
      return made_number(name, value);
    case MatValue::Kind::text:
      return made_text(name, value);
    case MatValue::Kind::cell:
      return made_cells(name, value);
    case MatValue::Kind::structure:
      return made_structure(name, value);
    default:
      throw InvalidInput("MAT: a " + value.class_name + " (" + shown(name) + ") cannot be written");
  }
}

// Bytes of the numbers and letters of a value.
double bytes_of(const MatValue& value) {
  double bytes = 8.0 * static_cast<double>(value.real.size() + value.imag.size());
  for (const auto& line : value.text) bytes += 2.0 * static_cast<double>(line.size());
  for (const auto& cell : value.cells) bytes += bytes_of(cell);
  for (const auto& [name, field] : value.fields) bytes += bytes_of(field);
  return bytes;
}

// A file in memory that goes with the object. In version 5 matio does not tell that a write has
// failed, so it writes here, and the disk gets bytes whose writing is checked.
class MemoryFile {
 public:
  explicit MemoryFile(std::string name)
      : name_(std::move(name)), bytes_(memfd_create("chladni.mat", MFD_CLOEXEC)) {
    if (bytes_.number() < 0) refuse();
  }

  [[nodiscard]] std::filesystem::path path() const {
    return "/proc/self/fd/" + fmt::to_string(bytes_.number());
  }

  void copy_to(std::ostream& stream) const {
    rlimit limit = {};
    const auto size = lseek(bytes_.number(), 0, SEEK_END);
    // Files in memory end there too, and matio would not have noticed.
    const bool cut_off = getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
                         static_cast<rlim_t>(size) >= limit.rlim_cur;
    if (cut_off) errno = EFBIG;
    if (size < 0 || cut_off || lseek(bytes_.number(), 0, SEEK_SET) != 0) refuse();
    std::vector<char> block(std::size_t{1} << 20U);
    for (off_t done = 0; done < size;) {
      const auto count = ::read(bytes_.number(), block.data(), block.size());
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) errno = EIO;
      if (count <= 0) refuse();
      stream.write(block.data(), count);
      done += count;
    }
  }

 private:
  [[noreturn]] void refuse() const {
    throw OutOfResources(name_ + ": cannot be written: " + reason(errno) +
                         "; the old file, if any, is untouched");
  }

  std::string name_;
  Descriptor bytes_;
};

void write_all(const std::filesystem::path& file, const MatFields& variables, MatVersion version) {
  const bool is_5 = version == MatVersion::mat_5;
  // The head has no date, so that the same input gives the same bytes.
  std::unique_ptr<mat_t, int (*)(mat_t*)> mat(
      Mat_CreateVer(file.c_str(),
                    is_5 ? "MATLAB 5.0 MAT-file, written by chladni"
                         : "MATLAB 7.3 MAT-file, written by chladni",
                    is_5 ? MAT_FT_MAT5 : MAT_FT_MAT73),
      Mat_Close);
  if (!mat) throw OutOfResources(file.string() + ": cannot be written");
  for (const auto& [name, value] : variables) {
    const Variable variable(made(name, value), Mat_VarFree);
    if (!variable || Mat_VarWrite(mat.get(), variable.get(), MAT_COMPRESSION_NONE) != 0) {
      throw OutOfResources(file.string() + ": " + shown(name) + " cannot be written");
    }
  }
  if (Mat_Close(mat.release()) != 0) throw OutOfResources(file.string() + ": cannot be closed");
}

}  // namespace

MatValue::MatValue(double number)
    : MatValue(Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, number))) {}

MatValue::MatValue(const Eigen::MatrixXd& matrix)
    : kind(Kind::number), dims{matrix.rows(), matrix.cols()}, real(matrix.reshaped()) {}

MatValue::MatValue(const Eigen::MatrixXcd& matrix)
    : kind(Kind::number),
      dims{matrix.rows(), matrix.cols()},
      real(matrix.real().reshaped()),
      imag(matrix.imag().reshaped()) {}

MatValue::MatValue(std::string words) : kind(Kind::text), class_name("char") {
  dims = {1, static_cast<Eigen::Index>(words.size())};
  text.push_back(std::move(words));
}

MatValue::MatValue(const std::vector<std::string>& texts)
    : kind(Kind::cell),
      dims{static_cast<Eigen::Index>(texts.size()), 1},
      cells(texts.begin(), texts.end()),
      class_name("cell") {}

MatValue::MatValue(std::vector<Eigen::Index> sizes_of, Eigen::VectorXd re, Eigen::VectorXd im)
    : kind(Kind::number), dims(std::move(sizes_of)), real(std::move(re)), imag(std::move(im)) {
  require(dims.size() >= 2 && size() == real.size() && (imag.size() == 0 || imag.size() == size()),
          "MAT: dimensions and numbers do not agree");
}

Eigen::Index MatValue::size() const {
  Eigen::Index product = 1;
  for (const auto n : dims) product *= n;
  return product;
}

MatVersion mat_version_for(const MatFields& variables) {
  constexpr double most = 2e9;  // MATLAB reads 2^31 - 1 bytes of a variable in version 5
  const bool is_large = std::ranges::any_of(
      variables, [&](const auto& variable) { return bytes_of(variable.second) > most; });
  return is_large ? MatVersion::mat_7_3 : MatVersion::mat_5;
}

void write_mat(const std::filesystem::path& file, const MatFields& variables, MatVersion version) {
  for (const auto& [name, value] : variables) {
    require(is_name(name), "MAT: a variable cannot be called " + shown(name));
  }
  const auto least = mat_version_for(variables);
  if (std::max(version, least) == MatVersion::mat_7_3) {  // HDF5 wants a place on a disk
    write_atomically_at(file, [&](const std::filesystem::path& at) {
      write_all(at, variables, MatVersion::mat_7_3);
    });
    return;
  }
  const HeldSignal held(SIGXFSZ);
  const MemoryFile made(file.string());
  write_all(made.path(), variables, MatVersion::mat_5);
  write_atomically(file, [&](std::ostream& stream) { made.copy_to(stream); });
}

}  // namespace chladni::io
