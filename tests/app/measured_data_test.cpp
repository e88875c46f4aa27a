// chladni check and convert on files of measured data, as a process.
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

TEST_F(CommandLine, BadDataAreInvalidInput) {
  write("bad.csv", "freq_hz,re_y1u1,im_y1u1\n1,2,x\n");
  const auto check = run({"check", "bad.csv"});
  EXPECT_EQ(check.status, 3);
  EXPECT_TRUE(says(check.err, "bad.csv: line 2: im_y1u1: found 'x'"));
  write("good.csv", responses());
  EXPECT_EQ(run({"convert", "good.csv", "out.stl"}).status, 3);
  EXPECT_EQ(run({"check", "absent.uff"}).status, 3);
}

}  // namespace
}  // namespace chladni::app
