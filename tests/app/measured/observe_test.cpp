// chladni observe: an independent virtual rig, its recordings, and the sensor that no filter saw.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "app/command.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/json.h"
#include "io/mat.h"
#include "rotation/turn.h"
#include "steps/observer_loop.h"
#include "steps/observer_replay.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

// A plate on four soft posts. The rig has a mass that the study does not know.
std::string plate(const std::string& more) {
  std::string text = R"(
geometry = { plate = { length = "300 mm", width = "200 mm", thickness = "8 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh     = { edge_length = "30 mm", order = 2 }
modes    = { count = 24, damping_ratio = 0.01 }
)";
  int post = 0;
  for (const char* at : {R"(["-140 mm", "-90 mm"])", R"(["140 mm", "-90 mm"])",
                         R"(["-140 mm", "90 mm"])", R"(["140 mm", "90 mm"])"}) {
    for (const auto& [direction, stiffness] :
         {std::pair("z", "20 N/mm"), std::pair("x", "2 kN/mm"), std::pair("y", "2 kN/mm")}) {
      text += std::string("[[attachment]]\nkind = \"spring\"\nname = \"post_") +
              std::to_string(++post) + "\"\nat = " + at + "\ndirection = \"" + direction +
              "\"\nstiffness = \"" + stiffness + "\"\nfootprint = \"10 mm\"\n";
    }
  }
  const std::pair<const char*, const char*> places[] = {{"1", R"(["-140 mm", "90 mm"])"},
                                                        {"2", R"(["140 mm", "90 mm"])"},
                                                        {"3", R"(["140 mm", "-90 mm"])"},
                                                        {"4", R"(["-140 mm", "-90 mm"])"},
                                                        {"5", R"(["20 mm", "10 mm"])"}};
  for (const auto& [name, at] : places) {
    text +=
        std::string("[[sensor]]\nname = \"s") + name + "\"\nat = " + at + "\ndirection = \"z\"\n";
    if (std::string(name) == "5") continue;  // in the middle, where no actuator is
    text +=
        std::string("[[actuator]]\nname = \"a") + name + "\"\nat = " + at + "\ndirection = \"z\"\n";
  }
  return text + more;
}

const std::string kMass = R"(
[[attachment]]
kind = "mass"
name = "hidden"
at   = ["60 mm", "40 mm"]
mass = "60 g"
)";

std::string experiment(const std::string& more) {
  return "[experiment]\nsample_rate = \"8192 Hz\"\nsamples = 4096\nband = [\"10 Hz\", \"2000 "
         "Hz\"]\ninputs = \"orthogonal\"\ndelay = \"150 us\"\n" +
         more;
}

const std::string kObserver = R"(
[measurement]
frf = "measured.csv"
hold_out = ["s5"]
[identification]
unit = "m"
[observer]
replay = "rig/time_data.csv"
truth = "rig.toml"
noise = "5 nm"
[[observer.point]]
name = "tool"
at = ["-40 mm", "20 mm"]
[[observer.disturbance]]
name = "amplifier"
kind = "actuators"
rms = "50 mN"
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

// The rig is shaken and its model identified once for all tests.
class Observe : public testing::Test {
 protected:
  // Only for a test that has its turn: it takes some ten seconds.
  static void prepare() {
    if (folder_) return;
    folder_ = std::make_unique<TestFolder>("observe");
    write("frf.toml", plate(kMass + "[measurement]\nfrf = \"measured.csv\"\n" +
                            experiment("periods = 3\nrealisations = 2\nwarm_up = 2\nnoise = \"1 "
                                       "nm\"\ncompensate = \"hold\"\n")));
    write("rig.toml", plate(kMass + experiment("periods = 2\nrealisations = 1\nnoise = \"5 "
                                               "nm\"\nprocess_noise = \"50 mN\"\namplitude = \"0.2 "
                                               "N\"\nleaves = \"time\"\n")));
    write("observer.toml", plate(kObserver));
    run("frf.toml", "frf", simulate_command);
    run("rig.toml", "rig", simulate_command);
    stage::WorkOptions options;
    options.certificate = false;
    work_ = std::make_unique<stage::Work>(options);
    study_ = study::read_study(folder_->path() / "observer.toml");
    study_.interpolation.emplace().methods = {"dynamic_residual"};
    solution_ = std::make_unique<stage::Solution>(stage::solved(study_, *work_));
    shapes_ = std::make_shared<const steps::Interpolated>(
        steps::interpolated(study_, *solution_, *work_));
    recorded_ = steps::recordings(study_, *shapes_->measured.identified, *work_);
  }
  static void TearDownTestSuite() {
    shapes_.reset();
    solution_.reset();
    folder_.reset();
  }

