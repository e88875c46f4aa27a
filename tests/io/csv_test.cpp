#include "io/csv.h"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

#include "base/error.h"

namespace chladni::io {
namespace {

using Columns = std::vector<CsvColumn>;
using Words = std::vector<std::string>;
using Numbers = Eigen::VectorXd;
using Whole = Eigen::VectorXi;

TEST(Csv, ColumnsBecomeRowsUnderTheirNames) {
  const std::string text = csv({{"mode", Whole{{1, 2}}},
                                {"kind", Words{"rigid", "flexible"}},
                                {"frequency_hz", Numbers{{0.0, 178.9033}}}});
  EXPECT_EQ(text, "mode,kind,frequency_hz\n1,rigid,0\n2,flexible,178.9033\n");
}

TEST(Csv, NumbersReadBackBitByBit) {
  const Eigen::Vector3d numbers(1.0 / 3.0, -2.5e-311, 1e22);
  std::string text = csv(Columns{{"a", Numbers(numbers)}});
  for (const double number : numbers) {
    text.erase(0, text.find('\n') + 1);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), number);
  }
}

TEST(Csv, SeparatorsQuotesAndLineEndsInNamesAreQuoted) {
  const std::string text = csv(Columns{{"na\"me", Words{"a,b", "two\nlines", "plain"}}});
  EXPECT_EQ(text, "\"na\"\"me\"\n\"a,b\"\n\"two\nlines\"\nplain\n");
}

TEST(Csv, WhatIsNoNumberIsEmpty) {
  const Eigen::Vector2d numbers(std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity());
  EXPECT_EQ(csv({{"a", Whole{{1, 2}}}, {"b", Numbers(numbers)}}), "a,b\n1,\n2,\n");
}

TEST(Csv, ADecimalCommaInTheLocaleChangesNothing) {
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(csv(Columns{{"a", Numbers(Numbers::Constant(1, 1.5))}}), "a\n1.5\n");
  std::setlocale(LC_ALL, "C");
}

TEST(Csv, UnequalOrDoubleColumnsAreRefusedByName) {
  EXPECT_THROW(static_cast<void>(csv(Columns{{"a", Words{"1"}}, {"b", Words{}}})), InvalidInput);
  EXPECT_THROW(static_cast<void>(csv(Columns{{"a", Words{}}, {"a", Words{}}})), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
