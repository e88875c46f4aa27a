#include "io/recordings_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/draw.h"
#include "base/error.h"
#include "io/bytes/room.h"
#include "io/measured/measured_format.h"
#include "io/measured/time_columns.h"
#include "io/uff/time_uff.h"
#include "tests/io/measured/gzipped.h"
#include "tests/io/measured/written_uff.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class RecordingsInPieces : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& text) const {
    const auto file = folder_ / "recorded.csv";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  fs::path folder_ = fs::temp_directory_path() / ("chladni_pieces_" + std::to_string(getpid()));
};

/// Records of two experiments and some realisations, so that blocks of a file end within lines.
recordings::TimeData recorded(int realisations, Eigen::Index samples) {
  Draw draw(5);
  recordings::TimeData data;
  data.outputs.resize(2);
  data.inputs.resize(2);
  data.outputs[0].name = "y1";
  data.outputs[1].name = "y2";
  data.inputs[0].name = "u1";
  data.inputs[1].name = "u2";
  data.sample_time_s = 1.0 / 4096.0;
  data.period = samples / 4;
  for (int n = 0; n < 2 * realisations; ++n) {
    recordings::Record record;
    record.outputs.resize(samples, 2);
    record.inputs.resize(samples, 2);
    record.references.resize(samples, 0);
    for (auto& sample : record.outputs.reshaped()) sample = draw.normal();
    for (auto& sample : record.inputs.reshaped()) sample = draw.normal();
    record.experiment = n % 2;
    record.realisation = n / 2;
    data.records.push_back(record);
  }
  return data;
}

std::string text_of(int realisations = 2, Eigen::Index samples = 8) {
  return time_csv(recorded(realisations, samples));
}

// All samples at once, and some in the midst of blocks and across their borders.
void expect_samples(const recordings::Recordings& pieces, std::size_t record, recordings::Side side,
                    const Eigen::MatrixXd& expected, Draw& draw) {
  for (Eigen::Index c = 0; c < expected.cols(); ++c) {
    EXPECT_EQ(pieces.samples(record, side, c, 0, expected.rows()), expected.col(c));
    for (int n = 0; n < 5; ++n) {
      const auto first =
          static_cast<Eigen::Index>(draw.uniform() * 0.999 * static_cast<double>(expected.rows()));
      const auto count = std::max<Eigen::Index>(
          1,
          static_cast<Eigen::Index>(draw.uniform() * static_cast<double>(expected.rows() - first)));
      EXPECT_EQ(pieces.samples(record, side, c, first, count),
                expected.col(c).segment(first, count));
    }
  }
}

void expect_same(const RecordingsFile& found, const TimeFile& whole) {
  const auto& pieces = found.data;
  EXPECT_EQ(found.notes, whole.notes);
  EXPECT_EQ(pieces.head.sample_time_s, whole.data.sample_time_s);
  EXPECT_EQ(pieces.head.period, whole.data.period);
  ASSERT_EQ(pieces.head.outputs.size(), whole.data.outputs.size());
  ASSERT_EQ(pieces.head.inputs.size(), whole.data.inputs.size());
  for (std::size_t i = 0; i < whole.data.outputs.size(); ++i) {
    EXPECT_EQ(pieces.head.outputs[i].name, whole.data.outputs[i].name);
    EXPECT_EQ(pieces.head.outputs[i].unit, whole.data.outputs[i].unit);
    EXPECT_EQ(pieces.head.outputs[i].kind, whole.data.outputs[i].kind);
  }
  ASSERT_EQ(pieces.records.size(), whole.data.records.size());
  Draw draw(6);
  for (std::size_t i = 0; i < whole.data.records.size(); ++i) {
    const auto& expected = whole.data.records[i];
    EXPECT_EQ(pieces.records[i].samples, expected.outputs.rows());
    EXPECT_EQ(pieces.records[i].experiment, expected.experiment);
    EXPECT_EQ(pieces.records[i].realisation, expected.realisation);
    expect_samples(pieces, i, recordings::Side::outputs, expected.outputs, draw);
    expect_samples(pieces, i, recordings::Side::inputs, expected.inputs, draw);
    expect_samples(pieces, i, recordings::Side::references, expected.references, draw);
  }
}

// 3 MB: three blocks of the reader.
TEST_F(RecordingsInPieces, AreThoseOfTheFileAsAWhole) {
  const auto text = text_of(3, 4096);
  ASSERT_GT(text.size(), std::size_t{2} << 20U);
  for (const auto& unit : {"", "mm", "g"}) {
    const TimeOptions options{.unit = unit};
    expect_same(read_in_pieces(write(text), options), parse_time_csv(text, "", options));
  }
}

