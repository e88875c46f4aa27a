// chladni check and convert on files of measured data, as a process.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

std::string responses() {
  std::ostringstream text;
  text.precision(17);
  text << "freq_hz,re_y1u1,im_y1u1,coh_y1u1\n";
  for (int k = 1; k <= 200; ++k) {  // one oscillator at 10 Hz, as a receptance
    const double f = 0.1 * k, real = 100.0 - f * f, imag = -0.4 * f;
    const double size = real * real + imag * imag;
    text << f << ',' << real / size << ',' << imag / size << ",0.99\n";
  }
  return text.str();
}

TEST_F(CommandLine, CheckSaysWhatAFileOfResponsesHolds) {
  write("frf.csv", responses());
  const auto check = run({"check", "frf.csv", "--unit", "mm"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.out, "frf.csv  CSV: frequency responses of 1 output to 1 input"));
  EXPECT_TRUE(says(check.out, "200 lines, 0.1 to 20 Hz, each 0.1 Hz"));
  EXPECT_TRUE(says(check.out, "variance: no   coherence: yes"));
  EXPECT_TRUE(says(check.out, "10.00 Hz"));
  EXPECT_TRUE(says(check.out, "nothing suspect"));
  const auto json = io::parse_json(run({"check", "frf.csv", "--json"}).out);
  EXPECT_EQ(json.at("lines").number(), 200.0);
  EXPECT_EQ(json.at("outputs").array()[0].at("kind").string(), "receptance");
  EXPECT_EQ(json.at("notes").array().size(), 1U);  // the unit is not stated
  EXPECT_TRUE(left("out").empty());
}

// A response without a coherence is not one of coherence 0.
TEST_F(CommandLine, CheckShowsNoCoherenceWhereNoneIsStated) {
  std::string text = "freq_hz,re_s1/a,im_s1/a,coh_s1/a,re_s2/a,im_s2/a\n";
  for (int k = 1; k <= 20; ++k) text += std::to_string(k) + ",1,2,0.9,3,4\n";
  write("frf.csv", text);
  const auto check = run({"check", "frf.csv", "--unit", "m"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.out, "0.9000\n"));
  EXPECT_EQ(check.out.find("0.0000"), std::string::npos) << check.out;
  EXPECT_TRUE(says(check.out, " -\n"));
}

TEST_F(CommandLine, CheckSaysWhatARecordingHolds) {
  write("hit.csv", "force,acceleration\n1,2\n3,4\n5,6\n");
  const auto check = run({"check", "hit.csv", "--sample-time", "0.5"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.out, "1 recording, 1 outputs, 1 inputs"));
  EXPECT_TRUE(says(check.out, "3 samples in the first, each 0.5 s: 1.5 s, up to 1 Hz"));
  const auto without = run({"check", "hit.csv"});
  EXPECT_EQ(without.status, 3);
  EXPECT_TRUE(says(without.err, "sample time"));
}

TEST_F(CommandLine, ConvertKeepsEveryBitThroughAllFormats) {
  write("text.csv", responses());
  EXPECT_EQ(run({"convert", "text.csv", "a.csv"}).status, 0);  // the shortest digits
  for (const char* next : {"b.uff", "c.mat", "d.csv"}) {
    static std::string from = "a.csv";
    const auto done = run({"convert", from, next});
    EXPECT_EQ(done.status, 0) << done.err;
    from = next;
  }
  EXPECT_TRUE(whole(folder_ / "d.csv") == whole(folder_ / "a.csv"));
}

TEST_F(CommandLine, ConvertWritesVersion73OfMatWhereItIsAskedTo) {
  write("text.csv", responses());
  EXPECT_EQ(run({"convert", "text.csv", "a.csv"}).status, 0);
  EXPECT_EQ(run({"convert", "a.csv", "b.mat", "--hdf5"}).status, 0);
  EXPECT_TRUE(says(run({"check", "b.mat"}).out, "b.mat  MAT 7.3: frequency responses"));
  EXPECT_EQ(run({"convert", "b.mat", "c.csv"}).status, 0);
  EXPECT_TRUE(whole(folder_ / "c.csv") == whole(folder_ / "a.csv"));
  for (const auto* other : {"d.uff", "d.stl"}) {
    const auto refused = run({"convert", "a.csv", other, "--hdf5"});
    EXPECT_EQ(refused.status, 3) << other;
    EXPECT_TRUE(says(refused.err, "expected OUT to end in .mat"));
  }
}

