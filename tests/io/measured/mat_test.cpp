#include "io/mat.h"

#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/matlab/frf_mat.h"
#include "io/matlab/time_mat.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/mat_by_hand.h"
#include "tests/io/measured/mat_files.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
void expect_channels(const modal::FrfSet& found, const modal::FrfSet& expected) {
  for (std::size_t i = 0; i < expected.outputs.size(); ++i) {
    EXPECT_EQ(found.outputs[i].unit, expected.outputs[i].unit);
    EXPECT_EQ(found.outputs[i].kind, expected.outputs[i].kind);
    EXPECT_EQ(found.outputs[i].node, expected.outputs[i].node);
    EXPECT_EQ(found.outputs[i].direction, expected.outputs[i].direction);
    EXPECT_EQ(found.outputs[i].position, expected.outputs[i].position);
  }
}

TEST_F(Mat, ReadsBackResponsesToTheLastBit) {
  const TemporaryFile file("responses.mat");
  const auto set = described_set();
  EXPECT_TRUE(write_frf(file.path, set).empty());
  const auto back = read_frf(file.path);
  EXPECT_EQ(back.format, "MAT 5");
  expect_same(back.set, set);
  expect_channels(back.set, set);
  EXPECT_EQ(back.set.averages, 8.0);
}

TEST_F(Mat, SameVariablesGiveTheSameBytes) {
  const TemporaryFile a("a.mat"), b("b.mat");
  (void)write_frf(a.path, described_set());
  (void)write_frf(b.path, described_set());
  EXPECT_TRUE(read_whole(a.path) == read_whole(b.path));
}

TEST_F(Mat, ReadsWhatWasPutTogetherByHand) {
  const TemporaryFile file("hand.mat");
  const std::vector<double> real{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const std::vector<double> imag{-1, -2, -3, -4, -5, -6, -7, -8, -9, -10, -11, -12};
  const auto frequency = doubles("freq_hz", {1, 3}, {0.5, 1.0, 2.0});
  const auto response = doubles("G", {2, 2, 3}, real, imag);
  const auto names = cells("output_names", {"y1", "y\xE9"});  // é, a letter of two bytes
  for (const bool packed : {false, true}) {
    const auto as = [&](const std::string& bytes) { return packed ? compressed(bytes) : bytes; };
    put(file.path, version_5({as(frequency), as(response), as(names)}));
    const auto set = read_frf(file.path).set;
    EXPECT_EQ(set.frequency_hz, Eigen::Vector3d(0.5, 1.0, 2.0));
    EXPECT_EQ(set.value[1](0, 1), Complex(7.0, -7.0));
    EXPECT_EQ(set.value[2](1, 0), Complex(10.0, -10.0));
    EXPECT_EQ(set.outputs[1].name, "y\xC3\xA9");
    EXPECT_EQ(set.inputs[1].name, "u2");
  }
}

TEST_F(Mat, ReadsAnFrdObjectThatWasSavedAsAStructure) {
  const TemporaryFile file("frd.mat");
  for (const char* unit : {"rad/TimeUnit", "Hz"}) {
    put(file.path,
        version_5(
            {doubles("unrelated", {1, 1}, {3.0}),
             structure("sys", {{"Frequency", doubles("", {2, 1}, {10.0, 20.0})},
                               {"FrequencyUnit", characters("", unit)},
                               {"ResponseData", doubles("", {1, 2, 2}, {1, 2, 3, 4}, {5, 6, 7, 8})},
                               {"InputName", cells("", {"u1", "u2"})},
                               {"OutputName", cells("", {"y1"})},
                               {"InputDelay", doubles("", {2, 1}, {0.0, 0.0})}})}));
    const auto set = read_frf(file.path).set;
    const double factor = unit[0] == 'H' ? 1.0 : 1.0 / (2.0 * std::numbers::pi);
    EXPECT_DOUBLE_EQ(set.frequency_hz(1), 20.0 * factor);
    EXPECT_EQ(set.value[1](0, 0), Complex(3.0, 7.0));
    EXPECT_EQ(set.inputs[1].name, "u2");
  }
}

// The same variables as MATLAB's -v7.3 has them: HDF5.
void write_73(const std::filesystem::path& file, const modal::FrfSet& set) {
  mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT73);
  ASSERT_NE(mat, nullptr);
  for (const auto& [name, value] : mat_of_frf(set)) {
    std::vector<std::size_t> dims(value.dims.begin(), value.dims.end());
    const auto rank = static_cast<int>(dims.size());
    auto copy = value;
    mat_complex_split_t parts{copy.real.data(), copy.imag.data()};
    matvar_t* variable = nullptr;
    if (value.kind == MatValue::Kind::number) {
      const bool is_complex = value.imag.size() > 0;
      void* data = is_complex ? static_cast<void*>(&parts) : copy.real.data();
      variable = Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, rank, dims.data(), data,
                               is_complex ? MAT_F_COMPLEX : 0);
    } else {
      std::vector<matvar_t*> texts;
      for (const auto& cell : value.cells) {
        std::string text = cell.text.front();
        std::size_t size[2] = {1, text.size()};
        texts.push_back(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, size, text.data(), 0));
      }
      variable =
          Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, rank, dims.data(), texts.data(), 0);
    }
    ASSERT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_ZLIB), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

