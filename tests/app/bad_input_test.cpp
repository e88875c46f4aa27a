// Bad material, channels, output and resources, one test each: the message names the place and the
// remedy, nothing half is left. (Faults of the study's text: study_test.cpp; of surfaces:
// tests/mesh; of files: tests/io.)
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "io/json.h"
#include "tests/app/program.h"
#include "tests/rotation/turn.h"

namespace chladni::app {
namespace {

class BadInput : public CommandLine {
 protected:
  /// The plate with pieces of its text replaced.
  fs::path plate_with(const std::vector<std::pair<std::string, std::string>>& changes,
                      const std::string& added = "") const {
    std::string text = kPlate;
    for (const auto& [from, to] : changes) {
      const auto at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    return write("study.toml", text + added);
  }
  Ended modes(const fs::path& study) const {
    return run({"modes", study.string(), "-o", "out", "--no-pictures"});
  }
  Ended check(const fs::path& study) const { return run({"check", study.string(), "-o", "out"}); }
};

std::string sensor(const std::string& name, const std::string& at, const std::string& direction) {
  return "[[sensor]]\nname = \"" + name + "\"\nat = " + at + "\ndirection = " + direction + "\n";
}

// ---- Material.

TEST_F(BadInput, AnAnisotropyThatGivesEnergyIsRefusedWithItsEigenvalue) {
  const auto refused = check(plate_with(
      {{"youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\"",
        "symmetry = \"cubic\", c11 = \"60 GPa\", c12 = \"80 GPa\", c44 = \"50 GPa\", density = "
        "\"2329 kg/m^3\""}}));
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "study.toml:3:"));
  EXPECT_TRUE(says(refused.err, "c11 - c12 of the cubic stiffness is -2e+10 Pa"));
}

TEST_F(BadInput, ADensityPerCubicMetreThatWasMeantPerMillimetreWarns) {
  const auto odd = check(plate_with({{"2700 kg/m^3", "2.7e-9 t/m^3"}}));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "density is 2.7e-06 kg/m^3; aluminium has 2700, steel 7850"));
}

TEST_F(BadInput, AModulusWithoutItsPrefixWarns) {
  const auto odd = check(plate_with({{"70 GPa", "70 Pa"}}));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "is \"GPa\" meant?"));
}

// ---- Channels.

TEST_F(BadInput, AChannelInsideTheBodyIsMovedOutWithAWarning) {
  const auto study = plate_with({}, sensor("deep", R"(["0 mm", "0 mm", "-2 mm"])", "\"z\""));
  const auto odd = check(study);
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "sensor \"deep\" at (0, 0, -2) mm is 2 mm inside the body"));
  EXPECT_TRUE(says(odd.err, "(0, 0, 0) mm, is taken instead"));
  EXPECT_TRUE(says(modes(study).err, "2 mm inside the body"));
}

TEST_F(BadInput, AChannelWherePlacementKeepsOutIsNamed) {
  const auto odd = modes(
      plate_with({},
                 "[placement]\nmodes = 1\nkeep_out = [{ disc = { at = [\"-40 mm\", \"20 mm\"], "
                 "diameter = \"10 mm\" } }]\n"));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "placement.keep_out"));
  EXPECT_TRUE(says(odd.err, "sensor \"s1\" (line 8)"));
}

// Twist is the second mode; the middle of the plate stands still in it.
TEST_F(BadInput, ASensorOnANodalLineIsNamedWithItsModeAndGain) {
  const auto odd = modes(plate_with({}, sensor("middle", R"(["0 mm", "0 mm"])", "\"z\"")));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "sensors on nodal lines: \"middle\" of mode 8 (gain 0.00"));
  EXPECT_EQ(odd.err.find("no sensor sees"), std::string::npos) << odd.err;
  const auto json = io::parse_json(whole(folder_ / "out" / "modes.json"));
  EXPECT_TRUE(says(json.at("warnings").array().at(0).string() + odd.err, "nodal lines"));
}

TEST_F(BadInput, SensorsOnALineOfSymmetryAreToldTheModesTheyCannotSee) {
  std::string middle_line;
  for (const auto* x : {"-30", "10", "40"}) {
    middle_line +=
        sensor(std::string("m") + x, "[\"" + std::string(x) + " mm\", \"0 mm\"]", "\"z\"");
  }
  const auto odd = modes(plate_with(
      {{"[[sensor]]\nname = \"s1\"\nat = [\"-40 mm\", \"20 mm\"]\ndirection = \"z\"\n", ""}},
      middle_line));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "no sensor sees mode 8 ("));
}

