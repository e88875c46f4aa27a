// chladni sweep and gather as processes.
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <map>
#include <thread>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class SweepVerbs : public CommandLine {
 protected:
  // A plan over a length of the small plate.
  fs::path plan(const std::string& values, const std::string& length = "thickness") const {
    write("base.toml", app::kPlate);  // not that of a neighbour
    return write("plan.toml",
                 "title = \"plates\"\nbase = \"base.toml\"\n[[axis]]\n"
                 "key = \"geometry.plate." +
                     length + "\"\nvalues = [" + values +
                     "]\n[[result]]\nname = \"first\"\nfile = \"modes.json\"\n"
                     "at = \"frequency_hz.6\"\nbetter = \"more\"\n");
  }
  std::vector<double> firsts() const {
    const auto json = io::parse_json(whole(folder_ / "out" / "sweep.json"));
    std::vector<double> all;
    for (const auto& variant : json.at("variants").array()) {
      all.push_back(variant.at("results").at("first").number());
    }
    return all;
  }
};

// A plate's first frequency goes with its thickness.
TEST_F(SweepVerbs, SolveEachVariantOnceAndGather) {
  const auto file = plan("\"4 mm\", \"5 mm\", \"6 mm\"").string();
  const auto first = run({"sweep", file, "-o", "out", "--no-pictures"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_TRUE(says(first.out, "3 variants: 3 done, 0 failed, 0 open"));
  const auto hz = firsts();
  ASSERT_EQ(hz.size(), 3U);
  EXPECT_NEAR(hz[0] / hz[1], 4.0 / 5.0, 0.02);
  EXPECT_NEAR(hz[2] / hz[1], 6.0 / 5.0, 0.02);
  const auto table = whole(folder_ / "out" / "table.csv");
  const auto begin = std::chrono::steady_clock::now();
  const auto again = run({"sweep", file, "-o", "out", "--no-pictures"});
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(whole(folder_ / "out" / "table.csv"), table);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  EXPECT_TRUE(says(run({"sweep", file, "-o", "out", "--list"}).out, "done   5 mm"));
  const auto gathered = run({"gather", file, "-o", "out", "--json", "--no-pictures"});
  EXPECT_EQ(io::parse_json(gathered.out).at("done").number(), 3.0);
}

// --json says what each kind of call has to say.
TEST_F(SweepVerbs, ListsRunsAndScriptsAreJsonToo) {
  const auto file = plan("\"4 mm\", \"5 mm\"").string();
  const auto json = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"sweep", file, "-o", "out", "--json"});
    const auto done = run(arguments);
    EXPECT_EQ(done.status, 0) << done.err;
    return io::parse_json(done.out);
  };
  const auto open = json({"--list"});
  ASSERT_EQ(open.at("variants").array().size(), 2U);
  EXPECT_EQ(open.at("variants").array()[1].at("state").string(), "open");
  const auto ran = json({"--run", "2"});
  ASSERT_EQ(ran.at("variants").array().size(), 1U);
  EXPECT_EQ(ran.at("variants").array()[0].at("variant").number(), 2.0);
  EXPECT_EQ(ran.at("variants").array()[0].at("state").string(), "done");
  EXPECT_EQ(json({"--list"}).at("variants").array()[1].at("axes").at("thickness").string(), "5 mm");
  const auto scripts = json({"--scripts"});
  EXPECT_EQ(scripts.at("variants").number(), 2.0);
  EXPECT_TRUE(fs::exists(folder_ / scripts.at("sbatch").string()));
}

// What is to be gathered is needed where something is gathered.
TEST_F(SweepVerbs, AListNeedsNoResult) {
  const auto file = plan("\"4 mm\", \"5 mm\"").string();
  const auto text = whole(file);
  write("plan.toml", text.substr(0, text.find("[[result]]")));
  const auto list = run({"sweep", file, "-o", "out", "--list"});
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_TRUE(says(list.out, "open   5 mm"));
  const auto swept = run({"sweep", file, "-o", "out"});
  EXPECT_EQ(swept.status, 3);
  EXPECT_TRUE(says(swept.err, "the plan lacks \"result\"")) << swept.err;
  EXPECT_TRUE(left("out").empty());
}

TEST_F(SweepVerbs, ReproducibleOnesLeaveTheSameBytes) {
  const auto file = plan("\"4 mm\", \"5 mm\"").string();
  const auto left = [&](const std::string& threads) {
    fs::remove_all(folder_ / "out");
    (void)run({"sweep", file, "-o", "out", "--reproducible", "--no-cache", "--jobs", threads});
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out")) {
      if (!entry.is_regular_file()) continue;
      files[entry.path().lexically_relative(folder_ / "out")] = whole(entry.path());
    }
    return files;
  };
  const auto once = left("1");
  EXPECT_TRUE(once.contains("table.csv"));
  EXPECT_TRUE(once.contains("sweep.png"));
  EXPECT_EQ(left("2"), once);
}

