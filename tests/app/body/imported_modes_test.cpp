// Frequencies of bodies that come as surfaces, at the default mesh, against exact ones.
#include "io/json.h"
#include "rotation/turn.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

using io::Json;

constexpr const char* kTable = CHLADNI_SOURCE_DIR "/../shared/data/wafer-table/wafer_table.stl";

// A box as a text STL [mm].
std::string box_stl(double x, double y, double z) {
  constexpr int corners[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  std::ostringstream text;
  text << "solid box\n";
  for (const auto& triangle : corners) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int i : triangle) {
      text << "vertex " << ((i & 1) != 0 ? x : 0.0) << " " << ((i & 2) != 0 ? y : 0.0) << " "
           << ((i & 4) != 0 ? z : 0.0) << "\n";
    }
    text << "endloop\nendfacet\n";
  }
  return text.str() + "endsolid box\n";
}

class ImportedModes : public CommandLine {
 protected:
  /// The flexible frequencies of body.stl.
  std::vector<double> frequencies(const std::string& material, int count,
                                  const std::string& mesh = "") const {
    write("study.toml", "title = \"t\"\ngeometry = { file = \"body.stl\", unit = \"mm\" }\n" +
                            mesh + "material = { " + material +
                            " }\nmodes = { count = " + std::to_string(count) + " }\n");
    const Ended ended = run({"modes", "study.toml", "-o", "out", "--no-pictures"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    std::vector<double> flexible;
    const Json result = io::parse_json(whole(folder_ / "out" / "modes.json"));
    for (const Json& hz : result.at("frequency_hz").array()) {
      if (hz.number() > 0.0) flexible.push_back(hz.number());
    }
    return flexible;
  }
};

void expect_near(const std::vector<double>& found, const std::vector<double>& exact,
                 double relative) {
  ASSERT_GE(found.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (exact[i] <= 0.0) continue;
    EXPECT_NEAR(found[i], exact[i], relative * exact[i]) << "mode " << i + 1;
  }
}

constexpr const char* kAluminium =
    "youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\"";

TEST_F(ImportedModes, TwentyOfAPlateAtTheDefault) {
  EVERY_FOURTH_LANDING();
  write("body.stl", box_stl(600, 600, 20));
  expect_near(frequencies(kAluminium, 20),
              {178.9033,  264.0703,  334.3557,  463.3912,  463.3912,  828.3701,  828.3701,
               841.9149,  917.1476,  1037.6694, 1387.2754, 1387.2754, 1564.5996, 1645.7702,
               1745.5952, 1745.5952, 1992.951,  2108.627,  2213.038,  2616.918,  2616.918},
              1e-3);
}

TEST_F(ImportedModes, TwelveOfAStripAtTheDefault) {
  EVERY_FOURTH_LANDING();
  write("body.stl", box_stl(500, 20, 2));
  expect_near(
      frequencies("youngs_modulus = \"210 GPa\", poissons_ratio = 0.3, density = \"7850 kg/m^3\"",
                  11),
      {42.534, 117.264, 229.937, 380.211, 422.906, 568.176, 618.167, 793.891, 1057.418, 1153.697,
       1237.903},
      5e-3);
}

// A study of that body with no word about patches: what looks up is where devices go.
std::string without_patches(const std::string& body, const std::string& edge_length) {
  return "geometry = { " + body + " }\nmaterial = { " + kAluminium +
         " }\nmesh = { edge_length = \"" + edge_length + R"(", order = 2 }
modes = { count = 8, damping_ratio = 0.005 }
sensor = [
  { name = "s1", at = ["8 mm", "7 mm"], direction = "z" },
  { name = "s2", at = ["50 mm", "9 mm"], direction = "z" },
  { name = "s3", at = ["10 mm", "33 mm"], direction = "z" },
]
actuator = [{ name = "a1", at = ["40 mm", "30 mm"], direction = "z" }]
[placement]
modes = 3
[priors]
samples = [60]
modes = 3
)";
}

