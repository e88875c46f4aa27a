// One record of results as text, as JSON and in the report.
#include "io/result_table.h"

#include <gtest/gtest.h>

#include <limits>

namespace chladni::io {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ResultTable places() {
  ResultTable table{"Places", {}};
  auto rank = word_column("", {"1", "2"}, 4);
  rank.gap = 0;
  rank.is_number = true;
  table.columns.push_back(rank);
  table.columns.push_back(
      number_column("x", "mm", Eigen::Vector2d(0.1, -0.25), {"{:.2f}", 1e3}, 9, "x_m"));
  table.columns.push_back(
      number_column("MAC", "", Eigen::Vector2d(0.5, kNone), {"{:.3f}"}, 7, "mac"));
  table.columns.push_back(json_column("weight", Eigen::Vector2d(1.0, 2.0)));
  table.columns.push_back(word_column("by", {"shape", "frequency"}));
  return table;
}

TEST(ResultTable, IsTextWithAlignedColumns) {
  EXPECT_EQ(text(places()),
            "         x [mm]      MAC  by\n"
            "   1     100.00    0.500  shape\n"
            "   2    -250.00        -  frequency\n");
}

TEST(ResultTable, IsJsonInSi) {
  const auto rows = json_rows(places());
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(text(rows[0]), text(Json(JsonObject{{"x_m", 0.1}, {"mac", 0.5}, {"weight", 1.0}})));
  EXPECT_EQ(rows[1].at("x_m").number(), -0.25);
  EXPECT_EQ(text(rows[1].at("mac")), text(Json(kNone)));
}

TEST(ResultTable, IsATableOfTheReportWithTheSameCells) {
  const auto table = report_table(places());
  EXPECT_EQ(table.caption, "Places");
  ASSERT_EQ(table.columns.size(), 4U);
  EXPECT_EQ(table.columns[1].heading, "x [mm]");
  EXPECT_TRUE(table.columns[1].is_number);
  EXPECT_FALSE(table.columns[3].is_number);
  EXPECT_EQ(table.rows[1].cells, (std::vector<std::string>{"2", "-250.00", "-", "frequency"}));
}

TEST(ResultTable, MayBeEmpty) {
  ResultTable table{"", {number_column("x", "mm", Eigen::VectorXd(0), {}, 9, "x_m")}};
  EXPECT_EQ(rows_text(table), "");
  EXPECT_TRUE(json_rows(table).empty());
  EXPECT_TRUE(report_table(table).rows.empty());
}

}  // namespace
}  // namespace chladni::io
