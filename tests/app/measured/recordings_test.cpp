// From recordings to modes: what `simulate` records of the studies in models/recordings is read by
// `identify`, and the modes are those of the simulated body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "app/command.h"
#include "base/error.h"
#include "base/turn.h"
#include "host/atomic_file.h"
#include "io/json.h"
#include "io/time_file.h"
#include "recordings/virtual_experiment.h"
#include "rotation/turn.h"
#include "stage/at_channels.h"
#include "stage/solution.h"
#include "steps/simulated.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

class Recordings : public testing::Test {
 protected:
  // A study of models/recordings in a folder of its own, with some words exchanged.
  [[nodiscard]] study::Study study_of(const std::string& name, const std::string& from = "",
                                      const std::string& to = "") const {
    auto text =
        read_whole(fs::path(CHLADNI_SOURCE_DIR) / "models" / "recordings" / (name + ".toml"));
    if (!from.empty()) {
      const auto at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    const auto file = folder_.path() / (name + ".toml");
    write_atomically(file, text);
    return study::read_study(file);
  }

  void simulate(const study::Study& study, const std::string& out) const {
    QuietRun quiet(study, folder_.path() / out);
    simulate_command.run(study, quiet.run());
  }

  [[nodiscard]] io::Json identify(const study::Study& study, std::string* said = nullptr,
                                  double memory_limit_gb = 0.0) const {
    QuietRun quiet(study, folder_.path() / "identified", memory_limit_gb);
    identify_command.run(study, quiet.run());
    if (said != nullptr) *said = quiet.said();
    return io::parse_json(read_whole(folder_.path() / "identified" / "identified.json"));
  }

  // The modes of the study's own body at its channels.
  [[nodiscard]] static modal::ReducedModel body_of(const study::Study& study) {
    stage::Work work;
    return stage::at_channels(study, stage::solved(study, work));
  }

  // Frequencies and damping within five deviations and 3e-4 (what the hold folds back) of the
  // body's.
  static void expect_modes(const io::Json& json, const modal::ReducedModel& body, double low_hz,
                           double high_hz) {
    std::size_t found = 0;
    for (Eigen::Index k = body.rigid_count; k < body.mode_count(); ++k) {
      const double hz = body.frequency_hz(k);
      if (hz < low_hz || hz > high_hz) continue;
      if (body.output_shapes.col(k).norm() < 1e-3 || body.input_shapes.row(k).norm() < 1e-3)
        continue;
      bool near = false;
      for (const auto& mode : json.at("modes").array()) {
        const double of_fit = mode.at("frequency_hz").number();
        if (std::abs(of_fit - hz) > 0.005 * hz) continue;
        near = true;
        EXPECT_NEAR(of_fit, hz, 5.0 * mode.at("frequency_std_hz").number() + 3e-4 * hz);
        EXPECT_NEAR(mode.at("damping_ratio").number(), body.damping_ratio(k),
                    5.0 * mode.at("damping_std").number() + 0.01 * body.damping_ratio(k));
      }
      EXPECT_TRUE(near) << hz;
      ++found;
    }
    EXPECT_GE(found, 2U);
  }

  TestFolder folder_{"recordings"};
};

TEST_F(Recordings, OpenLoopGivesTheModesOfTheBody) {
  const auto study = study_of("open_loop");
  simulate(study, "open_loop");
  const auto json = identify(study);
  expect_modes(json, body_of(study), 20.0, 1000.0);
  // The hold is taken off: what is left of a delay is within its deviation.
  EXPECT_LT(std::abs(json.at("delay_s").number()), 5.0 * json.at("delay_std_s").number() + 2e-7);
  const auto& quality = json.at("data_quality");
  EXPECT_NE(quality.at("verdict").string().find("good from"), std::string::npos);
  ASSERT_TRUE(fs::exists(folder_.path() / "identified" / "detection_lines.csv"));
  // No period is dropped.
  EXPECT_NE(quality.at("done").array().front().string().find("4 periods, 0 dropped"),
            std::string::npos)
      << quality.at("done").array().front().string();
}

// Commands that were held, taken for forces: half a sample is left as delay, and 1 − sin x / x.
TEST_F(Recordings, AHoldThatStaysLooksLikeADelay) {
  const auto study =
      study_of("open_loop", "[measurement]\n", "[measurement]\ninputs = \"forces\"\n");
  simulate(study, "open_loop");
  const auto json = identify(study);
  EXPECT_NEAR(json.at("delay_s").number(), 0.5 / 4096.0,
              5.0 * json.at("delay_std_s").number() + 1e-6);
}

TEST_F(Recordings, AClosedLoopGivesTheModesOfTheFreeBody) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of("closed_loop");
  simulate(study, "closed_loop");
  expect_modes(identify(study), body_of(study), 20.0, 1200.0);
}

