// Several specimens of one design from their files: read, solved, diagnosed together, told.
#include "steps/specimens.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "rotation/turn.h"
#include "show/specimens.h"
#include "stage/solution.h"
#include "steps/diagnosis.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::steps {
namespace {

constexpr double kLength = 0.5, kWidth = 0.3, kThickness = 0.006, kDensity = 2700.0;  // [m], SI
constexpr int kCount = 8;                                                             // modes each

const std::string kDesign = R"(
geometry = { plate = { length = "500 mm", width = "300 mm", thickness = "6 mm" } }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 12, damping_ratio = 0.01 }
[material]
youngs_modulus = { value = "70 GPa", within = "15 %" }
poissons_ratio = 0.33
density = { value = "2700 kg/m^3", within = "8 %" }
[[sensor]]
name = "s1"
at = ["-240 mm", "140 mm"]
direction = "z"
[[specimen]]
name = "p1"
study = "p1.toml"
[[specimen]]
name = "p2"
study = "p2.toml"
)";

// One plate of the series: its modulus and density over the design's, its true thickness over the
// one that is written.
struct Plate {
  double modulus = 1.0, density = 1.0, thickness = 1.0;
};

class Specimens : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  // Frequencies of the design with another thickness, by elements.
  Eigen::VectorXd frequencies(double thickness) const {
    auto text = kDesign.substr(0, kDesign.find("[[specimen]]"));
    const std::string written = "thickness = \"6 mm\"";
    text.replace(text.find(written), written.size(),
                 fmt::format("thickness = \"{:.6f} mm\"", 6.0 * thickness));
    write("plain.toml", text);
    stage::Work work;
    const auto modes = stage::solved(study::read_study(folder_.path() / "plain.toml"), work).modes;
    return modes.frequency_hz.segment(modes.rigid_count, kCount);
  }

  // All frequencies go as the root of modulus over density.
  void write_series(const std::vector<Plate>& plates) {
    write("design.toml", kDesign);
    const Eigen::VectorXd written = frequencies(1.0);
    std::string design = kDesign.substr(0, kDesign.find("[[specimen]]"));
    for (std::size_t p = 0; p < plates.size(); ++p) {
      const auto& plate = plates[p];
      const std::string name = fmt::format("p{}", p + 1);
      const Eigen::VectorXd hz = plate.thickness == 1.0 ? written : frequencies(plate.thickness);
      std::string table = "frequency_hz\n";
      for (Eigen::Index k = 0; k < kCount; ++k) {
        const double own = 1.0 + 0.002 * std::sin(7.0 * static_cast<double>(p) + 3.0 * k);
        table += fmt::format("{:.6f}\n", hz(k) * own * std::sqrt(plate.modulus / plate.density));
      }
      write(name + ".csv", table);
      const double mass =
          kDensity * plate.density * kLength * kWidth * kThickness * plate.thickness;
      write(
          name + ".toml",
          fmt::format("extends = \"design.toml\"\n[geometry.plate]\nthickness = {{ value = "
                      "\"6 mm\", measured = \"0.5 %\" }}\n[measurement]\nmodes = \"{}.csv\"\nmass "
                      "= {{ value = \"{:.3f} g\", measured = \"0.3 %\" }}\n",
                      name, 1e3 * mass));
      design += fmt::format("[[specimen]]\nname = \"{0}\"\nstudy = \"{0}.toml\"\n", name);
    }
    write("design.toml", design);
  }

  DiagnosedSpecimens found() {
    const auto study = study::read_study(folder_.path() / "design.toml");
    app::QuietRun quiet(study, folder_.path() / "out");
    auto result = diagnosed_specimens(study, quiet.run());
    shown_ = show::specimens_table(result.result);
    show::leave_specimens(result, quiet.run());
    return result;
  }

  std::string refusal(const std::string& design) {
    write("design.toml", design);
    return refusal_of([&] {
      stage::Work work;
      return diagnosed_specimens(study::read_study(folder_.path() / "design.toml"), work);
    });
  }

  std::string shown_;
  app::TestFolder folder_{"specimens"};
};

const std::vector<Plate> kSound{{1.03, 1.01},  {0.97, 0.99},  {1.0, 1.012},
                                {1.05, 0.995}, {0.96, 1.004}, {1.01, 0.985},
                                {0.98, 1.006}, {1.04, 0.998}, {0.99, 1.015}};