TEST_F(Mat, ReadsVersion73) {
  const TemporaryFile file("hdf5.mat");
  auto set = described_set();
  set.outputs[1].name = "links";
  write_73(file.path, set);
  const auto back = read_frf(file.path);
  EXPECT_EQ(back.format, "MAT 7.3");
  expect_same(back.set, set);
  expect_channels(back.set, set);
}

TEST_F(Mat, WritesVersion73ThatIsReadBackToTheLastBit) {
  const TemporaryFile file("hdf5.mat");
  const auto set = described_set();
  EXPECT_TRUE(write_frf(file.path, set, MatVersion::mat_7_3).empty());
  const auto bytes = read_whole(file.path);
  EXPECT_TRUE(bytes.starts_with("MATLAB 7.3 MAT-file, written by chladni"));
  EXPECT_EQ(bytes.substr(124, 4), std::string("\x00\x02IM", 4));         // version and byte order
  EXPECT_EQ(bytes.substr(512, 8), std::string("\x89HDF\r\n\x1a\n", 8));  // behind MATLAB's head
  const auto back = read_frf(file.path);
  EXPECT_EQ(back.format, "MAT 7.3");
  expect_same(back.set, set);
  expect_channels(back.set, set);
  EXPECT_EQ(back.set.averages, 8.0);
}

// Every kind of value that is written, in both versions.
TEST_F(Mat, BothVersionsHoldTheSameValues) {
  const MatFields inner{{"half", 0.5}, {"note", std::string("\xC3\xA4 b")}};
  MatValue structure;
  structure.kind = MatValue::Kind::structure;
  structure.dims = {1, 1};
  structure.fields = inner;
  structure.class_name = "struct";
  const Eigen::MatrixXd real = Eigen::RowVectorXd::LinSpaced(12, 0.1, 7.0).reshaped(3, 4);
  const Eigen::MatrixXcd both = Complex(0.5, -3.0) * real;
  const MatFields fields{{"number", -1e-300},
                         {"matrix", real},
                         {"complex", both},
                         {"cube", {{2, 3, 4}, Eigen::VectorXd::LinSpaced(24, 1.0, 24.0)}},
                         {"empty", Eigen::MatrixXd(0, 3)},
                         {"text", std::string("one line")},
                         {"texts", std::vector<std::string>{"a", "", "\xC3\xA4"}},
                         {"structure", structure}};
  const TemporaryFile file("both.mat");
  for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
    write_mat(file.path, fields, version);
    const auto back = read_mat(file.path, kLimit);
    EXPECT_EQ(back.format, version == MatVersion::mat_5 ? "MAT 5" : "MAT 7.3");
    std::map<std::string, MatValue> by_name(back.variables.begin(), back.variables.end());
    ASSERT_EQ(by_name.size(), fields.size());
    for (const auto& [name, value] : fields) {
      const auto& found = by_name.at(name);
      EXPECT_EQ(found.kind, value.kind) << name;
      EXPECT_EQ(found.real, value.real) << name;
      EXPECT_EQ(found.imag, value.imag) << name;
      EXPECT_EQ(found.cells.size(), value.cells.size()) << name;
      if (value.kind == MatValue::Kind::number) {
        EXPECT_EQ(found.dims, value.dims) << name;
      }
    }
    EXPECT_EQ(by_name.at("text").text, std::vector<std::string>{"one line"});
    EXPECT_EQ(by_name.at("texts").cells.at(0).text, std::vector<std::string>{"a"});
    EXPECT_EQ(by_name.at("texts").cells.at(2).text, std::vector<std::string>{"\xC3\xA4"});
    const auto& members = by_name.at("structure").fields;
    ASSERT_EQ(members.size(), 2U);
    EXPECT_EQ(members[0].second.real(0), 0.5);
    EXPECT_EQ(members[1].second.text, std::vector<std::string>{"\xC3\xA4 b"});
  }
}

