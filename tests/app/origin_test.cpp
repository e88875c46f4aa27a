// Results say which state of a study and of its files they come from.
#include "study/origin.h"

#include "base/sha256.h"
#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class Origins : public CommandLine {
 protected:
  // A plate whose truth is thicker, and what `verb` leaves of it in "out".
  Ended left_by(const std::string& verb, const std::string& thickness = "5 mm") const {
    write("real.toml", with_thickness("5.2 mm"));
    const auto study = write("study.toml", with_thickness(thickness) + channels() +
                                               "[measurement]\ntruth = \"real.toml\"\nmodes = 2\n");
    std::vector<std::string> arguments = {verb, study.string(), "-o", "out"};
    if (verb != "check") arguments.emplace_back("--no-pictures");
    return run(arguments);
  }
  static std::string with_thickness(const std::string& thickness) {
    std::string text = kPlate;
    return text.replace(text.find("5 mm"), 4, thickness);
  }
  static std::string channels() {
    std::string text;
    int number = 2;
    for (const auto* at : {"[\"40 mm\", \"20 mm\"]", "[\"40 mm\", \"-20 mm\"]",
                           "[\"-40 mm\", \"-20 mm\"]", "[\"5 mm\", \"3 mm\"]"}) {
      text += "[[sensor]]\nname = \"s" + std::to_string(number++) + "\"\nat = " + at +
              "\ndirection = \"z\"\n";
    }
    return text;
  }
  [[nodiscard]] io::Json json(const std::string& file) const {
    return io::parse_json(whole(folder_ / "out" / file));
  }
};

TEST_F(Origins, AreTheFilesThatAResultStandsOn) {
  const auto study = left_by("study");
  ASSERT_EQ(study.status, 0) << study.err;
  EXPECT_TRUE(json("modes.json").at("study").at("inputs").array().empty());
  const auto inputs = json("interpolation.json").at("study").at("inputs").array();
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].at("file").string(), "real.toml");
  EXPECT_EQ(inputs[0].at("sha256").string(), sha256(whole(folder_ / "real.toml")));
  const auto page = whole(folder_ / "out/report.html");
  EXPECT_TRUE(says(page, "sha256 of real.toml</dt><dd>" + sha256(whole(folder_ / "real.toml"))));
  EXPECT_TRUE(
      says(page, "isotropic: youngs_modulus 7e+10, poissons_ratio 0.33, density 2700 (SI)"));
  EXPECT_TRUE(says(page, "<dt>date</dt>"));
}

TEST_F(Origins, EndWhereATruthExtendsTheStudyThatNamesIt) {
  write("study.toml",
        std::string(kPlate) + channels() + "[measurement]\ntruth = \"real.toml\"\nmodes = 2\n");
  write("real.toml", "extends = \"study.toml\"\ngeometry.plate.thickness = \"5.2 mm\"\n");
  const auto ended = run({"interpolate", "study.toml", "-o", "out", "--no-pictures"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(json("interpolation.json").at("study").at("inputs").array()[0].at("file").string(),
            "real.toml");
}

TEST_F(Origins, OfABodyFromAFileHaveTheFile) {
  fs::copy_file(CHLADNI_SOURCE_DIR "/models/garteur/airplane.off", folder_ / "airplane.off");
  write("study.toml", R"(geometry = { file = "airplane.off", unit = "mm" }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.3, density = "2700 kg/m^3" }
)");
  ASSERT_EQ(run({"check", "study.toml", "-o", "out"}).status, 0);
  const auto inputs = json("study.json").at("study").at("inputs").array();
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].at("file").string(), "airplane.off");
  EXPECT_EQ(inputs[0].at("sha256").string(), sha256(whole(folder_ / "airplane.off")));
}

TEST_F(Origins, NameEachFileOfTheStudyButThoseThatAreNotThere) {
  write("rig.toml", with_thickness("5.2 mm"));
  for (const auto* file : {"a.csv", "b.csv", "played.csv", "replay.csv"}) write(file, "x");
  const auto study =
      study::read_study(write("study.toml", std::string(kPlate) +
                                                "[[actuator]]\nname = \"a1\"\nat = [\"5 mm\", \"0 "
                                                "mm\"]\ndirection = \"z\"\n" +
                                                R"([measurement]
frf = "a.csv"
validation = "b.csv"
shapes = "none.csv"
[experiment]
excitation = "played.csv"
[observer]
replay = "replay.csv"
truth = "rig.toml"
[[observer.disturbance]]
name = "d"
kind = "actuators"
rms = "0.1 N"
)"));
  std::vector<std::string> names;
  for (const auto& one : study::named_files(study, true)) names.push_back(one.name);
  std::ranges::sort(names);
  EXPECT_EQ(names,
            (std::vector<std::string>{"a.csv", "b.csv", "played.csv", "replay.csv", "rig.toml"}));
  EXPECT_TRUE(study::named_files(study, false).empty());
}

// A series lends its folder to specimens that lie below it and extend it.
TEST_F(Origins, NameTheDataOfSpecimensInAFolderBelow) {
  fs::create_directories(folder_ / "series");
  write("series/one.csv", "frequency_hz\n500\n");
  write("series/one.toml", "extends = \"../design.toml\"\n[measurement]\nmodes = \"one.csv\"\n");
  const auto file = write("design.toml", std::string(kPlate) +
                                             "[[specimen]]\nname = \"one\"\nstudy = "
                                             "\"series/one.toml\"\n");
  std::vector<std::string> names;
  for (const auto& one : study::named_files(study::read_study(file), true)) {
    names.push_back(one.name);
  }
  EXPECT_EQ(std::ranges::count(names, "series/one.csv"), 1) << names.size();
  const auto watched = study::files_of(file, {});
  EXPECT_EQ(std::ranges::count(watched, folder_ / "series/one.csv"), 1) << watched.size();
}

TEST_F(Origins, AFileIsHashedAsItsBytesAre) {
  for (const std::size_t size :
       {0U, 1U, 55U, 56U, 63U, 64U, 65U, 1048575U, 1048576U, 1048577U, 3000001U}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7919U % 251U);
    EXPECT_EQ(sha256_of_file(write("bytes", bytes)), sha256(bytes)) << size;
  }
  EXPECT_THROW((void)sha256_of_file(folder_ / "nowhere"), std::invalid_argument);
}

