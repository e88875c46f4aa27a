// .mat files of few lines, outputs and inputs, whose sizes do not tell which dimension is which.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "io/frf_file.h"
#include "io/mat.h"
#include "io/matlab/frf_mat.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/mat_files.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

// Responses of ones, of n lines, outputs and inputs, without names.
MatFields cube(Eigen::Index n, const MatFields& more = {}) {
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(n * n * n, 1.0, 2.0);
  MatFields fields{{"freq_hz", Eigen::MatrixXd(Eigen::VectorXd::LinSpaced(n, 1.0, 2.0))},
                   {"H", MatValue({n, n, n}, numbers, -numbers)}};
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

modal::FrfSet read_cube(const MatFields& fields) {
  return frf_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat").set;
}

// One response on one line was refused, and so were n outputs and n inputs on n lines.
TEST_F(Mat, WhatIsWrittenOfFewChannelsAndLinesIsReadBack) {
  const TemporaryFile file("few.mat");
  for (Eigen::Index p = 1; p <= 3; ++p) {
    for (Eigen::Index q = 1; q <= 3; ++q) {
      for (Eigen::Index k = 1; k <= 3; ++k) {
        SCOPED_TRACE(std::to_string(p) + " x " + std::to_string(q) + " x " + std::to_string(k));
        const auto set = random_set(p, q, k, 17);
        for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
          if (version == MatVersion::mat_7_3 && (p != q || q != k)) continue;
          (void)write_frf(file.path, set, version);
          ASSERT_EQ(refusal_of([&] { return read_frf(file.path); }), "");
          expect_same(read_frf(file.path).set, set);
        }
      }
    }
  }
}

// One number has one meaning; of eight only their maker knows.
TEST_F(Mat, OneNumberNeedsNoNames) {
  EXPECT_EQ(read_cube(cube(1)).value.at(0)(0, 0), std::complex<double>(2.0, -2.0));
  EXPECT_NE(refusal_of([] { return read_cube(cube(2)); }).find("dimensions"), std::string::npos);
}

TEST_F(Mat, DimensionsSayWhereTheLinesStand) {
  const auto last = read_cube(cube(2, {{"dimensions", std::string("outputs x inputs x lines")}}));
  const auto first = read_cube(cube(2, {{"dimensions", std::string("lines x outputs x inputs")}}));
  // The second number is that of the second output, or of the second line.
  EXPECT_EQ(last.value[0](1, 0), first.value[1](0, 0));
  EXPECT_EQ(last.value[1](0, 0), first.value[0](0, 1));
  const auto other = refusal_of(
      [] { return read_cube(cube(2, {{"dimensions", std::string("inputs x outputs x lines")}})); });
  EXPECT_NE(other.find("dimensions = \"outputs x inputs x lines\""), std::string::npos) << other;
}

}  // namespace
}  // namespace chladni::io
