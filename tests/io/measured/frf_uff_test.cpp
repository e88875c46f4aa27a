#include "io/uff/frf_uff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "io/uff/time_uff.h"
#include "io/uff/uff.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/uff_samples.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

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
      {0, "V", "V", 0.0, 0.0, "V", "V", 1.0, 0},
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

// Radians have no unit of length, whatever the file says of its lengths.
TEST(FrfUff, RotationsAreInRadians) {
  struct Case {
    int ordinate, direction;
    const char *unit, *si;
    double factor;
    int notes;
  };
  const Case cases[] = {
      {8, 4, "NONE", "rad", 1.0, 0},
      {11, -5, "NONE", "rad/s", 1.0, 0},
      {12, 6, "NONE", "rad/s^2", 1.0, 0},
      {12, 6, "(RAD/S2)", "rad/s^2", 1.0, 0},
      {8, 4, "deg", "rad", std::numbers::pi / 180.0, 0},
      {12, 6, "mm/s^2", "rad/s^2", 1.0, 1},  // of the file, not of a rotation: said
      {0, 6, "mm/s^2", "rad/s^2", 1.0, 1},
      {0, 6, "V", "V", 1.0, 0},
  };
  for (const auto& c : cases) {
    Sample58 sample;
    sample.ordinate = c.ordinate;
    sample.unit = c.unit;
    sample.response_direction = c.direction;
    SCOPED_TRACE(fmt::format("{} {}", c.ordinate, c.unit));
    const auto file = parse_frf_uff(dataset_164(1000.0, 1.0) + dataset_58(sample), "t.uff");
    EXPECT_EQ(file.set.outputs[0].unit, c.si);
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5 * c.factor, 1e-9);
    EXPECT_EQ(static_cast<int>(file.notes.size()), c.notes) << testing::PrintToString(file.notes);
    sample.function_type = 1;
    sample.ordinate_type = 4;
    const auto time = parse_time_uff(dataset_164(1000.0, 1.0) + dataset_58(sample), "t.uff");
    EXPECT_EQ(time.data.outputs[0].unit, c.si);
    EXPECT_NEAR(time.data.records[0].outputs(0, 0), 1.5 * c.factor, 1e-9);
    EXPECT_EQ(static_cast<int>(time.notes.size()), c.notes) << testing::PrintToString(time.notes);
  }
}