// Ten blows in turn on the two actuators of a bench, in records of 4096 samples.
recordings::TimeData ten_blows(const steps::Bench& bench) {
  recordings::TimeData data{.outputs = bench.rig.outputs,
                            .inputs = bench.rig.inputs,
                            .references = {},
                            .sample_time_s = bench.rig.sample_time_s,
                            .period = 0,
                            .records = {}};
  Draw draw(3);
  for (int hit = 0; hit < 10; ++hit) {
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(4096, 2);
    for (Eigen::Index n = 0; n < 8; ++n) {
      force(40 + n, hit % 2) =
          40.0 * std::sin(std::numbers::pi * (static_cast<double>(n) + 0.5) / 8.0);
    }
    auto record = recordings::recorded(bench.rig, force, draw);
    record.experiment = hit % 2;
    data.records.push_back(std::move(record));
  }
  return data;
}

// Blows on the simulated body, in records that are too short for its first mode.
TEST_F(Recordings, BlowsGiveDampingWithoutThatOfTheWindow) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of("hammer");
  stage::Work work;
  fs::create_directories(folder_.path() / "hammer");
  (void)io::write_time(folder_.path() / "hammer" / "time_data.csv",
                       ten_blows(steps::bench_of(study, work)));
  const auto json = identify(study);
  const auto body = body_of(study);
  const auto& modes = json.at("modes").array();
  const auto first = std::ranges::min_element(modes, {}, [&](const io::Json& mode) {
    return std::abs(mode.at("frequency_hz").number() - body.frequency_hz(0));
  });
  EXPECT_NEAR(first->at("frequency_hz").number(), body.frequency_hz(0),
              0.002 * body.frequency_hz(0));
  // The window adds 6.7 rad/s: more than the mode has itself.
  EXPECT_GT(1.0 / 0.15, kTwoPi * body.frequency_hz(0) * body.damping_ratio(0));
  EXPECT_NEAR(first->at("damping_ratio").number(), body.damping_ratio(0),
              0.05 * body.damping_ratio(0));

  // In pieces they have the same bits.
  std::string said;
  const auto pieces = identify(study, &said, 0.004);
  EXPECT_NE(said.find("time_data.csv: it is read in pieces"), std::string::npos) << said;
  for (const char* part : {"modes", "data_quality"}) {
    EXPECT_EQ(io::text(pieces.at(part)), io::text(json.at(part)));
  }
}

TEST_F(Recordings, NamesWhatIsWrongWithThem) {
  const auto study = study_of("open_loop", "\"odd_with_detection\"", "\"all\"");
  simulate(study, "open_loop");
  const auto file = folder_.path() / "open_loop" / "time_data.csv";
  const auto sound =
      io::read_time(file, {.sensor_names = {"tip", "middle"}, .actuator_names = {"coil1"}}).data;
  auto clipped = sound;
  for (auto& record : clipped.records) {
    const double limit = 0.6 * record.outputs.col(0).maxCoeff();
    record.outputs.col(0) = record.outputs.col(0).cwiseMin(limit);
  }
  (void)io::write_time(file, clipped);
  std::string said;
  try {
    (void)identify(study, &said);
  } catch (const NumericalFailure&) {
    // Clipping distorts: the fit may be one that nobody should trust.
  }
  const auto json = io::parse_json(read_whole(folder_.path() / "identified" / "identified.json"));
  ASSERT_FALSE(json.at("data_quality").at("clipped").array().empty());
  EXPECT_NE(json.at("data_quality").at("clipped").array().front().string().find("tip is clipped"),
            std::string::npos);
  auto lost = sound;
  auto& record = lost.records[1];
  const auto rows = record.inputs.rows();
  for (auto* side : {&record.inputs, &record.outputs}) {
    const Eigen::MatrixXd rest = side->bottomRows(rows - 9005);
    side->middleRows(9000, rows - 9005) = rest;
  }
  (void)io::write_time(file, lost);
  const auto refusal = refusal_of([&] { return identify(study); });
  EXPECT_NE(refusal.find("record 2: from period 2 on the excitation comes 5 samples early"),
            std::string::npos)
      << refusal;
}

TEST_F(Recordings, KeysOfRecordingsAreRefusedWithoutOnes) {
  const auto refusal = refusal_of([&] {
    return study_of("open_loop", "time = \"open_loop/time_data.csv\"",
                    "frf = \"measured.csv\"\nforce_window = \"2 ms\"");
  });
  EXPECT_NE(refusal.find("force_window changes nothing here"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace chladni::app
