// Four verbs on one body cost one solve.
#include <sys/mount.h>

#include <cstdlib>
#include <map>

#include "io/json.h"
#include "rotation/turn.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class CacheVerb : public CommandLine {
 protected:
  Ended kept(const std::vector<std::string>& words) const {
    return ended(started(words, "", [&] { setenv("CHLADNI_CACHE", cache().c_str(), 1); }));
  }
  std::string cache() const { return (folder_ / "cache").string(); }
  io::Json json(const std::string& file) const { return io::parse_json(whole(folder_ / file)); }

  /// Whether the run that left `file` has solved the modes.
  bool has_solved(const std::string& file) const {
    return io::text(json(file).at("seconds")).find("\"modes\"") != std::string::npos;
  }
};

const std::string kStage = std::string(kPlate) + R"(
[[actuator]]
name = "a1"
at = ["30 mm", "-15 mm"]
direction = "z"
[placement]
modes = 3
[priors]
modes = 3
)";

TEST_F(CacheVerb, FourVerbsOnOneBodyCostOneSolve) {
  EVERY_FOURTH_LANDING();
  const auto study = write("study.toml", kStage).string();
  const std::pair<std::string, std::string> verbs[] = {{"modes", "modes.json"},
                                                       {"place", "placement.json"},
                                                       {"priors", "priors.json"},
                                                       {"study", "modes.json"}};
  int solves = 0;
  int notes = 0;
  for (const auto& [verb, file] : verbs) {
    const auto done = kept({verb, study, "-o", "out", "--no-pictures"});
    ASSERT_EQ(done.status, 0) << done.err;
    solves += has_solved("out/" + file) ? 1 : 0;
    notes += says(done.err, "modes of an earlier run\n") ? 1 : 0;
  }
  EXPECT_EQ(solves, 1);
  EXPECT_EQ(notes, 3);
  EXPECT_TRUE(says(kept({"cache"}).out, "1 entry"));
  EXPECT_TRUE(says(kept({"cache", "--clear"}).out, "removed 1 entry"));
  EXPECT_TRUE(says(kept({"cache"}).out, "0 entries"));
}

TEST_F(CacheVerb, ResultsAreTheSameToTheLastByte) {
  EVERY_FOURTH_LANDING();
  const auto study = write("study.toml", kStage).string();
  std::map<std::string, std::string> first;
  for (const std::string out : {"alone", "kept", "taken"}) {
    const std::vector<std::string> words = {"study",          study,          "-o", out,
                                            "--reproducible", "--no-pictures"};
    const auto done = out == "alone" ? run(words) : kept(words);
    ASSERT_EQ(done.status, 0) << done.err;
    for (const auto& name : left(out)) {
      const auto bytes = whole(folder_ / out / name);
      if (out == "alone") first[name] = bytes;
      EXPECT_TRUE(first[name] == bytes) << out << "/" << name;
    }
  }
  EXPECT_TRUE(says(first.at("modes.json"), "frequency_hz"));
}

TEST_F(CacheVerb, IsOffByAnOptionAndWhereItCannotWrite) {
  const auto study = write("study.toml", kStage).string();
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(kept({"modes", study, "-o", "out", "--no-cache", "--no-pictures"}).status, 0);
    EXPECT_TRUE(has_solved("out/modes.json"));
    EXPECT_FALSE(fs::exists(folder_ / "cache"));
  }
  write("cache", "a file");
  const auto done = kept({"modes", study, "-o", "out", "--no-pictures"});
  EXPECT_EQ(done.status, 0);
  EXPECT_TRUE(says(done.err, "not kept for later runs"));
  EXPECT_TRUE(says(kept({"cache"}).out, "0 entries"));
  EXPECT_TRUE(says(run({"cache"}).out, "off"));
}

TEST_F(CacheVerb, TwoRunsAtOnceSolveOnce) {
  const auto study = write("study.toml", kStage).string();
  const auto prepare = [&] { setenv("CHLADNI_CACHE", cache().c_str(), 1); };
  std::vector<pid_t> children;
  for (const std::string out : {"a", "b", "c"}) {
    children.push_back(started({"modes", study, "-o", out, "--no-pictures"}, "", prepare));
  }
  for (const pid_t child : children) ASSERT_EQ(ended(child).status, 0);
  int solves = 0;
  for (const std::string out : {"a", "b", "c"}) solves += has_solved(out + "/modes.json") ? 1 : 0;
  EXPECT_EQ(solves, 1);
}

TEST_F(CacheVerb, TellsItselfAsJson) {
  const auto study = write("study.toml", kStage).string();
  ASSERT_EQ(kept({"modes", study, "-o", "out", "--no-pictures", "--quiet"}).status, 0);
  const auto told = io::parse_json(kept({"cache", "--json"}).out);
  EXPECT_EQ(told.at("folder").string(), cache());
  EXPECT_EQ(told.at("entries").number(), 1.0);
  EXPECT_GT(told.at("bytes").number(), 1000.0);
}

TEST_F(CacheVerb, TellsAnErrorAsJsonToo) {
  fs::create_directories(cache());
  const auto busy = write("cache/busy.kept", "");
  if (mount(busy.c_str(), busy.c_str(), "", MS_BIND, "") != 0) {
    GTEST_SKIP() << "no right to mount a file here: not tested";
  }
  const auto refused = kept({"cache", "--clear", "--json"});
  umount(busy.c_str());
  EXPECT_EQ(refused.status, 3) << refused.err;
  EXPECT_EQ(io::parse_json(refused.out).at("error").at("exit").number(), 3.0);
}

}  // namespace
}  // namespace chladni::app
