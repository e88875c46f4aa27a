// Bodies of a millimetre: what is near on them is not what is near on others.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "steps/checked.h"
#include "steps/placement.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::steps {
namespace {

const std::string kChip = R"(title = "a chip"
geometry = { plate = { length = "0.9 mm", width = "0.7 mm", thickness = "0.05 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "0.1 mm", order = 2 }
modes = { count = 10, damping_ratio = 0.005 }
sensor = [
  { name = "s1", at = ["-0.3 mm", "0.2 mm"], direction = "z" },
  { name = "s2", at = ["0.3 mm", "0.2 mm"], direction = "z" },
  { name = "s3", at = ["0.301 mm", "0.2 mm"], direction = "z" },
]
)";

class SmallBody : public testing::Test {
 protected:
  study::Study study_with(const std::string& more) const {
    return study::parse_study(kChip + more, folder_.path() / "study.toml");
  }

  // The message with which the check of the study refuses it.
  std::string refusal(const std::string& more) {
    const auto study = study_with(more);
    return refusal_of([&] {
      stage::Work work;
      return checked(study, false, work);
    });
  }

  BestPlaces placed_with(const std::string& more) {
    const auto study = study_with(more);
    app::QuietRun quiet(study, folder_.path() / "out");
    const auto solution = stage::solved(study, quiet.run());
    return best_places(study, solution, quiet.run());
  }

  app::TestFolder folder_{"small_body"};
};

TEST_F(SmallBody, HasNoPointsBesideIt) {
  const auto of_placement = [&](const std::string& z) {
    return refusal("[[placement.interest]]\nat = [\"0 mm\", \"0 mm\", \"" + z + " mm\"]\n");
  };
  EXPECT_EQ(of_placement("0.005"), "");
  EXPECT_NE(of_placement("0.4").find("a point of interest is not on the body, which is 0.4 mm"),
            std::string::npos)
      << of_placement("0.4");
}

// All sensors were in one place, the millimetre of other bodies.
TEST_F(SmallBody, HasSensorsInDifferentPlaces) {
  const auto places = placed_with("[placement]\nmodes = 2\n");
  ASSERT_EQ(places.notes.size(), 1U) << testing::PrintToString(places.notes);
  EXPECT_NE(places.notes[0].find("sensors s2 and s3 are in one place"), std::string::npos)
      << places.notes[0];
}

// Devices were kept 0.1 mm from what is there, a ninth of the body.
TEST_F(SmallBody, HasPlacesNearWhatIsThere) {
  const auto places = placed_with("[placement]\nmodes = 2\nthere = [\"s1\"]\n");
  const Eigen::RowVector3d there(-3e-4, 2e-4, 0.0);
  double farthest = 0.0;
  for (Eigen::Index k = 0; k < places.forbidden.size(); ++k) {
    if (places.forbidden(k) < 0) continue;
    const Eigen::RowVector3d off = places.surface.sites.position.row(k) - there;
    farthest = std::max(farthest, off.head<2>().norm());
  }
  EXPECT_LT(farthest, 2e-5);
}

}  // namespace
}  // namespace chladni::steps