  static void write(const std::string& name, const std::string& text) {
    write_atomically(folder_->path() / name, text);
  }
  static void run(const std::string& study_file, const std::string& out, const Command& command) {
    const auto study = study::read_study(folder_->path() / study_file);
    QuietRun quiet(study, folder_->path() / out);
    command.run(study, quiet.run());
    quiet.run().finish_pictures();
  }
  static study::Study study_with(const std::string& tables) {
    auto study = study::parse_study(plate(tables), folder_->path() / "other.toml");
    study.interpolation = study_.interpolation;
    return study;
  }
  static steps::Observer designed(const study::Study& study, const steps::Recordings* recorded) {
    return steps::observer(study, *solution_, shapes_, recorded, *work_);
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::unique_ptr<stage::Work> work_;
  static study::Study study_;
  static std::unique_ptr<stage::Solution> solution_;
  static std::shared_ptr<const steps::Interpolated> shapes_;
  static steps::Recordings recorded_;
};

std::unique_ptr<TestFolder> Observe::folder_;
std::unique_ptr<stage::Work> Observe::work_;
study::Study Observe::study_;
std::unique_ptr<stage::Solution> Observe::solution_;
std::shared_ptr<const steps::Interpolated> Observe::shapes_;
steps::Recordings Observe::recorded_;

TEST_F(Observe, EstimatesWhatNoSensorSeesBetterThanGeometryDoes) {
  EVERY_FOURTH_LANDING();
  prepare();
  const auto observer = designed(study_, &recorded_);
  const auto truth = steps::true_filter(study_, observer, *work_);
  const auto replay = steps::replay(study_, observer, recorded_, truth);
  ASSERT_EQ(replay.judges.size(), 1U);
  const auto& judge = replay.judges[0];
  EXPECT_EQ(judge.judge, "s5");
  EXPECT_LT(judge.observer, 0.02);
  EXPECT_LT(judge.observer, 0.5 * judge.interpolation);
  EXPECT_LT(judge.observer, 0.5 * judge.rigid);
  EXPECT_LT(judge.observer, judge.model);
  EXPECT_LE(judge.truth, judge.observer);
  EXPECT_GT(judge.covered_widened, 0.8);
  EXPECT_GE(judge.covered_widened, judge.covered);
  EXPECT_NEAR(judge.noise * judge.rms, 5e-9, 1e-12);
  EXPECT_GT(replay.surprise, 0.9);
  EXPECT_EQ(replay.surprise_of.size(), 4);
  EXPECT_EQ(observer.names(), (std::vector<std::string>{"tool", "s5"}));
  EXPECT_EQ(observer.judges, 1);
  EXPECT_LT(observer.filter.pole.cwiseAbs().maxCoeff(), 1.0);
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_GT(observer.deviation(i), 0.0);
    EXPECT_LE(observer.deviation(i), observer.prediction(i));
    EXPECT_LT(observer.prediction(i), observer.without(i));
  }
  EXPECT_LE(observer.unknown_part.maxCoeff(), 1.0 + 1e-9);
  EXPECT_GE(observer.unknown_part.minCoeff(), 0.0);
  // Without a stated noise it is found, together with what of the motion is as fast as the samples.
  auto study = study_;
  study.observer->noise = 0.0;
  const auto found = steps::recordings(study, *shapes_->measured.identified, *work_).noise;
  EXPECT_GT(found.minCoeff(), 4.8e-9);
  EXPECT_LT(found.maxCoeff(), 30e-9);
}

