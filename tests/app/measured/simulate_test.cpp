// chladni simulate: what it leaves is what a laboratory would have measured of the study's body.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

#include "app/command.h"
#include "base/error.h"
#include "base/turn.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "io/time_file.h"
#include "recordings/frf_estimate.h"
#include "recordings/rigid_chain.h"
#include "steps/simulated.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

const std::string kStrip = R"(
geometry = { beam = { length = "500 mm", width = "20 mm", thickness = "2 mm" } }
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7850 kg/m^3" }
[[sensor]]
name = "y1"
at = ["-200 mm", "0 mm"]
direction = "z"
[[sensor]]
name = "y4"
at = ["100 mm", "0 mm"]
direction = "z"
[[actuator]]
name = "u1"
at = ["-200 mm", "0 mm", "-2 mm"]
direction = "z"
)";

const std::string kPlate = R"(
geometry = { plate = { length = "300 mm", width = "250 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "40 mm", order = 2 }
modes = { count = 4, damping_ratio = 0.01 }
)";

std::string channel(const std::string& kind, const std::string& name, const std::string& place) {
  return "[[" + kind + "]]\nname = \"" + name + "\"\nat = [" + place + "]\ndirection = \"z\"\n";
}

// Three of each at the corners and one of each in the middle.
std::string plate_channels() {
  std::string text;
  for (const std::string kind : {"sensor", "actuator"}) {
    text += channel(kind, kind + "1", R"("-120 mm", "-100 mm")");
    text += channel(kind, kind + "2", R"("120 mm", "-100 mm")");
    text += channel(kind, kind + "3", R"("0 mm", "110 mm")");
    text += channel(kind, kind + "4", R"("0 mm", "0 mm")");
  }
  return text;
}

const std::string kShort = "sample_rate = \"1024 Hz\"\nsamples = 2048\n";

std::string in_other_words(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

class Simulate : public testing::Test {
 protected:
  [[nodiscard]] fs::path run(const std::string& text, const std::string& out = "out") const {
    const study::Study study = study::parse_study(text, folder_.path() / "study.toml");
    QuietRun quiet(study, folder_.path() / out);
    simulate_command.run(study, quiet.run());
    return folder_.path() / out;
  }

  TestFolder folder_{"simulate"};
};

// The names were refused when all was solved and the record was to be written.
TEST_F(Simulate, RefusesNamesThatATableCannotHoldBeforeItSolves) {
  const std::string too_fine = "mesh = { edge_length = \"1 um\" }\n";  // cannot be solved
  const auto said = refusal_of([&] {
    return run(too_fine + in_other_words(kStrip, "\"y1\"", "\"rig/y1\"") + "[experiment]\n" +
               kShort);
  });
  EXPECT_NE(said.find("CSV cannot hold the names"), std::string::npos) << said;
}

// Recordings and universal files have rules of their own.
TEST_F(Simulate, RefusesNamesThatItsOtherFilesCannotHoldBeforeItSolves) {
  const std::string too_fine = "mesh = { edge_length = \"1 um\" }\n";
  const auto said_of = [&](const std::string& name, const std::string& more,
                           const std::string& keys) {
    return refusal_of([&] {
      return run(too_fine + in_other_words(kStrip, "\"y1\"", "\"" + name + "\"") + more +
                 "[experiment]\n" + kShort + keys);
    });
  };
  const auto recordings = said_of("y1 [mm]", "", "leaves = \"time\"\n");
  EXPECT_NE(recordings.find("CSV cannot hold the channel name"), std::string::npos) << recordings;
  const auto uff = said_of(std::string(61, 'y'), "[measurement]\nfrf = \"m.uff\"\n", "");
  EXPECT_NE(uff.find("UFF cannot hold the channel name"), std::string::npos) << uff;
  const auto other = said_of("y1", "[measurement]\nfrf = \"m.xlsx\"\n", "");
  EXPECT_NE(other.find(".xlsx"), std::string::npos) << other;
}

TEST_F(Simulate, MeasuresTheChainWithinTheStatedVariance) {
  const auto out = run(kStrip + "[experiment]\n" + kShort +
                       "structure = \"rigid_chain\"\nwarm_up = 20\nperiods = 4\nrealisations = 6\n"
                       "band = [\"1 Hz\", \"60 Hz\"]\nnoise_ratio = 0.05\ndelay = \"1.3 ms\"\n");
  const auto set = io::read_frf(out / "measured.csv", {.unit = "m"}).set;
  ASSERT_EQ(set.output_count(), 2);
  const auto exact = recordings::frf(recordings::matrices(recordings::beam_with_coils()),
                                     Eigen::Vector2d(0.05, 0.35),
                                     Eigen::VectorXd::Constant(1, 0.05), set.frequency_hz);
  double chi2 = 0.0;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    for (Eigen::Index i = 0; i < 2; ++i) {
      chi2 += std::norm(set.value[k](i, 0) - exact.value[k](i, 0)) / set.variance[k](i, 0);
    }
  }
  // Variances of 15 degrees of freedom: 1.07 times the number, ± 0.07.
  EXPECT_NEAR(chi2 / static_cast<double>(2 * set.value.size()), 1.07, 0.25);
  const auto json = io::parse_json(read_whole(out / "simulated.json"));
  EXPECT_GT(json.at("crest_factor").number(), 2.0);
  EXPECT_NEAR(json.at("delay").at("hardware_s").number(), 1.3e-3, 1e-12);
}

// Far below its modes the middle of a free plate moves as its mass does, held by a loop or not.
TEST_F(Simulate, HoldsAFreeBodyAndFindsItsMass) {
  const auto out =
      run(kPlate + plate_channels() + "[experiment]\n" + kShort +
          "warm_up = 3\nperiods = 1\nrealisations = 1\nband = [\"20 Hz\", \"40 Hz\"]\n"
          "controlled = [\"actuator1\", \"actuator2\", \"actuator3\"]\nbandwidth = \"8 Hz\"\n");
  const auto set = io::read_frf(out / "measured.csv", {.unit = "m"}).set;
  const double mass = 0.3 * 0.25 * 0.01 * 2700.0;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const double omega = 2.0 * std::numbers::pi * set.frequency_hz(static_cast<Eigen::Index>(k));
    const auto apparent = -omega * omega * set.value[k](3, 3) * mass;
    EXPECT_NEAR(apparent.real(), 1.0, 0.03);
    EXPECT_NEAR(apparent.imag(), 0.0, 0.01);
  }
}

