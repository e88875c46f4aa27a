#include "io/uff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "io/frf_uff.h"
#include "io/uff_lines.h"
#include "tests/io/frf_samples.h"
#include "tests/io/uff_samples.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

int times(const std::vector<std::string>& said, const std::string& word) {
  return static_cast<int>(std::count_if(said.begin(), said.end(), [&](const auto& one) {
    return one.find(word) != std::string::npos;
  }));
}

void expect_sample(const Uff& uff, const Sample58& sample) {
  ASSERT_EQ(uff.functions.size(), 1U);
  const auto& f = uff.functions[0];
  EXPECT_EQ(f.type, sample.function_type);
  EXPECT_EQ(f.response.node, 12);
  EXPECT_EQ(f.response.direction, 3);
  EXPECT_EQ(f.reference.node, 3);
  EXPECT_EQ(f.reference.direction, -3);
  EXPECT_EQ(f.ordinate.type, 12);
  EXPECT_EQ(f.ordinate.unit, "m/s^2");
  EXPECT_EQ(f.abscissa.label, "Frequency");
  EXPECT_EQ(f.id[0], "response");
  EXPECT_EQ(f.id[1], "");
  ASSERT_EQ(f.y.size(), 5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_NEAR(f.x(k), sample.x[at], 1e-6);
    const Complex expected = sample.ordinate_type >= 5 ? sample.y[at] : sample.y[at].real();
    EXPECT_LT(std::abs(f.y(k) - expected), 1e-6 * std::abs(expected));
  }
}

TEST(Uff, ReadsEveryFormOfTheDataset) {
  for (const int type : {2, 4, 5, 6}) {
    for (const bool even : {false, true}) {
      for (const int encoding : {0, 1, 2}) {
        for (const char* eol : {"\n", "\r\n"}) {
          Sample58 sample;
          sample.ordinate_type = type;
          sample.even = even;
          sample.binary = encoding > 0;
          sample.big_endian = encoding == 2;
          sample.eol = eol;
          SCOPED_TRACE(fmt::format("type {} even {} encoding {}", type, even, encoding));
          const auto uff = parse_uff(dataset_58(sample), "t.uff");
          expect_sample(uff, sample);
          EXPECT_TRUE(uff.notes.empty()) << testing::PrintToString(uff.notes);
        }
      }
    }
  }
}

TEST(Uff, LineFeedsAroundBinaryDataAreNoData) {
  for (const char* extra : {"\n", "\r\n"}) {
    Sample58 sample;
    sample.binary = true;
    sample.ordinate_type = 6;
    sample.extra = extra;
    expect_sample(parse_uff(dataset_58(sample), "t.uff"), sample);
  }
}

TEST(Uff, BinaryDataMayHoldAnything) {
  Draw draw(11);
  for (int trial = 0; trial < 200; ++trial) {
    Sample58 sample;
    sample.binary = true;
    sample.ordinate_type = 5;
    for (auto& y : sample.y) {  // bytes that look like line ends and delimiters
      const std::uint32_t tricky[] = {0x3F0A0D0A, 0xBF312D0A, 0x3D0A0A2D, 0x400A312D};
      const auto word = [&] { return tricky[static_cast<int>(4.0 * draw.uniform())]; };
      const double real = static_cast<double>(std::bit_cast<float>(word()));
      y = {real, static_cast<double>(std::bit_cast<float>(word()))};
    }
    const auto uff = parse_uff(dataset_58(sample) + dataset_58(sample), "t.uff");
    ASSERT_EQ(uff.functions.size(), 2U);
    EXPECT_EQ(uff.functions[0].y, uff.functions[1].y);
    EXPECT_EQ(uff.functions[0].y(0).real(), sample.y[0].real());
  }
}

