// A body is solved once: later runs take its modes from the cache, to the last bit.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "host/parallel.h"
#include "stage/at_channels.h"
#include "stage/solution.h"

namespace chladni::stage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMost = 1 << 28;

/// Counts the solutions of K φ = ω² M φ that begin, and remembers what is noted.
class Counting : public Work {
 public:
  using Work::Work;
  [[nodiscard]] Progress progress() override {
    return [this](std::string_view step, double) {
      solves += step == "order" ? 1 : 0;
      meshes += step == "tetrahedra" ? 1 : 0;
    };
  }
  void note(std::string_view line) override { notes += std::string(line) + "\n"; }

  int solves = 0, meshes = 0;
  std::string notes;
};

std::string plate(const std::string& modes, const std::string& more = "") {
  return R"(
geometry = { plate = { length = "400 mm", width = "300 mm", thickness = "12 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "50 mm", order = 2 }
modes = { )" +
         modes + " }\n" + more;
}

constexpr const char* kChannels = R"(
[[sensor]]
name = "s1"
at = ["-150 mm", "100 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["120 mm", "-90 mm"]
direction = "z"
)";

struct Done {
  Solution solution;
  int solves, meshes;
  std::string notes;
};

class KeptModes : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("chladni_kept_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Done done(const std::string& text, bool reproducible = true, bool kept = true) const {
    WorkOptions options;
    options.keep_times = !reproducible;
    if (kept) options.cache = std::make_shared<const Cache>(folder_ / "cache", kMost);
    Counting work(options);
    auto solution = solved(study::parse_study(text, folder_ / "study.toml"), work);
    return {std::move(solution), work.solves, work.meshes, work.notes};
  }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
      if (entry.path().extension() == ".kept") files.push_back(entry.path());
    }
    return files;
  }

  fs::path folder_;
};

void expect_the_same_bits(const Solution& a, const Solution& b) {
  EXPECT_EQ(a.modes.frequency_hz, b.modes.frequency_hz);
  EXPECT_EQ(a.modes.damping_ratio, b.modes.damping_ratio);
  EXPECT_EQ(a.modes.shapes, b.modes.shapes);
  EXPECT_EQ(a.modes.rigid_count, b.modes.rigid_count);
  EXPECT_EQ(a.extra_shapes, b.extra_shapes);
  EXPECT_EQ(a.frequency_error, b.frequency_error);
  EXPECT_EQ(a.summary.residual, b.summary.residual);
  EXPECT_EQ(a.summary.text, b.summary.text);
  EXPECT_EQ(a.summary.complete, b.summary.complete);
  EXPECT_EQ(a.summary.clusters.size(), b.summary.clusters.size());
}

TEST_F(KeptModes, AreThoseThatWereSolvedToTheLastBit) {
  const auto text = plate("count = 9, damping_ratio = 0.01",
                          R"([[attachment]]
kind = "resonator"
name = "r"
at = ["100 mm", "50 mm"]
direction = "z"
mass = "20 g"
frequency = "300 Hz"
)");
  const auto without = done(text, true, false);
  const auto first = done(text);
  const auto second = done(text);
  EXPECT_EQ(without.solves, 1);
  EXPECT_EQ(first.solves, 1);
  EXPECT_EQ(second.solves, 0);
  EXPECT_EQ(first.notes.find("earlier run"), std::string::npos);
  EXPECT_NE(second.notes.find("modes of an earlier run\n"), std::string::npos);
  expect_the_same_bits(first.solution, without.solution);
  expect_the_same_bits(second.solution, without.solution);
  EXPECT_EQ(second.solution.extra_shapes.rows(), 1);
  EXPECT_TRUE(second.solution.summary.complete);
}

// What follows from the modes with a factor of K: the solver's own factor is not there any more.
TEST_F(KeptModes, GiveTheSameReducedModelToTheLastBit) {
  const auto text = plate("count = 9", kChannels);
  const auto study = study::parse_study(text, "study.toml");
  const auto first = done(text);
  const auto second = done(text);
  ASSERT_EQ(second.solves, 0);
  const auto a = at_channels(study, first.solution);
  const auto b = at_channels(study, second.solution);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.output_shapes, b.output_shapes);
}

