#include "io/measured/column_head.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/frf_file.h"
#include "io/recordings_file.h"
#include "io/time_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
using Names = std::pair<std::string, std::string>;

bool tells(const std::vector<std::string>& notes, const std::string& word) {
  return std::ranges::any_of(
      notes, [&](const auto& note) { return note.find(word) != std::string::npos; });
}

TEST(ColumnHead, HasAUnitInBrackets) {
  EXPECT_EQ(name_and_unit("Time [ms]"), Names("Time", "ms"));
  EXPECT_EQ(name_and_unit("Real ((m/s^2)/N)"), Names("Real", "(m/s^2)/N"));
  EXPECT_EQ(name_and_unit("time_s"), Names("time_s", ""));
  EXPECT_EQ(name_and_unit("[mm]"), Names("[mm]", ""));
  EXPECT_EQ(channel_and_unit("left [g]"), Names("left", "g"));
  EXPECT_EQ(channel_and_unit("re_y1u1 (um/N)"), Names("re_y1u1", "um/N"));
  for (const std::string name : {"z (left)", "sensor (A)", "sensor (in)", "y (1)", "y [2]"}) {
    EXPECT_EQ(channel_and_unit(name), Names(name, ""));
  }
}

TEST(ColumnHead, OfFrequenciesAndTimesTellsTheirUnit) {
  EXPECT_EQ(hertz_of_column("Frequency [Hz]"), 1.0);
  EXPECT_EQ(hertz_of_column("Frequency (kHz)"), 1e3);
  EXPECT_EQ(hertz_of_column("freq_hz"), 1.0);
  EXPECT_EQ(hertz_of_column("freq_kHz"), 1e3);
  EXPECT_EQ(seconds_of_column("time_ms"), 1e-3);
  EXPECT_NEAR(hertz_of_column("freq [rad/s]").value_or(0.0), 0.5 / std::numbers::pi, 1e-15);
  for (const auto* none : {"freq_hz [kHz]", "Frequency [mm]", "F", "frequent"}) {
    EXPECT_FALSE(hertz_of_column(none)) << none;
  }
  EXPECT_EQ(seconds_of_column("Time [s]"), 1.0);
  EXPECT_NEAR(seconds_of_column("TIME (ms)").value_or(0.0), 1e-3, 1e-18);
  for (const auto* none : {"T", "time_s [ms]", "t [K]", "times"}) {
    EXPECT_FALSE(seconds_of_column(none)) << none;
  }
}

