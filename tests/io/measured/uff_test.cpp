#include "io/uff/uff.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "io/scan.h"
#include "io/uff/frf_uff.h"
#include "io/uff/uff_fields.h"
#include "io/uff/uff_lines.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/uff_samples.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

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

TEST(Uff, NumbersThatNoInstrumentGivesAreRefusedWithTheirPlace) {
  for (const bool binary : {false, true}) {
    for (const double number : {1e200, -1e101}) {
      Sample58 sample;
      sample.ordinate_type = 6;
      sample.binary = binary;
      sample.y[3] = {1.0, number};
      try {
        (void)parse_uff(dataset_58(sample), "t.uff");
        ADD_FAILURE() << number << " is taken";
      } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("dataset 58"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("at most 1e+100"), std::string::npos) << e.what();
      }
    }
  }
  EXPECT_THROW((void)parse_uff("\xFF\xFE-\0"
                               "1\0",
                               "t.uff"),
               InvalidInput);
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

// A number of more columns would shift all that stand behind it.
TEST(Uff, NumbersWithoutColumnsAreNotWritten) {
  UffFunction function;
  function.x = Eigen::VectorXd::Ones(1);
  function.y = Eigen::VectorXcd::Ones(1);
  function.version = 99'999;
  EXPECT_EQ(parse_uff(uff_dataset(function, UffEncoding::text), "t").functions[0].version, 99'999);
  function.version = 100'000;
  EXPECT_THROW((void)uff_dataset(function, UffEncoding::text), InvalidInput);
  function.version = 1;
  function.reference.node = 10'000'000'000;
  EXPECT_THROW((void)uff_dataset(function, UffEncoding::text), InvalidInput);
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

TEST(Uff, AByteOrderMarkTakesNoDatasetAway) {
  const auto bytes = dataset_58({});
  const auto uff = parse_uff("\xEF\xBB\xBF" + bytes, "t.uff");
  expect_sample(uff, {});
  EXPECT_TRUE(uff.notes.empty()) << testing::PrintToString(uff.notes);
}

TEST(Uff, BlankLinesMayStandBeforeTheEndOfEveryDataset) {
  const std::string node_15 =
      "    -1\n    15\n"
      "         1         0         0        11  1.00000E+02  2.00000E+02  0.00000E+00\n";
  const auto with_lines = [](const std::string& number, int node) {
    return "    -1\n" + number + "\n" + fmt::format("{:10}", node) +
           "         0         0        11\n"
           "   1.5000000000000000D+02   0.0000000000000000D+00  -2.0000000000000000D+01\n";
  };
  const std::string element =
      "    -1\n  2412\n"
      "         1        91         1         1         7         3\n"
      "         1         2         3\n";
  for (const char* blank : {"\n", "   \n\n", "\t\r\n"}) {
    const auto end = std::string(blank) + "    -1\n";
    const auto uff = parse_uff(node_15 + end + with_lines("  2411", 2) + end +
                                   with_lines("   781", 3) + end + element + end + dataset_58({}),
                               "t.uff");
    EXPECT_EQ(uff.nodes.size(), 3U);
    EXPECT_EQ(uff.nodes.at(3), Eigen::Vector3d(150.0, 0.0, -20.0));
    EXPECT_EQ(uff.elements.size(), 1U);
    EXPECT_TRUE(uff.notes.empty()) << testing::PrintToString(uff.notes);
    expect_sample(uff, {});
  }
}

// Fortran's E13.5 takes the last five digits of a number without a point for decimals.
TEST(Uff, NumbersOfThirteenColumnsHaveAPoint) {
  for (const double value : {1e-05, -1e-05, 1e22, -5e-324, 3e-100, 0.0, 1.0, -123456.0, 0.015625,
                             1.234567e-05, -1.25e-07}) {
    const auto text = in_13(value);
    EXPECT_EQ(text.size(), 13U) << text;
    EXPECT_EQ(text.front(), ' ') << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
    EXPECT_EQ(number_in(trimmed(text)), value) << text;
  }
  EXPECT_EQ(in_13(1e-05), "       1.E-05");
  for (const double value : {1.00000000000003e-05, 299999999999.9, -1.99999999999999e-300}) {
    const auto text = in_13(value);  // rounded, so that it fits
    EXPECT_EQ(text.size(), 13U) << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
    EXPECT_NEAR(number_in(trimmed(text)).value_or(0.0) / value, 1.0, 1e-5) << text;
  }
}

TEST(Uff, ReadsHeadNodesAndPassesOverOthers) {
  const std::string bytes =
      "    -1\n   151\nplate\nNONE\n\nx\n    -1\n" + dataset_164(1000.0, 1000.0) +
      "    -1\n    15\n"
      "         1         0         0        11  1.00000E+02  2.00000E+02  0.00000E+00\n"
      "        12         0         0        11 -1.00000E+02-2.00000E+02  0.00000E+00\n    -1\n"
      "    -1\n  2411\n         3         0         0        11\n"
      "   1.5000000000000000D+02   0.0000000000000000D+00  -2.0000000000000000D+01\n    -1\n"
      "    -1\n  1858\n 1 2 3\n    -1\n";
  const auto uff = parse_uff(bytes, "t.uff");
  EXPECT_EQ(uff.title, "plate");
  ASSERT_TRUE(uff.units.has_value());
  EXPECT_DOUBLE_EQ(uff.units->length, 1e-3);
  EXPECT_EQ(uff.nodes.at(1), Eigen::Vector3d(100.0, 200.0, 0.0));
  EXPECT_EQ(uff.nodes.at(12), Eigen::Vector3d(-100.0, -200.0, 0.0));
  EXPECT_EQ(uff.nodes.at(3), Eigen::Vector3d(150.0, 0.0, -20.0));
  EXPECT_EQ(times(uff.notes, "dataset 1858: not read"), 1);
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

struct BadDataset {
  const char *from, *to, *word;
};

TEST(Uff, RefusalsNameDatasetLineAndByte) {
  const BadDataset faults[] = {
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

TEST(Uff, AnIncrementOfSixDigitsIsSaidWhereItMatters) {
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
