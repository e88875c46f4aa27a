// The program as a process: exit codes, what goes to which stream, what is left behind.
#include <sys/mount.h>

#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

TEST_F(CommandLine, UsageErrorsAreTwo) {
  EXPECT_EQ(run({}).status, 2);
  EXPECT_EQ(run({"sing", "study.toml"}).status, 2);
  EXPECT_EQ(run({"modes"}).status, 2);
  EXPECT_EQ(run({"modes", "study.toml", "--thread", "2"}).status, 2);
  EXPECT_EQ(run({"modes", "study.toml", "--threads", "0"}).status, 2);
  EXPECT_EQ(run({"list", "songs"}).status, 2);
}

TEST_F(CommandLine, ASlipIsAnsweredWithWhatWasMeant) {
  const auto verb = run({"mdoes", "study.toml"});
  EXPECT_EQ(verb.status, 2);
  EXPECT_TRUE(says(verb.err, "there is no verb \"mdoes\"; did you mean \"modes\"?")) << verb.err;
  for (const auto* word : {"--thread", "--thread=2"}) {
    const auto option = run({"modes", "study.toml", word, "2"});
    EXPECT_EQ(option.status, 2);
    EXPECT_TRUE(says(option.err, "modes has no option \"--thread\"; did you mean \"--threads\"?"))
        << option.err;
  }
  EXPECT_TRUE(says(run({"modes", "study.toml", "--no-picture"}).err, "\"--no-pictures\"?"));
  const auto far = run({"sing", "study.toml"}).err;
  EXPECT_TRUE(says(far, "there is no verb \"sing\"; expected \"check\", \"mesh\"")) << far;
  const auto missing = run({"modes"}).err;
  EXPECT_TRUE(says(missing, "STUDY is required")) << missing;
}

TEST_F(CommandLine, HelpAndVersionAreNoErrors) {
  const auto help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const auto* verb : {"check", "mesh", "modes", "study", "convert", "list", "doctor"}) {
    EXPECT_TRUE(says(help.out, verb));
  }
  EXPECT_TRUE(says(run({"--version"}).out, "chladni "));
}