// Memory that is never touched costs nothing.
TEST_F(Mat, WhatVersion5CannotHoldIsVersion73) {
  EXPECT_EQ(mat_version_for({{"a", 1.0}}), MatVersion::mat_5);
  MatFields fields;
  fields.emplace_back("large", MatValue({250'000'001, 1}, Eigen::VectorXd(250'000'001)));
  EXPECT_EQ(mat_version_for(fields), MatVersion::mat_7_3);
}

FrfFile of(const MatFields& fields, const FrfOptions& options = {}) {
  return frf_of_mat({.format = "MAT 5", .variables = fields, .notes = {}}, "t.mat", options);
}

MatValue counting(const std::vector<Eigen::Index>& dims, bool is_complex = true) {
  Eigen::Index size = 1;
  for (const auto n : dims) size *= n;
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(size, 1.0, static_cast<double>(size));
  return {dims, numbers, is_complex ? Eigen::VectorXd(-numbers) : Eigen::VectorXd()};
}

Eigen::MatrixXd lines(Eigen::Index count) {
  return Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count));
}

TEST_F(Mat, LinesAreFoundByTheirNumber) {
  const auto first = of({{"f", lines(5)}, {"H", counting({5, 2, 3})}}).set;
  EXPECT_EQ(first.output_count(), 2);
  EXPECT_EQ(first.input_count(), 3);
  EXPECT_EQ(first.value[4](1, 0), Complex(10.0, -10.0));
  EXPECT_EQ(first.value[0](0, 2), Complex(21.0, -21.0));
  const auto last = of({{"f", lines(5)}, {"H", counting({2, 3, 5})}}).set;
  EXPECT_EQ(last.value[0](1, 0), Complex(2.0, -2.0));
  EXPECT_EQ(last.value[4](0, 2), Complex(29.0, -29.0));
  const auto column = of({{"f", lines(5)}, {"H", counting({5, 1})}}).set;
  EXPECT_EQ(column.value[3](0, 0), Complex(4.0, -4.0));
  const auto row = of({{"f", lines(5)}, {"H", counting({1, 5})}}).set;
  EXPECT_EQ(row.value[3](0, 0), Complex(4.0, -4.0));
  const auto outputs = of({{"f", lines(5)}, {"H", counting({5, 3})}}).set;
  EXPECT_EQ(outputs.output_count(), 3);
  EXPECT_EQ(outputs.value[0](2, 0), Complex(11.0, -11.0));
  const auto inputs = of({{"f", lines(5)},
                          {"H", counting({3, 5})},
                          {"input_names", std::vector<std::string>{"a", "b", "c"}}})
                          .set;
  EXPECT_EQ(inputs.input_count(), 3);
  EXPECT_EQ(inputs.value[1](0, 2), Complex(6.0, -6.0));
  const auto named = of({{"f", lines(3)},
                         {"H", counting({3, 2, 3})},
                         {"output_names", std::vector<std::string>{"a", "b"}}})
                         .set;
  EXPECT_EQ(named.output_count(), 2);  // 3 lines × 2 × 3, and not 3 × 2 × 3 lines
  EXPECT_EQ(named.value[1](0, 0), Complex(2.0, -2.0));
}

