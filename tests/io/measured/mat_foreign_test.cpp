// .mat files that are broken, huge or hold what no instrument gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
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

TEST_F(Mat, BrokenFilesAreRefusedAndNotBelieved) {
  const TemporaryFile file("broken.mat");
  const auto refused = [&](const std::string& bytes) {
    put(file.path, bytes);
    try {
      (void)read_frf(file.path);
      return false;
    } catch (const InvalidInput& e) {
      EXPECT_EQ(std::string(e.what()).find(file.path.string()), 0U) << e.what();
      return true;
    }
  };
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("hello"));
  (void)write_frf(file.path, described_set());
  const auto whole = read_whole(file.path);
  Draw draw(3);
  for (int trial = 0; trial < 12; ++trial) {
    const auto size = static_cast<std::size_t>(draw.uniform() * static_cast<double>(whole.size()));
    EXPECT_TRUE(refused(whole.substr(0, size))) << size;
  }
  // A size of 2³¹ − 1 numbers, of which nothing follows.
  EXPECT_TRUE(refused(
      version_5({doubles("f", {1, 2}, {1, 2}), doubles("G", {2147483647, 1, 1}, {1.0}, {1.0})})));
  // Some hundred kilobytes that unpack to 128 megabytes.
  const std::string zeros(std::size_t{1} << 27U, '\0');
  FrfOptions options;
  options.limit_bytes = kLimit;
  put(file.path,
      version_5({compressed(element(14, array_head(6, {1, 1 << 24}, "G") + element(9, zeros)))}));
  EXPECT_LT(std::filesystem::file_size(file.path), 1U << 18U);
  EXPECT_THROW((void)read_frf(file.path, options), InvalidInput);
}