// From `check` to the report. A file known by its outline alone gets a second forecast.
class StudiesOfFiles : public ImportedModes {
 protected:
  void expect_all_verbs(const std::string& study, const std::string& face) const {
    SCOPED_TRACE(study);
    write("study.toml", study);
    const Ended check = run({"check", "study.toml"});
    EXPECT_EQ(check.status, 0) << check.err;
    EXPECT_FALSE(says(check.out + check.err, "patch"));
    fs::remove_all(folder_ / "out");
    const Ended ended = run({"study", "study.toml", "-o", "out", "--no-pictures"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(says(ended.err, "with the mesh: forecast: "));
    EXPECT_TRUE(says(ended.err, "placement.on: the face that looks along z, " + face));
    EXPECT_FALSE(says(ended.out + ended.err, "patch"));
    for (const auto* file : {"modes.json", "placement.json", "report.html"}) {
      EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    }
    const Ended priors = run({"priors", "study.toml", "-o", "out", "--no-pictures"});
    EXPECT_EQ(priors.status, 0) << priors.err;
    EXPECT_TRUE(fs::exists(folder_ / "out/priors.json"));
  }
};

bool reads_step() { return fs::exists(CHLADNI_BINARY_DIR "/bin/chladni-step"); }

TEST_F(StudiesOfFiles, OfABlockNameNoPatch) {
  const std::string face = "96 cm2 of the 96";
  write("body.stl", box_stl(120, 80, 6));
  expect_all_verbs(without_patches("file = \"body.stl\", unit = \"mm\"", "12 mm"), face);
  if (!reads_step()) return;
  fs::copy(CHLADNI_SOURCE_DIR "/tests/io/data/named_block.step", folder_ / "body.step");
  expect_all_verbs(without_patches("file = \"body.step\"", "12 mm"), face);
}

// Its face has three holes for pins, and pockets lie below it.
TEST_F(StudiesOfFiles, OfARibbedChuckNameNoPatch) {
  if (!reads_step()) GTEST_SKIP() << "no reader of STEP here";
  const std::string face = "572.799 cm2 of the 572.9";
  fs::copy(CHLADNI_SOURCE_DIR "/models/chuck/chuck.step", folder_ / "chuck.step");
  expect_all_verbs(without_patches("file = \"chuck.step\"", "14 mm"), face);
  ASSERT_EQ(run({"convert", "chuck.step", "chuck.stl"}).status, 0);
  expect_all_verbs(without_patches("file = \"chuck.stl\", unit = \"mm\"", "14 mm"), face);
}

// The guess of 110 MB, which may be a third too high, passes a limit of 100 MB; the 120 MB of the
// mesh do not.
TEST_F(StudiesOfFiles, AreRefusedWhereTheMeshIsMoreThanTheGuess) {
  if (!reads_step()) GTEST_SKIP() << "no reader of STEP here";
  fs::copy(CHLADNI_SOURCE_DIR "/models/chuck/chuck.step", folder_ / "chuck.step");
  write("study.toml", without_patches("file = \"chuck.step\"", "14 mm"));
  const auto limited = [&](const char* limit_gb) {
    return run({"modes", "study.toml", "-o", "out", "--no-pictures", "--no-cache", "--memory-limit",
                limit_gb});
  };
  const Ended late = limited("0.1");
  EXPECT_EQ(late.status, 5) << late.err;
  EXPECT_TRUE(says(late.err, "with the mesh: forecast: "));
  EXPECT_TRUE(says(late.err, "and there is 100 MB"));
  EXPECT_EQ(left("out"), std::vector<std::string>{});
  const Ended early = limited("0.07");
  EXPECT_EQ(early.status, 5) << early.err;
  EXPECT_FALSE(says(early.err, "with the mesh")) << "the guess is enough to refuse it";
}

// The first, a twist of open ribs, converges slowly (their edges are singular): not compared here.
TEST_F(ImportedModes, OfALightWeightedTable) {
  EVERY_EIGHTH_LANDING();
  if (!fs::exists(kTable)) GTEST_SKIP() << kTable << " is not here";
  fs::copy(kTable, folder_ / "body.stl");
  expect_near(
      frequencies(kAluminium, 12, "mesh = { edge_length = \"20 mm\" }\n"),
      {0.0, 556.89, 598.37, 617.00, 617.01, 1016.6, 1466.5, 1466.6, 1497.9, 1557.4, 1783.8, 1783.9},
      2e-3);
}

}  // namespace
}  // namespace chladni::app
