// Pictures of a run, and files of an earlier run that stand for nothing in this one.
#include "show/run.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/matrix_picture.h"
#include "tests/app/quiet_run.h"
#include "tests/study/plate_text.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;

class Runs : public testing::Test {
 protected:
  void with_run(const std::function<void(show::Run&)>& work, bool pictures = true) {
    Options options;
    options.folder = folder_.path() / "out";
    options.pictures = pictures;
    Talk talk(said_, manner_of_stderr(true));
    show::Run run(study_, options, shown_, talk);
    work(run);
    run.finish_pictures();
  }
  fs::path older(const std::string& name) const {
    fs::create_directories(folder_.path() / "out");
    std::ofstream(folder_.path() / "out" / name) << "of an earlier run";
    return folder_.path() / "out" / name;
  }
  fs::path hour_old(const std::string& name, const std::string& content) const {
    const auto file = older(name);
    std::ofstream(file) << content;
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
    return file;
  }

  app::TestFolder folder_{"run"};
  study::Study study_ = study::parse_study(study::kPlateText, folder_.path() / "plate.toml");
  std::ostringstream shown_, said_;
};

// A key of a JSON object stands once.
TEST_F(Runs, AStepThatRunsTwiceHasOneTime) {
  with_run([](show::Run& run) {
    for (const char* step : {"mesh", "diagnosis", "diagnosis"})
      (void)run.timed(step, [] { return 1; });
    ASSERT_EQ(run.seconds().size(), 2U);
    EXPECT_EQ(run.seconds()[1].first, "diagnosis");
  });
}

TEST_F(Runs, WhatCannotBeDrawnIsAWarningAndTheRestGoesOn) {
  bool is_painted = true;
  with_run([&](show::Run& run) {
    run.paint("errors.png", [](const io::PictureFile& file) {
      io::MatrixPicture picture;
      picture.title = "errors";
      picture.value.setZero(201, 1);
      picture.rows.resize(201);
      picture.columns.resize(1);
      io::draw_matrix(file, picture);
    });
    run.finish_pictures();
    is_painted = run.has_painted("errors.png");
  });
  EXPECT_FALSE(is_painted);
  EXPECT_NE(said_.str().find("warning: errors.png is not painted: matrix picture \"errors\""),
            std::string::npos)
      << said_.str();
}

TEST_F(Runs, WhatElsePreventsAPictureEndsTheVerb) {
  EXPECT_THROW(with_run([](show::Run& run) {
                 run.paint("a.png", [](const auto&) { throw OutOfResources("the disk is full"); });
               }),
               OutOfResources);
}

// Drawings that a user has changed, and what no run has written, are no run's to remove.
TEST_F(Runs, APictureThatIsNotPaintedLeavesFilesAsTheyAre) {
  const auto off = older("off.png"), vectors = older("off.svg"), nothing = older("nothing.png");
  with_run([](show::Run& run) { run.paint("off.png", [](const auto&) { FAIL(); }); }, false);
  with_run([](show::Run& run) { run.paint("nothing.png", [](const auto&) {}); });
  for (const auto& file : {off, vectors, nothing}) EXPECT_TRUE(fs::exists(file)) << file;
}

TEST_F(Runs, PutAsideRenamesTheFileOfAnEarlierRunAlone) {
  const auto extended = older("extended.toml"), other = older("modes.csv");
  fs::create_directory(extended.parent_path() / "folder.toml");
  with_run([](show::Run& run) {
    for (const char* file : {"extended.toml", "never.csv", "folder.toml"}) run.put_aside(file);
  });
  EXPECT_FALSE(fs::exists(extended));
  EXPECT_TRUE(fs::exists(extended.parent_path() / "extended_before.toml"));
  EXPECT_TRUE(fs::exists(other));
  EXPECT_TRUE(fs::exists(extended.parent_path() / "folder.toml"));
  EXPECT_NE(said_.str().find("it is extended_before.toml now"), std::string::npos) << said_.str();
}

// Another state of the study replaces the result. What it does not write itself would stand beside
// the new one: an animation of modes that are no more.
TEST_F(Runs, WhatStoodBesideAReplacedResultIsPutAside) {
  const auto leave = [](show::Run& run) { run.leave("modes.json", {}, false); };
  with_run(leave);
  const auto animation = hour_old("modes.pvd", "<DataSet file=\"modes_00.vtu\"/>");
  const auto frame = hour_old("modes_00.vtu", "frame"), other = hour_old("fit.png", "a fit");
  const auto picture = hour_old("modes.png", "old"), channels = hour_old("channels.vtu", "old");
  const auto out = animation.parent_path();
  with_run(leave);  // the same state
  for (const auto& file : {animation, frame, picture, channels}) EXPECT_TRUE(fs::exists(file));
  EXPECT_EQ(said_.str(), "");
  study_.sha256 = std::string(64, '0');
  with_run([&](show::Run& run) {
    leave(run);
    std::ofstream(run / "channels.vtu") << "new";
  });
  for (const auto& file : {animation, frame, picture}) EXPECT_FALSE(fs::exists(file)) << file;
  EXPECT_EQ(read_whole(out / "modes_before.pvd"), "<DataSet file=\"modes_before_00.vtu\"/>");
  EXPECT_EQ(read_whole(out / "modes_before_00.vtu"), "frame");
  EXPECT_EQ(read_whole(out / "modes_before.png"), "old");
  EXPECT_EQ(read_whole(channels), "new");
  EXPECT_FALSE(fs::exists(out / "channels_before.vtu"));
  EXPECT_TRUE(fs::exists(other));  // its result was not replaced
  EXPECT_NE(said_.str().find("is now modes_before.pvd, modes_before.png"), std::string::npos)
      << said_.str();
}

// `compare` and `diagnose` both paint the MAC.
TEST_F(Runs, WhatAPresentResultOwnsStays) {
  const auto leave = [&](const std::string& file) {
    with_run([&](show::Run& run) { run.leave(file, {}, false); });
  };
  leave("diagnosis.json");
  study_.sha256 = std::string(64, '0');
  leave("comparison.json");
  const auto mac = hour_old("mac.png", "of the comparison");
  leave("diagnosis.json");
  EXPECT_TRUE(fs::exists(mac));
  study_.sha256 = std::string(64, '1');
  leave("diagnosis.json");
  EXPECT_FALSE(fs::exists(mac));
  EXPECT_TRUE(fs::exists(mac.parent_path() / "mac_before.png"));
}

// An extended study that is diagnosed again, into the folder where it lies.
TEST_F(Runs, PutAsideKeepsWhatTheStudyIsReadFrom) {
  const auto extended = older("extended.toml");
  study_.file = extended;
  with_run([](show::Run& run) { run.put_aside("extended.toml"); });
  EXPECT_TRUE(fs::exists(extended));
}

}  // namespace
}  // namespace chladni::show