TEST_F(KeptModes, ServeOtherChannelsAndDampingOnTheSameBody) {
  static_cast<void>(done(plate("count = 9")));
  const auto other = done(plate("count = 9, damping_ratio = 0.02", kChannels));
  EXPECT_EQ(other.solves, 0);
  EXPECT_EQ(other.solution.model.sensors.size(), 1U);
  EXPECT_EQ(other.solution.modes.damping_ratio.tail<1>()(0), 0.02);
}

TEST_F(KeptModes, DoNotServeAnotherBody) {
  static_cast<void>(done(plate("count = 9")));
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, from.size(), to);
  };
  const auto same = plate("count = 9");
  for (const auto& text :
       {changed(same, "12 mm", "12.001 mm"), changed(same, "70 GPa", "70.1 GPa"),
        changed(same, "0.33", "0.331"), changed(same, "2700", "2701"),
        changed(same, "50 mm", "80 mm"), changed(same, "order = 2", "order = 3"),
        plate("count = 9", "[[support]]\npatch = \"x_min\"\nfixed = \"xyz\"\n"),
        plate("count = 9",
              "[[attachment]]\nkind = \"mass\"\nname = \"m\"\nat = [\"0 mm\", \"0 "
              "mm\"]\nmass = \"1 g\"\n")}) {
    EXPECT_EQ(done(text).solves, 1) << text;
  }
  set_thread_count(thread_count() + 1);
  EXPECT_EQ(done(same).solves, 1) << "the bits depend on the number of threads";
  set_thread_count(thread_count() - 1);
  EXPECT_EQ(done(same).solves, 0);
}

TEST_F(KeptModes, GiveTheFirstOfMoreWhereBitsNeedNotRepeat) {
  const auto more = done(plate("count = 14"));
  const auto exact = done(plate("count = 9"));
  EXPECT_EQ(exact.solves, 1) << "with --reproducible";
  const auto fewer = done(plate("count = 6"), false);
  EXPECT_EQ(fewer.solves, 0);
  EXPECT_NE(fewer.notes.find("the first 12 of its"), std::string::npos);
  ASSERT_EQ(fewer.solution.modes.mode_count(), 12);
  EXPECT_EQ(fewer.solution.frequency_error.size(), 12);
  EXPECT_EQ(fewer.solution.summary.residual.size(), 12);
  const auto alone = done(plate("count = 6"), true, false);
  const Eigen::ArrayXd ratio = fewer.solution.modes.frequency_hz.tail(6).array() /
                               alone.solution.modes.frequency_hz.tail(6).array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 1e-10);
  EXPECT_EQ(done(plate("count = 20"), false).solves, 1) << "more than are kept";
  EXPECT_GT(more.solution.modes.mode_count(), 12);
}

TEST_F(KeptModes, ServeARequestUpToAFrequencyThatTheyReach) {
  const auto more = done(plate("count = 24"));
  const double last = more.solution.modes.frequency_hz.tail<1>()(0);
  const auto up_to = [](double hz) { return plate("up_to = \"" + std::to_string(hz) + " Hz\""); };
  const auto below = done(up_to(0.6 * last), false);
  const auto alone = done(up_to(0.6 * last), false, false);
  EXPECT_EQ(below.solves, 0);
  EXPECT_EQ(below.solution.modes.mode_count(), alone.solution.modes.mode_count());
  EXPECT_GE(done(up_to(1.5 * last), false).solves, 1);
}

TEST_F(KeptModes, CutNoRepeatedMode) {
  auto square = plate("count = 9");
  square.replace(square.find("300 mm"), 6, "400 mm");
  static_cast<void>(done(square));
  square.replace(square.find("count = 9"), 9, "count = 4");
  const auto fewer = done(square, false);
  EXPECT_EQ(fewer.solves, 0);
  EXPECT_EQ(fewer.solution.modes.mode_count(), 6 + 5);  // flexible modes 4 and 5 are one pair
}

