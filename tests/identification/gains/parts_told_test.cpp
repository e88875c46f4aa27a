// What is said of a fit in which parts of the channels share no response.
#include <gtest/gtest.h>

#include <limits>

#include "identification/response_field.h"

namespace chladni::identification {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

// Two modes, each known at two of four rows: a fit of two parts.
struct InParts {
  ModalFit fit;
  GainMatch match;

  InParts() {
    fit.model.frequency_hz = Eigen::Vector2d(10.0, 20.0);
    match.modes.resize(2);
    for (auto& mode : match.modes) mode.by = MatchedBy::pairs;
    match.rows = {{false, 0}, {true, 0}, {false, 1}, {true, 1}};
    match.deviation = Eigen::MatrixXd::Constant(4, 2, 0.1);
    match.deviation.col(0).tail(2).setConstant(kUnknown);
    match.deviation.col(1).head(2).setConstant(kUnknown);
  }
};

// No pair would help: each mode has a scale.
TEST(PartsTold, AreTheReasonWhyNoModeIsKnownAtAllChannels) {
  const InParts parts;
  EXPECT_TRUE(modes_with_scale(parts.fit, parts.match).empty());
  EXPECT_EQ(rows_without(parts.fit, parts.match, 0), (std::vector<Eigen::Index>{2, 3}));
  EXPECT_EQ(rows_without(parts.fit, parts.match, 1), (std::vector<Eigen::Index>{0, 1}));
  const auto why = why_none_has_scale(parts.fit, parts.match);
  EXPECT_NE(why.find("parts without a response between them"), std::string::npos) << why;
  EXPECT_EQ(why.find("pair"), std::string::npos) << why;
}

TEST(PartsTold, AreNoReasonWhereNoModeHasAScale) {
  InParts parts;
  for (auto& mode : parts.match.modes) mode.by = MatchedBy::nothing;
  EXPECT_TRUE(rows_without(parts.fit, parts.match, 0).empty());
  EXPECT_NE(why_none_has_scale(parts.fit, parts.match).find("name a pair"), std::string::npos);
}

}  // namespace
}  // namespace chladni::identification