TEST_F(SweepVerbs, OneVariantOrEveryOther) {
  const auto file = plan("\"4 mm\", \"5 mm\", \"6 mm\"").string();
  EXPECT_EQ(run({"sweep", file, "-o", "out", "--run", "1/2"}).status, 0);
  const auto list = run({"sweep", file, "-o", "out", "--list"}).out;
  EXPECT_TRUE(says(list, "done   4 mm"));
  EXPECT_TRUE(says(list, "open   5 mm"));
  EXPECT_TRUE(says(list, "done   6 mm"));
  EXPECT_EQ(run({"sweep", file, "-o", "out", "--run", "4"}).status, 3);
  EXPECT_EQ(run({"sweep", file, "-o", "out", "--run", "0"}).status, 3);
  EXPECT_EQ(run({"sweep", file, "-o", "out", "--run", "1/x"}).status, 3);
}

// A sensor that is off the body is no fault of the file: it shows when the variant is solved.
TEST_F(SweepVerbs, AVariantThatFailsIsToldAndTheOthersGoOn) {
  const auto file = plan("\"5 mm\"").string();
  write("plan.toml", whole(file) +
                         "[[axis]]\nname = \"place\"\nkey = \"sensor[s1].at\"\n"
                         "values = [[\"-40 mm\", \"20 mm\"], [\"90 mm\", \"0 mm\"]]\n");
  const auto swept = run({"sweep", file, "-o", "out", "--no-pictures"});
  EXPECT_EQ(swept.status, 4) << swept.err;
  EXPECT_TRUE(says(swept.out, "1 done, 1 failed, 0 open"));
  EXPECT_TRUE(says(swept.err, "variant 2: "));
  EXPECT_TRUE(says(swept.out, "s1")) << swept.out;
}

// No room for the files of the longer plate. It is no fault of the variant, which runs next time.
TEST_F(SweepVerbs, AFullDiskLeavesTheOthersAndIsTriedAgain) {
  const auto file = plan("\"100 mm\", \"300 mm\"", "length").string();
  ASSERT_EQ(run({"sweep", file, "-o", "out", "--run", "1", "--no-pictures"}).status, 0);
  std::uintmax_t largest = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out")) {
    if (entry.is_regular_file()) largest = std::max(largest, entry.file_size());
  }
  const auto no_room = [&] {
    const rlimit limit{largest + 1024, largest + 1024};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const auto full = ended(started({"sweep", file, "-o", "out", "--no-pictures"}, "", no_room));
  EXPECT_EQ(full.status, 5) << full.err;
  EXPECT_TRUE(says(full.err, "variant 2: ")) << full.err;
  EXPECT_TRUE(says(full.err, "it is tried again next time"));
  const auto list = run({"sweep", file, "-o", "out", "--list"}).out;
  EXPECT_TRUE(says(list, "done   100 mm"));
  EXPECT_TRUE(says(list, "open   300 mm"));
  const auto later = run({"sweep", file, "-o", "out", "--no-pictures"});
  EXPECT_EQ(later.status, 0) << later.err;
  EXPECT_TRUE(says(later.out, "2 done, 0 failed, 0 open"));
}

TEST_F(SweepVerbs, AWrongPlanIsToldBeforeAnythingRuns) {
  const auto file = plan("\"5 mm\", \"5 kg\"").string();
  const auto swept = run({"sweep", file, "-o", "out"});
  EXPECT_EQ(swept.status, 3);
  EXPECT_TRUE(says(swept.err, "variant 2 (5 kg)"));
  EXPECT_TRUE(left("out").empty());
  for (const auto* verb : {"sweep", "gather"}) {
    EXPECT_EQ(run({verb, "nowhere.toml"}).out, "");
    const auto told = run({verb, "nowhere.toml", "--json"});
    EXPECT_EQ(told.status, 3);
    const auto error = io::parse_json(told.out).at("error");
    EXPECT_EQ(error.at("exit").number(), 3.0) << verb;
    EXPECT_TRUE(says(error.at("errors").array()[0].at("message").string(), "nowhere.toml"));
  }
}

TEST_F(SweepVerbs, CtrlCLeavesNoVariantHalf) {
  const auto file = plan("\"4 mm\", \"5 mm\"").string();
  std::string text = app::kPlate;
  text.replace(text.find("\"10 mm\", order = 2"), 18, "\"3 mm\", order = 3");
  write("base.toml", text);
  const pid_t child = started({"sweep", file, "-o", "out"});
  for (int i = 0; i < 1500 && left("out/variants").size() < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(child, SIGINT);
  EXPECT_EQ(ended(child).status, 130);
  for (const auto& name : left("out/variants")) {
    EXPECT_TRUE(name == ".locks" || name.ends_with(".part")) << name;
  }
}

}  // namespace
}  // namespace chladni::app
