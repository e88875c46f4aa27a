// Units beside the values of universal files.
#include <gtest/gtest.h>

#include <string>

#include "io/time_file.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"
#include "tests/io/measured/uff_samples.h"

namespace chladni::io {
namespace {

constexpr double kPound = 4.4482216152605;  // [N]

// Accelerations beside the type of displacements were metres, without a word.
TEST(UffUnits, CountMoreThanTheTypeOfTheData) {
  for (const bool has_164 : {false, true}) {
    Sample58 sample;
    sample.ordinate = 8;
    sample.unit = "g";
    const auto file =
        parse_frf_uff((has_164 ? dataset_164(1.0, 1.0) : "") + dataset_58(sample), "t.uff");
    EXPECT_EQ(file.set.outputs[0].unit, "m/s^2");
    EXPECT_EQ(file.set.outputs[0].kind, modal::FrfKind::accelerance);
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5 * 9.80665, 1e-9);
    EXPECT_EQ(times(file.notes, "is none of what the type of the data says"), 1);
  }
}

// A channel of a stated motion had no unit where another channel states no motion.
TEST(UffUnits, OfSiAreThoseOfTheMotionsThatTheFileStates) {
  Sample58 known;
  known.ordinate = 11;
  known.label = known.unit = "NONE";
  auto unknown = known;
  unknown.ordinate = 0;
  unknown.response_node = 13;
  const auto bytes = dataset_58(known) + dataset_58(unknown);
  const auto outputs = parse_frf_uff(bytes, "t.uff", {.unit = kEachInSi}).set.outputs;
  ASSERT_EQ(outputs.size(), 2U);
  EXPECT_EQ(outputs[0].kind, modal::FrfKind::mobility);
  EXPECT_EQ(outputs[0].unit, "m/s");
  EXPECT_EQ(outputs[1].unit, "");
}

// Pounds and kilonewtons in capitals or brackets were newtons, without a word.
TEST(UffUnits, OfForcesAreReadAsProgramsSpellThem) {
  struct Case {
    const char* unit;
    double newtons;
    int notes;
  };
  const Case cases[] = {{"N", 1.0, 0},       {"(N)", 1.0, 0},      {"lbf", kPound, 0},
                        {"LBF", kPound, 0},  {"[lbf]", kPound, 0}, {"lbs", kPound, 0},
                        {"KN", 1e3, 0},      {"kN", 1e3, 0},       {"Newton", 1.0, 0},
                        {"N (peak)", 1.0, 1}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.unit);
    Sample58 sample;
    sample.input_unit = c.unit;
    const auto file = parse_frf_uff(dataset_58(sample), "t.uff");
    EXPECT_NEAR(file.set.value[0](0, 0).real() * c.newtons, 1.5, 1e-9);
    EXPECT_EQ(file.set.inputs[0].unit == "N", c.notes == 0);
    EXPECT_EQ(times(file.notes, "is not known"), c.notes) << testing::PrintToString(file.notes);
    Sample58 force;
    force.function_type = 1;
    force.ordinate_type = 4;
    force.ordinate = 13;
    force.unit = c.unit;
    const auto time = parse_time_uff(dataset_58(force), "t.uff");
    EXPECT_NEAR(time.data.records[0].inputs(0, 0), 1.5 * c.newtons, 1e-9);
    EXPECT_EQ(times(time.notes, "is not known"), c.notes) << testing::PrintToString(time.notes);
  }
}

// "mg" beside the values was metres per second squared where dataset 164 says metres.
TEST(UffUnits, ThatAreNotKnownAreNamed) {
  for (const bool has_164 : {false, true}) {
    Sample58 sample;
    const auto read = [&] {
      return parse_frf_uff((has_164 ? dataset_164(1.0, 1.0) : "") + dataset_58(sample), "t.uff");
    };
    sample.unit = "mg";
    EXPECT_NEAR(read().set.value[0](0, 0).real(), 1.5 * 9.80665e-3, 1e-12);
    sample.unit = "counts";
    EXPECT_EQ(times(read().notes, "the unit 'counts' is not known"), 1);
    sample.unit = "m/s^2";
    sample.input_unit = "counts";
    EXPECT_EQ(times(read().notes, "the unit 'counts'"), 1);
  }
}

// A force in newtons for one response and in nothing for another was of one unit, without a word.
TEST(UffUnits, OfOneInputThatDifferAreNamed) {
  Sample58 one;
  Sample58 other;
  other.response_node = 13;
  const auto notes = [&](const std::string& unit) {
    other.input_unit = unit;
    return parse_frf_uff(dataset_58(one) + dataset_58(other), "t.uff").notes;
  };
  EXPECT_EQ(times(notes("NONE"), "in some responses only"), 1);
  EXPECT_EQ(times(notes("lbf"), "in some responses only"), 0);
}

// The pound of "g/lbf" was left out where the denominator has no unit.
TEST(UffUnits, OfAForceBesideTheMotionCount) {
  const auto with = [](const std::string& unit, const std::string& input_unit) {
    Sample58 sample;
    sample.unit = unit;
    sample.input_unit = input_unit;
    return parse_frf_uff(dataset_58(sample), "t.uff");
  };
  for (const auto* input : {"NONE", "lbf"}) {
    const auto file = with("g/lbf", input);
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5 * 9.80665 / kPound, 1e-9) << input;
    EXPECT_EQ(file.set.inputs[0].unit, "N");
    EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
  }
  const auto contradicting = with("g/lbf", "N");
  EXPECT_NEAR(contradicting.set.value[0](0, 0).real(), 1.5 * 9.80665, 1e-9);
  EXPECT_EQ(times(contradicting.notes, "that of the input is taken"), 1);
  EXPECT_NEAR(with("m/s^2/N", "NONE").set.value[0](0, 0).real(), 1.5, 1e-9);
}

// The kilonewton in the unit of the response was taken off again by the denominator.
TEST(UffUnits, OfAMotionOverAForceInOneWordCountOnce) {
  const auto with = [](const std::string& unit, const std::string& input_unit) {
    Sample58 sample;
    sample.unit = unit;
    sample.input_unit = input_unit;
    return parse_frf_uff(dataset_58(sample), "t.uff");
  };
  for (const auto* input : {"kN", "NONE", "N"}) {
    const auto file = with("m/(s^2*kN)", input);
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5e-3, 1e-12) << input;
    EXPECT_EQ(file.set.inputs[0].unit, "N") << input;
    EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
  }
  const auto contradicting = with("m/(s^2*N)", "lbf");
  EXPECT_NEAR(contradicting.set.value[0](0, 0).real(), 1.5, 1e-9);
  EXPECT_EQ(times(contradicting.notes, "that of the response is taken"), 1);
}

}  // namespace
}  // namespace chladni::io
