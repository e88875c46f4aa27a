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

TEST(PseudoInverse, HasThePropertiesOfPenrose) {
  Draw draw(9);
  const auto drawn = [&](Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd a(rows, columns);
    for (double& value : a.reshaped()) value = draw.normal();
    return a;
  };
  // Tall, wide, square, of a rank below both sides.
  for (const Eigen::MatrixXd& a :
       {drawn(9, 4), drawn(4, 9), drawn(6, 6), Eigen::MatrixXd(drawn(8, 3) * drawn(3, 7))}) {
    const Eigen::MatrixXd inverse = pseudo_inverse(a);
    EXPECT_TRUE((a * inverse * a).isApprox(a, 1e-12));
    EXPECT_TRUE((inverse * a * inverse).isApprox(inverse, 1e-12));
    EXPECT_TRUE((a * inverse).isApprox((a * inverse).transpose(), 1e-12));
    EXPECT_TRUE((inverse * a).isApprox((inverse * a).transpose(), 1e-12));
  }
}

TEST(AddTransposedProduct, IsThatOfTheFormula) {
  Draw draw(8);
  const auto drawn = [&](Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXcd a(rows, columns);
    for (auto& value : a.reshaped()) value = {draw.normal(), draw.normal()};
    return a;
  };
  const std::complex<double> s(0.3, -1.7);
  for (const Eigen::Index rows : {0, 1, 7, 60}) {
    const Eigen::MatrixXcd a = drawn(rows, 9);
    const Eigen::MatrixXcd b = drawn(rows, 5);
    const Eigen::MatrixXcd before = drawn(4, 3);
    Eigen::MatrixXcd c = before;
    add_transposed_product(a.middleCols(2, 4), b.rightCols(3), s, c);  // views on columns
    const Eigen::MatrixXcd expected = before + s * a.middleCols(2, 4).transpose() * b.rightCols(3);
    EXPECT_TRUE(c.isApprox(expected, 1e-14)) << rows;
  }
}

}  // namespace
}  // namespace chladni::dense