TEST_F(BadInput, FewerSensorsThanModesToPlaceIsSaid) {
  const auto odd = modes(plate_with({}, "[placement]\nmodes = 3\n"));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "1 sensors for the 3 modes of [placement]"));
}

TEST_F(BadInput, AGoodChannelIsNoReasonToWarn) {
  const auto good = modes(plate_with({{"order = 2", "order = 3"}, {"count = 4", "count = 2"}}));
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.err.find("warning"), std::string::npos) << good.err;
}

// ---- What the mesh and the machine can give.

TEST_F(BadInput, AMeshTooCoarseForItsModesSaysByHowMuch) {
  const auto odd = modes(plate_with({{"edge_length = \"10 mm\"", "edge_length = \"30 mm\""}}));
  EXPECT_EQ(odd.status, 0) << odd.err;
  EXPECT_TRUE(says(odd.err, "% too high; for 1 % shorten mesh.edge_length to 0."));
}

TEST_F(BadInput, MoreModesThanThereAreIsRefused) {
  const auto refused = modes(
      plate_with({{"edge_length = \"10 mm\", order = 2", "edge_length = \"60 mm\", order = 1"},
                  {"count = 4", "count = 400"}}));
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "400 flexible modes were asked for, expected 1 to "));
}

// No frequency has few enough modes below it where there are so few degrees of freedom.
TEST_F(BadInput, AFrequencyBeyondATinyMeshIsRefused) {
  const auto refused = check(plate_with(
      {{"edge_length = \"10 mm\", order = 2", "edge_length = \"1 m\", order = 1, layers = 1"},
       {"count = 4", "up_to = \"500 Hz\""}}));
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "at most. Shorten mesh.edge_length"));
}

TEST_F(BadInput, AnEnormousMeshIsRefusedBeforeItIsLaid) {
  const auto refused = modes(plate_with({{"10 mm", "0.02 mm"}}));
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "take a longer edge length"));
}

TEST_F(BadInput, AFactorThatDoesNotFitIsRefusedWithTheMeshThatDoes) {
  EVERY_FOURTH_LANDING();
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer needs all addresses";
  const auto study = plate_with({{"10 mm", "0.8 mm"}});
  const auto refused =
      ended(started({"modes", study.string(), "-o", "out", "--no-pictures"}, "", [] {
        const rlimit limit{1'500'000'000, 1'500'000'000};
        setrlimit(RLIMIT_AS, &limit);
      }));
  EXPECT_EQ(refused.status, 5);
  EXPECT_TRUE(says(refused.err, "are forecast to need "));
  EXPECT_TRUE(says(refused.err, "mesh.edge_length = \""));
  EXPECT_TRUE(says(refused.err, "mesh.order = 3"));
  EXPECT_TRUE(left("out").empty());
}

// ---- Files and folders.

TEST_F(BadInput, AnEmptyStudyAFifoAndADeviceAreRefusedAtOnce) {
  write("empty.toml", "");
  EXPECT_TRUE(says(run({"check", "empty.toml"}).err, "the study lacks \"geometry\""));
  ASSERT_EQ(mkfifo((folder_ / "fifo.toml").c_str(), 0600), 0);
  const auto fifo = run({"check", "fifo.toml"});
  EXPECT_EQ(fifo.status, 3);
  EXPECT_TRUE(says(fifo.err, "is not a regular file"));
  EXPECT_EQ(run({"check", "/dev/null"}).status, 3);
}

TEST_F(BadInput, AStudyThatMayNotBeReadSaysSo) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything: not tested";
  const auto study = plate_with({});
  fs::permissions(study, fs::perms::none);
  const auto refused = check(study);
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "study.toml"));
}

TEST_F(BadInput, ALinkInTheOutputFolderIsReplacedNotFollowed) {
  const auto victim = write("victim", "precious");
  fs::create_directories(folder_ / "out");
  fs::create_symlink(victim, folder_ / "out" / "study.json");
  EXPECT_EQ(check(plate_with({})).status, 0);
  EXPECT_EQ(whole(victim), "precious");
  EXPECT_FALSE(fs::is_symlink(folder_ / "out" / "study.json"));
}

