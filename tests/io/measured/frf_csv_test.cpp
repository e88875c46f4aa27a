#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/draw.h"
#include "base/error.h"
#include "io/frf_file.h"
#include "io/measured/channel_names.h"
#include "io/time_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/gzipped.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

TEST(FrfCsv, ReadsTheColumnsOfEachPair) {
  const auto file = parse_frf_csv(
      "\xEF\xBB\xBF# of a beam\r\nfreq_hz,re_y1u1,im_y1u1,im_y1u2,re_y1u2,coh_y1u2\r\n"
      "0,1,2,4,3,0.5\r\n\r\n0.25,-1e0,+2,4D0,3,1\r\n",
      "t.csv");
  ASSERT_EQ(file.set.output_count(), 1);
  ASSERT_EQ(file.set.input_count(), 2);
  EXPECT_EQ(file.set.outputs[0].name, "y1");
  EXPECT_EQ(file.set.inputs[1].name, "u2");
  EXPECT_EQ(file.set.frequency_hz, Eigen::Vector2d(0.0, 0.25));
  EXPECT_EQ(file.set.value[0](0, 0), Complex(1.0, 2.0));
  EXPECT_EQ(file.set.value[1](0, 1), Complex(3.0, 4.0));
  EXPECT_EQ(file.set.coherence[0](0, 1), 0.5);
  EXPECT_TRUE(std::isnan(file.set.coherence[0](0, 0)));
  EXPECT_TRUE(file.set.variance.empty());
  ASSERT_EQ(file.notes.size(), 1U);  // the unit
  EXPECT_NE(file.notes[0].find("unit"), std::string::npos);
}

TEST(FrfCsv, ReadsBackWhatItWroteToTheLastBit) {
  for (const bool awkward : {false, true}) {
    auto set = random_set(3, 2, 40, 7);
    if (awkward) {
      set.averages = 13.5;
      set.outputs[1].name = "left, \"front\" edge";
      set.inputs[0].name = "H1";
    }
    const auto back = parse_frf_csv(frf_csv(set), "t.csv").set;
    expect_same(back, set);
    EXPECT_EQ(back.averages, set.averages);
  }
}

TEST(FrfCsv, SaysOfHowManyAveragesItsVariancesAre) {
  const std::string names = "freq_hz,averages,re_y1u1,im_y1u1,var_y1u1\n";
  const auto read = [&](const std::string& lines) { return parse_frf_csv(names + lines, "t.csv"); };
  EXPECT_EQ(read("1,14,2,3,1\n2,14,2,3,1\n").set.averages, 14.0);
  EXPECT_EQ(read("1,14,2,3,1\n2,14,2,3,1\n").notes.size(), 1U);  // the unit
  EXPECT_EQ(read("1,0,2,3,1\n2,0,2,3,1\n").set.averages, 0.0);
  EXPECT_EQ(read("1,,2,3,1\n2,,2,3,1\n").set.averages, 0.0);
  const auto differ = read("1,14,2,3,1\n2,,2,3,1\n3,6,2,3,1\n");
  EXPECT_EQ(differ.set.averages, 6.0);
  ASSERT_EQ(differ.notes.size(), 2U);
  EXPECT_NE(differ.notes[0].find("averages are 6 to 14"), std::string::npos) << differ.notes[0];
  auto set = random_set(1, 1, 2, 1);
  set.averages = 4.0;
  set.variance.clear();  // whose averages there are none of
  EXPECT_EQ(frf_csv(set).find("averages"), std::string::npos);
}

TEST(FrfCsv, NamesAreWrittenAsPlainlyAsTheyAreReadBack) {
  auto set = random_set(1, 1, 2, 1);
  EXPECT_EQ(frf_csv(set).substr(0, 24), "freq_hz,re_y1u1,im_y1u1,");
  set.inputs[0].name = "shaker";
  EXPECT_EQ(frf_csv(set).substr(0, 24), "freq_hz,re_y1/shaker,im_");
  set.inputs[0].name = "a/b";
  EXPECT_THROW((void)frf_csv(set), InvalidInput);
  set.inputs[0].name = "a\nb";
  EXPECT_THROW((void)frf_csv(set), InvalidInput);
}

