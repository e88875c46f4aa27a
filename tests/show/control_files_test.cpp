// A state space that cannot be made ends no verb, and leaves no files of an earlier run.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "show/control_models.h"
#include "tests/study/plate_text.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;

study::Study with_table(const std::string& table) {
  return study::parse_study(study::kPlateText + table, "plate.toml");
}

// Two modes of the given damping between two channels.
steps::IdentifiedModel two_modes(double damping_ratio) {
  steps::IdentifiedModel model;
  auto& fit = model.found.fit;
  fit.model.frequency_hz = Eigen::Vector2d(50.0, 120.0);
  fit.model.damping_ratio.setConstant(2, damping_ratio);
  fit.model.output_shapes = model.match.shapes = Eigen::Matrix2d{{0.3, 0.5}, {-0.4, 0.2}};
  fit.model.input_shapes = model.match.input_shapes = Eigen::Matrix2d{{0.6, 0.1}, {0.2, -0.7}};
  model.match.modes.resize(2);
  for (auto& mode : model.match.modes) mode.by = identification::MatchedBy::pairs;
  const auto channel = [](const char* name) {
    modal::MeasuredChannel named;
    named.name = name;
    return named;
  };
  model.seen.outputs = {channel("s1"), channel("s2")};
  model.seen.inputs = {channel("a1"), channel("a2")};
  return model;
}

class LeftControlModels : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  template <typename Model>
  void leave(const study::Study& study, const Model& model) {
    show::Options options;
    options.folder = folder_;
    options.pictures = false;
    Talk talk(said_, manner_of_stderr(true));
    show::Run run(study, options, shown_, talk);
    leave_control_models(study, model, run);
  }

  [[nodiscard]] const fs::path& folder() const { return folder_; }
  [[nodiscard]] bool has(const std::string& name) const { return fs::exists(folder_ / name); }
  [[nodiscard]] std::string said() const { return said_.str(); }

 private:
  fs::path folder_ =
      fs::temp_directory_path() / ("chladni_left_models_" + std::to_string(getpid()));
  std::ostringstream shown_, said_;
};

TEST_F(LeftControlModels, OfTooFewStatesAreAWarningAndOldOnesGo) {
  leave(with_table("[state_space]\nsample_rate = \"1 kHz\"\n"), two_modes(0.01));
  for (const char* end : {"mat", "json", "h"}) EXPECT_TRUE(has(std::string("state_space.") + end));
  leave(with_table("[state_space]\nsample_rate = \"1 kHz\"\nstates = 40\n"), two_modes(0.01));
  for (const char* end : {"mat", "json", "h"}) EXPECT_FALSE(has(std::string("state_space.") + end));
  EXPECT_NE(said().find("no state space: plate.toml: [state_space]: "), std::string::npos);
}

TEST_F(LeftControlModels, OfASimulationGoWithTheirTable) {
  leave(with_table("[state_space]\nsample_rate = \"1 kHz\"\n"), two_modes(0.01));
  for (const char* end : {".mat", ".json", ".h"}) {
    fs::copy_file(folder() / (std::string("state_space") + end),
                  folder() / (std::string("simulated_state_space") + end));
  }
  leave(with_table(""), stage::Solution{});
  for (const char* end : {"mat", "json", "h"}) {
    EXPECT_FALSE(has(std::string("simulated_state_space.") + end));
    EXPECT_TRUE(has(std::string("state_space.") + end));
  }
  leave(with_table("[state_space]\n"), stage::Solution{});
  EXPECT_NE(said().find("no state space: plate.toml: [state_space] needs a sensor"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::show
