// Laws that every way to interpolate keeps, and what all of them refuse.
#include "priors/interpolator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "plate_case.h"

namespace chladni::priors {
namespace {

Field field_of(const Interpolator& method, const PlateCase& one) {
  return mode_field(method, one.measured, one.simulation)->at(one.simulation.surface);
}

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

class Every : public testing::TestWithParam<const Interpolator*> {
 protected:
  const Interpolator& method = *GetParam();
  PlateCase made = plate_case("rings", 1, 8);
};

TEST_P(Every, GivesAMeanAndADeviationForEachPlaceAndMode) {
  const auto field = field_of(method, made);
  EXPECT_EQ(field.mean.rows(), made.simulation.surface.count());
  EXPECT_EQ(field.mean.cols(), 8);
  EXPECT_TRUE(field.mean.allFinite());
  if (!method.has_deviation) return;
  EXPECT_TRUE(field.deviation.allFinite());
  EXPECT_GE(field.deviation.minCoeff(), 0.0);
}

TEST_P(Every, ScalesWithTheUnitOfTheValues) {
  const auto field = field_of(method, made);
  made.measured.values *= 1e-6;
  made.measured.noise *= 1e-6;
  const auto scaled = field_of(method, made);
  EXPECT_LT(difference(1e6 * scaled.mean, field.mean), 2e-3);
  if (!method.has_deviation) return;
  EXPECT_LT(difference(1e6 * scaled.deviation, field.deviation), 2e-3);
}

TEST_P(Every, TurnsAroundWithASign) {
  const auto field = field_of(method, made);
  made.measured.values *= -1.0;
  const auto turned = field_of(method, made);
  EXPECT_LT(difference(-turned.mean, field.mean), 1e-6);
}

TEST_P(Every, DoesNotCareForTheOrderOfThePlaces) {
  const auto field = field_of(method, made);
  std::vector<Eigen::Index> order;
  for (Eigen::Index k = made.measured.places.count(); k-- > 0;) order.push_back(k);
  made.measured.places = part(made.measured.places, order);
  made.measured.values = made.measured.values(order, Eigen::all).eval();
  made.measured.noise = made.measured.noise(order, Eigen::all).eval();
  EXPECT_LT(difference(field_of(method, made).mean, field.mean), 2e-3);
}

TEST_P(Every, DoesNotCareForSignsAndTurnsOfTheSimulatedModes) {
  const auto field = field_of(method, made);
  // Modes 4 and 5 of the square are one pair: flexible columns 3 and 4 after three rigid ones.
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  for (auto* places : {&made.measured.places, &made.simulation.surface}) {
    const Eigen::MatrixXd pair = places->shapes.middleCols<2>(6);
    places->shapes.col(6) = c * pair.col(0) + s * pair.col(1);
    places->shapes.col(7) = -s * pair.col(0) + c * pair.col(1);
    places->shapes.col(4) *= -1.0;
  }
  for (auto& model : made.simulation.similar) {
    const Eigen::MatrixXd rows = model.turn.middleRows<2>(6);
    model.turn.row(6) = c * rows.row(0) + s * rows.row(1);
    model.turn.row(7) = -s * rows.row(0) + c * rows.row(1);
    model.turn.row(4) *= -1.0;
  }
  EXPECT_LT(difference(field_of(method, made).mean, field.mean), 2e-3);
}

TEST_P(Every, GivesTheSameBitsTwice) {
  const auto once = field_of(method, made);
  const auto twice = field_of(method, made);
  EXPECT_EQ(once.mean, twice.mean);
}

TEST_P(Every, SaysNothingOfPlacesWithoutWhatItNeeds) {
  const auto field = mode_field(method, made.measured, made.simulation);
  Places bare = made.simulation.surface;
  bare.shapes.resize(bare.count(), 0);
  try {  // some learn from the modes and need them nowhere else
    EXPECT_EQ(field->at(bare).mean, field->at(made.simulation.surface).mean);
  } catch (const InvalidInput&) {
    EXPECT_TRUE(method.uses_modes);
  }
}

TEST_P(Every, RefusesWhatNoMethodCanUse) {
  const auto refused = [&](PlateCase bad, const std::string& word) {
    try {
      (void)mode_field(method, bad.measured, bad.simulation);
      ADD_FAILURE() << method.name << " took it; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  auto few = made;
  few.measured.places = part(made.measured.places, {0, 1});
  few.measured.values = made.measured.values.topRows(2);
  few.measured.noise = made.measured.noise.topRows(2);
  refused(few, "three or more");
  auto bad = made;
  bad.measured.values(3, 2) = std::numeric_limits<double>::quiet_NaN();
  refused(bad, "place 4, mode 3");
  bad = made;
  bad.measured.noise(1, 0) = 0.0;
  refused(bad, "positive standard deviation");
  bad = made;
  bad.measured.frequency_hz(0) = -1.0;
  refused(bad, "mode 1");
  bad = made;
  bad.measured.places.position.row(5) = bad.measured.places.position.row(2);
  if (method.uses_modes) {
    bad.measured.places.shapes.row(5) = bad.measured.places.shapes.row(2);
  }
  refused(bad, "same point");
}

// Two sensors at one place whose gains differ: two measurements with an error that covers it, not a
// fault. Both of equal worth: it does not matter which comes first.
TEST_P(Every, TakesTwoGainsAtOnePlace) {
  auto twice = made;
  auto& measured = twice.measured;
  measured.noise *= 0.02;  // 1 % are then some 50 deviations
  measured.places.position.row(5) = measured.places.position.row(2);
  if (method.uses_modes) measured.places.shapes.row(5) = measured.places.shapes.row(2);
  measured.values.row(5) = 1.01 * measured.values.row(2);
  const auto field = mode_field(method, measured, twice.simulation);
  const auto& notes = field->summary().notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("places 3 and 6 are the same point and their gains differ by 1 %") !=
           std::string::npos;
  }));
  measured.values.row(5) *= 1.2;  // no gain of a sensor that works
  EXPECT_THROW((void)mode_field(method, measured, twice.simulation), InvalidInput);
  measured.values.row(5) /= 1.2;
  measured.values(5, 1) *= 1.05;  // one mode alone is no gain
  EXPECT_THROW((void)mode_field(method, measured, twice.simulation), InvalidInput);
}

// A row that is missing is not read behind the end of its array.
TEST_P(Every, RefusesPlacesWhoseRowsDoNotAgree) {
  const auto field = mode_field(method, made.measured, made.simulation);
  const auto& surface = made.simulation.surface;
  Places few = surface;
  few.direction = surface.direction.topRows(1);
  EXPECT_THROW((void)field->at(few), InvalidInput);
  few = surface;
  few.position = surface.position.topRows(3);
  EXPECT_THROW((void)field->at(few), InvalidInput);
  few = surface;
  few.shapes = surface.shapes.topRows(3);
  EXPECT_THROW((void)field->at(few), InvalidInput);
  auto bad = made;
  bad.simulation.surface.shapes = surface.shapes.topRows(3);
  EXPECT_THROW((void)mode_field(method, bad.measured, bad.simulation), InvalidInput);
}

INSTANTIATE_TEST_SUITE_P(Interpolator, Every,
                         testing::ValuesIn(interpolators().begin(), interpolators().end()),
                         [](const auto& one) { return std::string(one.param->name); });

// Marks, deviations of the scale or noise of another size were read beyond their ends.
TEST(Interpolator, RefusesSidesThatDoNotFit) {
  const auto made = plate_case("rings", 1, 4);
  const auto s = made.measured.places.count();
  const auto refused = [&](const BothSides& sides, const std::string& words) {
    auto bad = made.measured;
    bad.sides = sides;
    try {
      (void)mode_field(interpolator("thin_plate_spline"), bad, made.simulation);
      ADD_FAILURE() << "taken; expected a refusal about " << words;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  };
  const BothSides sound{std::vector<bool>(static_cast<std::size_t>(s), false),
                        Eigen::VectorXd::Zero(4), made.measured.noise};
  auto sides = sound;
  sides.actuator.pop_back();
  refused(sides, "marks of actuators");
  sides = sound;
  sides.log_deviation = Eigen::VectorXd::Zero(3);
  refused(sides, "deviations of the scale");
  sides = sound;
  sides.log_deviation(2) = -0.1;
  refused(sides, "mode 3");
  sides = sound;
  sides.noise = made.measured.noise.topRows(s - 1);
  refused(sides, "noise");
  sides = sound;
  sides.noise(1, 2) = std::numeric_limits<double>::quiet_NaN();
  refused(sides, "place 2, mode 3");
  auto taken = made.measured;
  taken.sides = sound;
  EXPECT_NO_THROW((void)mode_field(interpolator("thin_plate_spline"), taken, made.simulation));
}

// The default method with corrections leaves out no doubt on the noise.
TEST(Interpolator, NotesThatTheNoiseIsNotTheStatedOne) {
  auto made = plate_case("rings", 1, 6);
  made.measured.frequency_hz = made.simulation.frequency_hz.segment(3, 6);
  made.measured.values = made.measured.places.shapes.middleCols(3, 6);
  made.measured.noise.setConstant(0.1 * made.measured.values.norm() / std::sqrt(6.0 * 13.0));
  const Eigen::RowVectorXd row = made.simulation.surface.shapes.row(7);
  made.simulation.corrections = {{"mass", {}, row.transpose() * row, 0.03}};
  const auto field = mode_field(interpolator("dynamic_residual"), made.measured, made.simulation);
  std::string notes;
  for (const auto& note : field->summary().notes) notes += note + "\n";
  EXPECT_NE(notes.find("the noise over the stated one is"), std::string::npos) << notes;
}

TEST(Serep, NeedsASimulatedModeInItsBand) {
  auto made = plate_case("rings", 1, 8);
  made.simulation.frequency_hz.array() += 1e6;
  EXPECT_THROW((void)mode_field(interpolator("serep"), made.measured, made.simulation),
               InvalidInput);
}

// Methods that trust the values: near the measured ones, surer there than elsewhere.
class Trusting : public testing::TestWithParam<const char*> {};

TEST_P(Trusting, PassNearTheMeasuredValues) {
  const auto made = plate_case("rings", 2, 6, 0.001);
  const auto field = mode_field(interpolator(GetParam()), made.measured, made.simulation);
  const auto there = field->at(made.measured.places);
  const Eigen::ArrayXXd away =
      (there.mean - made.measured.values).array().abs() /
      (made.measured.noise.array().square() + there.deviation.array().square()).sqrt();
  EXPECT_LT(away.maxCoeff(), 4.0);
  const auto everywhere = field->at(made.simulation.surface);
  EXPECT_LT(there.deviation.col(5).maxCoeff(), everywhere.deviation.col(5).maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Interpolator, Trusting,
                         testing::Values("dynamic_residual", "dynamic_residual_alone",
                                         "energy_spline", "thin_plate_spline"));

TEST(Interpolator, NamesItsNeighboursWhenThereIsNoneOfAName) {
  try {
    (void)interpolator("kriging");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("dynamic_residual"), std::string::npos);
  }
}

TEST(Interpolator, SquaredErrorIsNoneForTheTruthAndOneForNothing) {
  const auto made = plate_case("rings", 1, 3);
  const auto& area = made.simulation.area;
  EXPECT_EQ(squared_error(made.truth, made.truth, area).maxCoeff(), 0.0);
  EXPECT_NEAR(squared_error(0.0 * made.truth, made.truth, area)(1), 1.0, 1e-12);
}

// Where both stand the shape lies between them, and its band holds both.
TEST(Interpolator, TwoGainsAtOnePlaceLieWithinTheBandThere) {
  auto made = plate_case("rings", 1, 4);
  auto& measured = made.measured;
  measured.noise *= 1e-3;
  measured.places.position.row(5) = measured.places.position.row(2);
  measured.places.shapes.row(5) = measured.places.shapes.row(2);
  measured.values.row(5) = 1.02 * measured.values.row(2);
  const auto there = mode_field(interpolator("thin_plate_spline"), measured, made.simulation)
                         ->at(part(measured.places, {2}));
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double middle = 0.5 * (measured.values(2, i) + measured.values(5, i));
    const double apart = 0.01 * std::abs(measured.values(2, i));
    EXPECT_NEAR(there.mean(0, i), middle, 0.2 * apart) << i;
    EXPECT_GT(kTwoSided95 * there.deviation(0, i), apart) << i;
  }
}

// Without a deviation nobody knows what lies within it: that is not the same as nothing.
TEST(Interpolator, CoverageOfAnUnknownDeviationIsUnknown) {
  Field field{Eigen::MatrixXd::Zero(3, 2), Eigen::MatrixXd::Ones(3, 2)};
  const Eigen::MatrixXd truth = (Eigen::MatrixXd(3, 2) << 1, 1, 2.1, 1, 0, 1).finished();
  Eigen::Vector3d area(1.0, 2.0, 1.0);
  EXPECT_NEAR(coverage(field, truth, area)(0), 0.5, 1e-15);
  field.deviation(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(coverage(field, truth, area)(0), 0.5, 1e-15);
  EXPECT_TRUE(std::isnan(coverage(field, truth, area)(1)));
  area(1) = 0.0;  // outside the real body
  EXPECT_NEAR(coverage(field, truth, area)(1), 1.0, 1e-15);
}

// Places on mirror lines of the square cannot see the shape that is odd about all of them.
TEST(Interpolator, SaysWhichModeThePlacesCannotSee) {
  auto made = plate_case("quincunx", 1, 12);
  const auto field = mode_field(interpolator("dynamic_residual"), made.measured, made.simulation);
  const auto error =
      squared_error(field->at(made.simulation.surface).mean, made.truth, made.simulation.area);
  Eigen::Index worst = 0;
  ASSERT_GT(error.maxCoeff(&worst), 0.5);
  std::string notes;
  bool said = false;
  for (const auto& note : field->summary().notes) {
    notes += note + "\n";
    said |= note.starts_with("mode " + std::to_string(worst + 1) + ":");
  }
  EXPECT_TRUE(said) << "mode " << worst + 1 << ", error " << error.transpose() << "\n" << notes;
}

}  // namespace
}  // namespace chladni::priors
