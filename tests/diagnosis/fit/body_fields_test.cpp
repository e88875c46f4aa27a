#include "diagnosis/body_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// `n` cells along u, `across` along v, of a body of 2 by 0.2 m whose middle is at (1, 0).
BodyCells cells_of(Index n, Index across) {
  BodyCells cells;
  cells.from = {0.0, -0.1};
  cells.size = {2.0, 0.2};
  cells.area = Eigen::VectorXd::Constant(n * across, 0.4 / static_cast<double>(n * across));
  cells.centres.resize(n * across, 2);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < across; ++j) {
      cells.centres(i * across + j, 0) =
          2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      cells.centres(i * across + j, 1) =
          -0.1 + 0.2 * (static_cast<double>(j) + 0.5) / static_cast<double>(across);
    }
  }
  return cells;
}

// The names are those of the axes, also of a strip whose long side lies along v.
TEST(SmoothFields, AreNamedAfterTheAxisThatTheyVaryAlong) {
  const auto told = [](const BodyCells& cells) {
    Structure body;
    body.cells = cells;
    std::vector<std::string_view> names;
    for (const auto& one : effect("modulus_field").parameters(body)) names.push_back(one.name);
    return names;
  };
  const std::vector<std::string_view> face(kSmoothFields.begin(), kSmoothFields.end());
  EXPECT_EQ(told(cells_of(10, 10)), face);
  auto line = cells_of(24, 1);
  EXPECT_EQ(told(line), (std::vector<std::string_view>{"u1", "u2"}));
  std::swap(line.from(0), line.from(1));
  std::swap(line.size(0), line.size(1));
  line.centres.col(0).swap(line.centres.col(1));
  EXPECT_EQ(told(line), (std::vector<std::string_view>{"v1", "v2"}));
  EXPECT_EQ(smooth_fields(line).cols(), 2);
}

// Legendre's polynomials: orthogonal on the line, to each other and to the smooth fields, of norm
// 1 / (2n + 1).
TEST(ShortWaves, AreOrthogonalAlongALine) {
  const auto cells = cells_of(2000, 1);
  const MatrixXd smooth = smooth_fields(cells);
  const MatrixXd shorter = short_waves(cells);
  ASSERT_EQ(smooth.cols(), 2);
  ASSERT_EQ(shorter.cols(), 4);
  MatrixXd all(2000, 6);
  all << smooth, shorter;
  const MatrixXd products = all.transpose() * all / 2000.0;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 6; ++j) {
      const double expected = i == j ? 1.0 / static_cast<double>(2 * i + 3) : 0.0;
      EXPECT_NEAR(products(i, j), expected, 1e-4) << i << ' ' << j;
    }
  }
}

TEST(ShortWaves, AreThoseOfALineOnly) {
  EXPECT_EQ(short_waves(cells_of(10, 10)).cols(), 0);
  EXPECT_EQ(short_waves(BodyCells{}).cols(), 0);
}

// Whatever varies along it, a line has as many tolerances of its thickness as a face.
TEST(ShortWaves, GiveALineAsManyTolerancesAsAFace) {
  Tolerances thick = no_tolerances();
  thick.thickness = 1e-3;
  Structure plate = small_plate();
  const auto on_a_face = deviations(plate, thick, 1e3).size();
  auto& cells = plate.cells;
  cells.waves = {};
  const auto line = cells_of(cells.count(), 1);
  cells.centres = line.centres;
  cells.from = line.from;
  cells.size = line.size;
  EXPECT_EQ(deviations(plate, thick, 1e3).size(), on_a_face + 1);
}

// Cells across a line that have the same stiffness, or one cell that has that of all of them: a
// patch takes the same part of the line, wherever it lies, and also where it is narrower than the
// line is wide.
TEST(LocalStiffness, IsThatOfTheWholeWidthOfALine) {
  Structure resolved = small_plate();
  const Index n = 12;
  ASSERT_EQ(resolved.fine.count(), n * n);
  Structure line = resolved;
  line.fine.pitch(1) = 0.0;
  line.fine.centres.resize(n, 2);
  line.fine.stiffness.clear();
  for (Index i = 0; i < n; ++i) {
    MatrixXd column = resolved.fine.stiffness[static_cast<std::size_t>(i)];
    for (Index j = 1; j < n; ++j) {
      column += resolved.fine.stiffness[static_cast<std::size_t>(i + n * j)];
    }
    line.fine.centres.row(i) << resolved.fine.centres(i, 0), 0.0;
    line.fine.stiffness.push_back(column);
    for (Index j = 0; j < n; ++j) {
      resolved.fine.stiffness[static_cast<std::size_t>(i + n * j)] =
          column / static_cast<double>(n);
    }
  }
  const auto softer = [](const Structure& structure, double v, double radius) {
    State state = state_of(structure);
    effect("local_stiffness")
        .apply(state, structure, 0, Eigen::Vector4d(std::log(0.6), 0.08, v, std::log(radius)));
    return MatrixXd(state.stiffness - state_of(structure).stiffness);
  };
  for (const double radius : {0.05, 0.1, 0.4}) {
    for (const double v : {0.0, 0.11, -0.22}) {
      const MatrixXd truth = softer(resolved, v, radius);
      EXPECT_LT((softer(line, v, radius) - truth).norm(), 0.01 * truth.norm())
          << radius << ' ' << v;
    }
  }
}

}  // namespace
}  // namespace chladni::diagnosis