// The file states neither its period nor its times; the study does.
TEST_F(Observe, ReadsRecordingsAsTheStudySaysTheyAre) {
  EVERY_FOURTH_LANDING();
  prepare();
  const auto table = read_whole(folder_->path() / "rig" / "time_data.csv");
  write("bare.csv", replaced(replaced(table, "time_s", "clock"), "period", "turn"));
  auto text = replaced(kObserver, "frf = \"measured.csv\"", "time = \"bare.csv\"");
  text = replaced(text, "replay = \"rig/time_data.csv\"\n", "");
  text = replaced(text, "noise = \"5 nm\"\n", "");
  const auto study_of = [&](const std::string& more) {
    return study_with(replaced(text, "[identification]", more + "[identification]"));
  };
  const auto read = [&](const std::string& more, stage::Work& work) {
    return steps::recordings(study_of(more), *shapes_->measured.identified, work);
  };
  const std::string stated = "sample_rate = \"8192 Hz\"\nperiod = 4096\n";
  const auto found = read(stated, *work_);
  EXPECT_NEAR(found.sample_time_s * 8192.0, 1.0, 1e-12);
  EXPECT_EQ(found.records.size(), recorded_.records.size());
  EXPECT_GT(found.noise.minCoeff(), 4.8e-9);
  EXPECT_LT(found.noise.maxCoeff(), 30e-9);
  EXPECT_NE(refusal_of([&] { return read("", *work_); }).find("no sample time is stated"),
            std::string::npos);
  stage::WorkOptions options;
  options.memory_limit_bytes = 1U << 16U;
  stage::Work small(options);
  EXPECT_NE(refusal_of([&] { return read(stated, small); }), "");
  // Forces that are measured go on from sample to sample, commands are held.
  const auto commands = designed(study_of(stated), &found).filter.system;
  const auto forces = designed(study_of(stated + "inputs = \"forces\"\n"), &found).filter.system;
  EXPECT_EQ(commands.ahead.size(), 0);
  EXPECT_EQ(forces.ahead.cols(), 4);
}

// The identified model errs by more than the noise of the rig, which the recordings say.
TEST_F(Observe, LearnsItsNoiseFromTheRecordings) {
  EVERY_FOURTH_LANDING();
  prepare();
  study_.observer->settle = 0.3;  // by themselves the two filters settle a sample apart
  const auto stated = designed(study_, &recorded_);
  const auto learned = steps::with_learned_noise(study_, stated, recorded_);
  EXPECT_TRUE(learned.noise.is_learned());
  EXPECT_GT(learned.noise.gain, 0.0);
  EXPECT_EQ(learned.left_out.size(), 4);
  EXPECT_GE(learned.band_factor, 1.0);
  const auto before = steps::replay(study_, stated, recorded_, std::nullopt).judges[0];
  const auto after = steps::replay(study_, learned, recorded_, std::nullopt);
  EXPECT_LT(after.judges[0].observer, 1.2 * before.observer);
  EXPECT_GT(after.judges[0].covered, std::min(0.85, before.covered));
  EXPECT_NEAR(after.surprise, 1.0, 1e-9);  // the size of the noise is that of the innovations
  const double filter = std::sqrt(learned.filter.point_covariance(1, 1));
  EXPECT_NEAR(learned.deviation(1), learned.band_factor * filter, 1e-12 * filter);
}

