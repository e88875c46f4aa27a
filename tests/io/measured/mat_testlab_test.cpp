// Functions of Simcenter Testlab in .mat files: one structure each, with x_values, y_values and
// function_record.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/mat.h"
#include "io/matlab/frf_mat.h"
#include "io/matlab/time_mat.h"
#include "io/time_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/mat_by_hand.h"
#include "tests/io/measured/mat_files.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;

constexpr double kGravity = 9.80665;  // [m/s²]

MatValue structure_with(MatFields fields) {
  MatValue value;
  value.kind = MatValue::Kind::structure;
  value.class_name = "struct";
  value.dims = {1, 1};
  value.fields = std::move(fields);
  return value;
}

MatValue quantity(const std::string& label, double factor = 1.0, double offset = 0.0) {
  return structure_with(
      {{"label", label},
       {"unit_transformation",
        structure_with({{"log_reference", 1.0}, {"factor", factor}, {"offset", offset}})}});
}

/// What a function has; changed by tests.
struct Function {
  std::string type = "FRF", x_label = "Hz", label = "g/N", name = "FRF left:+Z/hammer:-Z";
  Eigen::MatrixXcd values = Eigen::Vector3cd(Complex(1, 2), Complex(3, -4), Complex(5, 6));
  bool is_complex = true;
  double start = 10.0, increment = 0.5, factor = 1.0, offset = 0.0, count = 3.0;
};

MatValue function(const Function& of) {
  const auto values =
      of.is_complex ? MatValue(of.values) : MatValue(Eigen::MatrixXd(of.values.real()));
  return structure_with(
      {{"x_values", structure_with({{"start_value", of.start},
                                    {"increment", of.increment},
                                    {"number_of_values", of.count},
                                    {"quantity", quantity(of.x_label)}})},
       {"y_values", structure_with({{"values", values},
                                    {"quantity", quantity(of.label, of.factor, of.offset)}})},
       {"function_record", structure_with({{"name", of.name}, {"type", of.type}})}});
}

FrfFile responses_of(const MatFields& fields, const FrfOptions& options = {}) {
  return frf_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat", options);
}

TimeFile recordings_of(const MatFields& fields, const TimeOptions& options = {}) {
  return time_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat", options);
}

bool tells_of(const std::vector<std::string>& notes, const std::string& word) {
  return std::ranges::any_of(
      notes, [&](const auto& note) { return note.find(word) != std::string::npos; });
}

