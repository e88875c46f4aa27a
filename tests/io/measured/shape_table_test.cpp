#include "io/shape_table.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "base/error.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

TEST(ShapeTable, ReadsModesByLineAndChannelsByColumn) {
  const auto table = parse_shapes(
      "# thesis table 4\r\nmode,frequency_hz,damping_ratio,s1,\"s,2\",std_s1\r\n"
      "1,139.2,0.004,0.1,-2e-1,0.01\r\n\r\n2,250,0.002,0.3,0.4,0.02\r\n",
      "t.csv");
  ASSERT_EQ(table.channels, (std::vector<std::string>{"s1", "s,2"}));
  EXPECT_EQ(table.frequency_hz, Eigen::Vector2d(139.2, 250.0));
  EXPECT_EQ(table.damping_ratio, Eigen::Vector2d(0.004, 0.002));
  EXPECT_EQ(table.values, (Eigen::Matrix2d() << 0.1, 0.3, -0.2, 0.4).finished());
  EXPECT_EQ(table.deviation, (Eigen::Matrix2d() << 0.01, 0.02, 0.0, 0.0).finished());
}

// As tables of responses, and as a German Excel writes them.
TEST(ShapeTable, MayBeSeparatedBySemicolonsOrTabs) {
  for (const char separator : {';', '\t'}) {
    std::string bytes = "frequency_hz,s1,s2,std_s1\r\n139.2,0.1,,0.01\r\n250,0.3,0.4,0.02\r\n";
    std::ranges::replace(bytes, ',', separator);
    const auto table = parse_shapes(bytes, "t.csv", ShapesStated::partly);
    ASSERT_EQ(table.channels, (std::vector<std::string>{"s1", "s2"}));
    EXPECT_EQ(table.frequency_hz, Eigen::Vector2d(139.2, 250.0));
    EXPECT_TRUE(std::isnan(table.values(1, 0)));
    EXPECT_EQ(table.values(1, 1), 0.4);
    EXPECT_EQ(table.deviation(0, 1), 0.02);
  }
}

TEST(ShapeTable, AByteOrderMarkIsNoPartOfAName) {
  EXPECT_EQ(parse_shapes("\xEF\xBB\xBF"
                         "frequency_hz,s1\n2,3\n",
                         "t.csv")
                .frequency_hz(0),
            2.0);
}

TEST(ShapeTable, ReadsBackWhatItWrote) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("chladni_shape_table_" + std::to_string(getpid()) + ".csv");
  ShapeTable table{{"a", "b"},
                   Eigen::Vector2d(1.0 / 3.0, 20.0),
                   Eigen::Vector2d(0.0, 0.1),
                   Eigen::Matrix2d::Random(),
                   Eigen::Matrix2d::Constant(0.1 / 3.0)};
  write_shapes(file, table);
  const auto back = read_shapes(file);
  std::filesystem::remove(file);
  EXPECT_EQ(back.channels, table.channels);
  EXPECT_EQ(back.frequency_hz, table.frequency_hz);
  EXPECT_EQ(back.values, table.values);
  EXPECT_EQ(back.deviation, table.deviation);
}

TEST(ShapeTable, MayHaveGapsWhereTheyAreAllowed) {
  const auto table = parse_shapes("frequency_hz,std_frequency_hz,s1,std_s1\n1,0.1,,\n2,,3,0.5\n",
                                  "t.csv", ShapesStated::partly);
  EXPECT_EQ(table.frequency_std_hz, Eigen::Vector2d(0.1, 0.0));
  EXPECT_TRUE(std::isnan(table.values(0, 0)));
  EXPECT_EQ(table.values(0, 1), 3.0);
  EXPECT_EQ(table.deviation, Eigen::RowVector2d(0.0, 0.5));
  EXPECT_TRUE(std::isnan(table.damping_ratio(0)));
  EXPECT_EQ(parse_shapes("frequency_hz\n1\n", "t.csv", ShapesStated::partly).values.rows(), 0);
  EXPECT_THROW((void)parse_shapes("frequency_hz\n\"\"\n", "t.csv", ShapesStated::partly),
               InvalidInput);
}

struct BrokenTable {
  const char *bytes, *word;
};

class BadTable : public testing::TestWithParam<BrokenTable> {};

