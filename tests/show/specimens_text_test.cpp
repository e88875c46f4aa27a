#include "show/specimens.h"

#include <gtest/gtest.h>

#include <limits>

namespace chladni::show {
namespace {

TEST(SpecimensText, AHeavyMassIsInKilograms) {
  diagnosis::OddEntry entry{.specimen = "table",
                            .key = "mass",
                            .effect = "",
                            .unit = "kg",
                            .of_study = 19.44,
                            .value = 19.4,
                            .std = 0.05};
  EXPECT_EQ(entry_text(entry), "mass of table: 19.400 +- 0.050 kg, written 19.440 (-0.2 %)");
  entry.of_study = 0.05;
  entry.value = 0.0482;
  entry.std = 0.0001;
  EXPECT_EQ(entry_text(entry), "mass of table: 48.20 +- 0.10 g, written 50.00 (-3.6 %)");
}

TEST(SpecimensText, ADeviationThatIsNotKnownIsCalledSo) {
  const diagnosis::OddEntry entry{.specimen = "table",
                                  .key = "mass",
                                  .effect = "",
                                  .unit = "kg",
                                  .of_study = 19.44,
                                  .value = 19.4,
                                  .std = std::numeric_limits<double>::infinity()};
  EXPECT_EQ(entry_text(entry), "mass of table: 19.400 +- unknown kg, written 19.440 (-0.2 %)");
}

}  // namespace
}  // namespace chladni::show