TEST(Uff, AWrongByteOrderIsSeenAndSaid) {
  Sample58 sample;
  sample.binary = true;
  for (const bool big : {false, true}) {
    sample.big_endian = big;
    auto bytes = dataset_58(sample);
    const auto at = bytes.find("58b") + 8;
    ASSERT_EQ(bytes[at], big ? '2' : '1');
    bytes[at] = big ? '1' : '2';
    const auto uff = parse_uff(bytes, "t.uff");
    expect_sample(uff, sample);
    EXPECT_EQ(times(uff.notes, "other order"), 1);
  }
}

TEST(Uff, ALyingByteCountIsSaid) {
  Sample58 sample;
  sample.binary = true;
  auto bytes = dataset_58(sample);
  const auto at = bytes.find("          40");
  ASSERT_NE(at, bytes.npos);
  bytes.replace(at, 12, "     1000000");
  const auto uff = parse_uff(bytes, "t.uff");
  expect_sample(uff, sample);
  EXPECT_EQ(times(uff.notes, "1000000 bytes, it has 40"), 1);
}

TEST(Uff, NumbersRunOnAsFortranWritesThem) {
  const auto all = [](std::string_view line) {
    std::vector<double> numbers;
    std::size_t at = 0;
    while (const auto value = run_on_number(line, at)) numbers.push_back(*value);
    return numbers;
  };
  using Numbers = std::vector<double>;
  EXPECT_EQ(all(" 1.5E+00-2.5E+00-1.0D-03+4.d2"), (Numbers{1.5, -2.5, -1e-3, 400.0}));
  EXPECT_EQ(all("1.0-100-2.0+101 3.5"), (Numbers{1e-100, -2e101, 3.5}));
  EXPECT_EQ(all("-1.23456E-100-1.23456E-100"), (Numbers{-1.23456e-100, -1.23456e-100}));
  EXPECT_EQ(all("0 -1 2"), (Numbers{0.0, -1.0, 2.0}));
  EXPECT_EQ(all("1.5x"), Numbers{});
  EXPECT_EQ(all("E5"), Numbers{});
  EXPECT_EQ(all(""), Numbers{});
}

TEST(Uff, BlankLinesAndAMissingEndAreTolerated) {
  Sample58 sample;
  const auto bytes = dataset_58(sample);
  expect_sample(parse_uff("\n\n" + bytes + "\n\n", "t.uff"), sample);
  const auto open = parse_uff(bytes.substr(0, bytes.rfind("    -1")), "t.uff");
  expect_sample(open, sample);
  EXPECT_EQ(times(open.notes, "without -1"), 1);
  auto spaced = bytes;
  const auto first_number = spaced.find("  1.50000E+00");
  ASSERT_NE(first_number, spaced.npos);
  expect_sample(parse_uff(spaced.insert(first_number, "\n\n"), "t.uff"), sample);
  // The closing -1 of one dataset is missing in the middle: the next opens at once.
  auto two = bytes.substr(0, bytes.rfind("    -1")) + bytes;
  EXPECT_EQ(parse_uff(two, "t.uff").functions.size(), 2U);
}

TEST(Uff, ReadsHeadNodesAndPassesOverOthers) {
  const std::string bytes =
      "    -1\n   151\nplate\nNONE\n\nx\n    -1\n" + dataset_164(1000.0, 1000.0) +
      "    -1\n    15\n"
      "         1         0         0        11  1.00000E+02  2.00000E+02  0.00000E+00\n"
      "        12         0         0        11 -1.00000E+02-2.00000E+02  0.00000E+00\n    -1\n"
      "    -1\n  2411\n         3         0         0        11\n"
      "   1.5000000000000000D+02   0.0000000000000000D+00  -2.0000000000000000D+01\n    -1\n"
      "    -1\n    82\n 1 2 3\n    -1\n";
  const auto uff = parse_uff(bytes, "t.uff");
  EXPECT_EQ(uff.title, "plate");
  ASSERT_TRUE(uff.units.has_value());
  EXPECT_DOUBLE_EQ(uff.units->length, 1e-3);
  EXPECT_EQ(uff.nodes.at(1), Eigen::Vector3d(100.0, 200.0, 0.0));
  EXPECT_EQ(uff.nodes.at(12), Eigen::Vector3d(-100.0, -200.0, 0.0));
  EXPECT_EQ(uff.nodes.at(3), Eigen::Vector3d(150.0, 0.0, -20.0));
  EXPECT_EQ(times(uff.notes, "dataset 82: not read"), 1);
  const auto set = parse_frf_uff(bytes + dataset_58({}), "t.uff").set;
  EXPECT_EQ(*set.outputs[0].position, Eigen::Vector3d(-0.1, -0.2, 0.0));
  EXPECT_EQ(*set.inputs[0].position, Eigen::Vector3d(0.15, 0.0, -0.02));
}

