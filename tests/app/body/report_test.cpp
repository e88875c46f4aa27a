// What report.html says of the body's mesh.
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class Report : public CommandLine {
 protected:
  /// report.html of a study of that body.
  std::string of(const std::string& body) const {
    write("study.toml", "geometry = { " + body + R"( }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "20 mm", order = 2 }
modes = { count = 4 }
)");
    const Ended ended = run({"study", "study.toml", "-o", "out", "--no-pictures"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    return whole(folder_ / "out/report.html");
  }
};

// The mesh of a disc is a little smaller than the disc, so its frequencies may be too low as well.
TEST_F(Report, SaysWhereTheExactFrequencyLiesOnlyIfTheMeshFillsTheBody) {
  const std::string below = "the exact frequency of the model lies below the one listed";
  const auto plate = of(R"(plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" })");
  EXPECT_TRUE(says(plate, "estimated error of the mesh; " + below));
  const auto disc = of(R"(disc = { diameter = "100 mm", thickness = "5 mm" })");
  EXPECT_TRUE(says(disc, "estimated error of the mesh. Not in it"));
  EXPECT_EQ(disc.find(below), std::string::npos);
}

}  // namespace
}  // namespace chladni::app
