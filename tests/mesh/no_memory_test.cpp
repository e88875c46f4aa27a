// Without memory a surface is refused: another one than with memory would be a silent change.
#include <gtest/gtest.h>

#include "mesh/bodies.h"
#include "mesh/check.h"
#include "tests/failing_new.h"

namespace chladni::mesh {
namespace {

TEST(Remesh, WithoutMemoryMakesNoOtherSurface) {
  Surface body;
  body.points.resize(8, 3);
  body.points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  body.triangles.resize(12, 3);
  body.triangles << 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7,
      2, 7, 6, 3, 0, 4, 3, 4, 7;
  body.patch = Eigen::VectorXi::Zero(12);
  (void)check_and_repair(body);
  const Surface with_memory = remesh(body, 0.5);
  const long failures = without_memory(4000, 7, [&] {
    const Surface again = remesh(body, 0.5);
    EXPECT_EQ(again.points, with_memory.points);
    EXPECT_EQ(again.triangles, with_memory.triangles);
  });
  EXPECT_GT(failures, 50);
}

}  // namespace
}  // namespace chladni::mesh
