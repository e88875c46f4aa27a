// What .mat files state of units, and what of them is not read.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/mat.h"
#include "io/matlab/frf_mat.h"
#include "io/matlab/time_mat.h"
#include "io/time_file.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Texts = std::vector<std::string>;

constexpr double kOneG = 9.80665;  // [m/s²]

// Two lines of two outputs, with these variables besides.
MatFields responses_and(const MatFields& more) {
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(4, 1.0, 4.0);
  MatFields fields{{"f", Eigen::MatrixXd(Eigen::Vector2d(1.0, 2.0))},
                   {"H", MatValue({2, 2, 1}, numbers, -numbers)}};
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

FrfFile frf_and(const MatFields& more) {
  return frf_of_mat({.format = "MAT 5", .variables = responses_and(more), .notes = {}}, "t.mat");
}

TimeFile time_and(const MatFields& more) {
  const Eigen::MatrixXd y = Eigen::VectorXd::LinSpaced(8, 1.0, 8.0).reshaped(4, 2);
  MatFields fields{{"y", y}, {"Ts", 0.5}};
  fields.insert(fields.end(), more.begin(), more.end());
  return time_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat");
}

bool is_told(const std::vector<std::string>& notes, const std::string& word) {
  return std::ranges::any_of(
      notes, [&](const auto& note) { return note.find(word) != std::string::npos; });
}

// A variable "unit" was passed over, and g were taken as metres.
TEST(MatUnits, OfAllOutputsAreReadFromOneVariable) {
  for (const auto* name : {"unit", "units", "Units"}) {
    const auto file = frf_and({{name, std::string("g/N")}});
    EXPECT_NEAR(file.set.value[1](1, 0).real(), 4.0 * kOneG, 1e-12) << name;
    EXPECT_EQ(file.set.outputs[0].unit, "m/s^2") << name;
    EXPECT_EQ(file.set.inputs[0].unit, "N") << name;
    EXPECT_FALSE(is_told(file.notes, "unit")) << testing::PrintToString(file.notes);
  }
  const auto each = frf_and({{"units", Texts{"mm", "g"}}}).set;
  EXPECT_EQ(each.outputs[0].unit, "m");
  EXPECT_EQ(each.outputs[1].unit, "m/s^2");
  const auto time = time_and({{"unit", std::string("g")}}).data;
  EXPECT_NEAR(time.records[0].outputs(3, 1), 8.0 * kOneG, 1e-12);
  EXPECT_EQ(time.outputs[1].kind, modal::FrfKind::accelerance);
}

TEST(MatUnits, OfChannelsCountBeforeThatOfAll) {
  const auto file = frf_and({{"unit", std::string("g/N")}, {"output_unit", std::string("m")}});
  EXPECT_EQ(file.set.outputs[0].unit, "m");
  EXPECT_TRUE(is_told(file.notes, "the variable unit is not read"))
      << testing::PrintToString(file.notes);
}

// Where two units stood for three outputs, the third took the last one.
TEST(MatUnits, AreOneOrOneForEachChannel) {
  for (const auto& [name, texts] :
       {std::pair("output_unit", Texts{"m", "m", "g"}), std::pair("unit", Texts{"m", "m", "g"}),
        std::pair("kind", Texts{"mobility", "mobility", "mobility"})}) {
    const auto said = refusal_of([&] { return frf_and({{name, texts}}); });
    EXPECT_NE(said.find("has 3 texts, expected one, or one for each of 2"), std::string::npos)
        << said;
  }
}

TEST(MatUnits, ThatAreNotKnownAreToldOrRefused) {
  EXPECT_TRUE(is_told(frf_and({{"unit", std::string("foo")}}).notes, "'foo' of y1 is not known"));
  EXPECT_TRUE(is_told(time_and({{"unit", std::string("foo")}}).notes, "'foo' of y1 is not known"));
  EXPECT_FALSE(is_told(frf_and({{"unit", std::string("V")}}).notes, "not known"));
  for (const auto* unit : {"Hz", "ms", "g/g"}) {
    EXPECT_NE(refusal_of([&] { return frf_and({{"unit", std::string(unit)}}); }), "") << unit;
  }
}

// frd objects of old versions of MATLAB have their unit of frequency so: Hz were taken as rad/s.
TEST(MatUnits, OfAnOldFrdObjectAreThoseOfItsFrequencies) {
  const MatFields fields{
      {"ResponseData", MatValue({1, 1, 2}, Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(3.0, 4.0))},
      {"Frequency", Eigen::MatrixXd(Eigen::Vector2d(10.0, 20.0))}};
  const auto hertz = [&](const MatFields& more) {
    auto all = fields;
    all.insert(all.end(), more.begin(), more.end());
    return frf_of_mat({.format = "MAT 5", .variables = all, .notes = {}}, "t.mat")
        .set.frequency_hz(1);
  };
  EXPECT_EQ(hertz({{"Units", std::string("Hz")}}), 20.0);
  EXPECT_DOUBLE_EQ(hertz({{"Units", std::string("rad/s")}}), 10.0 / std::numbers::pi);
  EXPECT_DOUBLE_EQ(hertz({}), 10.0 / std::numbers::pi);
}

TEST(MatUnits, VariablesThatAreNotReadAreNamed) {
  EXPECT_TRUE(is_told(frf_and({{"G", 1.0}, {"calibration", 2.0}}).notes,
                      "the variables G, calibration are not read"));
  EXPECT_TRUE(is_told(time_and({{"Fs", 3.0}}).notes, "the variable Fs is not read"));
  const auto inner = responses_and({});
  MatValue structure;
  structure.kind = MatValue::Kind::structure;
  structure.dims = {1, 1};
  structure.fields = inner;
  const auto file = frf_of_mat(
      {.format = "MAT 5", .variables = {{"data", structure}, {"gain", 10.0}}, .notes = {}},
      "t.mat");
  EXPECT_TRUE(is_told(file.notes, "the variable gain is not read"));
  for (const auto& notes : {frf_and({}).notes, time_and({}).notes}) {
    EXPECT_FALSE(is_told(notes, "not read")) << testing::PrintToString(notes);
  }
}

// MATLAB tells f and F apart: a force F was taken as the frequencies.
TEST(MatUnits, NamesInTheirCaseCountBeforeOthers) {
  auto fields = responses_and({});
  fields.insert(fields.begin(), {"F", Eigen::MatrixXd(Eigen::Vector2d(5.0, 7.0))});
  const auto set = frf_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat").set;
  EXPECT_EQ(set.frequency_hz, Eigen::Vector2d(1.0, 2.0));
}

// They were left out where they were several, or none above 0; kHz of freq_hz were taken as stated.
TEST(MatUnits, NumbersThatCannotBeMeantAreRefused) {
  const Eigen::MatrixXd two = Eigen::Vector2d(1.0, 2.0);
  const auto frf = [](const char* name, const MatValue& value) {
    return refusal_of([&] { return frf_and({{name, value}}); });
  };
  EXPECT_NE(frf("averages", two).find("averages is 2 x 1, expected a number"), std::string::npos);
  EXPECT_NE(
      frf("output_direction", Eigen::MatrixXd(Eigen::MatrixXd::Ones(2, 3))).find("the length"),
      std::string::npos);
  const auto hertz = refusal_of([] {
    return frf_of_mat({.format = "MAT 5",
                       .variables = {{"freq_hz", Eigen::MatrixXd(Eigen::Vector2d(1.0, 2.0))},
                                     {"freq_unit", std::string("kHz")},
                                     {"H", MatValue({2, 1}, Eigen::Vector2d(1.0, 2.0),
                                                    Eigen::Vector2d(1.0, 2.0))}},
                       .notes = {}},
                      "t.mat");
  });
  EXPECT_NE(hertz.find("in Hz by their name and in 'kHz' by their unit"), std::string::npos)
      << hertz;
}

TEST(MatUnits, NumbersOfRecordingsThatCannotBeMeantAreRefused) {
  const Eigen::MatrixXd two = Eigen::Vector2d(1.0, 2.0);
  EXPECT_NE(refusal_of([&] {
              return time_and({{"period", two}});
            }).find("period is 2 x 1"),
            std::string::npos);
  const auto time = [](const char* name, double value) {
    return refusal_of([&] {
      return time_of_mat(
          {.format = "MAT 5",
           .variables = {{"y", Eigen::MatrixXd(Eigen::MatrixXd::Ones(4, 1))}, {name, value}},
           .notes = {}},
          "t.mat", {.sample_time_s = 1.0});
    });
  };
  EXPECT_NE(time("Ts", -1.0).find("Ts is -1, expected a time above 0"), std::string::npos);
  const Eigen::MatrixXd seconds = Eigen::Vector4d(0.0, 0.1, 0.2, 0.3);
  EXPECT_NE(refusal_of([&] {
              return time_and({{"t", seconds}});
            }).find("steps of 0.1 s"),
            std::string::npos);
  EXPECT_EQ(time_and({{"t", Eigen::MatrixXd(5.0 * seconds)}}).data.sample_time_s, 0.5);
  EXPECT_NE(time("fs", 0.0).find("fs is 0, expected a rate above 0"), std::string::npos);
}

TEST(MatUnits, NodesAreWholeNumbers) {
  const auto said = refusal_of([] {
    return frf_and({{"output_node", Eigen::MatrixXd(Eigen::Vector2d(1.0, 2.5))}});
  });
  EXPECT_NE(said.find("output_node is 2.5"), std::string::npos) << said;
}

// A temperature T for each sample was a time, and uneven stamps beside Ts had the file refused.
TEST(MatUnits, VariablesOfOtherProgramsBesideRecordingsAreLeftOut) {
  const Eigen::MatrixXd uneven = Eigen::Vector4d(0.0, 0.5, 1.2, 1.5);
  EXPECT_EQ(time_and({{"T", uneven}}).data.sample_time_s, 0.5);
  const MatFields rated{
      {"y", Eigen::MatrixXd(Eigen::MatrixXd::Ones(4, 1))}, {"fs", 4.0}, {"T", uneven}};
  const auto by_rate = time_of_mat({.format = "MAT 5", .variables = rated, .notes = {}}, "t.mat");
  EXPECT_EQ(by_rate.data.sample_time_s, 0.25);
  const MatFields timed{rated[0], {"T", Eigen::MatrixXd(Eigen::Vector4d(0.0, 2.0, 4.0, 6.0))}};
  EXPECT_EQ(
      time_of_mat({.format = "MAT 5", .variables = timed, .notes = {}}, "t.mat").data.sample_time_s,
      2.0);
  const auto stamped = time_and({{"t", uneven}});
  EXPECT_TRUE(is_told(stamped.notes, "beside a sample time are not read"))
      << testing::PrintToString(stamped.notes);
  MatValue structure;
  structure.kind = MatValue::Kind::structure;
  structure.class_name = "struct";
  structure.dims = {1, 1};
  EXPECT_TRUE(is_told(time_and({{"units", structure}}).notes, "the variable units is not read"));
  EXPECT_TRUE(is_told(frf_and({{"units", structure}}).notes, "the variable units is not read"));
  for (const auto& units : {Texts{"s", "g", "N"}, Texts{"s", "g"}}) {
    const auto file = time_and({{"units", units}});
    EXPECT_TRUE(is_told(file.notes, "the variable unit is left out"));
    EXPECT_TRUE(file.data.outputs[0].unit.empty()) << file.data.outputs[0].unit;
  }
}

// A force F went before the frequencies of another name.
TEST(MatUnits, NamesInTheirCaseCountBeforeAllOthers) {
  for (const auto& [name, hertz] : {std::pair("freqs", 2.0), {"omega", 1.0 / std::numbers::pi}}) {
    auto fields = responses_and({});
    fields[0] = {"F", Eigen::MatrixXd(Eigen::Vector2d(5.0, 7.0))};
    fields.emplace_back(name, Eigen::MatrixXd(Eigen::Vector2d(1.0, 2.0)));
    const auto set = frf_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat").set;
    EXPECT_DOUBLE_EQ(set.frequency_hz(1), hertz) << name;
  }
}

}  // namespace
}  // namespace chladni::io
