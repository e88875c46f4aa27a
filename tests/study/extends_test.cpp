// A study that extends another: what is merged, what is refused, and trees that are texts again.
#include "study/extends.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.h"
#include "host/atomic_file.h"
#include "steps/extend/extended_study.h"
#include "study/problems.h"
#include "study/schemas.h"
#include "study/study.h"
#include "study/toml/toml_text.h"
#include "tests/app/quiet_run.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

const std::string kBase = R"(title = "plate"  # a comment
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
modes = { count = 12, damping_ratio = "0.5 %" }

[[sensor]]
name = "s1"
at = ["-250 mm", "150 mm"]
direction = "z"
[[sensor]]
name = "s2"
at = ["110 mm", "40 mm"]
direction = "z"
gain = 1.1
[[actuator]]
name = "a1"
at = ["-170 mm", "-120 mm"]
direction = "z"
)";

class Extends : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    const auto file = folder_.path() / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  [[nodiscard]] study::Study read(const std::string& text) const {
    return study::read_study(write("own.toml", text));
  }
  void refused(const std::string& text, const std::string& word) const {
    try {
      (void)read(text);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }

  app::TestFolder folder_{"extends"};
};

const mesh::Plate& plate_of(const study::Study& study) {
  return std::get<mesh::Plate>(study.geometry.body);
}

TEST_F(Extends, WithoutMoreIsTheStudyItself) {
  const auto base = study::read_study(write("base.toml", kBase));
  const auto own = read("extends = \"base.toml\"\n");
  EXPECT_EQ(own.title, base.title);
  EXPECT_EQ(own.sensors.size(), 2U);
  EXPECT_EQ(plate_of(own).thickness, plate_of(base).thickness);
  EXPECT_EQ(own.bases, std::vector{folder_.path() / "base.toml"});
  EXPECT_EQ(base.text, kBase);
  EXPECT_NE(own.sha256, base.sha256);
}

TEST_F(Extends, MergesTablesByKeyAndChannelsByName) {
  write("base.toml", kBase + "[expect]\nmass = { value = \"6.48 kg\", within = \"1 %\" }\n");
  const auto own = read(R"(extends = "base.toml"
title = "thicker"
geometry.plate.thickness = "12 mm"
modes = { count = 20 }
[[sensor]]
name = "s2"
at = ["120 mm", "40 mm"]
[[sensor]]
name = "s1"
removed = true
[[sensor]]
name = "s3"
at = ["0 mm", "0 mm"]
direction = "z"
)");
  EXPECT_EQ(own.title, "thicker");
  EXPECT_NEAR(plate_of(own).thickness, 0.012, 1e-15);
  EXPECT_NEAR(plate_of(own).length, 0.6, 1e-15);
  EXPECT_EQ(own.modes.count, 20);
  EXPECT_NEAR(own.modes.damping_ratio, 0.005, 1e-15);
  ASSERT_EQ(own.sensors.size(), 2U);
  EXPECT_EQ(own.sensors[0].name, "s2");
  EXPECT_EQ(own.sensors[0].gain, 1.1);
  EXPECT_NEAR(own.sensors[0].at.point.x(), 0.12, 1e-15);
  EXPECT_EQ(own.sensors[1].name, "s3");
  EXPECT_EQ(own.actuators.size(), 1U);
  EXPECT_TRUE(own.expectations.empty());
}

// The nearest base may remove all of its own sensors, and a sensor of a base further away.
TEST_F(Extends, RemovesChannelsOfEveryBase) {
  write("far.toml", kBase);
  write("near.toml", R"(extends = "far.toml"
[[sensor]]
name = "s3"
at = ["0 mm", "0 mm"]
direction = "z"
)");
  const auto own = read(R"(extends = "near.toml"
[[sensor]]
name = "s3"
removed = true
)");
  ASSERT_EQ(own.sensors.size(), 2U);
  EXPECT_EQ(own.sensors[0].name, "s1");
  const auto other = read(R"(extends = "near.toml"
[[sensor]]
name = "s1"
removed = true
)");
  ASSERT_EQ(other.sensors.size(), 2U);
  EXPECT_EQ(other.sensors[0].name, "s2");
  EXPECT_EQ(other.sensors[1].name, "s3");
}