TEST_F(Specimens, FindTheSheetAndItsEntry) {
  EVERY_FOURTH_LANDING();
  auto plates = kSound;
  plates[2].thickness = 0.86;
  write_series(plates);
  const auto result = found().result;
  EXPECT_NE(result.verdict, diagnosis::Verdict::no_discrepancy) << shown_;
  EXPECT_LT(result.none, 0.01);
  ASSERT_FALSE(result.entries.empty()) << shown_;
  const auto& entry = result.entries.front();
  EXPECT_EQ(entry.specimen, "p3");
  EXPECT_EQ(entry.key, "geometry.plate.thickness");
  for (std::size_t i = 1; i < result.entries.size(); ++i) {
    EXPECT_LT(result.entries[i].probability, 0.2 * entry.probability) << result.entries[i].key;
  }
  EXPECT_NE(result.measure_next.find("p3"), std::string::npos) << result.measure_next;
  EXPECT_NEAR(entry.change(), -0.14, 0.02);
  EXPECT_NE(shown_.find("p3"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out/diagnosis.json"));
}

TEST_F(Specimens, AccuseNoneOfASoundSeries) {
  EVERY_FOURTH_LANDING();
  write_series(kSound);
  const auto result = found().result;
  EXPECT_EQ(result.verdict, diagnosis::Verdict::no_discrepancy) << shown_;
  EXPECT_TRUE(result.best.entries.empty());
}

TEST_F(Specimens, AreReadBeforeAnythingIsSolved) {
  write("p1.toml", "extends = \"design.toml\"\n[measurement]\nmodes = \"p1.csv\"\n");
  write("p1.csv", "frequency_hz\n100\n200\n");
  EXPECT_NE(refusal(kDesign).find("p2"), std::string::npos) << refusal(kDesign);
  write("p2.toml", "extends = \"design.toml\"\n");
  EXPECT_NE(refusal(kDesign).find("measurement"), std::string::npos) << refusal(kDesign);
}

TEST_F(Specimens, SayThatAMassWithoutADeviationIsNotCompared) {
  struct Heard : stage::Work {
    void warn(std::string_view message) override { text += message; }
    std::string text;
  } work;
  const auto with_mass = [](const std::string& mass) {
    return "extends = \"design.toml\"\n[measurement]\nmodes = \"p.csv\"\nmass = " + mass + "\n";
  };
  write("p.csv", "frequency_hz\n100\n200\n");
  write("p1.toml", with_mass("\"2430 g\""));
  write("p2.toml", "extends = \"design.toml\"\n");  // refused before anything is solved
  write("design.toml", kDesign);
  const auto study = study::read_study(folder_.path() / "design.toml");
  EXPECT_THROW((void)diagnosed_specimens(study, work), InvalidInput);
  EXPECT_NE(work.text.find("p1"), std::string::npos) << work.text;
  EXPECT_NE(work.text.find("mass = { value = \"2430 g\""), std::string::npos) << work.text;
  work.text.clear();
  write("p1.toml", with_mass("{ value = \"2430 g\", measured = \"0.3 %\" }"));
  EXPECT_THROW((void)diagnosed_specimens(study, work), InvalidInput);
  EXPECT_EQ(work.text, "");
}

TEST_F(Specimens, NeedNamesThatDifferAndSpecimensThatAreThere) {
  const std::string twice = kDesign + "[[specimen]]\nname = \"p1\"\nstudy = \"p1.toml\"\n";
  EXPECT_NE(refusal(twice).find("p1"), std::string::npos) << refusal(twice);
  const std::string nobody =
      kDesign + "[[specimen]]\nname = \"p3\"\nstudy = \"p1.toml\"\nsame_as = \"p9\"\n";
  EXPECT_NE(refusal(nobody).find("p9"), std::string::npos) << refusal(nobody);
  const std::string nothing = kDesign + "[[specimen]]\nname = \"p3\"\n";
  EXPECT_NE(refusal(nothing).find("study"), std::string::npos) << refusal(nothing);
}

// The sheet of 1L says 4.8 mm; from masses and frequencies by hand it is 4.52 +- 0.05 mm
// (docs/reference/diagnosis_cases.md).
TEST_F(Specimens, OfFourSprucePlatesNameTheThicknessThatIsWrong) {
  EVERY_EIGHTH_LANDING();
  const std::filesystem::path source = CHLADNI_SOURCE_DIR;
  const auto data = std::filesystem::weakly_canonical(source / "../shared/data");
  if (!std::filesystem::exists(data / "tonewood-1to4/plate_01_1L_H1.csv")) {
    GTEST_SKIP() << "the responses of the plates are not here: " << data;
  }
  const auto study = study::read_study(source / "models/tonewood/four_plates.toml", {data});
  stage::Work work(stage::WorkOptions{.allowed = {data}});
  const auto result = diagnosed_specimens(study, work).result;
  ASSERT_FALSE(result.entries.empty());
  const auto& entry = result.entries.front();
  EXPECT_EQ(entry.specimen + " " + entry.key, "1L geometry.plate.thickness");
  EXPECT_GT(entry.probability, 0.5);
  EXPECT_NEAR(entry.value, 0.00452, 0.00012);
  for (std::size_t i = 1; i < result.entries.size(); ++i) {
    EXPECT_LT(result.entries[i].probability, 0.2) << result.entries[i].key;
  }
}

}  // namespace
}  // namespace chladni::steps
