// What a fit leaves, in words.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "show/identification.h"

namespace chladni::show {
namespace {

identification::BandResidual band(double low_hz, double high_hz, double level) {
  identification::BandResidual one;
  one.low_hz = low_hz;
  one.high_hz = high_hz;
  one.level = level;
  return one;
}

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// A band where nothing was measured has no level, wherever it stands.
TEST(ValidationText, NamesTheWorstOfTheMeasuredBands) {
  steps::IdentifiedModel model;
  model.validation.bands = {band(30.0, 60.0, kNothing), band(60.0, 90.0, 1.2),
                            band(90.0, 120.0, 1.63), band(120.0, 150.0, kNothing)};
  const auto text = validation_text(model);
  EXPECT_NE(text.find("1.63 times at most (90 to 120 Hz)"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  model.validation.bands = {band(30.0, 60.0, kNothing), band(60.0, 90.0, kNothing)};
  EXPECT_EQ(validation_text(model).find("at most"), std::string::npos);
}

// A damping at its bound has no deviation that the data tell; a gain that nothing tells has none.
TEST(IdentifiedTable, CallsADeviationThatIsNotKnownUnknown) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  steps::IdentifiedModel model;
  auto& fit = model.found.fit;
  fit.model.frequency_hz = Eigen::VectorXd::Constant(1, 50.0);
  fit.model.damping_ratio = Eigen::VectorXd::Constant(1, 0.01);
  fit.frequency_std_hz = fit.damping_std = Eigen::VectorXd::Constant(1, kInfinite);
  model.match.modes.resize(1);
  model.match.modes[0].by = identification::MatchedBy::pairs;
  model.match.modes[0].alpha_std = kInfinite;
  const auto text = io::text(identified_modes_table(model));
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  EXPECT_NE(text.find("50.0000 +- unknown"), std::string::npos) << text;
  EXPECT_NE(text.find("0.010000 +- unknown"), std::string::npos) << text;
}

// A second record whose variances are of an unknown number of averages.
TEST(ValidationText, DoesNotTakeSampleVariancesForAFaultOfTheModel) {
  steps::IdentifiedModel model;
  auto& second = model.second_record.emplace();
  second.left.whole = band(30.0, 150.0, 1.1);
  second.left.whole.level_deviation = 0.01;
  EXPECT_NE(unseen_text(model).find("lacks or invents"), std::string::npos);
  second.freedom_known = false;
  EXPECT_EQ(unseen_text(model).find("lacks or invents"), std::string::npos);
  second.left.whole.level = 1.6;
  EXPECT_NE(unseen_text(model).find("lacks or invents"), std::string::npos);
}

}  // namespace
}  // namespace chladni::show