TEST_P(BadTable, IsRefusedWithItsLine) {
  try {
    (void)parse_shapes(GetParam().bytes, "t.csv");
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().word), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find("t.csv"), 0U) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    ShapeTable, BadTable,
    testing::Values(BrokenTable{"", "no lines"}, BrokenTable{"frequency_hz,s1\n", "no mode"},
                    BrokenTable{"f,s1\n1,2\n", "no column frequency_hz"},
                    BrokenTable{"frequency_hz\n1\n", "no column of a channel"},
                    BrokenTable{"frequency_hz,s1\n1\n", "line 2: 1 fields; expected 2"},
                    BrokenTable{"frequency_hz,s1\n1,x\n", "line 2: s1"},
                    BrokenTable{"frequency_hz,s1\n1,nan\n", "line 2: s1"},
                    BrokenTable{"frequency_hz,s1\n1,\n", "line 2: s1"},
                    BrokenTable{"frequency_hz,s1\n-1,2\n", "frequency_hz is negative"},
                    BrokenTable{"frequency_hz,s1,s1\n1,2,3\n", "two columns"},
                    BrokenTable{"frequency_hz,s1,\n1,2,3\n", "column 3 has no name"},
                    BrokenTable{"frequency_hz,s1,std_s2\n1,2,3\n", "std_s2"},
                    BrokenTable{"frequency_hz,s1,std_s1\n1,2,0\n", "more than 0"},
                    BrokenTable{"frequency_hz,s1\n1e99,2\n", "found 1e+99 Hz, expected 0, or"},
                    BrokenTable{"frequency_hz,s1\n1e-99,2\n", "found 1e-99 Hz, expected 0, or"},
                    BrokenTable{"frequency_hz,damping_ratio,s1\n1,0.5,2\n2,1.2,3\n",
                                "line 3: damping_ratio is 1.2; expected a ratio below 1"},
                    BrokenTable{"frequency_hz,s1\n1,1e200\n", "line 2: s1: found"},
                    BrokenTable{"\xFF\xFE", "UTF-16"},
                    BrokenTable{"frequency_hz,\"s1\n1,2\n", "quote"}));

// A negative damping ratio was none, a shape without a value had a MAC of 0, and a mode that was
// there twice was a second mode.
TEST(ShapeTable, ModesThatNoMeasurementGivesAreRefused) {
  const auto said = [](const std::string& lines, ShapesStated stated = ShapesStated::partly) {
    const std::string head = "frequency_hz,damping_ratio,s1,s2\n";
    return refusal_of([&] { return parse_shapes(head + lines, "t.csv", stated); });
  };
  EXPECT_NE(said("5,-0.02,1,2\n").find("line 2: damping_ratio is -0.02; expected 0 or more"),
            std::string::npos);
  EXPECT_NE(said("5,0.01,0,0\n").find("line 2: all values of the shape are 0"), std::string::npos);
  EXPECT_NE(said("5,0.01,1,2\n6,0,1,2\n5,0.02,1,2\n").find("line 4: the mode repeats mode 1"),
            std::string::npos);
  EXPECT_NE(said("5,0.01,,2\n5,0.02,,2\n").find("repeats mode 1"), std::string::npos);
  for (const auto* sound : {"5,0,1,0\n", "5,,0,\n", "5,0,1,2\n5,0,2,1\n", "5,,,\n5,,,\n"}) {
    EXPECT_EQ(said(sound), "") << sound;
  }
  EXPECT_EQ(said("5,-0.02,0,0\n5,-0.02,0,0\n", ShapesStated::all), "");
}

// All modes of one frequency were compared with each other.
TEST(ShapeTable, ManyModesOfOneFrequencyAreReadInTime) {
  std::string bytes = "frequency_hz,s1\n";
  for (int mode = 0; mode < 99'999; ++mode) bytes += "5," + std::to_string(mode + 1) + "\n";
  EXPECT_EQ(parse_shapes(bytes, "t.csv", ShapesStated::partly).values.cols(), 99'999);
  const auto said =
      refusal_of([&] { return parse_shapes(bytes + "5,7\n", "t.csv", ShapesStated::partly); });
  EXPECT_NE(said.find("line 100001: the mode repeats mode 7"), said.npos) << said;
}

}  // namespace
}  // namespace chladni::io