TEST_F(BadInput, NamesWithMarkupStayText) {
  const std::string name = "<script>alert(1)</script>";
  const auto study = plate_with(
      {{"small plate", "a <b>\\\"plate\\\"</b> & more"}, {"\"s1\"", "\"" + name + "\""}});
  const auto done = run({"study", study.string(), "-o", "out", "--no-pictures"});
  EXPECT_EQ(done.status, 0) << done.err;
  const auto report = whole(folder_ / "out" / "report.html");
  EXPECT_EQ(report.find(name), std::string::npos);
  EXPECT_EQ(report.find("<b>"), std::string::npos);
  EXPECT_TRUE(says(report, "&lt;script&gt;"));
  const auto json = io::parse_json(whole(folder_ / "out" / "modes.json"));
  EXPECT_NO_THROW(static_cast<void>(json.at("sensors").at(name)));
}

TEST_F(BadInput, ResultsHoldNoPlaceNoHostAndNoClock) {
  const auto study = plate_with({});
  ASSERT_EQ(run({"study", study.string(), "-o", "out", "--no-pictures", "--reproducible"}).status,
            0);
  for (const auto& name : left("out")) {
    EXPECT_EQ(whole(folder_ / "out" / name).find(folder_.string()), std::string::npos) << name;
  }
}

// A comma for the decimal point in the environment changes neither what is read nor what is
// written.
TEST_F(BadInput, ALocaleWithCommasChangesNothing) {
  const std::string make =
      "localedef -i de_DE -f UTF-8 " + (folder_ / "de_DE.UTF-8").string() + " >/dev/null 2>&1";
  if (std::system(make.c_str()) != 0) GTEST_SKIP() << "no localedef: not tested";
  const auto study = plate_with({});
  ASSERT_EQ(run({"study", study.string(), "-o", "plain", "--no-pictures", "--reproducible"}).status,
            0);
  const auto german = ended(started(
      {"study", study.string(), "-o", "german", "--no-pictures", "--reproducible"}, "", [&] {
        setenv("LOCPATH", folder_.c_str(), 1);
        setenv("LC_ALL", "de_DE.UTF-8", 1);
        setenv("LANG", "de_DE.UTF-8", 1);
      }));
  ASSERT_EQ(german.status, 0) << german.err;
  ASSERT_EQ(left("plain"), left("german"));
  for (const auto& name : left("plain")) {
    EXPECT_EQ(whole(folder_ / "plain" / name), whole(folder_ / "german" / name)) << name;
  }
}

// SIGKILL leaves no time to tidy up: what has its final name must be whole all the same.
TEST_F(BadInput, KilledWhileItWritesLeavesOldOrNew) {
  const auto study = plate_with({});
  ASSERT_EQ(modes(study).status, 0);
  const auto vtu = whole(folder_ / "out" / "modes.vtu");
  for (int wait = 0; wait < 20; ++wait) {
    const pid_t child = started({"modes", study.string(), "-o", "out", "--no-pictures"});
    std::this_thread::sleep_for(std::chrono::milliseconds(100 + 17 * wait));
    kill(child, SIGKILL);
    static_cast<void>(ended(child));
    EXPECT_NO_THROW(static_cast<void>(io::parse_json(whole(folder_ / "out" / "modes.json"))));
    EXPECT_EQ(whole(folder_ / "out" / "modes.vtu"), vtu);
  }
  EXPECT_EQ(modes(study).status, 0) << "the folder can be used again";
}

// A mesher that is not there, or dies, arrives as such.
TEST_F(BadInput, AWorkerThatIsMissingIsSix) {
  fs::create_directories(folder_ / "bin");
  fs::copy_file(CHLADNI_BINARY_DIR "/bin/chladni", folder_ / "bin" / "chladni");
  const auto study = plate_with({{"order = 2", "order = 2, mesher = \"tetgen\""}});
  const std::string command = (folder_ / "bin" / "chladni").string() + " mesh " + study.string() +
                              " -o " + (folder_ / "out").string() + " 2>" +
                              (folder_ / "said").string() + " >/dev/null";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 6) << whole(folder_ / "said");
  EXPECT_TRUE(says(whole(folder_ / "said"), "chladni-tetgen"));
}

