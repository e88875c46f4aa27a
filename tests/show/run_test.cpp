// Pictures of a run, and files of an earlier run that stand for nothing in this one.
#include "show/run.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
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

  app::TestFolder folder_{"run"};
  study::Study study_ = study::parse_study(study::kPlateText, folder_.path() / "plate.toml");
  std::ostringstream shown_, said_;
};

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

// An extended study that is diagnosed again, into the folder where it lies.
TEST_F(Runs, PutAsideKeepsWhatTheStudyIsReadFrom) {
  const auto extended = older("extended.toml");
  study_.file = extended;
  with_run([](show::Run& run) { run.put_aside("extended.toml"); });
  EXPECT_TRUE(fs::exists(extended));
}

}  // namespace
}  // namespace chladni::show
