#include "show/first_study.h"

#include <gtest/gtest.h>

namespace chladni::show {
namespace {

std::string of_plate(const std::string& length, const std::string& width) {
  return first_study(
      {.kind = "plate",
       .dimensions = {{"length", length}, {"width", width}, {"thickness", "0.01 mm"}},
       .part = {},
       .unit = {}},
      "plate.toml");
}

// Places were whole tenths of a millimetre: on a body of 0.4 mm all corners lay at 0.1 or 0.2 mm.
TEST(FirstStudy, PlacesOfASmallBodyAreAtItsCorners) {
  const auto small = of_plate("0.4 mm", "0.3 mm");
  EXPECT_NE(small.find("at = [\"-0.16 mm\", \"-0.12 mm\"]"), std::string::npos) << small;
  const auto large = of_plate("400 mm", "300 mm");
  EXPECT_NE(large.find("at = [\"-160 mm\", \"-120 mm\"]"), std::string::npos) << large;
}

}  // namespace
}  // namespace chladni::show