TEST(FrfCsv, CutsNamesWhereTheyAreKnown) {
  const auto cut = [](const char* word, std::vector<std::string> s, std::vector<std::string> a) {
    return channel_pair(word, s, a);
  };
  using Pair = ChannelPair;
  EXPECT_EQ(cut("y1u1", {}, {}), Pair("y1", "u1"));
  EXPECT_EQ(cut("s_z12a_3", {}, {}), Pair("s_z12", "a_3"));
  EXPECT_EQ(cut("y1_u2", {}, {}), Pair("y1", "u2"));
  EXPECT_EQ(cut("y1 -> u2", {}, {}), Pair("y1", "u2"));
  EXPECT_EQ(cut("left/right", {}, {}), Pair("left", "right"));
  EXPECT_EQ(cut("leftright", {"left", "up"}, {"right"}), Pair("left", "right"));
  EXPECT_EQ(cut("leftright", {"left"}, {}), Pair("left", "right"));
  EXPECT_EQ(cut("leftright", {}, {"right"}), Pair("left", "right"));
  EXPECT_EQ(cut("y1u1", {"s1"}, {"a1"}), Pair("y1", "u1"));  // strangers to the study
  EXPECT_EQ(cut("12", {"1"}, {"2"}), Pair("1", "2"));
  EXPECT_THROW((void)cut("leftright", {}, {}), InvalidInput);
  EXPECT_THROW((void)cut("y1", {}, {}), InvalidInput);
  EXPECT_THROW((void)cut("y1u1w1", {}, {}), InvalidInput);
  EXPECT_THROW((void)cut("a/b/c", {}, {}), InvalidInput);
  EXPECT_THROW((void)cut("121", {"1", "12"}, {"1", "21"}), InvalidInput);
}

