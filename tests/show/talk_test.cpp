// What a user is told: folded warnings, progress with its time, errors with their place.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "show/excerpt.h"
#include "show/run/terminal.h"

namespace chladni::show {
namespace {

using namespace std::chrono_literals;

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Talk, ALineThatCouldNotBeWrittenKeepsNoLaterOneBack) {
  std::ostringstream said;
  Talk talk(said, {});
  talk.note("first");
  said.setstate(std::ios::badbit);  // as after a write that failed
  talk.error("second");
  EXPECT_EQ(said.str(), "first\nerror: second\n");
}

TEST(Talk, TellsThreeOfAKindAndHowManyMore) {
  std::ostringstream said;
  {
    Talk talk(said, {});
    for (int mode = 7; mode < 47; ++mode) {
      talk.warn("no sensor sees mode " + std::to_string(mode) + " of \"s" + std::to_string(mode) +
                "\"");
    }
    talk.warn("another matter");
    talk.note("modes of an earlier run");
  }
  EXPECT_EQ(count_of(said.str(), "warning: no sensor"), 4) << said.str();  // one as an example
  EXPECT_EQ(count_of(said.str(), "37 more such as \"warning: no sensor sees mode 7 of"), 1);
  EXPECT_EQ(count_of(said.str(), "another matter"), 1);
  EXPECT_EQ(count_of(said.str(), "earlier run"), 1);
}

TEST(Talk, FoldsNothingThatDiffersInItsWordsNorWithAll) {
  std::ostringstream said;
  {
    Talk talk(said, {.all = true});
    for (int i = 0; i < 9; ++i) talk.warn("mode " + std::to_string(i));
  }
  EXPECT_EQ(count_of(said.str(), "warning: mode"), 9);
  said.str("");
  {
    Talk talk(said, {});
    for (const auto* word : {"a", "b", "c", "d", "e"}) talk.warn(std::string("mode ") + word);
  }
  EXPECT_EQ(count_of(said.str(), "warning: mode"), 5);
  EXPECT_EQ(count_of(said.str(), "more such"), 0);
}

TEST(Talk, TellsWhatWasFoldedBeforeAnError) {
  std::ostringstream said;
  Talk talk(said, {});
  for (int i = 0; i < 5; ++i) talk.warn("mode " + std::to_string(i));
  talk.error("it failed");
  EXPECT_LT(said.str().find("2 more such"), said.str().find("error: it failed")) << said.str();
}

// A step of which nothing is heard is told nevertheless, with the time since the beginning.
TEST(Talk, TellsALineEverySoOftenWhereThereIsNoTerminal) {
  std::ostringstream said;
  {
    Talk talk(said, {.lines = true, .every = 50ms});
    tell(talk.progress(), "factorise", 0.25);
    std::this_thread::sleep_for(400ms);
  }
  const auto lines = count_of(said.str(), "factorise 25 %\n");
  EXPECT_GE(lines, 2) << said.str();
  EXPECT_LE(lines, 9) << said.str();
  EXPECT_EQ(said.str().find('\r'), std::string::npos);
}

TEST(Talk, TellsNoLineOfAShortStep) {
  std::ostringstream said;
  {
    Talk talk(said, {.lines = true});
    tell(talk.progress(), "factorise");
    talk.clear_progress();
  }
  EXPECT_EQ(said.str(), "");
}

TEST(Talk, DrawsTheTimeOfAStepAndClearsTheLine) {
  std::ostringstream said;
  {
    Talk talk(said, {.progress = true});
    tell(talk.progress(), "factorise", 0.5);
    std::this_thread::sleep_for(3200ms);
    talk.note("done");
  }
  // On a busy machine the line is drawn later: 3 s or 4 s instead of 2 s.
  EXPECT_TRUE(std::regex_search(said.str(), std::regex("factorise   50 %  [2-9] s"))) << said.str();
  EXPECT_TRUE(said.str().ends_with("\r\033[Kdone\n")) << said.str();
}

class Excerpts : public testing::Test {
 protected:
  void SetUp() override {
    file_ = (std::filesystem::temp_directory_path() /
             ("chladni_excerpt_" + std::to_string(getpid()) + ".toml"))
                .string();
  }
  void TearDown() override { std::filesystem::remove(file_); }
  void write(const std::string& text) const { std::ofstream(file_) << text; }

  std::string file_;
};

TEST_F(Excerpts, ShowTheLineWithACaretBelowItsColumn) {
  write("title = \"a\"\nmodes = { cuont = 3 }\n");
  EXPECT_EQ(
      with_excerpts(file_ + ":2:11: modes.cuont is not known\n" + file_ + ":1:1: no"),
      file_ + ":2:11: modes.cuont is not known\n  2 | modes = { cuont = 3 }\n    |           ^\n" +
          file_ + ":1:1: no\n  1 | title = \"a\"\n    | ^");
}

TEST_F(Excerpts, CountLettersAndCutLongLines) {
  write("# µµµµ x\n" + std::string(300, '-') + "X" + std::string(300, '-') + "\n");
  EXPECT_TRUE(with_excerpts(file_ + ":1:8: here").ends_with("\n    |        ^"));
  const auto text = with_excerpts(file_ + ":2:301: here");
  const auto caret = text.substr(text.rfind('\n') + 1);
  const auto line = text.substr(text.find('\n') + 1);
  EXPECT_EQ(line[caret.find('^')], 'X') << text;
  EXPECT_LT(caret.size(), 120U);
}

TEST_F(Excerpts, LeaveOtherMessagesAlone) {
  write("a\n");
  for (const std::string& message :
       {std::string("no such thing"), std::string("at 12:30: noon"), file_ + ": no line",
        file_ + ":77:1: beyond its end", std::string("none.toml:1:1: not there"),
        std::string("first\nsecond")}) {
    EXPECT_EQ(with_excerpts(message), message);
  }
  EXPECT_EQ(with_excerpts(file_ + ":1: a line alone"), file_ + ":1: a line alone\n  1 | a");
}

TEST_F(Excerpts, AreJsonWithTheirPlaces) {
  const auto json = error_json("s.toml:3:8: one\ns.toml:4:1: two\n  of two lines\n", 3);
  const auto& error = json.at("error");
  EXPECT_EQ(error.at("exit").number(), 3.0);
  ASSERT_EQ(error.at("errors").array().size(), 2U);
  EXPECT_EQ(error.at("errors").array()[0].at("column").number(), 8.0);
  EXPECT_EQ(error.at("errors").array()[1].at("message").string(), "two\n  of two lines");
  EXPECT_EQ(error_json("x", 4).at("error").at("errors").array()[0].at("message").string(), "x");
}

}  // namespace
}  // namespace chladni::show