TEST(Uff, ReadsShapes) {
  const std::string normal =
      "    -1\n    55\nshape\nNONE\nNONE\nNONE\nNONE\n"
      "         1         2         2         8         2         3\n"
      "         2         4         0         1\n"
      "  1.23400E+02  1.00000E+00  5.00000E-03  0.00000E+00\n"
      "        11\n  1.00000E+00  0.00000E+00 -2.00000E+00\n"
      "        12\n  0.00000E+00  0.00000E+00  3.00000E+00\n    -1\n";
  const auto uff = parse_uff(normal, "t.unv");
  ASSERT_EQ(uff.shapes.size(), 1U);
  EXPECT_EQ(uff.shapes[0].frequency_hz, 123.4);
  EXPECT_EQ(uff.shapes[0].damping_ratio, 0.005);
  EXPECT_EQ(uff.shapes[0].nodes, (std::vector<long long>{11, 12}));
  EXPECT_EQ(uff.shapes[0].values(0, 2), Complex(-2.0));
  EXPECT_EQ(uff.shapes[0].values(1, 2), Complex(3.0));
  const std::string complex_one =
      "    -1\n    55\nshape\nNONE\nNONE\nNONE\nNONE\n"
      "         1         3         2         8         5         3\n"
      "         2         6         0         1\n"
      " -3.00000E+00  4.00000E+00  1.00000E+00  0.00000E+00  1.00000E+00  0.00000E+00\n"
      "        11\n  1.00000E+00  5.00000E-01  0.00000E+00  0.00000E+00 -2.00000E+00  1.00000E+00\n"
      "    -1\n";
  const auto other = parse_uff(complex_one, "t.unv");
  ASSERT_EQ(other.shapes.size(), 1U);
  EXPECT_DOUBLE_EQ(other.shapes[0].frequency_hz, 5.0 / (2.0 * std::numbers::pi));
  EXPECT_DOUBLE_EQ(other.shapes[0].damping_ratio, 0.6);
  EXPECT_EQ(other.shapes[0].values(0, 2), Complex(-2.0, 1.0));
}

TEST(Uff, EveryPrefixOfAFileIsReadOrRefused) {
  for (const bool binary : {false, true}) {
    Sample58 sample;
    sample.binary = binary;
    const auto bytes = dataset_164(1.0, 1.0) + dataset_58(sample);
    const auto data_ends = bytes.rfind("    -1") - 1;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      try {
        const auto uff = parse_uff(std::string_view(bytes).substr(0, size), "t.uff");
        const bool whole = uff.functions.size() == 1;
        EXPECT_EQ(whole, size >= (binary ? data_ends : data_ends + 1)) << size;
        if (whole) expect_sample(uff, sample);
      } catch (const InvalidInput& e) {
        EXPECT_EQ(std::string(e.what()).find("t.uff"), 0U) << e.what();
      }
    }
  }
}

struct Bad {
  const char *from, *to, *word;
};

