#include <fmt/format.h>

#include <iterator>
#include <ostream>

#include "host/atomic_file.h"
#include "io/matrix.h"

namespace chladni::io {
namespace {

constexpr std::size_t kMarketBlock = std::size_t{1} << 16U;

void pass_on(std::ostream& out, fmt::memory_buffer& text, std::size_t least) {
  if (text.size() < least) return;
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  text.clear();
}

// The entries that `belongs` chooses, counted from 1.
template <typename Belongs>
void write_coordinates(std::ostream& out, const SparseMatrix& matrix, const char* kind,
                       Belongs belongs) {
  Eigen::Index count = 0;
  const auto for_each = [&](auto take) {
    for (Eigen::Index c = 0; c < matrix.outerSize(); ++c) {
      for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) {
        if (belongs(entry.row(), entry.col())) take(entry);
      }
    }
  };
  for_each([&](const auto&) { ++count; });
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "%%MatrixMarket matrix coordinate real {}\n{} {} {}\n",
                 kind, matrix.rows(), matrix.cols(), count);
  for_each([&](const auto& entry) {
    fmt::format_to(std::back_inserter(text), "{} {} {}\n", entry.row() + 1, entry.col() + 1,
                   entry.value());
    pass_on(out, text, kMarketBlock);
  });
  pass_on(out, text, 0);
}

}  // namespace

void write_matrix_market_symmetric(const std::filesystem::path& file, const SparseMatrix& lower) {
  write_atomically(file, [&](std::ostream& out) {
    write_coordinates(out, lower, "symmetric",
                      [](Eigen::Index row, Eigen::Index column) { return row >= column; });
  });
}

void write_matrix_market(const std::filesystem::path& file, const SparseMatrix& matrix) {
  write_atomically(file, [&](std::ostream& out) {
    write_coordinates(out, matrix, "general", [](Eigen::Index, Eigen::Index) { return true; });
  });
}

void write_matrix_market(const std::filesystem::path& file, const Eigen::MatrixXd& matrix) {
  write_atomically(file, [&](std::ostream& out) {
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text), "%%MatrixMarket matrix array real general\n{} {}\n",
                   matrix.rows(), matrix.cols());
    for (const double value : matrix.reshaped()) {
      fmt::format_to(std::back_inserter(text), "{}\n", value);
      pass_on(out, text, kMarketBlock);
    }
    pass_on(out, text, 0);
  });
}

}  // namespace chladni::io
