#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <ostream>
#include <vector>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/matrix.h"

namespace chladni::io {
namespace {

constexpr std::int32_t kMatrixMark = 1211216;  // MAT_FILE_CLASSID

// Words in the byte order of the file, a block at a time.
class BigEndian {
 public:
  explicit BigEndian(std::ostream& out) : out_(out) { bytes_.reserve(kBlock + 8); }
  ~BigEndian() { flush(); }
  BigEndian(const BigEndian&) = delete;
  BigEndian& operator=(const BigEndian&) = delete;
  BigEndian(BigEndian&&) = delete;
  BigEndian& operator=(BigEndian&&) = delete;

  template <typename Word>
  void put(Word value) {
    auto word = std::bit_cast<std::array<char, sizeof(Word)>>(value);
    if constexpr (std::endian::native == std::endian::little)
      std::reverse(word.begin(), word.end());
    bytes_.insert(bytes_.end(), word.begin(), word.end());
    if (bytes_.size() >= kBlock) flush();
  }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 16U;
  void flush() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }
  std::ostream& out_;
  std::vector<char> bytes_;
};

// Calls take(column, value) for each entry of a row of the symmetric matrix, columns ascending:
// what is left of the diagonal stands in the rows of the lower triangle, the rest in its columns.
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
template <typename Take>
void for_row(const Rows& rows, const SparseMatrix& lower, Eigen::Index i, Take take) {
  for (Rows::InnerIterator entry(rows, i); entry && entry.col() < i; ++entry) {
    take(entry.col(), entry.value());
  }
  for (SparseMatrix::InnerIterator entry(lower, i); entry; ++entry) {
    if (entry.row() >= i) take(entry.row(), entry.value());
  }
}

std::int64_t entries_of_both(const SparseMatrix& lower) {
  std::int64_t count = 0;
  for (Eigen::Index i = 0; i < lower.cols(); ++i) {
    for (SparseMatrix::InnerIterator entry(lower, i); entry; ++entry) {
      if (entry.row() >= i) count += entry.row() == i ? 1 : 2;
    }
  }
  return count;
}

template <typename Index>
void write_words(std::ostream& stream, const SparseMatrix& lower) {
  const Rows rows = lower;
  const auto n = lower.cols();
  BigEndian out(stream);
  for (const std::int64_t word :
       {std::int64_t{kMatrixMark}, std::int64_t{n}, std::int64_t{n}, entries_of_both(lower)}) {
    out.put(static_cast<Index>(word));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    Index length = 0;
    for_row(rows, lower, i, [&](Eigen::Index, double) { ++length; });
    out.put(length);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for_row(rows, lower, i,
            [&](Eigen::Index column, double) { out.put(static_cast<Index>(column)); });
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for_row(rows, lower, i, [&](Eigen::Index, double value) { out.put(value); });
  }
}

}  // namespace

PetscIndex petsc_index(const SparseMatrix& lower) {
  const bool many = entries_of_both(lower) > std::numeric_limits<std::int32_t>::max();
  return many ? PetscIndex::wide : PetscIndex::narrow;
}

void write_petsc(const std::filesystem::path& file, const SparseMatrix& lower, PetscIndex index) {
  require(lower.rows() == lower.cols(), file.string() + ": a symmetric matrix must be square");
  require(index == PetscIndex::wide || petsc_index(lower) == PetscIndex::narrow,
          file.string() + ": 2^31 entries or more need indices of 64 bits");
  write_atomically(file, [&](std::ostream& stream) {
    if (index == PetscIndex::wide) {
      write_words<std::int64_t>(stream, lower);
    } else {
      write_words<std::int32_t>(stream, lower);
    }
  });
}

}  // namespace chladni::io