// "re_y1u1 [um/N]" was the response of "y1u1 [um" to "N]", and its values were metres.
TEST(FrfCsv, UnitsOfTheHeadAreRead) {
  const auto file = parse_frf_csv(
      "Frequency [kHz],re_y1u1 [um/lbf],im_y1u1 [um/lbf],var_y1u1\n2,3,-4,8\n", "t.csv");
  const double factor = 1e-6 / 4.4482216152605;
  EXPECT_EQ(file.set.frequency_hz(0), 2000.0);
  EXPECT_EQ(file.set.outputs[0].name, "y1");
  EXPECT_EQ(file.set.outputs[0].unit, "m");
  EXPECT_EQ(file.set.inputs[0].unit, "N");
  EXPECT_LT(std::abs(file.set.value[0](0, 0) - factor * Complex(3.0, -4.0)), 1e-15 * factor);
  EXPECT_NEAR(file.set.variance[0](0, 0), 8.0 * factor * factor, 1e-15 * factor * factor);
  EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
  const auto nameless =
      parse_frf_csv("Frequency (Hz);Real (g/N);Imaginary (g/N)\r\n2;3;-4\r\n", "t.csv");
  EXPECT_EQ(nameless.set.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_NEAR(nameless.set.value[0](0, 0).imag(), -4.0 * 9.80665, 1e-12);
  const auto named = parse_frf_csv("freq_hz,re_y/u (left),im_y/u (left)\n1,2,3\n", "t.csv");
  EXPECT_EQ(named.set.inputs[0].name, "u (left)");
}

TEST(FrfCsv, UnitsOfTheHeadThatContradictEachOtherAreRefused) {
  for (const auto* head : {"freq_hz,re_y1u1 [um/N],im_y1u1", "freq_hz,re_y1u1 [um/N],im_y1u1 [m/N]",
                           "freq_hz,re_y1u1 [g],im_y1u1 [g],re_y1u2 [m],im_y1u2 [m]"}) {
    const std::string row =
        std::string(head).find("u2") == std::string::npos ? "1,2,3" : "1,2,3,4,5";
    const auto said =
        refusal_of([&] { return parse_frf_csv(head + ("\n" + row + "\n"), "t.csv"); });
    EXPECT_NE(said.find("has another unit than others of y1"), said.npos) << said;
    EXPECT_EQ(said.find("t.csv"), said.rfind("t.csv")) << said;
    EXPECT_NE(said.find(" beside "), said.npos) << said;
  }
  const auto said = refusal_of([&] {
    return parse_frf_csv(
        "freq_hz,re_y1u1 [g/N],im_y1u1 [g/N],re_y2u1 [g/lbf],im_y2u1 [g/lbf]\n"
        "1,2,3,4,5\n",
        "t.csv");
  });
  EXPECT_NE(said.find("is over another one than"), said.npos) << said;
}

// What the user states besides was left out without a word.
TEST(FrfCsv, AUnitThatIsNotUsedIsNamed) {
  FrfOptions options;
  options.unit = "mm";
  const std::string bytes = "freq_hz,re_y1u1 [g],im_y1u1 [g]\n1,2,3\n";
  const auto file = parse_frf_csv(bytes, "t.csv", options);
  EXPECT_EQ(file.set.outputs[0].unit, "m/s^2");
  EXPECT_TRUE(tells(file.notes, "the unit \"mm\" is not used"));
  EXPECT_FALSE(tells(parse_frf_csv(bytes, "t.csv").notes, "is not used"));
  FrfOptions kind;
  kind.kind = modal::FrfKind::accelerance;
  EXPECT_EQ(parse_frf_csv(bytes, "t.csv", kind).set.outputs[0].unit, "m/s^2");
  kind.kind = modal::FrfKind::receptance;  // it took the place of that of the file
  EXPECT_THROW((void)parse_frf_csv(bytes, "t.csv", kind), InvalidInput);
}

// A recording with a force "f" was refused as a table of frequencies without responses.
TEST(FrfCsv, OfATimeAndAForceIsARecording) {
  EXPECT_THROW((void)parse_frf_csv("time_s,y1,f\n0,1,2\n1,2,3\n", "t.csv"), NoResponses);
}

// A column "Time [s]" was a channel where a sample time is stated, and "left [g]" had no unit.
TEST(TimeFile, UnitsOfTheHeadAreRead) {
  const std::string bytes =
      "Time [ms],left [g],right,hammer [lbf],force (kN),s9 [N]\n0,1,2,3,4,5\n0.5,6,7,8,9,10\n";
  TimeOptions options;
  options.unit = "mm/s^2";
  options.sample_time_s = 1.0;  // for files without times
  const auto file = parse_time_csv(bytes, "t.csv", options);
  const auto& data = file.data;
  EXPECT_EQ(modal::names_of(data.outputs), (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(modal::names_of(data.inputs), (std::vector<std::string>{"hammer", "force", "s9"}));
  EXPECT_NEAR(data.sample_time_s, 0.5e-3, 1e-18);
  EXPECT_EQ(data.outputs[0].unit, "m/s^2");
  EXPECT_NEAR(data.records[0].outputs(1, 0), 6.0 * 9.80665, 1e-12);
  EXPECT_NEAR(data.records[0].outputs(1, 1), 7e-3, 1e-15);
  EXPECT_NEAR(data.records[0].inputs(1, 0), 8.0 * 4.4482216152605, 1e-12);
  EXPECT_EQ(data.records[0].inputs(1, 1), 9e3);
  EXPECT_EQ(data.records[0].inputs(1, 2), 10.0);
  options.sensor_names = {"left [g]", "s9"};
  const auto known = parse_time_csv(bytes, "t.csv", options).data;
  EXPECT_EQ(modal::names_of(known.outputs), (std::vector<std::string>{"left [g]", "right", "s9"}));
  const auto said = refusal_of([] { return parse_time_csv("omega,y1\n1,2\n3,4\n", "t.csv"); });
  EXPECT_NE(said.find("freq_hz"), said.npos) << said;
}

TEST(TimeFile, UnitsOfTheHeadAreReadInPieces) {
  const TemporaryFile file("column_head.csv");
  const std::string bytes = "Time [ms],period,left [g],u\n0,0,1,2\n0.5,0,3,4\n1,1,5,6\n1.5,1,7,8\n";
  std::ofstream(file.path, std::ios::binary) << bytes;
  const auto whole = parse_time_csv(bytes, "t.csv").data;
  const auto pieces = read_in_pieces(file.path).data;
  EXPECT_EQ(pieces.head.sample_time_s, whole.sample_time_s);
  EXPECT_EQ(pieces.head.outputs[0].unit, "m/s^2");
  EXPECT_EQ(pieces.samples(0, recordings::Side::outputs, 0, 0, 4), whole.records[0].outputs.col(0));
  EXPECT_NEAR(whole.records[0].outputs(3, 0), 7.0 * 9.80665, 1e-12);
}

TEST(TimeFile, NamesThatEndInAUnitAreNotWritten) {
  recordings::TimeData data;
  data.outputs.emplace_back().name = "left [g]";
  data.sample_time_s = 1.0;
  data.records.push_back(
      {Eigen::MatrixXd::Ones(2, 1), Eigen::MatrixXd(2, 0), Eigen::MatrixXd(2, 0)});
  EXPECT_THROW((void)time_csv(data), InvalidInput);
  data.outputs[0].name = "Time";
  EXPECT_EQ(parse_time_csv(time_csv(data), "t.csv").data.outputs[0].name, "Time");
}

}  // namespace
}  // namespace chladni::io