TEST_F(RecordingsInPieces, AreReadWithOtherEndsOfLines) {
  auto text = text_of();
  std::string other = "\xEF\xBB\xBF# a comment\r\n";
  for (const char c : text) other += c == '\n' ? "\r\n" : std::string(1, c);
  other.resize(other.size() - 2);  // the last line has no end
  expect_same(read_in_pieces(write(other)), parse_time_csv(text, ""));
}

// A line of blanks that is longer than a block.
TEST_F(RecordingsInPieces, AreReadWithLongLines) {
  const auto text = text_of();
  const auto at = text.find('\n') + 1;
  const auto other =
      text.substr(0, at) + std::string(std::size_t{3} << 20U, ' ') + "\n" + text.substr(at);
  expect_same(read_in_pieces(write(other)), parse_time_csv(text, ""));
}

// Each fault is told with the same line and words as of the file as a whole.
TEST_F(RecordingsInPieces, AreRefusedWithTheSameWords) {
  const auto text = text_of(2, 8);
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  const auto with = [&](std::size_t line, const std::string& words) {
    std::string changed;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i != line || !words.empty()) changed += (i == line ? words : lines[i]) + "\n";
    }
    return changed;
  };
  const auto start = [&](std::size_t line) { return lines[line].substr(0, lines[line].find(',')); };
  const std::vector<std::string> wrong = {
      with(13, ""),                               // a sample is missing
      with(13, lines[13] + ",1"),                 // too many fields
      with(20, start(20) + ",1,1,0,1,word,3,4"),  // no number
      with(20, start(20) + ",0,1,1,1,,3,4"),      // an empty field
      with(20, start(20) + ",0.5,1,1,1,2,3,4"),   // no experiment
      with(21, ",0,1,2,1,2,3,4"),                 // no time
      with(0, "time_s,experiment,experiment,period,y1,y2,u1,u2"),
      lines[0] + "\n",
      "",
      "1,2,3\n4,5,6\n"};
  for (const auto& one : wrong) {
    const auto file = write(one);
    const auto found = refusal_of([&] { return read_in_pieces(file); });
    EXPECT_FALSE(found.empty()) << one;
    EXPECT_EQ(found, refusal_of([&] { return parse_time_csv(one, file.string()); }));
  }
}

