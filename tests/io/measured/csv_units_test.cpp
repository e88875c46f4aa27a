// Tables of measured data whose units stand in the line below the names.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <fstream>
#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/measured/frf_units.h"
#include "io/recordings_file.h"
#include "io/time_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

constexpr double kPound = 4.4482216152605;  // [N]
constexpr double kGravity = 9.80665;        // [m/s²]

// A table with its units below the names is the table with its units in brackets.
TEST(UnitsBelowTheNames, OfResponsesAreThoseInBrackets) {
  const auto below = parse_frf_csv(
      "Frequency,re_y1u1,im_y1u1,coh_y1u1\nkHz,um/lbf,um/lbf,-\n2,3,-4,0.5\n", "t.csv");
  const auto beside = parse_frf_csv(
      "Frequency [kHz],re_y1u1 [um/lbf],im_y1u1 [um/lbf],coh_y1u1\n2,3,-4,0.5\n", "t.csv");
  EXPECT_EQ(below.set.frequency_hz(0), 2000.0);
  EXPECT_EQ(below.set.outputs[0].unit, "m");
  EXPECT_EQ(below.set.inputs[0].unit, "N");
  EXPECT_EQ(below.set.value[0](0, 0), beside.set.value[0](0, 0));
  EXPECT_LT(std::abs(below.set.value[0](0, 0) - 1e-6 / kPound * Complex(3.0, -4.0)), 1e-20);
  EXPECT_EQ(below.set.coherence[0](0, 0), 0.5);
  EXPECT_EQ(below.notes, beside.notes);
}

TEST(UnitsBelowTheNames, MayHaveBracketsBlanksAndOtherSeparators) {
  for (const auto* bytes : {"freq_hz; re_y1u1; im_y1u1\n[Hz]; [g/N]; [g/N]\n2;3;-4\n",
                            "# of a beam\n\nfreq\tReal\tImaginary\r\n\r\n# in\r\n\"Hz\"\tg/N\tg/N"
                            "\r\n2\t3\t-4\r\n",
                            "freq_hz,re_y1u1 [g/N],im_y1u1 [g/N]\nHz,g/N,(g/N)\n2,3,-4\n",
                            "freq_hz,re_y1u1,im_y1u1\n,g,g\n2,3,-4\n"}) {
    const auto set = parse_frf_csv(bytes, "t.csv").set;
    EXPECT_EQ(set.outputs[0].kind, modal::FrfKind::accelerance) << bytes;
    EXPECT_NEAR(set.value[0](0, 0).real(), 3.0 * kGravity, 1e-12) << bytes;
    EXPECT_EQ(set.line_count(), 1) << bytes;
  }
}

TEST(UnitsBelowTheNames, OfResponsesThatCannotBeMeantAreRefused) {
  const auto said = [](const std::string& units) {
    return refusal_of(
        [&] { return parse_frf_csv("freq_hz,re_y1u1,im_y1u1\n" + units + "\n1,2,3\n", "t.csv"); });
  };
  EXPECT_NE(said("Hz,foo,foo").find("t.csv: line 2: the unit 'foo' of 're_y1u1'"),
            std::string::npos)
      << said("Hz,foo,foo");
  EXPECT_NE(said("Hz,g,m").find("another unit"), std::string::npos) << said("Hz,g,m");
  EXPECT_NE(said("Hz,N,N").find("of a force"), std::string::npos) << said("Hz,N,N");
  EXPECT_NE(said("kHz,g,g").find("freq_hz"), std::string::npos) << said("kHz,g,g");
  // Lines that are none of units are refused as lines of numbers are.
  EXPECT_NE(said("a,b,c").find("expected a number"), std::string::npos) << said("a,b,c");
  EXPECT_NE(said("x,1,1").find("expected a number"), std::string::npos) << said("x,1,1");
  EXPECT_NE(said("Hz,g").find("line 2"), std::string::npos) << said("Hz,g");
  EXPECT_NE(said("Hz,2,g").find("expected a number"), std::string::npos) << said("Hz,2,g");
  const auto later =
      refusal_of([] { return parse_frf_csv("freq_hz,re_y1u1,im_y1u1\n1,2,3\nHz,g,g\n", "t.csv"); });
  EXPECT_NE(later.find("line 3"), std::string::npos) << later;
  const auto twice = refusal_of(
      [] { return parse_frf_csv("freq_hz,re_y1u1 [m],im_y1u1 [m]\nHz,g,g\n1,2,3\n", "t.csv"); });
  EXPECT_NE(twice.find("the unit below 're_y1u1 [m]' is 'g'"), std::string::npos) << twice;
}