TEST(FrfCsv, OneResponseNeedsNoNames) {
  const std::string bytes = "freq_hz,re_accelerance,im_accelerance,coherence\n0,1,0,0.5\n1,2,3,1\n";
  const auto file = parse_frf_csv(bytes, "t.csv");
  EXPECT_EQ(file.set.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_EQ(file.set.value[1](0, 0), Complex(2.0, 3.0));
  EXPECT_EQ(file.set.coherence[1](0, 0), 1.0);
  FrfOptions options;
  options.sensor_names = {"s7"};
  options.actuator_names = {"hammer"};
  options.unit = "g/N";
  const auto named = parse_frf_csv(bytes, "t.csv", options);
  EXPECT_EQ(named.set.outputs[0].name, "s7");
  EXPECT_EQ(named.set.inputs[0].name, "hammer");
  EXPECT_EQ(named.set.outputs[0].unit, "m/s^2");
  EXPECT_EQ(named.set.inputs[0].unit, "N");
  EXPECT_NEAR(named.set.value[1](0, 0).real(), 2.0 * 9.80665, 1e-12);
  options.unit = "mm";  // of a receptance
  EXPECT_THROW((void)parse_frf_csv(bytes, "t.csv", options), InvalidInput);
}

TEST(FrfCsv, PutsTheStatedUnitIntoSi) {
  struct Case {
    const char *unit, *si;
    double factor;
    modal::FrfKind kind;
  };
  const Case cases[] = {{"mm", "m", 1e-3, modal::FrfKind::receptance},
                        {"um/N", "m", 1e-6, modal::FrfKind::receptance},
                        {"in/s", "m/s", 0.0254, modal::FrfKind::mobility},
                        {"mm/s^2", "m/s^2", 1e-3, modal::FrfKind::accelerance},
                        {"m/s^2/kN", "m/s^2", 1e-3, modal::FrfKind::accelerance},
                        {"um/V", "m", 1e-6, modal::FrfKind::receptance},
                        {"mg/N", "m/s^2", 9.80665e-3, modal::FrfKind::accelerance},
                        {"g/lbs", "m/s^2", 9.80665 / 4.4482216152605, modal::FrfKind::accelerance},
                        {"[mm]", "m", 1e-3, modal::FrfKind::receptance},
                        {"(um/N)", "m", 1e-6, modal::FrfKind::receptance},
                        {"(m/s^2)/(N)", "m/s^2", 1.0, modal::FrfKind::accelerance},
                        {"um N^-1", "m", 1e-6, modal::FrfKind::receptance},
                        {"mm s^-2 kN^-1", "m/s^2", 1e-6, modal::FrfKind::accelerance},
                        {"V", "V", 1.0, modal::FrfKind::receptance}};
  for (const auto& [unit, si, factor, kind] : cases) {
    FrfOptions options;
    options.unit = unit;
    const auto set =
        parse_frf_csv("freq_hz,re_y1u1,im_y1u1,var_y1u1\n1,2,-4,8\n", "t.csv", options).set;
    EXPECT_EQ(set.outputs[0].unit, si) << unit;
    EXPECT_EQ(set.outputs[0].kind, kind) << unit;
    EXPECT_NEAR(std::abs(set.value[0](0, 0) / Complex(2.0, -4.0) - factor), 0.0, 1e-15) << unit;
    EXPECT_NEAR(set.variance[0](0, 0) / (8.0 * factor * factor), 1.0, 1e-13) << unit;
  }
}

TEST(FrfCsv, RefusesWhatIsNoUnitOfASensor) {
  for (const auto* unit : {"UM", "foo", "foo/N", "um/foo", "kg", "m m", "[]"}) {
    FrfOptions options;
    options.unit = unit;
    const auto said = refusal_of(
        [&] { return parse_frf_csv("freq_hz,re_y1u1,im_y1u1\n1,2,-4\n", "t.csv", options); });
    EXPECT_NE(said.find("is none that is known"), said.npos) << unit << ": " << said;
  }
}

// Excel writes a table in the code page of the machine.
TEST(FrfCsv, NamesOfLatin1AreUtf8) {
  for (const char* name : {"T\xFCr", "T\xC3\xBCr"}) {
    const auto file = parse_frf_csv(
        "freq_hz;re_" + std::string(name) + "/u;im_" + name + "/u\r\n1;2;3\r\n", "t.csv");
    EXPECT_EQ(file.set.outputs[0].name, "T\xC3\xBCr");
  }
}

// |S|^2 over two powers, in single precision, is 1.0000001 where all is coherent.
TEST(FrfCsv, ACoherenceIsOneWithinItsRounding) {
  const auto coherence = [](const char* text) {
    return parse_frf_csv("freq_hz,re_y1u1,im_y1u1,coh_y1u1\n1,2,3," + std::string(text) + "\n",
                         "t.csv")
        .set.coherence[0](0, 0);
  };
  EXPECT_EQ(coherence("1.0000001"), 1.0);
  EXPECT_EQ(coherence("-1e-7"), 0.0);
  EXPECT_EQ(coherence("0.9999999"), 0.9999999);
  EXPECT_THROW((void)coherence("1.001"), InvalidInput);
}

TEST(FrfCsv, WhatIsMissingIsNotANumber) {
  const auto set =
      parse_frf_csv("freq_hz,re_y1u1,im_y1u1,re_y2u2,im_y2u2\n1,2,3,,\n2,nan,NaN,1,1\n", "t.csv")
          .set;
  ASSERT_EQ(set.output_count(), 2);
  ASSERT_EQ(set.input_count(), 2);
  EXPECT_TRUE(std::isnan(set.value[0](0, 1).real()));
  EXPECT_TRUE(std::isnan(set.value[0](1, 1).real()));
  EXPECT_TRUE(std::isnan(set.value[1](0, 0).imag()));
  EXPECT_EQ(set.value[1](1, 1), Complex(1.0, 1.0));
}

struct Bad {
  const char *bytes, *word;
};

class BadFrfCsv : public testing::TestWithParam<Bad> {};

TEST_P(BadFrfCsv, IsRefusedWithItsPlace) {
  try {
    (void)parse_frf_csv(GetParam().bytes, "t.csv");
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().word), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find("t.csv"), 0U) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    FrfCsv, BadFrfCsv,
    testing::Values(Bad{"", "no lines"}, Bad{"freq_hz,re_y1u1,im_y1u1\n", "no line of numbers"},
                    Bad{"x,re_y1u1,im_y1u1\n1,2,3\n", "no column freq_hz"},
                    Bad{"freq_hz,x\n1,2\n", "no column of a response"},
                    Bad{"freq_hz,re_y1u1\n1,2\n", "y1/u1 has no column im_"},
                    Bad{"freq_hz,re_left,im_left\n1,2,3\n", "column 're_left'"},
                    Bad{"freq_hz,re_y1u1,im_y1u1,re_y1/u1\n1,2,3,4\n", "same response"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n1,2\n", "line 2: 2 fields; expected 3"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n1,2,3,4,5\n", "line 2: 5 fields; expected 3"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n1,x,3\n", "line 2: re_y1u1: found 'x'"},
                    Bad{"freq_hz;re_y1u1;im_y1u1\n1;2,5;3\n", "decimal"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n1,2,inf\n", "line 2: im_y1u1"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n2,2,3\n\n1,2,3\n",
                        "line 4: freq_hz is 1 after 2"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n2,2,3\n2,2,3\n", "ascending"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n-2,2,3\n", "ascending"},
                    Bad{"freq_hz,re_y1u1,im_y1u1\n,2,3\n", "ascending"},
                    Bad{"freq_hz,re_y1u1,im_y1u1,coh_y1u1\n1,2,3,1.5\n", "coherence is 1.5"},
                    Bad{"freq_hz,re_y1u1,im_y1u1,var_y1u1\n1,2,3,-1\n", "variance is -1"},
                    Bad{"freq_hz,averages,re_y1u1,im_y1u1\n1,-2,2,3\n", "line 2: averages is -2"},
                    Bad{"0,1,2\n1,2,3\n", "expected a first line of names"},
                    Bad{"freq_hz,freq_hz\n1,2\n", "two columns"},
                    Bad{"freq_hz,\"re_y1u1\n1,2\n", "quote"}));

TEST(FrfCsv, RefusesAMatrixThatIsMostlyEmpty) {
  std::string head = "freq_hz", line = "1";
  for (int n = 1; n <= 2000; ++n) {
    const auto name = "y" + std::to_string(n) + "u" + std::to_string(n);
    head += ",re_" + name + ",im_" + name;
    line += ",1,2";
  }
  FrfOptions options;
  options.limit_bytes = 64U << 20U;
  EXPECT_THROW((void)parse_frf_csv(head + "\n" + line + "\n", "t.csv", options), InvalidInput);
}

TEST(FrfCsv, NumbersThatNoInstrumentGivesAreRefusedWithLineAndColumn) {
  const std::string head = "freq_hz,re_y1u1,im_y1u1\n1,2,3\n";
  for (const char* number : {"1e200", "-1.5e101", "1e308"}) {
    try {
      (void)parse_frf_csv(head + "2,0.5," + number + "\n", "t.csv");
      ADD_FAILURE() << number << " is taken";
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find("t.csv: line 3: im_y1u1: found "), std::string::npos)
          << e.what();
    }
  }
  for (const char* number : {"inf", "-inf", "1e999"}) {
    EXPECT_THROW((void)parse_frf_csv(head + "2,0.5," + number + "\n", "t.csv"), InvalidInput);
  }
  EXPECT_EQ(parse_frf_csv(head + "2,0.5,1e99\n", "t.csv").set.value[1](0, 0).imag(), 1e99);
  EXPECT_TRUE(std::isnan(parse_frf_csv(head + "2,nan,nan\n", "t.csv").set.value[1](0, 0).real()));
}