TEST(Uff, RefusalsNameDatasetLineAndByte) {
  const Bad faults[] = {
      {"         5         5         1", "         7         5         1", "ordinate data type 7"},
      {"         5         5         1", "         5  99999999         1", "99999999 values"},
      {"         5         5         1", "         5        -5         1", "-5 values"},
      {"         5         5         1", "         5         5         3", "abscissa spacing 3"},
      {"         5         5         1", "         5         9         1",
       "10 numbers, expected 18"},
      {"         5         5         1", "         x         5         1",
       "ordinate data type: found 'x'"},
      {"  1.50000E+00", "  1.5 ,000+00", "found ',000+00'"},
      {"12   3", "12   9", "direction 9"},
      {"        18    0    0    0", "        xx    0    0    0", "type of data"},
  };
  const auto good = dataset_164(1.0, 1.0) + dataset_58({});
  for (const auto& [from, to, word] : faults) {
    auto bytes = good;
    const auto at = bytes.find(from);
    ASSERT_NE(at, bytes.npos) << from;
    bytes.replace(at, std::string_view(from).size(), to);
    try {
      (void)parse_uff(bytes, "t.uff");
      ADD_FAILURE() << word << " is taken";
    } catch (const InvalidInput& e) {
      const std::string what = e.what();
      EXPECT_NE(what.find(word), what.npos) << what;
      EXPECT_EQ(what.find("t.uff: dataset 58 (from line 8), line "), 0U) << what;
      EXPECT_NE(what.find(", byte "), what.npos) << what;
    }
  }
  EXPECT_THROW((void)parse_uff("", "t.uff"), InvalidInput);
  EXPECT_THROW((void)parse_uff("hello\n", "t.uff"), InvalidInput);
  EXPECT_THROW((void)parse_uff("    -1\nhello\n    -1\n", "t.uff"), InvalidInput);
}

TEST(Uff, BytesThatWereSentAsTextAreRefused) {
  Sample58 sample;
  sample.binary = true;
  sample.ordinate_type = 6;
  sample.y[2] = {std::bit_cast<double>(0x3FE00A0A0A0A0A0A), 1.0};
  std::string bytes = dataset_58(sample), sent;
  for (const char c : bytes) sent += c == '\n' ? std::string("\r\n") : std::string(1, c);
  try {
    (void)parse_uff(sent, "t.uff");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("sent as text"), std::string::npos) << e.what();
  }
}

TEST(FrfUff, UnitsOfTheFileBecomeSi) {
  struct Case {
    int ordinate;
    const char *unit, *input;
    double length, force;  // of dataset 164; 0: none
    const char *si, *input_si;
    double factor;
    int notes;
  };
  const Case cases[] = {
      {12, "NONE", "NONE", 1000.0, 1000.0, "m/s^2", "N", 1.0, 0},  // mm and mN
      {8, "NONE", "NONE", 1000.0, 1.0, "m", "N", 1e-3, 0},
      {11, "mm/s", "N", 0.0, 0.0, "m/s", "N", 1e-3, 0},
      {12, "g", "N", 0.0, 0.0, "m/s^2", "N", 9.80665, 0},
      {12, "G's", "lbf", 0.0, 0.0, "m/s^2", "N", 9.80665 / 4.4482216152605, 0},
      {12, "(m/s2)", "N", 1.0, 1.0, "m/s^2", "N", 1.0, 0},
      {12, "g", "N", 1.0, 1.0, "m/s^2", "N", 9.80665, 1},  // contradicts 164: said
      {0, "V", "V", 0.0, 0.0, "V", "", 1.0, 0},
      {12, "NONE", "NONE", 0.0, 0.0, "", "", 1.0, 1},  // nobody says
  };
  for (const auto& c : cases) {
    Sample58 sample;
    sample.ordinate = c.ordinate;
    sample.unit = c.unit;
    sample.input_unit = c.input;
    const auto bytes = (c.length > 0.0 ? dataset_164(c.length, c.force) : "") + dataset_58(sample);
    const auto file = parse_frf_uff(bytes, "t.uff");
    SCOPED_TRACE(fmt::format("{} {} {}", c.ordinate, c.unit, c.length));
    EXPECT_EQ(file.set.outputs[0].unit, c.si);
    EXPECT_EQ(file.set.inputs[0].unit, c.input_si);
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5 * c.factor, 1e-9 * c.factor);
    EXPECT_EQ(static_cast<int>(file.notes.size()), c.notes) << testing::PrintToString(file.notes);
  }
}