TEST_F(BadInput, AWorkerThatDiesIsSix) {
  fs::create_directories(folder_ / "bin");
  fs::copy_file(CHLADNI_BINARY_DIR "/bin/chladni", folder_ / "bin" / "chladni");
  std::ofstream(folder_ / "bin" / "chladni-tetgen") << "#!/bin/sh\nkill -ABRT $$\n";
  fs::permissions(folder_ / "bin" / "chladni-tetgen", fs::perms::owner_all);
  const auto study = plate_with({{"order = 2", "order = 2, mesher = \"tetgen\""}});
  const std::string command = (folder_ / "bin" / "chladni").string() + " mesh " + study.string() +
                              " -o " + (folder_ / "out").string() + " 2>" +
                              (folder_ / "said").string() + " >/dev/null";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 6) << whole(folder_ / "said");
  EXPECT_TRUE(says(whole(folder_ / "said"), "signal 6"));
  EXPECT_TRUE(left("out").empty());
}

// A size that is too small is refused with what the body needs: it was understood.
TEST_F(CommandLine, NumbersOfOptionsMayHaveAUnit) {
  const auto study = write("plate.toml", R"(title = "plate"
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
)");
  for (const auto* size : {"0.001", "1 MB", "1MB", "0.000001 TB", "0.001 GB"}) {
    const auto refused = run({"modes", study.string(), "-o", "out", "--memory-limit", size});
    EXPECT_EQ(refused.status, 5) << size << refused.err;
  }
  for (const auto* size : {"0", "-8 GB", "8 kg", "nan", "inf", "", "8 GB 2"}) {
    const auto wrong = run({"modes", study.string(), "--memory-limit", size});
    EXPECT_EQ(wrong.status, 2) << size;
    EXPECT_TRUE(says(wrong.err, "expected a size such as 8, \"8 GB\" or \"500 MB\"")) << wrong.err;
  }
  EXPECT_TRUE(
      says(run({"check", "rig.csv", "--sample-time", "1 kg"}).err, "expected a time such as"));
  EXPECT_TRUE(says(run({"modes", study.string(), "--animate", "0"}).err, "1 to 1000000"));
}

// Frequencies of another structure, or in kHz: there is no pair to begin with.
TEST_F(CommandLine, MeasuredModesFarFromAllSimulatedOnesAreRefused) {
  write("far.csv", "frequency_hz\n0.15\n");
  const auto file = write("far.toml",
                          "geometry = { plate = { length = \"400 mm\", width = \"300 mm\", "
                          "thickness = \"12 mm\" } }\nmaterial = \"aluminium 6061\"\n"
                          "modes = { count = 6, damping_ratio = 0.005 }\n"
                          "measurement.modes = \"far.csv\"\n[[sensor]]\nname = \"s1\"\n"
                          "at = [\"-150 mm\", \"-100 mm\"]\ndirection = \"z\"\n");
  const auto done = run({"diagnose", file.string(), "-o", "far", "--no-pictures"});
  EXPECT_EQ(done.status, 3) << done.err;
  EXPECT_TRUE(says(done.err, "far from all simulated ones")) << done.err;
}

// They did nothing there, and nobody was told.
TEST_F(CommandLine, CheckTakesOptionsOfDataForDataAlone) {
  const auto study = write("plate.toml", kPlate).string();
  for (const std::string option : {"--unit", "--sample-time"}) {
    const auto refused = run({"check", study, option, option == "--unit" ? "g" : "1 ms"});
    EXPECT_EQ(refused.status, 3) << refused.out;
    EXPECT_TRUE(says(refused.err, option + " is of a file of measured data")) << refused.err;
  }
  write("frf.csv", "freq_hz,re_y1u1,im_y1u1\n1,2,3\n");
  const auto refused = run({"check", "frf.csv", "--expect"});
  EXPECT_EQ(refused.status, 3) << refused.out;
  EXPECT_TRUE(says(refused.err, "--expect is of a study")) << refused.err;
}

TEST_F(CommandLine, OnlyVerbsThatLeaveModesAnimateOne) {
  for (const auto* verb : {"place", "priors", "experiment", "simulate", "identify", "interpolate",
                           "observe", "compare", "diagnose"}) {
    const auto refused = run({verb, "plate.toml", "--animate", "7"});
    EXPECT_EQ(refused.status, 2) << verb;
    EXPECT_TRUE(says(refused.err, std::string(verb) + " has no option \"--animate\""));
  }
  for (const auto* verb : {"modes", "study"}) {
    EXPECT_TRUE(says(run({verb, "--help"}).out, "--animate")) << verb;
  }
}

}  // namespace
}  // namespace chladni::app
