#include "io/matrix.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "base/error.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class MatrixFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("chladni_matrix_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string bytes_of(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  }
  fs::path folder_;
};

// Reads a PETSc matrix as its manual has it, by another way than it was written: bytes are shifted,
// not reversed.
class PetscReader {
 public:
  PetscReader(std::string bytes, std::size_t width) : bytes_(std::move(bytes)), width_(width) {}

  Eigen::MatrixXd matrix() {
    EXPECT_EQ(whole(), 1211216);
    const auto rows = whole();
    const auto columns = whole();
    const auto entries = whole();
    std::vector<std::int64_t> lengths;
    std::vector<std::int64_t> at;
    std::int64_t sum = 0;
    for (std::int64_t i = 0; i < rows; ++i) sum += lengths.emplace_back(whole());
    EXPECT_EQ(sum, entries);
    for (std::int64_t i = 0; i < entries; ++i) at.push_back(whole());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, columns);
    std::size_t next = 0;
    for (std::int64_t i = 0; i < rows; ++i) {
      for (std::int64_t k = 0; k < lengths[static_cast<std::size_t>(i)]; ++k, ++next) {
        if (k > 0) {
          EXPECT_LT(at[next - 1], at[next]);
        }
        dense(i, at[next]) = number();
      }
    }
    EXPECT_EQ(used_, bytes_.size());
    return dense;
  }

 private:
  std::uint64_t word(std::size_t width) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < width; ++i) {
      value = (value << 8U) | static_cast<unsigned char>(bytes_.at(used_++));
    }
    return value;
  }
  std::int64_t whole() { return static_cast<std::int64_t>(word(width_)); }
  double number() {
    const std::uint64_t value = word(8);
    double result = 0.0;
    std::memcpy(&result, &value, sizeof result);
    return result;
  }
  std::string bytes_;
  std::size_t width_, used_ = 0;
};

// A sparse symmetric matrix; one row has nothing but zeros that are not stored.
SparseMatrix some_lower(int n, unsigned seed) {
  std::mt19937 draw(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    if (i == n / 2) continue;
    for (int j = 0; j <= i; ++j) {
      if (j != n / 2 && (i == j || draw() % 4 == 0)) entries.emplace_back(i, j, value(draw) / 3.0);
    }
  }
  SparseMatrix lower(n, n);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

TEST_F(MatrixFiles, PetscHoldsBothTrianglesToTheLastBit) {
  for (const int n : {1, 2, 7, 40}) {
    const SparseMatrix lower = some_lower(n, static_cast<unsigned>(n));
    const Eigen::MatrixXd truth = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
    write_petsc(folder_ / "a.petsc", lower, PetscIndex::narrow);
    EXPECT_EQ(PetscReader(bytes_of("a.petsc"), 4).matrix(), truth) << n;
    write_petsc(folder_ / "a.petsc", lower, PetscIndex::wide);
    EXPECT_EQ(PetscReader(bytes_of("a.petsc"), 8).matrix(), truth) << n;
  }
}

// What stands above the diagonal of a matrix that is given by its lower triangle does not count.
TEST_F(MatrixFiles, PetscOverlooksAnUpperTriangle) {
  const SparseMatrix lower = some_lower(12, 5);
  const SparseMatrix both = lower.selfadjointView<Eigen::Lower>();
  write_petsc(folder_ / "lower.petsc", lower, PetscIndex::narrow);
  write_petsc(folder_ / "both.petsc", both, PetscIndex::narrow);
  EXPECT_EQ(bytes_of("lower.petsc"), bytes_of("both.petsc"));
}

TEST_F(MatrixFiles, SmallMatricesHaveNarrowIndices) {
  EXPECT_EQ(petsc_index(some_lower(40, 1)), PetscIndex::narrow);
  EXPECT_EQ(petsc_index(SparseMatrix()), PetscIndex::narrow);
}

TEST_F(MatrixFiles, PetscRefusesWhatIsNotSquare) {
  EXPECT_THROW(write_petsc(folder_ / "a.petsc", SparseMatrix(2, 3), PetscIndex::narrow),
               InvalidInput);
  EXPECT_FALSE(fs::exists(folder_ / "a.petsc"));
}

// The numbers after the head of a Matrix Market file.
std::vector<double> numbers_of(const std::string& text, std::string& head) {
  std::istringstream in(text);
  std::getline(in, head);
  std::vector<double> numbers;
  for (std::string word; in >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

TEST_F(MatrixFiles, MatrixMarketHasTheLowerTriangleToTheLastBit) {
  const SparseMatrix lower = some_lower(9, 3);
  write_matrix_market_symmetric(folder_ / "a.mtx", lower);
  std::string head;
  const auto numbers = numbers_of(bytes_of("a.mtx"), head);
  EXPECT_EQ(head, "%%MatrixMarket matrix coordinate real symmetric");
  ASSERT_EQ(numbers.size(), 3 + 3 * static_cast<std::size_t>(lower.nonZeros()));
  EXPECT_EQ(numbers[0], 9.0);
  EXPECT_EQ(numbers[1], 9.0);
  EXPECT_EQ(numbers[2], static_cast<double>(lower.nonZeros()));
  Eigen::MatrixXd read = Eigen::MatrixXd::Zero(9, 9);
  for (std::size_t i = 3; i < numbers.size(); i += 3) {
    read(static_cast<Eigen::Index>(numbers[i]) - 1, static_cast<Eigen::Index>(numbers[i + 1]) - 1) =
        numbers[i + 2];
  }
  EXPECT_EQ(read, Eigen::MatrixXd(lower));
}

TEST_F(MatrixFiles, MatrixMarketOfGeneralAndOfDenseMatrices) {
  SparseMatrix wide(2, 3);
  wide.insert(0, 2) = 0.1;
  wide.insert(1, 0) = -2.5e-300;
  write_matrix_market(folder_ / "a.mtx", wide);
  std::string head;
  EXPECT_EQ(numbers_of(bytes_of("a.mtx"), head),
            (std::vector<double>{2, 3, 2, 2, 1, -2.5e-300, 1, 3, 0.1}));
  EXPECT_EQ(head, "%%MatrixMarket matrix coordinate real general");
  write_matrix_market(folder_ / "a.mtx", Eigen::MatrixXd(Eigen::Matrix2d{{1, 2}, {3, 1.0 / 3.0}}));
  EXPECT_EQ(numbers_of(bytes_of("a.mtx"), head), (std::vector<double>{2, 2, 1, 3, 2, 1.0 / 3.0}));
  EXPECT_EQ(head, "%%MatrixMarket matrix array real general");
}

}  // namespace
}  // namespace chladni::io