// The plate bends within a decade of the bandwidth: neither loop need be stable, and each says so.
TEST_F(Observe, TriesTheLoopOnTheEstimateBesideTheOneOnTheSensors) {
  EVERY_FOURTH_LANDING();
  prepare();
  const auto study = study_with(kObserver +
                                "[observer.loop]\nactuators = [\"a1\", \"a2\", \"a3\", "
                                "\"a4\"]\nbandwidth = \"150 Hz\"\n");
  const auto observer = designed(study, &recorded_);
  const auto trial = steps::loop_trial(study, observer, *work_);
  EXPECT_EQ(trial.axes, 3);
  EXPECT_EQ(trial.draws, steps::kLoopDraws);
  for (const auto* one : {&trial.on_sensors, &trial.on_estimate}) {
    EXPECT_LE(one->modulus_margin, 1.0);
    EXPECT_LE(one->worst_margin, one->modulus_margin + 0.05);
    ASSERT_EQ(one->rms.size(), 2U);
    EXPECT_EQ(one->stable, std::isfinite(one->rms[0]));
    EXPECT_EQ(one->stable, one->modulus_margin > 0.0);
    EXPECT_LE(one->stable_draws, trial.draws);
    ASSERT_EQ(one->worst_rms.size(), 2U);
    EXPECT_EQ(std::isfinite(one->worst_rms[0]), one->stable_draws == trial.draws);
    EXPECT_LE(one->median_rms[0], one->worst_rms[0]);
  }
}

// What is not known of a mode was drawn as known. Modes beyond the lines are known together alone.
TEST_F(Observe, DrawsWhatIsNotKnownOfAModeWithinTheLines) {
  EVERY_EIGHTH_LANDING();
  prepare();
  const auto study = study_with(kObserver +
                                "[observer.loop]\nactuators = [\"a1\", \"a2\", \"a3\", "
                                "\"a4\"]\nbandwidth = \"85 Hz\"\n");
  auto observer = designed(study, &recorded_);
  observer.places.at_points.deviation.setZero();
  const auto shapes =
      std::make_shared<steps::Interpolated>(steps::interpolated(study_, *solution_, *work_));
  observer.shapes = shapes;
  const auto trial_of = [&](bool unknown, bool beyond) {
    auto model = *shapes_->measured.identified;
    const auto mode = model.found.fit.model.rigid_count + 4;
    for (auto& other : model.found.fit.mode_covariance) other.setZero();
    auto& covariance = model.found.fit.mode_covariance[static_cast<std::size_t>(mode)];
    if (unknown) covariance.setConstant(std::numeric_limits<double>::infinity());
    if (beyond) model.judgement.beyond_lines = {mode};
    shapes->measured.identified = std::make_shared<const steps::IdentifiedModel>(std::move(model));
    return steps::loop_trial(study, observer, *work_);
  };
  const auto notes = [](const steps::LoopTrial& trial) {
    std::string all;
    for (const auto& note : trial.notes) all += note + "\n";
    return all;
  };
  const auto unknown = trial_of(true, false);
  EXPECT_NE(notes(unknown).find("have no known deviation"), std::string::npos) << notes(unknown);
  EXPECT_EQ(unknown.draws, steps::kLoopDraws);
  const auto known = trial_of(false, false);
  ASSERT_EQ(known.on_estimate.stable_draws, steps::kLoopDraws);  // all are the model itself
  EXPECT_LT(unknown.on_estimate.worst_margin, known.on_estimate.worst_margin);
  EXPECT_LT(unknown.on_estimate.stable_draws, known.on_estimate.stable_draws);
  const auto beyond = trial_of(true, true);
  EXPECT_EQ(notes(beyond), notes(known));
  EXPECT_EQ(beyond.on_estimate.stable_draws, steps::kLoopDraws);
  EXPECT_EQ(beyond.on_estimate.worst_margin, known.on_estimate.worst_margin);
}

// All is linear: with twice the noise everywhere the loops move twice as much. The disturbances of
// the plant stayed as stated where those of the filter were learned.
TEST_F(Observe, ALoopHasTheNoiseThatWasLearned) {
  EVERY_FOURTH_LANDING();
  prepare();
  const auto study = study_with(kObserver +
                                "[observer.loop]\nactuators = [\"a1\", \"a2\", \"a3\", "
                                "\"a4\"]\nbandwidth = \"85 Hz\"\n");
  const auto stated = designed(study, &recorded_);
  auto loud = stated;
  loud.noise = {2.0, 2.0};
  loud.filter = modal::kalman_filter(modal::with_noise(stated.filter.system, loud.noise));
  const auto trial = steps::loop_trial(study, stated, *work_);
  const auto loud_trial = steps::loop_trial(study, loud, *work_);
  for (const auto of : {&steps::LoopTrial::on_sensors, &steps::LoopTrial::on_estimate}) {
    const auto& one = trial.*of;
    const auto& other = loud_trial.*of;
    EXPECT_EQ(one.stable, other.stable);
    for (std::size_t i = 0; i < one.rms.size(); ++i) {
      if (one.stable) {
        EXPECT_NEAR(other.rms[i] / one.rms[i], 2.0, 1e-6);
      }
    }
    EXPECT_NEAR(other.modulus_margin, one.modulus_margin, 1e-6);
  }
  EXPECT_TRUE(trial.on_estimate.stable);
}