// Such data have no answer: the model that is compared with them has modes that they lack.
TEST_F(Simulate, SaysWhereTheBandGoesBeyondTheModel) {
  const auto notes_of = [&](const std::string& rate, const std::string& high) {
    const auto out = run(
        kPlate + plate_channels() + "[experiment]\nsample_rate = \"" + rate +
        "\"\nsamples = 2048\nwarm_up = 3\nperiods = 1\nrealisations = 1\nband = [\"20 Hz\", \"" +
        high +
        "\"]\ncontrolled = [\"actuator1\", \"actuator2\", \"actuator3\"]\n"
        "bandwidth = \"8 Hz\"\n");
    const auto json = io::parse_json(read_whole(out / "simulated.json"));
    std::string all;
    for (const auto& note : json.at("notes").array()) all += note.string() + "\n";
    return all;
  };
  EXPECT_NE(notes_of("64 kHz", "24 kHz").find("the responses lack the modes"), std::string::npos);
  EXPECT_EQ(notes_of("1024 Hz", "40 Hz").find("the responses lack the modes"), std::string::npos);
}

// A diagnosis of such responses has 64 modes, however few a study shows.
TEST_F(Simulate, ResponsesDoNotTurnOnTheModesThatAreShown) {
  const std::string text =
      kPlate + plate_channels() +
      "[experiment]\nsample_rate = \"16 kHz\"\nsamples = 2048\nwarm_up = 3\nperiods = 1\n"
      "realisations = 1\nband = [\"20 Hz\", \"4 kHz\"]\n"
      "controlled = [\"actuator1\", \"actuator2\", \"actuator3\"]\nbandwidth = \"8 Hz\"\n";
  const auto few = read_whole(run(text, "few") / "measured.csv");
  const auto more = in_other_words(text, "count = 4,", "count = 9,");
  EXPECT_EQ(read_whole(run(more, "more") / "measured.csv"), few);
}

TEST_F(Simulate, TheSameSeedLeavesTheSameBytes) {
  const std::string text = kStrip + "[experiment]\n" + kShort +
                           "structure = \"rigid_chain\"\nperiods = 3\nrealisations = 2\n"
                           "noise = \"2 um\"\nquantisation = \"1 um\"\n";
  const auto first = read_whole(run(text, "a") / "measured.csv");
  EXPECT_EQ(first, read_whole(run(text, "b") / "measured.csv"));
  EXPECT_NE(first, read_whole(run("seed = 2\n" + text, "c") / "measured.csv"));
}

TEST_F(Simulate, NeverOverwritesWhatItDidNotLeave) {
  const std::string text = kStrip + "[measurement]\nfrf = \"real.csv\"\n[experiment]\n" + kShort +
                           "structure = \"rigid_chain\"\nperiods = 3\nrealisations = 1\n";
  (void)run(text);
  (void)run(text);  // its own
  const auto file = folder_.path() / "real.csv";
  write_atomically(file, "freq_hz,re_y1u1,im_y1u1\n1,2,3\n");
  EXPECT_THROW((void)run(text), InvalidInput);
  EXPECT_EQ(read_whole(file), "freq_hz,re_y1u1,im_y1u1\n1,2,3\n");
}

// The study of a rig that is recorded may inherit the responses of another experiment.
TEST_F(Simulate, OfRecordingsLeavesAFileOfResponsesAlone) {
  write_atomically(folder_.path() / "real.csv", "freq_hz,re_y1u1,im_y1u1\n1,2,3\n");
  const auto out = run(kStrip + "[measurement]\nfrf = \"real.csv\"\n[experiment]\n" + kShort +
                       "structure = \"rigid_chain\"\nperiods = 3\nrealisations = 1\n"
                       "leaves = \"time\"\n");
  EXPECT_TRUE(fs::exists(out / "time_data.csv"));
  EXPECT_EQ(read_whole(folder_.path() / "real.csv"), "freq_hz,re_y1u1,im_y1u1\n1,2,3\n");
}