TEST_F(Mat, AnArrayOfMillionsIsNotMillionsOfChannels) {
  const TemporaryFile file("wide.mat");
  const auto refused = [&](const std::vector<std::string>& variables, const char* word) {
    put(file.path, version_5(variables));
    try {
      (void)read_frf(file.path);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const NoResponses&) {
      try {
        (void)read_time(file.path);
        ADD_FAILURE() << "taken; expected a refusal about " << word;
      } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
      }
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  const std::vector<double> many(400'000, 0.0);
  const auto frequencies = doubles("f", {1, 2}, {1.0, 2.0});
  refused({frequencies, doubles("G", {2, 200'000}, many)}, "200000 outputs, expected at most");
  refused({frequencies, doubles("G", {2, 1, 200'000}, many)}, "200000 inputs, expected at most");
  const auto step = doubles("Ts", {1, 1}, {0.1});
  refused({step, doubles("y", {2, 200'000}, many)}, "200000 outputs, expected at most");
}

TEST_F(Mat, ARateIsASampleTime) {
  const TemporaryFile file("rate.mat");
  const auto y = doubles("y", {4, 1}, {1.0, 2.0, 3.0, 4.0});
  put(file.path, version_5({doubles("Fs", {1, 1}, {2048.0}), y}));
  EXPECT_EQ(read_time(file.path).data.sample_time_s, 1.0 / 2048.0);
  put(file.path, version_5({doubles("Fs", {1, 1}, {2048.0}), doubles("Ts", {1, 1}, {0.5}), y}));
  EXPECT_EQ(read_time(file.path).data.sample_time_s, 0.5);
}

TEST_F(Mat, CountsOfRecordingsAreWholeNumbers) {
  const TemporaryFile file("counts.mat");
  const std::vector<double> samples{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
  for (const char* name : {"period", "experiment", "realisation"}) {
    for (const double wrong : {std::nan(""), HUGE_VAL, -1.0, 2.5, 1e300}) {
      put(file.path, version_5({doubles("Ts", {1, 1}, {0.1}), doubles("y", {8, 1}, samples),
                                doubles(name, {1, 1}, {wrong})}));
      const auto said = refusal_of([&] { return read_time(file.path); });
      EXPECT_NE(said.find(std::string(name) + " is "), std::string::npos) << wrong << ": " << said;
      EXPECT_NE(said.find("expected a whole number, 0 or more"), std::string::npos) << said;
    }
  }
}

TEST_F(Mat, NumbersThatNoInstrumentGivesAreRefused) {
  const TemporaryFile file("large.mat");
  put(file.path, version_5({doubles("f", {1, 2}, {1.0, 2.0}),
                            doubles("G", {2, 1}, {1.0, 1e200}, {1.0, 1.0})}));
  try {
    (void)read_frf(file.path);
    ADD_FAILURE() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("line 2 from input 1 to output 1"), std::string::npos)
        << e.what();
  }
  put(file.path, version_5({doubles("Ts", {1, 1}, {0.1}), doubles("y", {2, 1}, {1.0, 1e200})}));
  EXPECT_THROW((void)read_time(file.path), InvalidInput);
}

TEST_F(Mat, ReadsEveryUnitOfFrequencyThatMatlabHas) {
  const TemporaryFile file("units.mat");
  const auto read = [&](const std::string& unit, const std::string& time) {
    put(file.path, version_5({doubles("ResponseData", {1, 1, 2}, {1, 2}, {3, 4}),
                              doubles("Frequency", {2, 1}, {10.0, 20.0}),
                              characters("FrequencyUnit", unit), characters("TimeUnit", time)}));
    return read_frf(file.path).set.frequency_hz(1) / 20.0;
  };
  const double turn = 2.0 * std::numbers::pi;
  EXPECT_DOUBLE_EQ(read("rpm", "seconds"), 1.0 / 60.0);
  EXPECT_DOUBLE_EQ(read("MHz", "seconds"), 1e6);
  EXPECT_DOUBLE_EQ(read("cycles/TimeUnit", "minutes"), 1.0 / 60.0);
  EXPECT_DOUBLE_EQ(read("rad/TimeUnit", "milliseconds"), 1e3 / turn);
  EXPECT_DOUBLE_EQ(read("rad/minute", "seconds"), 1.0 / 60.0 / turn);
  EXPECT_DOUBLE_EQ(read("rad/s", "seconds"), 1.0 / turn);
  EXPECT_NE(refusal_of([&] { (void)read("furlongs", "seconds"); }).find("FrequencyUnit"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { (void)read("rad/TimeUnit", "years"); }).find("years"),
            std::string::npos);
}

// Samples that another variable counts otherwise are not channels.
TEST_F(Mat, RecordingsOfDifferentLengthsAreRefused) {
  const TemporaryFile file("lengths.mat");
  const auto refused = [&](std::vector<int> y, std::vector<int> u) {
    const auto numbers = [](const std::vector<int>& dims) {
      int count = 1;
      for (const int dim : dims) count *= dim;
      return std::vector<double>(static_cast<std::size_t>(count), 0.5);
    };
    put(file.path, version_5({doubles("y", y, numbers(y)), doubles("u", u, numbers(u)),
                              doubles("sample_time_s", {1, 1}, {0.001})}));
    return refusal_of([&] { return read_time(file.path); });
  };
  EXPECT_EQ(refused({8, 2}, {8, 1}), "");
  EXPECT_EQ(refused({8, 2}, {1, 8}), "");
  EXPECT_EQ(refused({8, 2, 3}, {8, 1, 3}), "");
  for (const auto& said :
       {refused({8, 1}, {1, 16}), refused({8, 2}, {8, 2, 3}), refused({2, 8}, {1, 8}),
        refused({8, 2, 3}, {8, 1, 6}), refused({2, 8}, {2, 8})}) {  // channels x samples
    EXPECT_NE(said.find("expected"), std::string::npos) << said;
  }
}

// The structures of a log were walked, and the file was refused for their number.
TEST_F(Mat, ALargeArrayOfStructuresIsLeftOut) {
  const TemporaryFile file("log.mat");
  constexpr int count = 20'001;
  const std::vector<std::string> values(4 * static_cast<std::size_t>(count),
                                        doubles("", {1, 1}, {1.0}));
  put(file.path, version_5({doubles("f", {1, 2}, {1.0, 2.0}),
                            structures("log", {1, count}, {"a", "b", "c", "d"}, values),
                            doubles("H", {2, 1}, {1.0, 2.0}, {3.0, 4.0})}));
  const auto read = read_frf(file.path);
  EXPECT_EQ(read.set.value[1](0, 0), std::complex<double>(2.0, 4.0));
  EXPECT_EQ(std::ranges::count(read.notes, "the variable log is not read"), 1);
}

}  // namespace
}  // namespace chladni::io
