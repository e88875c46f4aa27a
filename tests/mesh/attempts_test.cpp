#include "mesh/remesh/attempts.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.h"
#include "mesh/bodies.h"

namespace chladni::mesh {
namespace {

// Cells that are the flatter the thinner the plate.
TetMesh flat_plate(double thickness) { return layered(Plate{0.1, 0.1, thickness}, 0.05, 1); }
double angle(const TetMesh& mesh) { return quality(mesh).smallest_dihedral_degrees; }

TEST(BetterMesh, IsTheFirstWhereItIsGoodEnough) {
  const auto never = []() -> TetMesh { throw NumericalFailure("was asked for"); };
  const auto good = [] { return flat_plate(0.05); };
  EXPECT_EQ(angle(better_mesh(good, never, 5.0)), angle(flat_plate(0.05)));
}

TEST(BetterMesh, IsTheOneWithTheLargerAngles) {
  const auto flat = [] { return flat_plate(0.001); };
  const auto flatter = [] { return flat_plate(0.0005); };
  EXPECT_EQ(angle(better_mesh(flat, flatter, 90.0)), angle(flat_plate(0.001)));
  EXPECT_EQ(angle(better_mesh(flatter, flat, 90.0)), angle(flat_plate(0.001)));
}

// Quality first, then size: angles within a quarter are the same, unless only one is good enough.
TEST(BetterMesh, IsTheSmallerOneOfTwoThatAreAsPoor) {
  const auto few = [] { return flat_plate(0.001); };
  const auto many = [] { return layered(Plate{0.1, 0.1, 0.00055}, 0.025, 1); };
  const double poor = angle(few());
  ASSERT_GT(angle(many()), 1.05 * poor);
  ASSERT_LT(angle(many()), 1.2 * poor);
  EXPECT_EQ(better_mesh(few, many, 90.0).tet_count(), few().tet_count());
  EXPECT_EQ(better_mesh(many, few, 90.0).tet_count(), few().tet_count());
  EXPECT_EQ(better_mesh(few, many, 1.02 * poor).tet_count(), many().tet_count());
  const auto clearly = [] { return layered(Plate{0.1, 0.1, 0.001}, 0.025, 1); };
  EXPECT_EQ(better_mesh(few, clearly, 90.0).tet_count(), clearly().tet_count());
  EXPECT_EQ(better_mesh(clearly, few, 90.0).tet_count(), clearly().tet_count());
}

TEST(BetterMesh, IsKeptWhereTheOtherWayFails) {
  const auto flat = [] { return flat_plate(0.001); };
  const auto dies = []() -> TetMesh { throw WorkerDied("signal 11"); };
  const auto inverts = []() -> TetMesh { throw InvalidInput("inverted"); };
  EXPECT_EQ(angle(better_mesh(flat, dies, 90.0)), angle(flat_plate(0.001)));
  EXPECT_EQ(angle(better_mesh(flat, inverts, 90.0)), angle(flat_plate(0.001)));
  EXPECT_EQ(angle(better_mesh(dies, flat, 90.0)), angle(flat_plate(0.001)));
  EXPECT_THROW((void)better_mesh(inverts, dies, 90.0), WorkerDied);
}

// Only a death is told, and only where there is a mesh all the same.
TEST(BetterMesh, TellsOfADeathThatItOutlived) {
  std::vector<std::string> told;
  const auto hear = [&](const std::string& why) { told.push_back(why); };
  const auto flat = [] { return flat_plate(0.001); };
  const auto dies = []() -> TetMesh { throw WorkerDied("signal 9"); };
  const auto inverts = []() -> TetMesh { throw InvalidInput("inverted"); };
  (void)better_mesh(flat, flat, 90.0, hear);
  (void)better_mesh(inverts, flat, 90.0, hear);
  EXPECT_THROW((void)better_mesh(dies, dies, 90.0, hear), WorkerDied);
  EXPECT_TRUE(told.empty());
  (void)better_mesh(dies, flat, 90.0, hear);
  (void)better_mesh(flat, dies, 90.0, hear);
  EXPECT_EQ(told, (std::vector<std::string>{"signal 9", "signal 9"}));
}

// Neither Ctrl-C nor a lack of memory is a reason to try another way.
TEST(BetterMesh, IsNotLookedForAfterCtrlC) {
  int asked = 0;
  const auto other = [&asked] {
    ++asked;
    return flat_plate(0.01);
  };
  const auto stopped = []() -> TetMesh { throw Interrupted("stopped by Ctrl-C"); };
  const auto full = []() -> TetMesh { throw OutOfResources("no memory"); };
  EXPECT_THROW((void)better_mesh(stopped, other, 5.0), Interrupted);
  EXPECT_THROW((void)better_mesh(full, other, 5.0), OutOfResources);
  EXPECT_EQ(asked, 0);
}

}  // namespace
}  // namespace chladni::mesh