// Transmissibilities have no dimension, and are no receptances.
TEST(UnitsBelowTheNames, WithoutADimensionAreKept) {
  const auto set = parse_frf_csv("freq_hz,re_y1u1,im_y1u1\nHz,-,-\n1,2,3\n", "t.csv").set;
  EXPECT_EQ(set.outputs[0].unit, "1");
}

TEST(UnitsBelowTheNames, OfRecordingsAreReadAsAWholeAndInPieces) {
  const std::string bytes =
      "time,period,left,hammer,coil,in\nms,,g,lbf,A,in\n0,0,1,2,3,4\n0.5,0,5,6,7,8\n"
      "1,1,1,2,3,4\n1.5,1,5,6,7,8\n";
  const auto whole = parse_time_csv(bytes, "t.csv").data;
  EXPECT_NEAR(whole.sample_time_s, 0.5e-3, 1e-18);
  ASSERT_EQ(modal::names_of(whole.outputs), (std::vector<std::string>{"left", "coil", "in"}));
  EXPECT_EQ(whole.outputs[0].unit, "m/s^2");
  EXPECT_EQ(whole.outputs[1].unit, "A");
  EXPECT_EQ(whole.outputs[2].unit, "m");
  EXPECT_NEAR(whole.records[0].outputs(1, 0), 5.0 * kGravity, 1e-12);
  EXPECT_NEAR(whole.records[0].outputs(1, 2), 8.0 * 0.0254, 1e-15);
  EXPECT_NEAR(whole.records[0].inputs(1, 0), 6.0 * kPound, 1e-12);
  const TemporaryFile file("units_below.csv");
  std::ofstream(file.path, std::ios::binary) << bytes;
  const auto pieces = read_in_pieces(file.path).data;
  EXPECT_EQ(pieces.head.sample_time_s, whole.sample_time_s);
  for (Eigen::Index c = 0; c < 3; ++c) {
    EXPECT_EQ(pieces.samples(0, recordings::Side::outputs, c, 0, 4),
              whole.records[0].outputs.col(c));
  }
  const auto said =
      refusal_of([] { return parse_time_csv("time,left\ns,foo\n0,1\n1,2\n", "t.csv"); });
  EXPECT_NE(said.find("the unit 'foo' of 'left'"), std::string::npos) << said;
}