TEST_F(Observe, RefusesWhatCannotBeMeant) {
  EVERY_FOURTH_LANDING();
  prepare();
  const auto says = [](const std::string& text, const steps::Recordings* recorded,
                       const std::string& part) {
    const auto found = refusal_of([&] { return designed(study_with(text), recorded); });
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  says(replaced(kObserver, "-40 mm", "-400 mm"), &recorded_, "point \"tool\" is not on the body");
  says(replaced(kObserver, "noise = ", "sample_rate = \"4096 Hz\"\nnoise = "), &recorded_,
       "observer.sample_rate is 4096 Hz and");
  says(kObserver, nullptr, "has no sample rate");
  says(replaced(kObserver, "noise = \"5 nm\"", "sample_rate = \"8192 Hz\""), nullptr,
       "the noise of the sensors is not known");
  says(kObserver +
           "[[observer.disturbance]]\nname = \"hum\"\nkind = \"actuators\"\nrms = \"1 "
           "N\"\nband = [\"1 Hz\", \"5 kHz\"]\n",
       &recorded_, "half of the sample rate, 4096 Hz");
  says(replaced(kObserver, "\"tool\"", "\"s5\""), &recorded_, "is a held-out sensor");
  says("[measurement]\nfrf = \"measured.csv\"\n", &recorded_, "there is no [observer]");
  const auto late = study_with(replaced(kObserver, "noise = ", "settle = \"20 s\"\nnoise = "));
  EXPECT_NE(refusal_of([&] {
              return steps::replay(late, designed(late, &recorded_), recorded_, std::nullopt);
            }).find("every record is shorter"),
            std::string::npos);
  const auto slow = study_with(kObserver +
                               "[observer.loop]\nactuators = [\"a1\", \"a2\", \"a3\", "
                               "\"a4\"]\nbandwidth = \"150 Hz\"\ndelay = \"1e30 s\"\n");
  EXPECT_NE(refusal_of([&] {
              return steps::loop_trial(slow, designed(slow, &recorded_), *work_);
            }).find("expected at most 1000 samples"),
            std::string::npos);
  const auto missing = study_with(replaced(kObserver, "rig/time_data.csv", "rig/none.csv"));
  EXPECT_NE(refusal_of([&] {
              return steps::recordings(missing, *shapes_->measured.identified, *work_);
            }).find("there is no such file"),
            std::string::npos);
}

TEST_F(Observe, LeavesItsFiles) {
  EVERY_EIGHTH_LANDING();
  prepare();
  run("observer.toml", "observer", observe_command);
  const auto json = io::parse_json(read_whole(folder_->path() / "observer" / "observe.json"));
  EXPECT_FALSE(json.at("study").at("inputs").array().empty()) << "it stands on recordings";
  EXPECT_EQ(json.at("replay").at("judges").array().at(0).at("name").string(), "s5");
  EXPECT_EQ(json.at("points").array().size(), 2U);
  EXPECT_TRUE(std::get<bool>(json.at("noise").at("learned").value()));
  EXPECT_EQ(json.at("replay_as_stated").at("judges").array().size(), 1U);
  const auto mat = io::read_mat(folder_->path() / "observer" / "observer.mat", 1U << 24U);
  EXPECT_EQ(mat.variables.front().first, "observer");
  EXPECT_TRUE(fs::exists(folder_->path() / "observer" / "observer.h"));
}

}  // namespace
}  // namespace chladni::app