TEST_F(CommandLine, CheckSaysWhatWasUnderstood) {
  const auto study = write("study.toml", R"(title = "OAT wafer table"
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
)");
  const auto check = run({"check", study.string(), "-o", "out"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_EQ(check.out.substr(0, check.out.find('\n')),
            "600.0 x 600.0 x 20.0 mm  19.44 kg  first plate estimate 186 Hz");
  EXPECT_TRUE(says(check.out, "forecast: "));
  EXPECT_EQ(left("out"), std::vector<std::string>{"study.json"});
  const auto json = io::parse_json(whole(folder_ / "out" / "study.json"));
  EXPECT_EQ(json.at("study").at("title").string(), "OAT wafer table");
  EXPECT_EQ(json.at("study").at("sha256").string().size(), 64U);
  EXPECT_DOUBLE_EQ(json.at("geometry").at("plate").at("length_m").number(), 0.6);
}

TEST_F(CommandLine, TheDefaultFolderIsNamedAfterTheStudy) {
  const auto study = write("small.toml", kPlate);
  EXPECT_EQ(run({"check", study.string()}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "small" / "study.json"));
}

TEST_F(CommandLine, ModesLeavesTheFilesOfTheContract) {
  const auto study = write("study.toml", kPlate);
  const auto modes = run({"modes", study.string(), "-o", "out", "--no-pictures"});
  EXPECT_EQ(modes.status, 0) << modes.err;
  EXPECT_TRUE(says(modes.out, "counted"));
  EXPECT_EQ(left("out"),
            (std::vector<std::string>{"channels.vtu", "modes.csv", "modes.json", "modes.vtu"}));
  const auto json = io::parse_json(whole(folder_ / "out" / "modes.json"));
  EXPECT_EQ(json.at("rigid_body_modes").number(), 6.0);
  EXPECT_GE(json.at("frequency_hz").array().size(), 10U);
  EXPECT_EQ(json.at("frequency_hz").array()[5].number(), 0.0);
  EXPECT_EQ(json.at("frequency_hz").array().size(), json.at("residual").array().size());
  EXPECT_EQ(json.at("frequency_hz").array().size(), json.at("sensors").at("s1").array().size());
  EXPECT_NEAR(json.at("mass_kg").number(), 0.081, 1e-9);
  EXPECT_NEAR(json.at("centre_of_mass_m").array()[2].number(), -2.5e-3, 1e-12);
  for (const auto* key :
       {"chladni", "seed", "seconds", "degrees_of_freedom", "inertia_kg_m2", "complete",
        "actuators", "frequency_error_hz", "clusters", "blas_kernel"}) {
    EXPECT_NO_THROW(static_cast<void>(json.at(key))) << key;
  }
  EXPECT_EQ(json.at("certificate").at("found").number(),
            json.at("certificate").at("counted").number());
}

TEST_F(CommandLine, JsonOnTheStandardOutputIsTheFile) {
  const auto study = write("study.toml", kPlate);
  const auto modes = run({"modes", study.string(), "-o", "out", "--no-pictures", "--json"});
  EXPECT_EQ(modes.status, 0) << modes.err;
  EXPECT_EQ(modes.out, whole(folder_ / "out" / "modes.json"));
}

TEST_F(CommandLine, QuietSaysNothingOnStandardError) {
  std::string text = kPlate;  // without its warning of a coarse mesh
  text.replace(text.find("order = 2"), 9, "order = 3");
  const auto study = write("study.toml", text);
  EXPECT_EQ(run({"modes", study.string(), "--no-pictures", "--quiet"}).err, "");
  const auto loud = run({"modes", study.string(), "--no-pictures"});
  EXPECT_TRUE(says(loud.err, "forecast: "));
  EXPECT_EQ(loud.err.find('\033'), std::string::npos) << "no colours or progress in a file";
}

TEST_F(CommandLine, TheSameInputGivesTheSameFiles) {
  const auto study = write("study.toml", kPlate);
  for (const auto* out : {"one", "two"}) {
    ASSERT_EQ(run({"study", study.string(), "-o", out, "--no-pictures", "--reproducible"}).status,
              0);
  }
  ASSERT_EQ(left("one"), left("two"));
  EXPECT_GE(left("one").size(), 6U);
  for (const auto& name : left("one")) {
    EXPECT_EQ(whole(folder_ / "one" / name), whole(folder_ / "two" / name)) << name;
  }
}

TEST_F(CommandLine, WallTimesAreAllThatDiffers) {
  const auto study = write("study.toml", kPlate);
  const auto without_seconds = [&](const std::string& out) {
    EXPECT_EQ(run({"modes", study.string(), "-o", out, "--no-pictures"}).status, 0);
    const std::string text = whole(folder_ / out / "modes.json");
    const auto begin = text.find("\"seconds\"");
    return text.substr(0, begin) + text.substr(text.find('}', begin));
  };
  EXPECT_EQ(without_seconds("one"), without_seconds("two"));
}

TEST_F(CommandLine, ExpectationsMetAreZeroAndMissedAreFour) {
  const std::string plate = kPlate;
  const auto good = write("good.toml", plate +
                                           "[expect]\nrigid_body_modes = { value = 6 }\n"
                                           "mass = { value = \"81 g\", within = \"0.001 g\" }\n");
  const auto met = run({"check", "--expect", good.string()});
  EXPECT_EQ(met.status, 0) << met.err;
  EXPECT_TRUE(says(met.out, "met     mass"));
  const auto json = io::parse_json(run({"check", "--expect", "--json", good.string()}).out);
  EXPECT_TRUE(std::get<bool>(json.at("expect").at("mass").at("met").value()));
  for (const std::string far : {"1 Hz", "1 MHz"}) {
    const auto bad = write("bad.toml", plate + "[expect]\nfrequency_1 = { value = \"" + far +
                                           "\", within = \"1 %\" }\n");
    const auto missed = run({"check", "--expect", bad.string()});
    EXPECT_EQ(missed.status, 4) << far;
    EXPECT_TRUE(says(missed.out, "FAILED  frequency_1"));
    EXPECT_TRUE(says(missed.err, "1 of 1 expectations not met"));
    const auto told = io::parse_json(run({"check", "--expect", "--json", bad.string()}).out);
    const auto& one = told.at("expect").at("frequency_1");
    EXPECT_FALSE(std::get<bool>(one.at("met").value())) << far;
    EXPECT_NEAR(one.at("found").number(), 2600.0, 800.0);
    EXPECT_EQ(told.at("error").at("exit").number(), 4.0);
  }
}

// --- Bad input: exit 3 and one clear message.

class BadStudy : public CommandLine {
 protected:
  /// The plate with `from` replaced by `to`.
  Ended refused(const std::string& from, const std::string& to) {
    std::string text = kPlate;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    const auto study = write("study.toml", text.replace(at, from.size(), to));
    const auto check = run({"check", study.string(), "-o", "out"});
    EXPECT_EQ(check.status, 3) << check.err;
    EXPECT_EQ(check.out, "") << "nothing was understood";
    EXPECT_TRUE(left("out").empty());
    return check;
  }
};

TEST_F(BadStudy, Thickness) {
  EXPECT_TRUE(says(refused("\"5 mm\"", "\"0 mm\"").err, "geometry.plate.thickness is 0 mm"));
  EXPECT_TRUE(says(refused("\"5 mm\"", "\"-5 mm\"").err, "expected more than 0"));
  EXPECT_TRUE(says(refused("\"5 mm\"", "\"nan mm\"").err, "geometry.plate.thickness"));
  EXPECT_TRUE(says(refused("\"5 mm\"", "5").err, "has no unit"));
}

TEST_F(BadStudy, Material) {
  EXPECT_TRUE(says(refused("\"70 GPa\"", "\"0 GPa\"").err, "material.youngs_modulus is 0 GPa"));
  EXPECT_TRUE(says(refused("\"2700 kg/m^3\"", "\"-1 kg/m^3\"").err, "material.density is -1"));
  EXPECT_TRUE(says(refused("0.33", "0.5").err, "less than 0.5"));
  EXPECT_TRUE(says(refused("0.33", "nan").err, "material.poissons_ratio"));
}

TEST_F(BadStudy, UnknownKey) {
  EXPECT_TRUE(says(refused("thickness", "thicknes").err,
                   "study.toml:2:60: unknown key \"thicknes\" in geometry.plate; did you mean "
                   "\"thickness\"?"));
}

TEST_F(BadStudy, AMissingFile) {
  EXPECT_TRUE(says(run({"check", "nowhere.toml"}).err, "nowhere.toml"));
  EXPECT_EQ(run({"check", "nowhere.toml"}).status, 3);
  EXPECT_EQ(run({"check", "/dev/zero"}).status, 3);
  EXPECT_EQ(run({"check", "."}).status, 3);
}

TEST_F(CommandLine, AChannelOffTheBodySaysByHowFar) {
  std::string text = kPlate;
  text.replace(text.find("-40 mm"), 6, "-62 mm");
  const auto check = run({"check", write("study.toml", text).string()});
  EXPECT_EQ(check.status, 3);
  EXPECT_TRUE(says(check.err,
                   "sensor \"s1\" at (-62, 20) mm is 12 mm off the body; nearest is "
                   "(-50, 20) mm"));
}

TEST_F(CommandLine, AChannelJustOffTheBodyIsMovedAloud) {
  std::string text = kPlate;
  text.replace(text.find("-40 mm"), 6, "-50.4 mm");
  const auto check = run({"check", write("study.toml", text).string()});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.err, "0.4 mm off the body"));
}