TEST(FrfCsv, TextInUtf16IsCalledSo) {
  const std::string text = "freq_hz,re_y1u1,im_y1u1\n1,2,3\n";
  for (const bool big_endian : {false, true}) {
    std::string wide;
    for (const char c : text) wide += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    const std::string mark = big_endian ? "\xFE\xFF" : "\xFF\xFE";
    for (const std::string& bytes : {wide, mark + wide}) {
      try {
        (void)parse_frf_csv(bytes, "t.csv");
        ADD_FAILURE() << "taken";
      } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("UTF-16; save it as UTF-8"), std::string::npos);
      }
      EXPECT_THROW((void)parse_time_csv(bytes, "t.csv"), InvalidInput);
    }
  }
}

TEST(FrfCsv, IsReadCompressedToo) {
  const auto set = random_set(2, 2, 500, 3);
  const auto whole = gzipped(frf_csv(set));
  const TemporaryFile file("frf_csv_test.csv.gz");
  const auto put = [&](const std::string& bytes) {
    std::ofstream(file.path, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
  };
  put(whole);
  expect_same(read_frf(file.path).set, set);
  put(whole.substr(0, whole.size() / 2));
  EXPECT_THROW((void)read_frf(file.path), InvalidInput);
  auto bent = whole;
  bent[bent.size() / 2] = static_cast<char>(~bent[bent.size() / 2]);
  put(bent);
  EXPECT_THROW((void)read_frf(file.path), InvalidInput);
  put(gzipped(std::string(1U << 22U, '\n')));
  FrfOptions options;
  options.limit_bytes = 1U << 20U;
  EXPECT_THROW((void)read_frf(file.path, options), InvalidInput);
}

std::filesystem::path shared_data() {
  return std::filesystem::path(CHLADNI_SOURCE_DIR) / "../shared/data";
}

TEST(MeasuredData, BeamOfEindhovenIsReadAsItIs) {
  const auto path = shared_data() / "tue-beam-3x3/frf_3x3.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto file = read_frf(path);
  ASSERT_EQ(file.set.output_count(), 3);
  ASSERT_EQ(file.set.input_count(), 3);
  EXPECT_EQ(file.set.outputs[2].name, "y5");
  EXPECT_EQ(file.set.line_count(), 8000);
  EXPECT_EQ(file.set.frequency_hz(7999), 1999.75);
  EXPECT_EQ(file.set.value[0](0, 0), Complex(22.98063, -0.919778));
  EXPECT_EQ(file.set.value[0](2, 2), Complex(15.39967, -0.6354132));
}

TEST(MeasuredData, FreeBarIsReadAsItIs) {
  const auto path = shared_data() / "freebar-modelab/frf_9x1_roving_hammer.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  FrfOptions options;
  options.unit = "m/s^2";
  options.collocated = {{"y1", "u4"}};
  const auto file = read_frf(path, options);
  EXPECT_EQ(file.set.input_count(), 9);
  EXPECT_EQ(file.set.line_count(), 51201);
  EXPECT_EQ(file.set.value[1](0, 8), Complex(-0.1706937, 3.705532e-05));
  const auto turned = std::count_if(file.notes.begin(), file.notes.end(), [](const auto& note) {
    return note.starts_with("y1/u4 looks as if its sign were turned");  // its README: along −x
  });
  EXPECT_EQ(turned, 1) << testing::PrintToString(file.notes);
}

TEST(MeasuredData, TonewoodIsOneAccelerance) {
  const auto path = shared_data() / "tonewood-1to4/plate_01_1L_H1.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto file = read_frf(path);
  EXPECT_EQ(file.set.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_EQ(file.set.line_count(), 4001);
  EXPECT_EQ(file.set.coherence[0](0, 0), 0.20445);
}

}  // namespace
}  // namespace chladni::io