TEST(FrfUff, TheCallerStatesTheUnitThatIsMissing) {
  Sample58 sample;
  sample.unit = sample.input_unit = "NONE";
  FrfOptions options;
  options.unit = "mm/s^2";
  const auto file = parse_frf_uff(dataset_58(sample), "t.uff", options);
  EXPECT_EQ(file.set.outputs[0].unit, "m/s^2");
  EXPECT_DOUBLE_EQ(file.set.value[0](0, 0).real(), 1.5e-3);
  EXPECT_TRUE(file.notes.empty());
  options.unit = "mm";  // of a displacement, and the file says acceleration
  EXPECT_THROW((void)parse_frf_uff(dataset_58(sample), "t.uff", options), InvalidInput);
}

TEST(FrfUff, ChannelsAreNodesWithDirections) {
  Sample58 a, b;
  b.response_direction = -1;
  b.reference_node = 7;
  const auto set = parse_frf_uff(dataset_58(a) + dataset_58(b), "t.uff").set;
  ASSERT_EQ(set.output_count(), 2);
  ASSERT_EQ(set.input_count(), 2);
  EXPECT_EQ(set.outputs[0].name, "12z");
  EXPECT_EQ(set.outputs[1].name, "-12x");
  EXPECT_EQ(set.inputs[0].name, "-3z");
  EXPECT_EQ(set.outputs[1].node, 12);
  EXPECT_EQ(set.outputs[1].direction, Eigen::Vector3d(-1.0, 0.0, 0.0));
  EXPECT_EQ(set.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_TRUE(std::isnan(set.value[0](0, 1).real()));
  EXPECT_EQ(set.value[0](1, 1), Complex(1.5, -2.25));
}

TEST(FrfUff, CoherenceBelongsToItsResponse) {
  Sample58 response, coherence;
  coherence.function_type = 6;
  coherence.ordinate_type = 2;
  for (auto& y : coherence.y) y = 0.75;
  const auto file = parse_frf_uff(dataset_58(response) + dataset_58(coherence), "t.uff");
  ASSERT_EQ(file.set.coherence.size(), 5U);
  EXPECT_EQ(file.set.coherence[4](0, 0), 0.75);
  coherence.response_node = 99;
  const auto other = parse_frf_uff(dataset_58(response) + dataset_58(coherence), "t.uff");
  EXPECT_TRUE(other.set.coherence.empty());
  EXPECT_EQ(times(other.notes, "coherences have no response"), 1);
  Sample58 power;
  power.function_type = 9;
  EXPECT_EQ(times(parse_frf_uff(dataset_58(response) + dataset_58(power), "t.uff").notes,
                  "1 function of type 9"),
            1);
}

TEST(FrfUff, RefusalsNameBoth) {
  const auto refused = [](const std::string& bytes, const char* a, const char* b) {
    try {
      (void)parse_frf_uff(bytes, "t.uff");
      ADD_FAILURE() << "taken";
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(a), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(b), std::string::npos) << e.what();
    }
  };
  Sample58 first, second;
  second.response_node = 13;
  second.x.pop_back();
  second.y.pop_back();
  refused(dataset_58(first) + dataset_58(second), "12z over -3z", "13z over -3z");
  Sample58 shifted;
  shifted.response_node = 13;
  shifted.x = {1.0, 1.6, 2.2, 2.8, 3.4};
  refused(dataset_58(first) + dataset_58(shifted), "unequal frequency lines", "3.4");
  Sample58 again;
  again.y[0] = 99.0;
  refused(dataset_58(first) + dataset_58(again), "line 2 ", "line 18 ");
  EXPECT_EQ(times(parse_frf_uff(dataset_58(first) + dataset_58(first), "t.uff").notes, "repeats"),
            1);
  Sample58 falling;
  falling.even = false;
  falling.x = {1.0, 2.0, 1.5, 3.0, 4.0};
  refused(dataset_58(falling), "value 3", "ascending");
  Sample58 time;
  time.function_type = 1;
  refused(dataset_58(time), "no frequency response", "time response");
}