TEST_F(CommandLine, UnitsOffByAThousandWarn) {
  std::string text = kPlate;
  for (const auto* length : {"100 mm", "60 mm", "5 mm"}) {
    const std::string in_metres =
        std::string(length).substr(0, std::string(length).find(' ')) + " m";
    text.replace(text.find(length), std::string(length).size(), in_metres);
  }
  text.resize(text.find("mesh ="));
  const auto check = run({"check", write("study.toml", text).string()});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.err, "warning: "));
  EXPECT_TRUE(says(check.err, "the body is 100 m long"));
}

TEST_F(CommandLine, AnOutputFolderThatCannotBeMade) {
  const auto study = write("study.toml", kPlate);
  const auto check = run({"check", study.string(), "-o", "/proc/nothing"});
  EXPECT_EQ(check.status, 3);
  EXPECT_TRUE(says(check.err, "/proc/nothing"));
  write("occupied", "");
  EXPECT_EQ(run({"check", study.string(), "-o", "occupied"}).status, 3);
}

TEST_F(CommandLine, ASecondRunIsToldWhoWritesThere) {
  const auto study = write("study.toml", kPlate);
  fs::create_directories(folder_ / "out");
  const fs::path lock = folder_ / "out/.chladni.lock";
  std::ofstream(lock) << "4711\n";
  const pid_t holder = fork();
  if (holder == 0) {
    setpgid(0, 0);
    execlp("flock", "flock", "-x", "-o", lock.c_str(), "sleep", "30", nullptr);
    _exit(97);
  }
  Ended check;
  for (int i = 0; i < 600 && check.status != 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    check = run({"check", study.string(), "-o", "out"});
    if (check.status == 0) std::ofstream(lock) << "4711\n";
  }
  setpgid(holder, holder);  // whichever of the two comes first
  kill(-holder, SIGTERM);   // what it started too: whoever reads this test's output waits for it
  waitpid(holder, nullptr, 0);
  EXPECT_EQ(check.status, 3);
  EXPECT_TRUE(says(check.err, "another run (process 4711)"));
}

TEST_F(CommandLine, AFullStandardOutputIsSaid) {
  const auto study = write("study.toml", kPlate);
  const std::vector<std::string> calls[] = {
      {"check", study.string()},          {"list", "keys"},    {"cache"},
      {"new", "plate", "-o", "new.toml"}, {"modes", "--help"}, {"--version"}};
  for (const auto& words : calls) {
    const auto full = run(words, "/dev/full");
    EXPECT_EQ(full.status, 5) << words.front();
    EXPECT_TRUE(says(full.err, "error: cannot write to the standard output")) << words.front();
  }
}