// An accelerometer a1 and a displacement u were taken as forces.
TEST(UnitsOfColumns, OfMotionsAreThoseOfOutputs) {
  const auto sides = [](const TimeOptions& options) {
    const auto data =
        parse_time_csv("t,a1 [g],u [mm],f,u2 [V],in_a3 [g]\n0,1,2,3,4,5\n1,1,2,3,4,5\n", "t.csv",
                       options)
            .data;
    return std::pair(modal::names_of(data.outputs), modal::names_of(data.inputs));
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(sides({}), std::pair(Names({"a1", "u"}), Names({"f", "u2", "a3"})));
  TimeOptions study;
  study.actuator_names = {"u"};
  EXPECT_EQ(sides(study), std::pair(Names({"a1"}), Names({"u", "f", "u2", "a3"})));
}

// The first row of numbers is none of units, in pieces either.
TEST(UnitsBelowTheNames, ThatAreNotThereLeaveTheFirstRow) {
  const TemporaryFile file("no_units_below.csv");
  std::ofstream(file.path, std::ios::binary) << "time_s,period,y\n\n0,0,1\n1,0,2\n2,1,1\n3,1,2\n";
  const auto pieces = read_in_pieces(file.path).data;
  EXPECT_EQ(pieces.samples(0, recordings::Side::outputs, 0, 0, 4), Eigen::Vector4d(1, 2, 1, 2));
}

TEST(BareUnit, IsWithoutTheBracketsAroundTheWholeOfIt) {
  EXPECT_EQ(bare_unit(" [mm] "), "mm");
  EXPECT_EQ(bare_unit("((m/s^2))"), "m/s^2");
  EXPECT_EQ(bare_unit("(m)/(N)"), "(m)/(N)");
  EXPECT_EQ(bare_unit("[m/s]/N"), "(m/s)/N");
  EXPECT_EQ(bare_unit("(m/s**2)/N"), "(m/s^2)/N");
  EXPECT_EQ(parse_time_csv("t,y [m/s**2]\n0,1\n1,2\n", "t.csv").data.outputs[0].unit, "m/s^2");
  for (const auto* odd : {"", "(", "()", "(m", "m)", "(m]", ")m("}) EXPECT_EQ(bare_unit(odd), odd);
}

// "um N^-1" in the head of a column was kept as it stands, a micrometre as a metre.
TEST(FrfCsv, UnitsOfAMotionOverAForceInOneWordAreBroughtToSi) {
  for (const auto& [unit, factor] : {std::pair("um N^-1", 1e-6), std::pair("mm/(s^2 N)", 1e-3),
                                     std::pair("[mm/s]/kN", 1e-6), std::pair("1/kg", 1.0)}) {
    const std::string word = std::string("(") + unit + ")";
    const auto set =
        parse_frf_csv("freq_hz,re_y1u1 " + word + ",im_y1u1 " + word + "\n1,2,3\n", "t.csv").set;
    EXPECT_NEAR(set.value[0](0, 0).real(), 2.0 * factor, 1e-12 * factor) << unit;
    EXPECT_EQ(set.inputs[0].unit, "N") << unit;
  }
}

// Each pair of brackets took a frame of the stack and a copy of the word.
TEST(BareUnit, IsNotLookedForInALongWord) {
  const std::string deep = std::string(100'000, '(') + std::string(100'000, ')');
  EXPECT_EQ(bare_unit(deep), deep);
  EXPECT_EQ(bare_unit("((((((mm))))))"), "mm");
  EXPECT_NE(refusal_of([&] { return parse_frf_csv("freq_hz\n" + deep + "\n1\n", "t.csv"); }), "");
}

FrfFile response_in(const std::string& unit) {
  return parse_frf_csv("freq_hz,re_y1u1 [" + unit + "],im_y1u1 [" + unit + "]\n1,2,3\n", "t.csv");
}

// The last stroke stands in brackets here: these went as responses to forces.
TEST(FrfCsv, MotionsOverMotionsInBracketsAreTransmissibilities) {
  for (const auto* unit : {"(m/s^2)/(m/s^2)", "m/s^2/(m/s^2)", "(m/s^2)/g", "g/(m/s^2)"}) {
    const auto said = refusal_of([&] {
      FrfFile file{.format = "", .set = random_set(1, 1, 2, 3), .notes = {}};
      file.set.outputs[0].unit = unit;
      bring_to_si(file, false);
      return file;
    });
    EXPECT_NE(said.find("transmissibility"), said.npos) << unit << ": " << said;
  }
  EXPECT_NEAR(response_in("g/(kg m/s^2)").set.value[0](0, 0).real(), 2.0 * kGravity, 1e-13);
}

// The unit replaced the kind that it contradicts; "um kN^-1" beside kN was over another force.
TEST(FrfUnits, OfAMotionOverAForceInOneWordAreThoseOfTheKindAndTheInput) {
  const auto with = [](const std::string& unit, const std::string& input, bool kind_known) {
    FrfFile file{.format = "", .set = random_set(1, 1, 2, 3), .notes = {}};
    file.set.value[0](0, 0) = 2.0;
    file.set.outputs[0].unit = unit;
    file.set.outputs[0].kind = modal::FrfKind::accelerance;
    file.set.inputs[0].unit = input;
    bring_to_si(file, kind_known);
    return file.set;
  };
  EXPECT_NE(refusal_of([&] { return with("m N^-1", "N", true); }).find("of a accelerance"),
            std::string::npos);
  EXPECT_EQ(with("m N^-1", "N", false).outputs[0].kind, modal::FrfKind::receptance);
  EXPECT_NEAR(with("um kN^-1", "kN", false).value[0](0, 0).real(), 2e-9, 1e-21);
  EXPECT_NEAR(with("um kN^-1", "", false).value[0](0, 0).real(), 2e-9, 1e-21);
  EXPECT_NE(refusal_of([&] { return with("um N^-1", "kN", false); }), "");
}

// "u [N]" is the name of an actuator, and no second unit of the column.
TEST(UnitsBelowTheNames, StandBesideAnActuatorThatEndsInAForce) {
  const auto set =
      parse_frf_csv("freq_hz,re_y1/u [N],im_y1/u [N]\nHz,g/N,g/N\n1,2,3\n", "t.csv").set;
  EXPECT_EQ(set.inputs[0].name, "u [N]");
  EXPECT_NEAR(set.value[0](0, 0).real(), 2.0 * kGravity, 1e-13);
}

}  // namespace
}  // namespace chladni::io