// The system follows ".." from where a link leads, not from where it stands.
TEST_F(Extends, FindsTheFilesOfABaseBehindALink) {
  write("real/deep/w/base.toml", kBase + "[measurement]\nfrf = \"rig.csv\"\n");
  write("real/deep/w/rig.csv", "");
  fs::create_directories(folder_.path() / "x");
  fs::create_directory_symlink(folder_.path() / "real/deep/w", folder_.path() / "w");
  const auto file = write("x/own.toml", "extends = \"../w/base.toml\"\n");
  const auto own = study::read_study(file, {folder_.path() / "real"});
  EXPECT_TRUE(fs::equivalent(own.measurement->frf, folder_.path() / "real/deep/w/rig.csv"))
      << own.measurement->frf;
}

TEST_F(Extends, ReplacesABodyOfAnotherKind) {
  write("base.toml", kBase);
  const auto own = read(R"(extends = "base.toml"
geometry = { disc = { diameter = "300 mm", thickness = "10 mm" } }
)");
  EXPECT_EQ(std::get_if<mesh::Plate>(&own.geometry.body), nullptr);
}

TEST_F(Extends, GoesOnAndFindsFilesFromWhereTheyAreNamed) {
  write("parts/measured.csv", "freq_hz,re_s1a1,im_s1a1\n1,2,3\n2,3,4\n");
  write("parts/base.toml", kBase + "[measurement]\nfrf = \"measured.csv\"\n");
  write("parts/thick.toml", "extends = \"base.toml\"\ngeometry.plate.thickness = \"20 mm\"\n");
  const auto own = read("extends = \"parts/thick.toml\"\nseed = 3\n");
  EXPECT_NEAR(plate_of(own).thickness, 0.02, 1e-15);
  EXPECT_EQ(own.seed, 3U);
  ASSERT_EQ(own.bases.size(), 2U);
  EXPECT_EQ(own.bases[1].filename(), "base.toml");
  EXPECT_TRUE(fs::equivalent(own.measurement->frf, folder_.path() / "parts/measured.csv"));
}

TEST_F(Extends, FindsTheFilesOfEveryTable) {
  write("parts/base.toml", kBase + R"([experiment]
excitation = "signals.csv"
[observer]
replay = "time.csv"
truth = "rig.toml"
[[observer.point]]
name = "p"
at = ["10 mm", "0 mm"]
[[observer.disturbance]]
name = "amplifier"
kind = "actuators"
rms = "50 mN"
)");
  const auto own = read("extends = \"parts/base.toml\"\n");
  EXPECT_EQ(own.experiment->excitation, folder_.path() / "parts/signals.csv");
  EXPECT_EQ(own.observer->replay, folder_.path() / "parts/time.csv");
  EXPECT_EQ(own.observer->truth, folder_.path() / "parts/rig.toml");
}

TEST_F(Extends, FindsTheRecordThatNoFitSees) {
  write("parts/base.toml", kBase + "[measurement]\nfrf = \"a.csv\"\nvalidation = \"b.csv\"\n");
  const auto own = read("extends = \"parts/base.toml\"\n");
  EXPECT_EQ(own.measurement->validation, folder_.path() / "parts/b.csv");
}

// "`[[specimen]]`" is the table "specimen".
std::string table_of(const std::string& heading) {
  std::string name;
  std::ranges::copy_if(heading, std::back_inserter(name),
                       [](char c) { return std::string("`[]").find(c) == std::string::npos; });
  return name;
}

// A new key that names a file is one that a study in another folder finds, and whose content is in
// the hashes of results, only if it is among these.
TEST(FileKeys, AreThoseOfTheTablesOfAStudy) {
  std::set<std::pair<std::string, std::string>> of_tables, known;
  for (const auto& table : tables_of_a_study()) {
    for (const auto& key : table.keys) {
      const bool is_file = key.expected.starts_with("a path") || key.expected.starts_with("a file");
      if (is_file) of_tables.emplace(table_of(table.heading), key.name);
    }
  }
  for (const auto& [table, key] : kFileKeys) known.emplace(table, key);
  EXPECT_EQ(known, of_tables);
}