TEST_F(Origins, TheDateIsNoPartOfReproducibleResults) {
  write("study.toml", kPlate);
  ASSERT_EQ(run({"study", "study.toml", "-o", "out", "--no-pictures", "--reproducible"}).status, 0);
  EXPECT_FALSE(says(whole(folder_ / "out/report.html"), "<dt>date</dt>"));
  const auto dated = ended(started({"study", "study.toml", "-o", "out", "--no-pictures"}, "",
                                   [] { setenv("SOURCE_DATE_EPOCH", "86400", 1); }));
  ASSERT_EQ(dated.status, 0) << dated.err;
  EXPECT_TRUE(says(whole(folder_ / "out/report.html"), "<dt>date</dt><dd>1970-01-02 00:00 UTC"));
}

TEST_F(Origins, OlderResultsBesideNewOnesAreSaid) {
  ASSERT_EQ(left_by("study").status, 0);
  const auto report = whole(folder_ / "out/report.html");
  const auto again = left_by("modes");
  EXPECT_FALSE(says(again.err, "earlier state")) << "nothing changed";
  EXPECT_EQ(whole(folder_ / "out/report.html"), report);

  const auto modes = left_by("modes", "8 mm");
  EXPECT_EQ(modes.status, 0) << modes.err;
  EXPECT_TRUE(says(modes.err, "report.html was of an earlier state of the study"));
  EXPECT_TRUE(says(modes.err, "interpolation.json, mesh.json and the pictures"));
  EXPECT_FALSE(fs::exists(folder_ / "out/report.html"));
  EXPECT_EQ(whole(folder_ / "out/report_before.html"), report);

  EXPECT_FALSE(says(left_by("study", "8 mm").err, "earlier state")) << "all is new";
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
}

TEST_F(Origins, SoAreResultsOfOtherFiles) {
  ASSERT_EQ(left_by("study").status, 0);
  write("real.toml", with_thickness("5.4 mm"));
  const auto modes = run({"modes", "study.toml", "-o", "out", "--no-pictures"});
  EXPECT_TRUE(says(modes.err, "report.html was of an earlier state"));
  EXPECT_TRUE(says(modes.err, "interpolation.json"));
  EXPECT_FALSE(says(modes.err, "modes.json"));
}

TEST_F(Origins, FilesOfOthersAreLeftAlone) {
  fs::create_directories(folder_ / "out");
  std::ofstream(folder_ / "out/report.html") << "<p>my own page</p>";
  std::ofstream(folder_ / "out/mine.json") << R"({"study": "mine"})";
  std::ofstream(folder_ / "out/broken.json") << "{";
  const auto study = left_by("study");
  EXPECT_EQ(study.status, 0) << study.err;
  const auto check = left_by("check", "8 mm");
  EXPECT_TRUE(says(check.err, "report.html was of an earlier state")) << "now it is Chladni's";
  EXPECT_EQ(whole(folder_ / "out/mine.json"), R"({"study": "mine"})");
  EXPECT_FALSE(says(check.err, "mine.json"));
  EXPECT_FALSE(says(check.err, "broken.json"));
}

// --- The version has its commit.

TEST_F(CommandLine, TheVersionHasItsCommitEverywhere) {
  const auto said = run({"--version"}).out;
  const std::string version = said.substr(said.find(' ') + 1, said.find('\n') - said.find(' ') - 1);
  EXPECT_TRUE(version.find("+g") != version.npos || version.ends_with("+unknown-commit")) << said;
  write("study.toml", kPlate);
  ASSERT_EQ(run({"study", "study.toml", "-o", "out", "--no-pictures"}).status, 0);
  EXPECT_EQ(io::parse_json(whole(folder_ / "out/modes.json")).at("chladni").string(), version);
  EXPECT_TRUE(says(whole(folder_ / "out/report.html"), version));
}

}  // namespace
}  // namespace chladni::app
