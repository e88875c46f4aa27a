#include "base/diagonal.h"

#include <gtest/gtest.h>

namespace chladni {
namespace {

TEST(Diagonal, IsThatOfTheBoxWhereverItLies) {
  Points points(3, 3);
  points << 1.0, 2.0, 3.0, 4.0, 6.0, 3.0, 2.0, 5.0, 15.0;
  EXPECT_DOUBLE_EQ(diagonal_of(points), 13.0);  // 3, 4 and 12
  points.rowwise() += Eigen::RowVector3d(-7.0, 0.5, 1.0);
  EXPECT_DOUBLE_EQ(diagonal_of(points), 13.0);
  EXPECT_EQ(diagonal_of(points.topRows(1)), 0.0);
  EXPECT_EQ(diagonal_of(Points(0, 3)), 0.0);
}

}  // namespace
}  // namespace chladni