TEST_F(CommandLine, AFullDiskLeavesNoHalfFile) {
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "no right to mount a small disk here: not tested";
  }
  const auto study = write("study.toml", kPlate);
  const auto modes = run({"modes", study.string(), "-o", "disk", "--no-pictures"});
  const auto files = left("disk");
  umount(disk.c_str());
  EXPECT_EQ(modes.status, 5) << modes.err;
  EXPECT_TRUE(says(modes.err, "modes.vtu"));
  EXPECT_EQ(files, (std::vector<std::string>{"modes.csv", "modes.json"}));
}

TEST_F(CommandLine, CtrlCLeavesNothingHalf) {
  std::string text = kPlate;
  text.replace(text.find("\"10 mm\", order = 2"), 18, "\"3 mm\", order = 3");
  const auto study = write("study.toml", text);
  const pid_t child = started({"modes", study.string(), "-o", "out", "--no-pictures"});
  for (int i = 0; i < 3000 && whole(folder_ / "stderr").find("forecast") == std::string::npos;
       ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(child, SIGINT);
  const auto modes = ended(child);
  EXPECT_EQ(modes.status, 130) << modes.err;
  EXPECT_TRUE(left("out").empty());
}

TEST_F(CommandLine, ListsWhatThereIs) {
  EXPECT_TRUE(says(run({"list", "elements"}).out, "tet10"));
  EXPECT_TRUE(says(run({"list", "bodies"}).out, "wafer_table"));
  EXPECT_TRUE(says(run({"list", "formats"}).out, ".step"));
  EXPECT_TRUE(says(run({"list", "materials"}).out, "cubic"));
  EXPECT_TRUE(says(run({"list", "attachments"}).out, "resonator"));
}

// --- The studies that come with Chladni.

// All but the tables of tolerances, which studies name.
std::vector<std::string> model_studies() {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(CHLADNI_SOURCE_DIR "/models")) {
    const auto name = entry.path().filename();
    const bool is_study = name != "tolerances.toml" && name != "plan.toml";
    if (is_study && entry.path().extension() == ".toml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool leads_outside(const std::string& study) {
  return whole(study).find("\"../../../shared/data/") != std::string::npos;
}

class ModelStudies : public CommandLine {};

// Data that are measured, or that another study simulates, need not be there.
TEST_F(ModelStudies, AllPassTheirCheckOrSayWhereTheirDataAre) {
  const auto studies = model_studies();
  EXPECT_GE(studies.size(), 37U);
  for (const auto& study : studies) {
    const auto check = run({"check", study, "-o", "out", "--quiet", "--allow-outside",
                            fs::path(CHLADNI_SOURCE_DIR).parent_path().parent_path().string()});
    if (check.status == 3 && says(check.err, "measurement.frf")) {
      EXPECT_TRUE(says(check.err, "it does not come with the study: ")) << study << check.err;
      std::istringstream lines(check.err);  // a replay may not be there either
      for (std::string line; std::getline(lines, line);) {
        EXPECT_TRUE(says(line, "\" does not exist (looked for ")) << study << check.err;
      }
      continue;
    }
    EXPECT_EQ(check.status, 0) << study << "\n" << check.err;
  }
}

TEST_F(ModelStudies, ThatNeedDataFromElsewhereSayWhereTheyAre) {
  int count = 0;
  for (const auto& study : model_studies()) {
    if (!leads_outside(study)) continue;
    ++count;
    const auto check = run({"check", study, "-o", "out"});
    EXPECT_EQ(check.status, 3) << study;
    EXPECT_TRUE(says(check.err, "it does not come with the study: github.com/")) << study;
    EXPECT_TRUE(says(check.err, ", commit ")) << study;
  }
  EXPECT_EQ(count, 7);
}

TEST_F(ModelStudies, WithoutTheirDataAreRefusedOrGoOnAloud) {
  const auto study =
      write("study.toml", std::string(kPlate) +
                              "[[actuator]]\nname = \"a1\"\nat = [\"40 mm\", \"20 mm\"]\n"
                              "direction = \"z\"\n[measurement]\nfrf = \"far.csv\"\n"
                              "source = \"drawer 3\"\n")
          .string();
  for (const auto* verb : {"identify", "interpolate", "diagnose"}) {
    const auto refused = run({verb, study, "-o", "out"});
    EXPECT_EQ(refused.status, 3) << verb;
    EXPECT_TRUE(says(refused.err,
                     "far.csv: there is no such file; it does not come with the study: "
                     "drawer 3"))
        << verb;
  }
  const auto all = run({"study", study, "-o", "out", "--no-pictures"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_TRUE(says(all.err,
                   "far.csv: there is no such file; nothing that was measured is used; it does not "
                   "come with the study: drawer 3"));
}

}  // namespace
}  // namespace chladni::app