TEST_F(CommandLine, ConvertWritesOverNothingThatItWasNotToldTo) {
  write("a.csv", responses());
  const std::string before = whole(folder_ / "a.csv");
  fs::create_symlink("a.csv", folder_ / "link.csv");
  fs::create_hard_link(folder_ / "a.csv", folder_ / "hard.csv");
  for (const char* same : {"a.csv", "./a.csv", "link.csv", "hard.csv"}) {
    for (const auto& more : {std::vector<std::string>{}, std::vector<std::string>{"--force"}}) {
      std::vector<std::string> words{"convert", "a.csv", same, "--unit", "g"};
      words.insert(words.end(), more.begin(), more.end());
      const auto done = run(words);
      EXPECT_EQ(done.status, 3) << same;
      EXPECT_TRUE(says(done.err, "it is the file that is read"));
      EXPECT_TRUE(whole(folder_ / "a.csv") == before) << same;
    }
  }
  write("other.mat", "of great value");
  const auto refused = run({"convert", "a.csv", "other.mat"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "other.mat: there is such a file"));
  EXPECT_TRUE(says(refused.err, "--force"));
  EXPECT_EQ(whole(folder_ / "other.mat"), "of great value");
  EXPECT_EQ(run({"convert", "a.csv", "other.mat", "--force"}).status, 0);
  EXPECT_NE(whole(folder_ / "other.mat"), "of great value");
}

// Under a limit of addresses, as `ulimit -v` sets it.
TEST_F(CommandLine, AFileThatNeedsMoreMemoryThanThereIsIsRefused) {
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer needs all addresses";
  std::string text = "freq_hz,re_y1u1,im_y1u1\n";
  for (int k = 0; k < 1'500'000; ++k) text += std::to_string(k) + ",0,0\n";
  write("large.csv", text);
  const auto limited = [&](rlim_t bytes) {
    return ended(started({"check", "large.csv"}, "", [bytes] {
      const rlimit limit{bytes, bytes};
      setrlimit(RLIMIT_AS, &limit);
    }));
  };
  const auto refused = limited(rlim_t{512} << 20U);
  EXPECT_EQ(refused.status, 3) << refused.err;
  EXPECT_TRUE(says(refused.err, "large.csv"));
  EXPECT_TRUE(says(refused.err, " MB"));
}

TEST_F(CommandLine, CheckShowsTheFirstOfManyChannels) {
  std::string head = "freq_hz";
  std::string line = "1";
  for (int n = 1; n <= 500; ++n) {
    head += ",re_y" + std::to_string(n) + "u1,im_y" + std::to_string(n) + "u1";
    line += ",1,2";
  }
  write("wide.csv", head + ",a,b,c,d,e,g,h,i\n" + line + ",1,2,3,4,5,6,7,8\n");
  const auto check = run({"check", "wide.csv", "--unit", "m"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_TRUE(says(check.out, "  and 436 more\n"));
  EXPECT_TRUE(says(check.out, "'g' and 2 more are not of a response"));
  EXPECT_TRUE(
      says(check.out, "y7/u1 and 493 more are the same as y1/u1 on every line: they are copies"));
  EXPECT_LT(std::count(check.out.begin(), check.out.end(), '\n'), 120);
}

TEST_F(CommandLine, TextInUtf16IsCalledSo) {
  std::string wide = "\xFF\xFE";
  for (const char c : responses()) wide += {c, '\0'};
  for (const char* name : {"a.csv", "a.uff", "study.toml"}) {
    write(name, wide);
    const auto check = run({"check", name});
    EXPECT_EQ(check.status, 3) << name;
    EXPECT_TRUE(says(check.err, "UTF-16; save it as UTF-8"));
  }
}

TEST_F(CommandLine, OneCellOfAnotherWorldIsRefusedOrNamed) {
  const auto with = [&](const std::string& cell) {
    std::string text = responses();
    const auto row = text.find("\n10,");
    const auto from = text.find(',', row) + 1;
    return text.replace(from, text.find(',', from) - from, cell);
  };
  write("frf.csv", with("1e200"));
  write("study.toml", std::string(kPlate) + R"(
[[actuator]]
name = "u1"
at = ["-40 mm", "20 mm"]
direction = "z"
[measurement]
frf = "frf.csv"
)");
  const auto refused = run({"identify", "study.toml"});
  EXPECT_EQ(refused.status, 3) << refused.err;
  EXPECT_TRUE(says(refused.err, "frf.csv: line 101: re_y1u1: found 1e+200"));
  EXPECT_EQ(run({"check", "frf.csv"}).status, 3);
  write("frf.csv", with("1e12"));
  EXPECT_TRUE(says(run({"check", "frf.csv"}).out,
                   "y1/u1: more than a million times the neighbours on 1 line, the first is line "
                   "100 (10 Hz)"));
}

TEST_F(CommandLine, BadDataAreInvalidInput) {
  write("bad.csv", "freq_hz,re_y1u1,im_y1u1\n1,2,x\n");
  const auto check = run({"check", "bad.csv"});
  EXPECT_EQ(check.status, 3);
  EXPECT_TRUE(says(check.err, "bad.csv: line 2: im_y1u1: found 'x'"));
  write("good.csv", responses());
  EXPECT_EQ(run({"convert", "good.csv", "out.stl"}).status, 3);
  EXPECT_EQ(run({"convert", "good.csv", "out.csv.gz"}).status, 3);
  EXPECT_TRUE(!fs::exists(folder_ / "out.csv.gz"));
  EXPECT_TRUE(says(run({"list", "formats"}).out, "\n.csv.gz          read: "));
  EXPECT_EQ(run({"check", "absent.uff"}).status, 3);
}

}  // namespace
}  // namespace chladni::app
