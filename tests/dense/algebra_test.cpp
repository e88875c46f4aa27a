#include "dense/algebra.h"

#include <gtest/gtest.h>

#include "base/draw.h"

namespace chladni::dense {
namespace {

TEST(OrthonormalBasis, SpansWhatTheColumnsSpan) {
  Draw draw(7);
  for (const Eigen::Index columns : {1, 4, 60}) {  // more than a block of reflections
    Eigen::MatrixXd a(90, columns);
    for (double& value : a.reshaped()) value = draw.normal();
    const Eigen::MatrixXd q = orthonormal_basis(a);
    ASSERT_EQ(q.rows(), a.rows());
    ASSERT_EQ(q.cols(), columns);
    EXPECT_TRUE((q.transpose() * q).isIdentity(1e-13)) << columns;
    EXPECT_LT((a - q * (q.transpose() * a)).norm(), 1e-13 * a.norm()) << columns;
    // The k-th vector is in the span of the first k columns.
    const Eigen::MatrixXd r = q.transpose() * a;
    EXPECT_LT(r.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 1e-12 * a.norm());
  }
}

}  // namespace
}  // namespace chladni::dense