TEST_F(Mat, UnitsAreBroughtToSi) {
  const auto set = of({{"f", lines(5)},
                       {"H", counting({5, 2, 1})},
                       {"output_unit", std::vector<std::string>{"mm", "g"}},
                       {"input_unit", std::string("kN")}})
                       .set;
  EXPECT_NEAR(set.value[0](0, 0).real(), 1e-6, 1e-20);
  EXPECT_NEAR(set.value[0](1, 0).real(), 6.0 * 9.80665e-3, 1e-15);
  EXPECT_EQ(set.outputs[0].kind, modal::FrfKind::receptance);
  EXPECT_EQ(set.outputs[1].kind, modal::FrfKind::accelerance);
  EXPECT_EQ(set.inputs[0].unit, "N");
}

// "um/N" of an output was no unit, "LBF" of an input was a newton, and the unit of f was not read.
TEST_F(Mat, UnitsAreReadAsProgramsSpellThem) {
  const auto file = of({{"f", lines(5)},
                        {"f_unit", std::string("kHz")},
                        {"H", counting({5, 2, 1})},
                        {"output_unit", std::string("um/N")}});
  EXPECT_EQ(file.set.frequency_hz(1), 2000.0);
  EXPECT_NEAR(file.set.value[0](1, 0).real(), 6e-6, 1e-20);
  EXPECT_EQ(file.set.outputs[1].unit, "m");
  EXPECT_EQ(file.set.inputs[0].unit, "N");
  const auto with = [](const std::string& input) {
    return of({{"f", lines(5)}, {"H", counting({5, 1, 1})}, {"input_unit", input}});
  };
  EXPECT_NEAR(with("LBF").set.value[0](0, 0).real(), 1.0 / 4.4482216152605, 1e-12);
  const auto notes = with("counts").notes;
  EXPECT_TRUE(std::ranges::any_of(notes, [](const auto& note) {
    return note.find("the unit 'counts' of the input u1 is not known") != std::string::npos;
  })) << testing::PrintToString(notes);
}

struct Fault {
  const char* word;
  MatFields fields;
};

TEST_F(Mat, RefusalsNameTheVariable) {
  using Texts = std::vector<std::string>;
  MatValue object;
  object.class_name = "opaque";
  const Fault faults[] = {
      {"there are no frequencies", {{"H", counting({5, 2, 2})}}},
      {"there are no responses", {{"f", lines(5)}}},
      {"there are: f, x", {{"f", lines(5)}, {"x", 1.0}}},
      {"5 x 2 x 2 for 4 frequencies", {{"f", lines(4)}, {"H", counting({5, 2, 2})}}},
      {"lines may be first or last", {{"f", lines(3)}, {"H", counting({3, 3, 3})}}},
      {"lines may be first or last", {{"f", lines(3)}, {"H", counting({3, 3})}}},
      {"expected lines x outputs", {{"f", lines(3)}, {"H", counting({3, 3, 3, 2})}}},
      {"the responses are a cell", {{"f", lines(3)}, {"H", Texts{"a"}}}},
      {"without a phase", {{"f", lines(3)}, {"H", counting({3, 1, 1}, false)}}},
      {"the frequencies is a char", {{"f", std::string("abc")}, {"H", counting({3, 1, 1})}}},
      {"frequency 2 is 2",
       {{"f", Eigen::MatrixXd(Eigen::Vector3d(2, 2, 3))}, {"H", counting({3, 1, 1})}}},
      {"variance is 3 x 2",
       {{"f", lines(3)}, {"H", counting({3, 1, 1})}, {"variance", counting({3, 2}, false)}}},
      {"variance is complex",
       {{"f", lines(3)}, {"H", counting({3, 1, 1})}, {"variance", counting({3, 1, 1})}}},
      {"2 names for 1 channels",
       {{"f", lines(3)}, {"H", counting({3, 1, 1})}, {"output_names", Texts{"a", "b"}}}},
      {"two outputs are called",
       {{"f", lines(3)}, {"H", counting({3, 2, 1})}, {"output_names", Texts{"a", "a"}}}},
      {"save an frd object as struct", {{"sys", object}}},
      {"kind is 'x'", {{"f", lines(3)}, {"H", counting({3, 1, 1})}, {"kind", Texts{"x"}}}},
      {"is said to be of a mobility",
       {{"f", lines(3)},
        {"H", counting({3, 1, 1})},
        {"kind", Texts{"mobility"}},
        {"output_unit", Texts{"mm"}}}},
  };
  for (const auto& fault : faults) {
    try {
      (void)of(fault.fields);
      ADD_FAILURE() << fault.word << " is taken";
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(fault.word), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find("t.mat: "), 0U) << e.what();
    }
  }
}

