// Recordings in .mat files that are larger than the memory.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/draw.h"
#include "io/mat.h"
#include "io/matlab/mat_parts.h"
#include "io/matlab/time_mat.h"
#include "io/recordings_file.h"
#include "io/time_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/mat_by_hand.h"
#include "tests/io/measured/mat_files.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Eigen::Index;

constexpr std::size_t kSmall = std::size_t{1} << 20U;  // parts of 64 kB, 8192 numbers

// Recordings in g and lbf. @param samples  of each record
recordings::TimeData recorded(Index samples, Index outputs, int records) {
  Draw draw(11);
  recordings::TimeData data;
  data.outputs.resize(static_cast<std::size_t>(outputs));
  data.inputs.resize(1);
  for (Index c = 0; c < outputs; ++c) {
    auto& output = data.outputs[static_cast<std::size_t>(c)];
    output.name = "y" + std::to_string(c + 1);
    output.unit = "g";
  }
  data.inputs[0].name = "u1";
  data.inputs[0].unit = "lbf";
  data.sample_time_s = 1.0 / 4096.0;
  data.period = samples / 4;
  for (int r = 0; r < records; ++r) {
    recordings::Record record;
    record.outputs.resize(samples, outputs);
    record.inputs.resize(samples, 1);
    record.references.resize(samples, 0);
    for (auto& sample : record.outputs.reshaped()) sample = draw.normal();
    for (auto& sample : record.inputs.reshaped()) sample = draw.normal();
    record.experiment = r % 2;
    record.realisation = r / 2;
    data.records.push_back(record);
  }
  return data;
}

void expect_same_samples(const RecordingsFile& pieces, const TimeFile& whole) {
  const auto& [head, records, samples] = pieces.data;
  EXPECT_EQ(pieces.format, whole.format);
  EXPECT_EQ(pieces.notes, whole.notes);
  EXPECT_EQ(modal::names_of(head.outputs), modal::names_of(whole.data.outputs));
  EXPECT_EQ(head.sample_time_s, whole.data.sample_time_s);
  EXPECT_EQ(head.period, whole.data.period);
  ASSERT_EQ(records.size(), whole.data.records.size());
  for (std::size_t r = 0; r < records.size(); ++r) {
    const auto& record = whole.data.records[r];
    EXPECT_EQ(records[r].experiment, record.experiment);
    EXPECT_EQ(records[r].realisation, record.realisation);
    ASSERT_EQ(records[r].samples, record.outputs.rows());
    const auto part = records[r].samples / 3;
    for (Index c = 0; c < record.outputs.cols(); ++c) {
      EXPECT_EQ(samples(r, recordings::Side::outputs, c, part, 2 * part),
                record.outputs.col(c).segment(part, 2 * part));
    }
    EXPECT_EQ(samples(r, recordings::Side::inputs, 0, 0, records[r].samples), record.inputs.col(0));
  }
}

TEST_F(Mat, RecordingsInPiecesAreThoseOfTheWhole) {
  const TemporaryFile file("pieces.mat");
  // Parts are cut between records, between channels, and between samples.
  for (const auto& [samples, outputs, records] :
       {std::tuple<Index, Index, int>(1024, 3, 6), {5000, 3, 4}, {20000, 2, 2}, {20000, 1, 1}}) {
    const auto data = recorded(samples, outputs, records);
    for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
      (void)write_time(file.path, data, version);
      EXPECT_TRUE(is_read_in_pieces(file.path, {.limit_bytes = kSmall})) << samples;
      expect_same_samples(read_in_pieces(file.path, {.limit_bytes = kSmall}), read_time(file.path));
    }
  }
}

// Packed by zlib as MATLAB writes version 7; the time stands beside the samples.
TEST_F(Mat, PackedRecordingsInPiecesAreThoseOfTheWhole) {
  const TemporaryFile file("packed.mat");
  Draw draw(4);
  std::vector<double> y(60000), u(30000), t(30000);
  for (auto& sample : y) sample = draw.normal();
  for (auto& sample : u) sample = draw.normal();
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = 0.25 * static_cast<double>(k);
  const auto write = [&] {
    put(file.path,
        version_5({compressed(doubles("y", {30000, 2}, y)), compressed(doubles("u", {1, 30000}, u)),
                   compressed(doubles("t", {30000, 1}, t)), compressed(characters("unit", "mm"))}));
  };
  write();
  const TimeOptions small{.period = 1000, .limit_bytes = kSmall};
  EXPECT_TRUE(is_read_in_pieces(file.path, small));
  expect_same_samples(read_in_pieces(file.path, small), read_time(file.path, {.period = 1000}));
  const auto same_refusal = [&](const char* word) {
    write();
    const auto said = refusal_of([&] { return read_in_pieces(file.path, small); });
    EXPECT_EQ(said, refusal_of([&] { return read_time(file.path, {.period = 1000}); }));
    EXPECT_NE(said.find(word), std::string::npos) << said;
  };
  y[45000] = std::nan("");
  same_refusal("y(45001)");
  y[45000] = 1.0;
  t[29000] = -1.0;
  same_refusal("time_s(29001)");
  t.pop_back();
  put(file.path, version_5({doubles("y", {30000, 2}, y), doubles("t", {29999, 1}, t)}));
  EXPECT_NE(refusal_of([&] { return read_in_pieces(file.path, small); }).find("29999 entries"),
            std::string::npos);
}