TEST(FrfUff, ReadsBackWhatItWrote) {
  for (const auto encoding : {UffEncoding::binary, UffEncoding::text}) {
    for (const bool even : {false, true}) {
      auto set = random_set(3, 2, 30, 5);
      set.noise_variance.clear();
      if (even) set.frequency_hz = Eigen::VectorXd::LinSpaced(30, 0.0, 29.0) * 0.01953125;
      set.outputs[1].name = "a sensor with a long name";
      set.outputs[0].node = 1;
      set.outputs[2].direction = -Eigen::Vector3d::UnitY();
      set.outputs[2].position = Eigen::Vector3d(0.1, 0.2, 1.0 / 3.0);
      for (auto& output : set.outputs) output.unit = "m/s^2";
      for (auto& output : set.outputs) output.kind = modal::FrfKind::accelerance;
      for (auto& input : set.inputs) input.unit = "N";
      std::vector<std::string> lost;
      const auto file = parse_frf_uff(frf_uff(set, encoding, lost), "t.uff");
      EXPECT_EQ(lost.size(), 1U);  // the variances
      EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
      set.variance.clear();
      EXPECT_EQ(file.set.outputs[0].unit, "m/s^2");
      EXPECT_EQ(file.set.outputs[2].direction, set.outputs[2].direction);
      EXPECT_LT((*file.set.outputs[2].position - *set.outputs[2].position).norm(), 1e-15);
      if (encoding == UffEncoding::binary) {
        expect_same(file.set, set);
        continue;
      }
      EXPECT_EQ(file.set.outputs[1].name, "a sensor with a long name");
      EXPECT_LT((file.set.frequency_hz - set.frequency_hz).cwiseAbs().maxCoeff(), 1e-8);
      for (std::size_t k = 0; k < 29; ++k) {
        EXPECT_LT((file.set.value[k] - set.value[k]).cwiseQuotient(set.value[k]).norm(), 1e-11);
      }
    }
  }
}

TEST(FrfUff, KeepsKindAndUnitThatAreNotSi) {
  auto set = random_set(1, 1, 3, 5);
  set.outputs[0].kind = modal::FrfKind::mobility;
  std::vector<std::string> lost;
  auto back = parse_frf_uff(frf_uff(set, UffEncoding::text, lost), "t.uff").set;
  EXPECT_EQ(back.outputs[0].kind, modal::FrfKind::mobility);
  EXPECT_EQ(back.outputs[0].unit, "");
  set.outputs[0].unit = "V";
  back = parse_frf_uff(frf_uff(set, UffEncoding::text, lost), "t.uff").set;
  EXPECT_EQ(back.outputs[0].unit, "V");
}

TEST(FrfUff, AnIncrementOfSixDigitsIsSaidWhereItMatters) {
  Sample58 sample;
  sample.x.clear();
  sample.y.clear();
  for (int k = 0; k < 52000; ++k) {
    sample.x.push_back(0.01953125 * k);
    sample.y.emplace_back(1.0, -1.0);
  }
  EXPECT_EQ(times(parse_uff(dataset_58(sample), "t.uff").notes, "six digits"), 1);
  for (int k = 0; k < 52000; ++k) sample.x[static_cast<std::size_t>(k)] = 0.25 * k;
  EXPECT_EQ(times(parse_uff(dataset_58(sample), "t.uff").notes, "six digits"), 0);
}

}  // namespace
}  // namespace chladni::io