// Each file that a study names is in its list, so that `check` looks for it and hashes have it.
TEST_F(Extends, ListsEachFileThatIsNamed) {
  const std::vector<std::string> parts = {
      "[measurement]\nfrf = \"1.csv\"\nvalidation = \"2.csv\"\nshapes = \"3.csv\"\n",
      "[measurement]\ntime = \"4.csv\"\nperiod = 64\nsample_rate = \"1 kHz\"\n",
      "[measurement]\ntruth = \"5.toml\"\n",
      "[measurement]\nmodes = \"6.csv\"\nreference = \"7.csv\"\n",
      "[diagnosis]\ntolerances = \"tolerances.toml\"\n",
      "[experiment]\nexcitation = \"8.csv\"\n",
      "[[specimen]]\nname = \"p\"\nstudy = \"9.toml\"\n",
      "[observer]\nreplay = \"10.csv\"\ntruth = \"11.toml\"\n[[observer.disturbance]]\nname = "
      "\"d\"\nkind = \"actuators\"\nrms = \"1 N\"\n"};
  write("tolerances.toml", "");
  write("body.stl", "");
  std::set<std::string> listed, known;
  const auto list = [&](const study::Study& one) {
    for (auto [key, path, line, column] : one.files) {
      const auto place = key.find("[0]");
      listed.insert(place == key.npos ? key : key.erase(place, 3));
    }
  };
  for (const auto& part : parts) list(read(kBase + part));
  const std::string plate =
      R"({ plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } })";
  std::string text = kBase;
  list(read(text.replace(text.find(plate), plate.size(), R"({ file = "body.stl", unit = "mm" })")));
  for (const auto& [table, key] : kFileKeys) {
    known.insert(std::string(table) + "." + std::string(key));
  }
  EXPECT_EQ(listed, known);
}

TEST_F(Extends, TellsEveryFileThatIsNamedThereOrNot) {
  write("base.toml", kBase + "[measurement]\nfrf = \"measured.csv\"\ntruth = \"rig.toml\"\n");
  write("rig.toml", "extends = \"base.toml\"\n[measurement]\ntime = \"time.csv\"\n");
  write("own.toml", "extends = \"base.toml\"\nnonsense = 1\n");
  std::vector<std::string> names;
  for (const auto& file : study::files_of(folder_.path() / "own.toml")) {
    names.push_back(file.filename().string());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"own.toml", "base.toml", "measured.csv", "rig.toml",
                                             "time.csv"}));
  EXPECT_EQ(study::files_of(folder_.path() / "none.toml").size(), 1U);
}

// The whole of it is a study that a diagnosis may extend.
TEST_F(Extends, HasATextThatIsTheSameStudy) {
  write("base.toml", kBase);
  const auto own = read("extends = \"base.toml\"\ngeometry.plate.thickness = \"12 mm\"\n");
  const auto again = study::parse_study(own.text, folder_.path() / "again.toml");
  EXPECT_TRUE(again.bases.empty());
  EXPECT_EQ(plate_of(again).thickness, plate_of(own).thickness);
  EXPECT_EQ(again.sensors[1].gain, 1.1);
  diagnosis::Cause heavier;
  heavier.effect = "density";
  heavier.parameters = {{"relative", "1", 0.02, 0.001}};
  const auto extended = steps::extended_study(own.text, own.file, {}, {heavier}, folder_.path());
  EXPECT_TRUE(extended.unexpressed.empty());
  EXPECT_NE(extended.text.find("2754"), std::string::npos) << extended.text;
}

TEST_F(Extends, GoesOnForEightStudiesAndNoMore) {
  write("base_0.toml", kBase);
  for (int i = 1; i < 9; ++i) {
    write("base_" + std::to_string(i) + ".toml",
          "extends = \"base_" + std::to_string(i - 1) + ".toml\"\n");
  }
  EXPECT_EQ(read("extends = \"base_7.toml\"\n").bases.size(), 8U);
  EXPECT_THROW((void)read("extends = \"base_8.toml\"\n"), InvalidInput);
}