TEST_F(Mat, RecordingsAreReadInPiecesWhereTheWholeIsTooLarge) {
  const TemporaryFile file("large.mat");
  auto data = recorded(20000, 2, 2);
  const std::size_t bytes = 8 * 20000 * 3 * 2;
  (void)write_time(file.path, data);
  EXPECT_FALSE(is_read_in_pieces(file.path, {.limit_bytes = 10 * bytes}));
  EXPECT_TRUE(is_read_in_pieces(file.path, {.limit_bytes = 9 * bytes}));
  const TimeOptions less{.limit_bytes = bytes};
  EXPECT_NE(refusal_of([&] { return read_time(file.path, less); }), "");
  expect_same_samples(read_in_pieces(file.path, less), read_time(file.path));
  data.period = 0;  // blows of a hammer
  (void)write_time(file.path, data);
  EXPECT_FALSE(is_read_in_pieces(file.path, less));
  EXPECT_TRUE(is_read_in_pieces(file.path, {.limit_bytes = bytes, .blows_in_pieces = true}));
  EXPECT_TRUE(is_read_in_pieces(file.path, {.period = 5000, .limit_bytes = bytes}));
}

TEST_F(Mat, APartOfAVariableIsWhatStandsThere) {
  const TemporaryFile file("part.mat");
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(60, 1.0, 60.0);
  for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
    write_mat(file.path, {{"cube", MatValue({3, 4, 5}, numbers)}, {"other", 1.0}}, version);
    const auto heads = read_mat_heads(file.path, kLimit, 100);
    ASSERT_EQ(heads.variables.size(), 2U);
    EXPECT_EQ(heads.variables[0].second.kind, MatValue::Kind::large);
    EXPECT_EQ(heads.variables[0].second.dims, (std::vector<Index>{3, 4, 5}));
    EXPECT_EQ(heads.variables[1].second.real(0), 1.0);
    EXPECT_EQ(read_mat_part(file.path, "cube", {1, 2, 3}, {2, 1, 2}),
              Eigen::Vector4d(44.0, 45.0, 56.0, 57.0));
    for (const auto& start : {std::vector<Index>{2, 0, 0}, {0, 0}, {0, 0, 5}}) {
      const std::vector<Index> count(start.size(), 2);
      EXPECT_NE(refusal_of([&] { return read_mat_part(file.path, "cube", start, count); }), "");
    }
    EXPECT_NE(refusal_of([&] { return read_mat_part(file.path, "none", {0}, {1}); }), "");
  }
}

// Two channels of one name went through, and so did a step that is no number.
TEST_F(Mat, RecordingsInPiecesAreCheckedAsTheWhole) {
  const TemporaryFile file("checked.mat");
  auto data = recorded(20000, 2, 1);
  const auto said = [&] {
    (void)write_time(file.path, data);
    return refusal_of([&] { return read_in_pieces(file.path, {.limit_bytes = kSmall}); });
  };
  EXPECT_EQ(said(), "");
  data.outputs[1].name = "y1";
  EXPECT_NE(said().find("two channels of the output side are called \"y1\""), std::string::npos);
  data.outputs[1].name = "";
  EXPECT_NE(said().find("an output has no name"), std::string::npos);
  const std::vector<double> y(20000, 1.0);
  put(file.path, version_5({doubles("y", {20000, 1}, y), doubles("Ts", {1, 1}, {HUGE_VAL})}));
  EXPECT_NE(refusal_of([&] {
              return read_in_pieces(file.path, {.limit_bytes = kSmall});
            }).find("the sample time is inf s"),
            std::string::npos);
}

// The worker said "stoi".
TEST_F(Mat, APartBeyondWhatLibmatioReadsIsNamed) {
  const TemporaryFile file("far_part.mat");
  write_mat(file.path, {{"y", MatValue({3, 4}, Eigen::VectorXd::LinSpaced(12, 1.0, 12.0))}});
  const auto said = refusal_of([&] {
    return read_mat_part(file.path, "y", {3'000'000'000, 0}, {1, 1});
  });
  EXPECT_NE(said.find("the place 3000000000 in a variable is not read"), said.npos) << said;
}

}  // namespace
}  // namespace chladni::io