TEST_F(Simulate, LeavesTheRecordingsItsResponsesCameFrom) {
  const std::string text = kStrip + "[experiment]\nsample_rate = \"512 Hz\"\nsamples = 256\n" +
                           "structure = \"rigid_chain\"\nperiods = 3\nrealisations = 2\n"
                           "noise = \"1 um\"\ncompensate = \"none\"\n";
  const auto responses = io::read_frf(run(text, "a") / "measured.csv", {.unit = "m"}).set;
  const auto out = run(text + "leaves = \"time\"\n", "b");
  const auto data = io::read_time(out / "time_data.csv").data;
  ASSERT_EQ(data.records.size(), 2U);
  EXPECT_EQ(data.period, 256);
  const auto set = recordings::frf_estimate(data).set;
  ASSERT_GE(set.value.size(), responses.value.size());
  for (std::size_t k = 0; k < responses.value.size(); ++k) {
    const auto line = static_cast<Eigen::Index>(k);
    ASSERT_NEAR(set.frequency_hz(line), responses.frequency_hz(line), 1e-9);
    EXPECT_LT((set.value[k] - responses.value[k]).norm(), 1e-9 * responses.value[k].norm());
  }
}

// At another sensor its force would follow a velocity as if that were a displacement, and against
// the sensor's direction it would push away.
TEST_F(Simulate, ACubicSpringFollowsADisplacement) {
  const auto spring = [&](const std::string& strip) {
    return refusal_of([&] {
      return run(strip + "[experiment]\n" + kShort +
                 "structure = \"rigid_chain\"\nperiods = 1\nrealisations = 1\n"
                 "cubic_spring = { stiffness = \"1e9 N/m^3\", sensor = \"y1\", actuator = \"u1\" "
                 "}\n");
    });
  };
  EXPECT_EQ(spring(kStrip), "");
  for (const std::string quantity : {"velocity", "acceleration"}) {
    const auto text = in_other_words(kStrip, "\"y1\"", "\"y1\"\nquantity = \"" + quantity + "\"");
    EXPECT_NE(spring(text).find("\"y1\" measures " + quantity), std::string::npos);
  }
  EXPECT_NE(spring(in_other_words(kStrip, "direction = \"z\"", "direction = \"-z\""))
                .find("\"y1\" and \"u1\" do not point in one direction"),
            std::string::npos);
}

// A file of another size than `amplitude`, on other lines.
TEST_F(Simulate, TheNoiseIsAPartOfWhatTheFileMoves) {
  std::string table = "time_s,u1\n";
  for (int n = 0; n < 2048; ++n) {
    table +=
        fmt::format("{:.9f},{:.9f}\n", n / 1024.0, 20.0 * std::sin(kTwoPi * 12.0 * n / 1024.0));
  }
  write_atomically(folder_.path() / "played.csv", table);
  const auto bench_of = [&](const std::string& more) {
    stage::Work work;
    return steps::bench_of(
        study::parse_study(kStrip + "[experiment]\n" + kShort +
                               "structure = \"rigid_chain\"\nwarm_up = 20\nperiods = 2\n"
                               "excitation = \"played.csv\"\n" +
                               more,
                           folder_.path() / "study.toml"),
        work);
  };
  const auto quiet = bench_of("");
  Draw draw(1);
  const auto played = recordings::played(quiet.rig, quiet.excitation, 2, 20, draw);
  const auto& outputs = played.records.front().outputs;
  const auto noise = bench_of("noise_ratio = 0.05\n").rig.sensor_noise;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double rms = outputs.col(i).norm() / std::sqrt(static_cast<double>(outputs.rows()));
    EXPECT_NEAR(noise(i), 0.05 * rms, 1e-9 * rms);
  }
}

TEST_F(Simulate, RefusesWhatNoLaboratoryCanDo) {
  const auto refused = [&](const std::string& text) {
    EXPECT_THROW((void)run(text), InvalidInput) << text;
  };
  refused(kStrip);                                                 // nothing to do
  refused(kPlate + plate_channels() + "[experiment]\n" + kShort);  // would drift away
  refused(kPlate + plate_channels() + "[experiment]\nstructure = \"rigid_chain\"\n");
  refused(kStrip + "[experiment]\nband = [\"10 Hz\", \"5 kHz\"]\n");
  refused(kStrip + "[experiment]\nnoise = \"2 N\"\n");
  refused(kStrip + "[experiment]\nnoise = \"2 nm\"\nnoise_ratio = 0.1\n");
  refused(kStrip + "[experiment]\ncontrolled = [\"u1\"]\n");
  refused(kStrip + "[experiment]\ncontroled = [\"u1\"]\n");
  refused(kPlate + plate_channels() + "[experiment]\n" + kShort +
          "controlled = [\"actuator1\", \"actuator2\", \"actuator3\"]\nbandwidth = \"100 Hz\"\n");
}

}  // namespace
}  // namespace chladni::app