TEST(Problems, TellTwentyAndHowManyMore) {
  const auto told = [](int count) -> std::string {
    study::Problems problems("study.toml");
    for (int i = 0; i < count; ++i) problems.add(i + 1, 1, "wrong");
    try {
      problems.throw_if_any();
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(told(0), "");
  EXPECT_TRUE(told(20).ends_with("study.toml:20:1: wrong")) << told(20);
  EXPECT_TRUE(told(21).ends_with("study.toml:20:1: wrong\nstudy.toml: and 1 more")) << told(21);
}

TEST(NearestName, IsTheFirstOfThoseThatAreEquallyNear) {
  EXPECT_EQ(study::nearest_name("sensr", {"sensor", "sense"}), "sensor");
  EXPECT_EQ(study::nearest_name("ab", {"cd"}), "");  // two letters of two
  EXPECT_EQ(study::nearest_name("ab", {"ac"}), "ac");
}

TEST_F(Extends, RefusesWhatCannotBeMeant) {
  write("base.toml", kBase);
  refused("extends = \"nothing.toml\"\n", "own.toml:1:11: extends \"nothing.toml\"");
  refused("extends = 3\n", "extends is the number 3");
  refused("extends = \"own.toml\"\n", "extends itself");
  refused("extends = \"/etc/hostname\"\n", "leaves the study's folder");
  refused("extends = \"base.toml\"\n[[sensor]]\nname = \"s9\"\nremoved = true\n",
          "own.toml:2:1: sensor \"s9\" is to be removed");
  // What the study as a whole lacks is told where it says what it extends.
  write("bad.toml", kBase + "[modes2]\ncount = 3\n");
  refused("extends = \"bad.toml\"\n", "own.toml:1:11: ");
  write("a.toml", "extends = \"b.toml\"\n");
  write("b.toml", "extends = \"a.toml\"\n");
  refused("extends = \"a.toml\"\n", "extends itself");
}

void expect_same(const study::TomlNode& a, const study::TomlNode& b, const std::string& where) {
  ASSERT_EQ(a.kind, b.kind) << where;
  if (a.kind == study::TomlNode::Kind::text) {
    EXPECT_EQ(a.text, b.text) << where;
  }
  if (a.is_number()) {
    EXPECT_EQ(a.number, b.number) << where;
  }
  EXPECT_EQ(a.truth, b.truth) << where;
  ASSERT_EQ(a.members.size(), b.members.size()) << where;
  for (const auto& member : a.members) {
    const auto other = std::ranges::find(b.members, member.key, &study::TomlMember::key);
    ASSERT_NE(other, b.members.end()) << where << "." << member.key;
    expect_same(member.value, other->value, where + "." + member.key);
  }
  ASSERT_EQ(a.elements.size(), b.elements.size()) << where;
  for (std::size_t n = 0; n < a.elements.size(); ++n) {
    expect_same(a.elements[n], b.elements[n], where + "[" + std::to_string(n) + "]");
  }
}

TEST(TomlText, IsReadBackAsTheSameTree) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(CHLADNI_SOURCE_DIR "/models")) {
    if (entry.path().extension() != ".toml") continue;
    const auto file = entry.path().string();
    const auto tree = study::parse_toml(read_whole(entry.path()), file);
    expect_same(tree, study::parse_toml(study::toml_text(tree), file), file);
    ++count;
  }
  EXPECT_GT(count, 15);
  const auto odd = study::parse_toml(
      "\"a key\" = \"\\u0007 tab\\t \\\\ quote\\\" ä\"\nx = 0.1\ny = 1e300\nz = -inf\nw = 3.0\nb = "
      "[]\n"
      "t = {}\n[c.d]\ne = [{ f = [1, 2.5] }, { f = true }]\n",
      "odd");
  expect_same(odd, study::parse_toml(study::toml_text(odd), "odd"), "odd");
}

}  // namespace
}  // namespace chladni::study