// A record of three blocks of the store; its faults are told with their lines, too.
TEST_F(RecordingsInPieces, AreReadWithLongRecords) {
  const auto text = text_of(1, 150'000);
  expect_same(read_in_pieces(write(text)), parse_time_csv(text, ""));
  auto at = text.find('\n');
  for (int line = 2; line < 140'000; ++line) at = text.find('\n', at + 1);
  const auto end = text.find('\n', at + 1);
  const auto without = text.substr(0, at) + text.substr(end);
  const auto file = write(without);
  const auto found = refusal_of([&] { return read_in_pieces(file); });
  EXPECT_NE(found.find("line 140000: time_s is "), std::string::npos) << found;
  EXPECT_NE(found.find("1 sample is missing before it"), std::string::npos) << found;
  EXPECT_EQ(found, refusal_of([&] { return parse_time_csv(without, file.string()); }));
}

// What is wrong with the time, at the borders of blocks and in their midst.
TEST_F(RecordingsInPieces, WithAWrongTimeAreRefusedWithTheSameWords) {
  using Wrong = std::pair<const char*, double (*)(int)>;  // what is said, samples after the fault
  const Wrong faults[] = {{"are missing before it", [](int after) { return after + 2.0; }},
                          {"changes from 1 to 2 Hz", [](int after) { return 0.5 * (after - 1); }},
                          {"does not ascend", [](int after) { return after - 1.0; }},
                          {"begins anew", nullptr}};
  for (const int at : {10, 65'535, 65'536, 65'537}) {
    for (const auto& [what, later] : faults) {
      std::string text = "time_s,y1\n";
      for (int n = 0; n < 140'000; ++n) {
        const double time = n < at ? n : later == nullptr ? n - at : at + later(n - at);
        text += std::to_string(time) + ",1\n";
      }
      const auto file = write(text);
      const auto found = refusal_of([&] { return read_in_pieces(file); });
      EXPECT_NE(found.find("line " + std::to_string(at + 2) + ": time_s"), std::string::npos)
          << found;
      EXPECT_NE(found.find(what), std::string::npos) << found;
      EXPECT_EQ(found, refusal_of([&] { return parse_time_csv(text, file.string()); }));
    }
  }
}

// A fault far inside is found without the whole column in memory.
TEST(RecordedTimes, AreLookedAtAFewAtATime) {
  Eigen::Index most = 0;
  const RecordedTimes time{.file = "t.csv",
                           .name = "time_s",
                           .samples = 300'000,
                           .times =
                               [&](Eigen::Index first, Eigen::Index count) {
                                 most = std::max(most, count);
                                 Eigen::VectorXd some(count);
                                 for (Eigen::Index i = 0; i < count; ++i) {
                                   const auto n = first + i;
                                   some(i) = static_cast<double>(n < 200'000 ? n : n + 1);
                                 }
                                 return some;
                               },
                           .line = [](Eigen::Index row) { return static_cast<int>(row) + 2; }};
  EXPECT_EQ(refusal_of([&] {
              check_steps(time, step_of(time));
              return 0;
            }),
            "t.csv: line 200002: time_s is 200001: 1 sample is missing before it; expected one "
            "step from sample to sample");
  EXPECT_LE(most, 65'537);
}

TEST_F(RecordingsInPieces, AreReadSoWhereTheWholeIsTooLarge) {
  const auto file = write(text_of(2, 1024));
  const auto size = static_cast<std::size_t>(fs::file_size(file));
  EXPECT_FALSE(is_read_in_pieces(file, {.limit_bytes = 4 * size}));
  EXPECT_TRUE(is_read_in_pieces(file, {.limit_bytes = 3 * size}));
  EXPECT_FALSE(is_read_in_pieces(folder_ / "none.csv", {.limit_bytes = 1}));
  // A packed one by its size when unpacked.
  const auto packed = write(gzipped(text_of(2, 1024)));
  ASSERT_LT(fs::file_size(packed), 3 * size / 4);
  EXPECT_FALSE(is_read_in_pieces(packed, {.limit_bytes = 4 * size}));
  EXPECT_TRUE(is_read_in_pieces(packed, {.limit_bytes = 3 * size}));
  fs::rename(packed, folder_ / "recorded.csv.gz");
  EXPECT_TRUE(is_read_in_pieces(folder_ / "recorded.csv.gz", {.limit_bytes = 3 * size}));
}

TEST_F(RecordingsInPieces, AreUnpackedWhileTheyAreRead) {
  const auto text = text_of(3, 4096);
  const auto half = text.find('\n', text.size() / 2) + 1;
  for (const auto& packed :
       {gzipped(text), gzipped(text.substr(0, half)) + gzipped(text.substr(half)),
        gzipped(text.substr(0, half + 7)) + gzipped(text.substr(half + 7)) + gzipped(""),
        gzipped(text) + std::string(512, '\0'), gzipped(text) + std::string(700'000, '\0'),
        gzipped(text.substr(0, half)) + std::string(9, '\0') + gzipped(text.substr(half))}) {
    expect_same(read_in_pieces(write(packed)), parse_time_csv(text, ""));
  }
}

TEST_F(RecordingsInPieces, AreRefusedWhereTheyAreDamagedOrCutOff) {
  const auto packed = gzipped(text_of(2, 1024));
  const char* behind = "has bytes after its end that are no gzip file";
  auto other_length = packed;  // the last four bytes are the length
  other_length.back() ^= 1;
  auto damaged = packed;
  for (std::size_t i = 0; i < 8; ++i) damaged[damaged.size() / 2 + i] ^= 0x55;
  for (const auto& [bytes, what] :
       {std::pair(packed.substr(0, packed.size() / 2), "is cut off"),
        std::pair(packed.substr(0, packed.size() - 4), "is cut off"),
        std::pair(packed + "more", behind), std::pair(packed + "\x1Fmore", behind),
        std::pair(packed + std::string(99, '\0') + "m", behind),
        std::pair(packed + packed.substr(0, 40), "is cut off"),
        std::pair(other_length, "is damaged")}) {
    const auto file = write(bytes);
    const auto found = refusal_of([&] { return read_in_pieces(file); });
    EXPECT_EQ(found, file.string() + ": gzip: the file " + what);
    EXPECT_EQ(found, refusal_of([&] { return content_of(file, reading_limit()); }));
  }
  EXPECT_FALSE(refusal_of([&] { return read_in_pieces(write(damaged)); }).empty());
}

TEST_F(RecordingsInPieces, AreThoseOfAUniversalFile) {
  auto data = recorded(3, 4096);
  data.outputs[0].unit = "m/s^2";
  data.outputs[0].kind = modal::FrfKind::accelerance;
  const auto file = folder_ / "recorded.uff";
  for (const auto encoding : {UffEncoding::text, UffEncoding::binary}) {
    const auto text = written_uff(data, encoding);
    for (const auto& unit : {"", "mm"}) {
      for (const bool packed : {false, true}) {
        const TimeOptions options{.unit = unit};
        std::ofstream(file, std::ios::binary) << (packed ? gzipped("\xEF\xBB\xBF" + text) : text);
        expect_same(read_in_pieces(file, options), parse_time_uff(text, "", options));
      }
    }
  }
}

TEST_F(RecordingsInPieces, OfAUniversalFileAreReadSoWhereTheWholeIsTooLarge) {
  const auto file = folder_ / "recorded.uff";
  const auto text = written_uff(recorded(2, 1024), UffEncoding::binary);
  std::ofstream(file, std::ios::binary) << text;
  EXPECT_FALSE(is_read_in_pieces(file, {.limit_bytes = 20 * text.size()}));
  EXPECT_TRUE(is_read_in_pieces(file, {.limit_bytes = 19 * text.size()}));
  // Twice the bytes are enough in pieces, not as a whole.
  const TimeOptions options{.limit_bytes = 2 * text.size()};
  expect_same(read_in_pieces(file, options), parse_time_uff(text, ""));
  EXPECT_FALSE(refusal_of([&] { return parse_time_uff(text, "", options); }).empty());
  auto blows = recorded(2, 1024);
  blows.period = 0;
  std::ofstream(file, std::ios::binary) << written_uff(blows, UffEncoding::binary);
  EXPECT_FALSE(is_read_in_pieces(file, {.limit_bytes = 1}));
  EXPECT_TRUE(is_read_in_pieces(file, {.period = 256, .limit_bytes = 1}));
}

TEST_F(RecordingsInPieces, OfAUniversalFileAreRefusedWithTheSameWords) {
  const auto whole = written_uff(recorded(1, 64), UffEncoding::text);
  const auto dataset = [&](int number) {  // its place, from -1 to -1
    auto at = whole.find("    -1\n    58\n");
    for (int n = 0; n < number; ++n) at = whole.find("    -1\n    58\n", at + 1);
    return at;
  };
  auto other = recorded(1, 64);
  other.sample_time_s = 1.0;
  const std::vector<std::string> bad{
      whole.substr(0, dataset(2)) + whole.substr(dataset(3)),  // a channel is missing
      whole.substr(0, whole.size() / 2), whole + written_uff(other, UffEncoding::text), "no file\n",
      written_uff(recorded(1, 1), UffEncoding::text)};
  const auto file = folder_ / "recorded.uff";
  for (const auto& text : bad) {
    std::ofstream(file, std::ios::binary) << text;
    const auto found = refusal_of([&] { return read_in_pieces(file); });
    EXPECT_FALSE(found.empty());
    EXPECT_EQ(found, refusal_of([&] { return parse_time_uff(text, file.string()); }));
  }
}

// Too many open files: the user reads that the machine lacks them, not that the file is bad.
TEST_F(RecordingsInPieces, AShortageOfTheMachineIsNoFaultOfTheFile) {
  const auto file = write(text_of());
  const TimeOptions options;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  EXPECT_THROW((void)is_read_in_pieces(file, options), OutOfResources);
  EXPECT_THROW((void)content_of(file, options.limit_bytes), OutOfResources);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

// What has no periods is read so only where that is asked for.
TEST_F(RecordingsInPieces, AreBlowsOfAHammerWhereThatIsAskedFor) {
  auto blows = recorded(2, 8);
  blows.period = 0;
  const auto text = time_csv(blows);
  const auto file = write(text);
  EXPECT_FALSE(is_read_in_pieces(file, {.limit_bytes = 1}));
  EXPECT_TRUE(is_read_in_pieces(file, {.period = 4, .limit_bytes = 1}));
  EXPECT_TRUE(is_read_in_pieces(file, {.limit_bytes = 1, .blows_in_pieces = true}));
  expect_same(read_in_pieces(file), parse_time_csv(text, ""));
}

}  // namespace
}  // namespace chladni::io