// They were no responses, "there are no frequencies".
TEST(TestlabMat, ResponsesAreReadInTheirUnits) {
  const auto file = responses_of({{"FRF_1", function({})}});
  EXPECT_EQ(file.set.frequency_hz, Eigen::Vector3d(10.0, 10.5, 11.0));
  EXPECT_EQ(file.set.outputs[0].name, "left:+Z");
  EXPECT_EQ(file.set.inputs[0].name, "hammer:-Z");
  EXPECT_EQ(file.set.outputs[0].unit, "m/s^2");
  EXPECT_EQ(file.set.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_EQ(file.set.inputs[0].unit, "N");
  EXPECT_LT(std::abs(file.set.value[1](0, 0) - kGravity * Complex(3.0, -4.0)), 1e-13);
  EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
  for (const auto* label : {"(m/s^2)/N", "m/(s^2 N)", "[m/s^2]/[N]"}) {
    const auto si = responses_of({{"FRF_1", function({.label = label})}}).set;
    EXPECT_EQ(si.value[1](0, 0), Complex(3.0, -4.0)) << label;
    EXPECT_EQ(si.outputs[0].unit, "m/s^2") << label;
  }
}

TEST(TestlabMat, SeveralFunctionsAreOneSet) {
  Function coherence{.type = "Coherence", .label = "", .name = "Coherence a/u"};
  coherence.values = Eigen::Vector3cd(0.5, 0.75, 1.0);
  coherence.is_complex = false;
  Function spectrum = coherence;
  spectrum.type = "PSD";
  MatValue cell;
  cell.kind = MatValue::Kind::cell;
  cell.class_name = "cell";
  cell.dims = {2, 1};
  cell.cells = {function({.name = "FRF b/v"}), function(coherence)};
  const auto file = responses_of({{"one", function({.name = "FRF a/u"})},
                                  {"more", cell},
                                  {"inner", structure_with({{"psd", function(spectrum)}})}});
  ASSERT_EQ(file.set.output_count(), 2);
  ASSERT_EQ(file.set.input_count(), 2);
  EXPECT_EQ(file.set.inputs[1].name, "v");
  EXPECT_TRUE(std::isnan(file.set.value[0](0, 1).real()));  // a over v was not measured
  EXPECT_NEAR(file.set.value[0](1, 1).real(), kGravity, 1e-14);
  EXPECT_EQ(file.set.coherence[1](0, 0), 0.75);
  EXPECT_TRUE(std::isnan(file.set.coherence[1](1, 1)));
  EXPECT_TRUE(tells_of(file.notes, "inner.psd (PSD) is not read"))
      << testing::PrintToString(file.notes);
}

// Whether values beside a transformation are in the unit of the label or in SI is told by nobody.
TEST(TestlabMat, ValuesWhoseUnitIsNotToldAreRefusedUnlessItIsStated) {
  const MatFields fields{{"FRF_1", function({.factor = kGravity})}};
  const auto said = refusal_of([&] { return responses_of(fields); });
  EXPECT_EQ(said.find("t.mat: the function FRF_1: y_values has the label 'g/N'"), 0U) << said;
  EXPECT_NE(said.find("state the unit"), std::string::npos) << said;
  FrfOptions options;
  options.unit = "g/N";
  EXPECT_NEAR(responses_of(fields, options).set.value[1](0, 0).real(), 3.0 * kGravity, 1e-13);
  options.unit = "m/s^2/N";
  EXPECT_EQ(responses_of(fields, options).set.value[1](0, 0), Complex(3.0, -4.0));
  EXPECT_NE(refusal_of([] { return responses_of({{"F", function({.offset = 1.0})}}); }), "");
}

TEST(TestlabMat, WhatCannotBeMeantIsRefusedByName) {
  const auto said = [](const Function& of) {
    return refusal_of([&] { return responses_of({{"FRF_1", function(of)}}); });
  };
  EXPECT_NE(said({.count = 4.0}).find("number_of_values 4, y_values 3 values"), std::string::npos);
  EXPECT_NE(said({.increment = 0.0}).find("an increment above 0"), std::string::npos);
  EXPECT_NE(said({.x_label = "rpm s"}).find("expected Hz or s"), std::string::npos);
  EXPECT_NE(said({.label = "g/g"}).find("transmissibility"), std::string::npos);
  EXPECT_NE(said({.type = "", .label = "g^2"}).find("expected the type FRF"), std::string::npos);
  EXPECT_NE(said({.is_complex = false}).find("without a phase"), std::string::npos)
      << said({.is_complex = false});
  EXPECT_NE(said({.type = "AutoPower"}).find("no frequency responses"), std::string::npos);
  const auto twice = refusal_of([] {
    return responses_of({{"A", function({})}, {"B", function({})}});
  });
  EXPECT_NE(twice.find("B and A are both of left:+Z over hammer:-Z"), std::string::npos) << twice;
  const auto lines = refusal_of([] {
    return responses_of({{"A", function({})}, {"B", function({.name = "b/u", .increment = 1.0})}});
  });
  EXPECT_NE(lines.find("B has 3 values from 10 to 12 Hz"), std::string::npos) << lines;
  const auto unit = refusal_of([] {
    return responses_of(
        {{"A", function({})}, {"B", function({.label = "m/N", .name = "left:+Z/other"})}});
  });
  EXPECT_NE(unit.find("B is in 'm/N'"), std::string::npos) << unit;
  EXPECT_TRUE(tells_of(responses_of({{"A", function({.label = "foo"})}}).notes, "'foo'"));
  EXPECT_TRUE(tells_of(responses_of({{"A", function({.name = "x"})}}).notes, "A over u1"));
}

Function signal_of(const std::string& name, const std::string& label) {
  Function of{.type = "Signal", .x_label = "s", .label = label, .name = name};
  of.is_complex = false;
  of.start = 0.0;
  of.increment = 1.0 / 1024.0;
  return of;
}

TEST(TestlabMat, RecordingsAreReadInTheirUnits) {
  const MatFields fields{{"Signal_0", function(signal_of("left", "g"))},
                         {"Signal_1", function(signal_of("Point5", "lbf"))},
                         {"Signal_2", function(signal_of("coil", "V"))}};
  EXPECT_THROW((void)responses_of(fields), NoResponses);
  const auto file = recordings_of(fields);
  EXPECT_EQ(file.data.sample_time_s, 1.0 / 1024.0);
  EXPECT_EQ(modal::names_of(file.data.outputs), (std::vector<std::string>{"left", "coil"}));
  EXPECT_EQ(modal::names_of(file.data.inputs), (std::vector<std::string>{"Point5"}));
  EXPECT_NEAR(file.data.records[0].outputs(1, 0), 3.0 * kGravity, 1e-13);
  EXPECT_EQ(file.data.records[0].outputs(1, 1), 3.0);
  EXPECT_EQ(file.data.outputs[1].unit, "V");
  EXPECT_NEAR(file.data.records[0].inputs(2, 0), 5.0 * 4.4482216152605, 1e-12);
}

TEST(TestlabMat, RecordingsOfSeveralColumnsHaveANameForEach) {
  auto of = signal_of("", "m/s^2");
  of.values = (Eigen::MatrixXcd(3, 2) << 1, 2, 3, 4, 5, 6).finished();
  auto value = function(of);
  value.fields[2].second.fields[0].second = MatValue(std::vector<std::string>{"left", "right"});
  const auto data = recordings_of({{"Signal", value}}).data;
  EXPECT_EQ(modal::names_of(data.outputs), (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(data.records[0].outputs.col(1), Eigen::Vector3d(2.0, 4.0, 6.0));
}

TEST(TestlabMat, RecordingsThatDoNotBelongTogetherAreRefused) {
  const auto left = function(signal_of("left", "g"));
  auto slow = signal_of("right", "g");
  slow.increment = 1.0 / 512.0;
  auto late = signal_of("right", "g");
  late.start = 1.0;
  for (const auto& other : {slow, late, signal_of("left", "g")}) {
    const auto said = refusal_of([&] {
      return recordings_of({{"A", left}, {"B", function(other)}});
    });
    EXPECT_EQ(said.find("t.mat: B "), 0U) << said;
  }
}

TEST_F(Mat, TestlabFunctionsAreReadFromBothVersions) {
  const TemporaryFile file("testlab.mat");
  const MatFields fields{{"FRF_1", function({})}, {"Signal", function(signal_of("left", "g"))}};
  for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
    write_mat(file.path, fields, version);
    const auto frf = read_frf(file.path);
    EXPECT_EQ(frf.set.outputs[0].name, "left:+Z");
    EXPECT_LT(std::abs(frf.set.value[1](0, 0) - kGravity * Complex(3.0, -4.0)), 1e-13);
    EXPECT_TRUE(tells_of(frf.notes, "Signal (Signal) is not read"));
    EXPECT_NEAR(read_time(file.path).data.records[0].outputs(1, 0), 3.0 * kGravity, 1e-13);
  }
}

// An array of structures, in a file.
TEST_F(Mat, ArraysOfTestlabFunctionsAreRead) {
  const auto x = structure("", {{"start_value", doubles("", {1, 1}, {0.0})},
                                {"increment", doubles("", {1, 1}, {0.5})},
                                {"number_of_values", doubles("", {1, 1}, {2.0})}});
  const auto y = [](double value) {
    return structure("", {{"values", doubles("", {2, 1}, {value, 2.0}, {0.5, 0.25})},
                          {"quantity", structure("", {{"label", characters("", "m/N")}})}});
  };
  const auto record = [](const char* name) {
    return structure("", {{"type", characters("", "FRF")}, {"name", characters("", name)}});
  };
  const TemporaryFile file("testlab.mat");
  put(file.path, version_5({structures("FRF", {1, 2}, {"x_values", "y_values", "function_record"},
                                       {x, y(7.0), record("a/u"), x, y(8.0), record("b/u")})}));
  const auto set = read_frf(file.path).set;
  ASSERT_EQ(set.output_count(), 2);
  EXPECT_EQ(set.outputs[1].name, "b");
  EXPECT_EQ(set.value[0](0, 0), Complex(7.0, 0.5));
  EXPECT_EQ(set.value[0](1, 0), Complex(8.0, 0.5));
}

// The arrays of outputs by inputs were filled before anything was asked: 1500 names took 54 GB.
TEST(TestlabMat, ResponsesThatAreManyPairsAreRefusedByTheirSize) {
  constexpr Eigen::Index count = 1500;
  Function of{.count = count};
  of.values = Eigen::MatrixXcd::Constant(count, count, Complex(1.0, 2.0));
  auto value = function(of);
  std::vector<std::string> names;
  for (Eigen::Index c = 0; c < count; ++c) {
    names.push_back("y" + std::to_string(c) + "/u" + std::to_string(c));
  }
  value.fields[2].second.fields[0].second = MatValue(names);
  FrfOptions options;
  options.limit_bytes = std::size_t{1} << 30U;
  const auto said = refusal_of([&] { return responses_of({{"F", value}}, options); });
  EXPECT_NE(said.find("1500 outputs by 1500 inputs on 1500 lines need"), said.npos) << said;
}

// The label went with the transformation, and a force was an acceleration.
TEST(TestlabMat, AForceWithATransformationIsNoneInTheUnitOfTheOutputs) {
  auto left = signal_of("left", "g");
  left.factor = kGravity;
  auto force = signal_of("hammer:1", "lbf");
  force.factor = 4.4482216152605;
  const MatFields fields{{"A", function(left)}, {"B", function(force)}};
  const auto said = [&](const TimeOptions& options) {
    return refusal_of([&] { return recordings_of(fields, options); });
  };
  EXPECT_NE(said({.unit = "g"}).find("B has the label 'lbf'"), std::string::npos);
  EXPECT_NE(said({.sensor_names = {"hammer:1"}, .unit = "g"}).find("B has"), std::string::npos);
  EXPECT_NE(said({.actuator_names = {"hammer:1"}, .unit = "g"}).find("B has"), std::string::npos);
  const auto data = recordings_of(fields, {.unit = kEachInSi}).data;
  ASSERT_EQ(data.inputs.size(), 1U);
  EXPECT_EQ(data.inputs[0].unit, "N");
  EXPECT_EQ(data.records[0].inputs(1, 0), 3.0);
  EXPECT_EQ(data.outputs[0].unit, "m/s^2");
  EXPECT_EQ(data.records[0].outputs(1, 0), 3.0);
  const auto alone = recordings_of({{"A", function(left)}}, {.unit = "g"}).data;
  EXPECT_NEAR(alone.records[0].outputs(1, 0), 3.0 * kGravity, 1e-13);
  EXPECT_NE(refusal_of([&] {
              return recordings_of({{"A", function(left)}}, {.unit = "mm"});
            }).find("A has the label 'g'"),
            std::string::npos);
}

// They were refused as without an increment.
TEST(TestlabMat, TimesMayStandValueByValue) {
  auto value = function(signal_of("left", "g"));
  value.fields[0].second.fields.emplace_back("values",
                                             Eigen::MatrixXd(Eigen::Vector3d(0.5, 0.75, 1.0)));
  EXPECT_EQ(recordings_of({{"A", value}}).data.sample_time_s, 0.25);
  value.fields[0].second.fields.back().second = Eigen::MatrixXd(Eigen::Vector3d(0.5, 0.8, 1.0));
  EXPECT_NE(refusal_of([&] {
              return recordings_of({{"A", value}});
            }).find("expected one step"),
            std::string::npos);
}

// They had the whole file refused.
TEST(TestlabMat, FunctionsOfOtherTypesMayHoldAnything) {
  auto power = function({.type = "AutoPower"});
  power.fields[1].second.fields[0].second = Eigen::MatrixXd(0, 0);
  const auto orders = function({.type = "", .x_label = "orders"});
  const auto file = responses_of({{"FRF_1", function({})}, {"P", power}, {"O", orders}});
  EXPECT_EQ(file.set.output_count(), 1);
  EXPECT_TRUE(tells_of(file.notes, "P (AutoPower), O are not read"))
      << testing::PrintToString(file.notes);
  auto empty = function({});
  empty.fields[1].second.fields[0].second = Eigen::MatrixXd(0, 0);
  EXPECT_NE(refusal_of([&] { return responses_of({{"FRF_1", empty}}); }), "");
}

// By their names alone they were plain samples and responses.
TEST(TestlabMat, FunctionsMayHaveTheNamesOfPlainVariables) {
  const MatFields recorded{{"y", function(signal_of("left", "g"))},
                           {"u", function(signal_of("hammer", "N"))}};
  EXPECT_EQ(recordings_of(recorded).data.inputs.size(), 1U);
  const auto response = function({});
  for (const auto* name : {"F", "freq"}) {
    const MatFields fields{{"FRF", response}, {name, Eigen::MatrixXd(Eigen::Vector3d(1, 2, 3))}};
    EXPECT_EQ(responses_of(fields).set.frequency_hz(0), 10.0) << name;
  }
}

}  // namespace
}  // namespace chladni::io