TEST_F(Mat, AModelIsWrittenAsItsMatrices) {
  const TemporaryFile file("model.mat");
  const Eigen::MatrixXd a = Eigen::MatrixXd::Constant(2, 2, 1.0 / 3.0);
  write_mat(file.path, {{"A", a}, {"B", Eigen::MatrixXd(2, 0)}, {"name", std::string("stage")}});
  const auto found = read_mat(file.path, kLimit);
  ASSERT_EQ(found.variables.size(), 3U);
  EXPECT_EQ(found.variables[0].second.real, a.reshaped());
  EXPECT_EQ(found.variables[1].second.size(), 0);
  EXPECT_EQ(found.variables[2].second.text, std::vector<std::string>{"stage"});
  EXPECT_THROW(write_mat(file.path, {{"1x", a}}), InvalidInput);
  EXPECT_THROW(write_mat(file.path, {{"", a}}), InvalidInput);
  EXPECT_EQ(read_mat(file.path, kLimit).variables.size(), 3U);  // the old file stands
}

TEST_F(Mat, RecordingsAreReadBack) {
  const TemporaryFile file("recordings.mat");
  recordings::TimeData data;
  data.outputs.resize(2);
  data.outputs[0].name = "left";
  data.outputs[1].name = "right";
  data.inputs.resize(1);
  data.inputs[0].name = "coil";
  data.inputs[0].unit = "N";
  data.sample_time_s = 1.0 / 4096.0;
  data.period = 4;
  Draw draw(2);
  for (int r = 0; r < 3; ++r) {
    recordings::Record record;
    record.outputs.resize(8, 2);
    record.inputs.resize(8, 1);
    record.references.resize(8, 0);
    for (auto& sample : record.outputs.reshaped()) sample = draw.normal();
    for (auto& sample : record.inputs.reshaped()) sample = draw.normal();
    record.experiment = r % 2;
    record.realisation = r / 2;
    data.records.push_back(record);
  }
  (void)write_time(file.path, data);
  const auto found = read_time(file.path).data;
  EXPECT_EQ(found.outputs[1].name, "right");
  EXPECT_EQ(found.inputs[0].unit, "N");
  EXPECT_EQ(found.sample_time_s, data.sample_time_s);
  EXPECT_EQ(found.period, 4);
  ASSERT_EQ(found.records.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_EQ(found.records[r].outputs, data.records[r].outputs);
    EXPECT_EQ(found.records[r].inputs, data.records[r].inputs);
    EXPECT_EQ(found.records[r].experiment, data.records[r].experiment);
    EXPECT_EQ(found.records[r].realisation, data.records[r].realisation);
  }
}

}  // namespace
}  // namespace chladni::io