// A force at a rotation is a moment. The file of dataset 164 is in mm and mN.
TEST(FrfUff, ForcesAtRotationsAreMoments) {
  struct Case {
    const char *unit, *si;
    double factor;  // SI value of 1
    bool with_164;
    int notes;
  };
  const Case cases[] = {
      {"NONE", "N m", 1e-6, true, 0},  // mN mm
      {"N-mm", "N m", 1e-3, true, 0}, {"Nm", "N m", 1.0, true, 0},
      {"N", "N m", 1e-3, true, 1},  // of the file: lengths are those of the dataset, and it is said
      {"N", "N m", 1.0, false, 1},    {"lbf in", "N m", 0.1129848290276167, false, 0},
      {"NONE", "", 1.0, false, 0},
  };
  for (const auto& c : cases) {
    Sample58 sample;
    sample.input_unit = c.unit;
    sample.reference_direction = 5;
    sample.unit = "m/s^2";
    SCOPED_TRACE(c.unit);
    const auto bytes = (c.with_164 ? dataset_164(1000.0, 1000.0) : "") + dataset_58(sample);
    const auto file = parse_frf_uff(bytes, "t.uff");
    EXPECT_EQ(file.set.inputs[0].unit, c.si);
    EXPECT_NEAR(file.set.value[0](0, 0).real() * c.factor, 1.5, 1e-9);
    const auto said = std::ranges::count_if(file.notes, [](const std::string& note) {
      return note.find("of a moment") != std::string::npos;
    });
    EXPECT_EQ(said, c.notes) << testing::PrintToString(file.notes);
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

// A motion over a motion was taken for an accelerance, a force over a motion for a receptance.
TEST(FrfUff, RatiosThatAreNoResponsesToForcesAreNotRead) {
  Sample58 response, transmissibility, stiffness;
  transmissibility.denominator = 12;
  transmissibility.input_unit = "g";
  transmissibility.reference_node = 40;
  stiffness.ordinate = 13;
  stiffness.unit = "N";
  stiffness.denominator = 8;
  stiffness.input_unit = "m";
  for (const auto& other : {transmissibility, stiffness}) {
    EXPECT_THROW((void)parse_frf_uff(dataset_58(other), "t.uff"), InvalidInput);
    const auto file = parse_frf_uff(dataset_58(other) + dataset_58(response), "t.uff");
    ASSERT_EQ(file.set.input_count(), 1);
    EXPECT_EQ(file.set.inputs[0].name, "-3z");
    EXPECT_EQ(times(file.notes, "no motion over a force"), 1);
  }
  Sample58 labelled;  // the label counts more than the type
  labelled.ordinate = 13;
  EXPECT_EQ(parse_frf_uff(dataset_58(labelled), "t.uff").set.outputs[0].unit, "m/s^2");
}

TEST(FrfUff, OfCoherencesOfOnePairTheFirstIsTaken) {
  Sample58 response, first, second;
  for (auto* one : {&first, &second}) {
    one->function_type = 6;
    one->ordinate_type = 2;
    one->ordinate = 1;
    for (auto& y : one->y) y = 0.75;
  }
  first.y[0] = 1.000001;  // of single precision
  second.y[1] = 0.25;
  const auto file = parse_frf_uff(
      dataset_58(response) + dataset_58(first) + dataset_58(second) + dataset_58(first), "t.uff");
  EXPECT_EQ(file.set.coherence[0](0, 0), 1.0);
  EXPECT_EQ(file.set.coherence[1](0, 0), 0.75);
  EXPECT_EQ(times(file.notes, "two coherences of one pair that differ"), 1);
  first.y[0] = 1.01;
  EXPECT_THROW((void)parse_frf_uff(dataset_58(response) + dataset_58(first), "t.uff"),
               InvalidInput);
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
  // The least integer has no absolute value.
  std::string least = dataset_58({});
  least.replace(least.find("  12   3"), 8, "  12 -9223372036854775808");
  refused(least, "direction -9223372036854775808", "-6 to 6");
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

// Letters that are no ASCII became blanks, and shifted the columns behind them.
TEST(FrfUff, NamesKeepTheirLetters) {
  for (const auto encoding : {UffEncoding::binary, UffEncoding::text}) {
    auto set = random_set(2, 2, 4, 5);
    set.outputs[0].name = "Fläche l";  // in the ten columns of an entity
    set.outputs[1].name = "Prüfstand, linke äußere Ecke";
    set.inputs[0].name = "größe";
    set.outputs[0].node = 4711;
    set.outputs[1].node = 4712;
    set.outputs[1].unit = "µm";
    std::vector<std::string> lost;
    const auto bytes = frf_uff(set, encoding, lost);
    const auto found = parse_frf_uff(bytes, "t.uff").set;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(found.outputs[i].name, set.outputs[i].name);
      EXPECT_EQ(found.outputs[i].node, set.outputs[i].node);
    }
    EXPECT_EQ(found.inputs[0].name, set.inputs[0].name);
    EXPECT_EQ(found.outputs[1].unit, "m");
  }
}

// Other programs write Latin-1.
TEST(FrfUff, LettersOfLatin1AreRead) {
  Sample58 sample;
  sample.ordinate = 8;
  sample.response_name = "T\xFCr";
  sample.unit = "\xB5m";
  const auto latin = parse_frf_uff(dataset_58(sample), "t.uff").set;
  EXPECT_EQ(latin.outputs[0].name, "Tür");
  EXPECT_EQ(latin.outputs[0].unit, "m");
  sample.response_name = "Tür";  // with a blank less than columns want
  EXPECT_EQ(parse_frf_uff(dataset_58(sample), "t.uff").set.outputs[0].name, "Tür");
}

// Bytes that go on with a letter of UTF-8 are letters of their own in Latin-1.
TEST(FrfUff, AllEightyLettersOfALatin1LineAreRead) {
  const std::string letters(69, 'a');  // behind "response: ": columns 11 to 79
  const auto text = dataset_58(Sample58{});
  const auto read_as = [&](const std::string& name) {
    auto changed = text;
    changed.replace(changed.find("\nresponse\n") + 1, 8, "response: " + name);
    return parse_frf_uff(changed, "t.uff").set.outputs[0].name;
  };
  EXPECT_EQ(read_as(letters + "m\xB5 beyond"), letters + "m");
  EXPECT_EQ(read_as(letters + "\xB5m beyond"), letters + "µ");
  EXPECT_EQ(read_as(letters + "µ beyond"), letters);  // UTF-8: its second byte is in column 81
}

TEST(FrfUff, NamesAllThatItLeavesOut) {
  auto set = random_set(2, 1, 4, 5);
  set.averages = 8.0;
  for (auto* channel : {&set.outputs[0], &set.inputs[0]}) {
    channel->node = 3;
    channel->position = Eigen::Vector3d(channel == &set.inputs[0] ? 1.0 : 0.0, 0.0, 0.0);
  }
  set.outputs[1].direction = Eigen::Vector3d(0.6, 0.0, 0.8);
  std::vector<std::string> lost;
  static_cast<void>(frf_uff(set, UffEncoding::text, lost));
  EXPECT_EQ(lost, (std::vector<std::string>{
                      "UFF holds no variances: they are left out",
                      "UFF holds no variances by noise: they are left out",
                      "UFF holds no number of averages: it is left out",
                      "UFF holds directions along the axes only: that of y2 is left out",
                      "UFF holds one place of a node: that of u1, at node 3, is left out"}));
}

// A channel that was never measured left no trace.
TEST(FrfUff, NamesTheChannelsWithoutAResponse) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  modal::FrfSet set = random_set(3, 2, 4, 5);
  set.variance.clear();
  set.noise_variance.clear();
  for (auto& line : set.value) {
    line.row(1).setConstant({nothing, nothing});
    line(2, 0) = {nothing, nothing};
  }
  std::vector<std::string> lost;
  const auto back = parse_frf_uff(frf_uff(set, UffEncoding::text, lost), "t.uff").set;
  EXPECT_EQ(back.output_count(), 2);
  EXPECT_TRUE(std::isnan(back.value[0](1, 0).real()));
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0], "UFF holds no channel without a measured response: y2 is left out");
  for (auto& line : set.value) line.col(0).setConstant({nothing, nothing});
  (void)frf_uff(set, UffEncoding::text, lost);
  EXPECT_EQ(lost.back(), "UFF holds no channel without a measured response: u1 is left out");
}

// Channels without nodes at places of their own must not share one.
TEST(FrfUff, KeepsPlacesOfChannelsWithoutNodes) {
  auto set = random_set(1, 1, 4, 5);
  set.outputs[0].position = Eigen::Vector3d(0.25, 0.0, 0.0);
  set.inputs[0].position = Eigen::Vector3d(0.5, 0.0, 0.0);
  std::vector<std::string> lost;
  const auto back = parse_frf_uff(frf_uff(set, UffEncoding::binary, lost), "t.uff").set;
  ASSERT_TRUE(back.outputs[0].position && back.inputs[0].position);
  EXPECT_LT((*back.outputs[0].position - *set.outputs[0].position).norm(), 1e-15);
  EXPECT_LT((*back.inputs[0].position - *set.inputs[0].position).norm(), 1e-15);
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

}  // namespace
}  // namespace chladni::io