TEST_F(KeptModes, ServeAStudyAndItsDiagnosis) {
  const auto study = study::parse_study(plate("count = 9"), "study.toml");
  WorkOptions options;
  options.keep_times = false;
  options.cache = std::make_shared<const Cache>(folder_ / "cache", kMost);
  Counting first(options);
  const auto once = solved_with_more(study, 16, first);
  Counting second(options);
  const auto again = solved_with_more(study, 16, second);
  EXPECT_EQ(first.solves, 1);
  EXPECT_EQ(second.solves, 0);
  expect_the_same_bits(once.own, again.own);
  expect_the_same_bits(once.with_more, again.with_more);
}

// Bytes that a checksum does not protect, because they were written with it.
TEST_F(KeptModes, AreSolvedAgainWhereTheEntryHoldsSomethingElse) {
  const auto text = plate("count = 9");
  const auto good = done(text);
  ASSERT_EQ(entries().size(), 1U);
  const auto file = entries().front();
  const auto name = file.stem().string();
  const Cache cache(folder_ / "cache", kMost);
  const auto content = cache.content(name);
  ASSERT_TRUE(content);
  auto other = plate("count = 9");
  other.replace(other.find("50 mm"), 5, "80 mm");
  static_cast<void>(done(other));
  std::string of_another_mesh;
  for (const auto& entry : entries()) {
    if (entry != file) of_another_mesh = cache.content(entry.stem().string()).value();
  }
  ASSERT_FALSE(of_another_mesh.empty());
  std::string not_finite = *content;  // the first frequency
  const double nan = std::nan("");
  std::memcpy(not_finite.data() + 16, &nan, sizeof nan);
  for (const std::string& forged :
       {std::string(), std::string(100, '\0'), content->substr(0, content->size() / 2),
        *content + "x", of_another_mesh, not_finite}) {
    ASSERT_EQ(cache.keep(name, forged), "");
    const auto again = done(text);
    EXPECT_EQ(again.solves, 1) << forged.size() << " bytes";
    expect_the_same_bits(again.solution, good.solution);
    EXPECT_EQ(done(text).solves, 0) << "it was replaced";
  }
}

TEST_F(KeptModes, AreNotNeededWhereNothingCanBeWritten) {
  std::ofstream(folder_ / "cache") << "a file";
  const auto one = done(plate("count = 9"));
  EXPECT_EQ(one.solves, 1);
  EXPECT_NE(one.notes.find("not kept for later runs"), std::string::npos);
}

// A box as STL: its tetrahedra are kept too, by the surface that the file describes.
TEST_F(KeptModes, StandOnAMeshThatIsKept) {
  const auto stl = [](double h) {
    const Eigen::Matrix<double, 8, 3> p = (Eigen::Matrix<double, 8, 3>() << 0, 0, 0, 60, 0, 0, 60,
                                           40, 0, 0, 40, 0, 0, 0, h, 60, 0, h, 60, 40, h, 0, 40, h)
                                              .finished();
    constexpr int faces[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                  {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    std::string text = "solid box\n";
    for (const auto& face : faces) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int corner : face) {
        text += "vertex " + std::to_string(p(corner, 0)) + " " + std::to_string(p(corner, 1)) +
                " " + std::to_string(p(corner, 2)) + "\n";
      }
      text += "endloop\nendfacet\n";
    }
    return text + "endsolid box\n";
  };
  const std::string text = R"(
geometry = { file = "box.stl", unit = "mm" }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { order = 2, edge_length = "15 mm" }
modes = { count = 4 }
)";
  std::ofstream(folder_ / "box.stl") << stl(8.0);
  const auto first = done(text);
  const auto second = done(text);
  EXPECT_EQ(first.meshes, 1);
  EXPECT_EQ(second.meshes, 0);
  EXPECT_EQ(second.solves, 0);
  expect_the_same_bits(first.solution, second.solution);
  EXPECT_EQ(first.solution.model.body.points, second.solution.model.body.points);
  EXPECT_EQ(first.solution.model.body.patch_names, second.solution.model.body.patch_names);
  std::ofstream(folder_ / "box.stl") << stl(8.5);
  const auto thicker = done(text);
  EXPECT_EQ(thicker.meshes, 1);
  EXPECT_EQ(thicker.solves, 1);
}

}  // namespace
}  // namespace chladni::stage
