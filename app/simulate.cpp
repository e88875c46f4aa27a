// chladni simulate STUDY: a virtual experiment, on the study's model or on the thesis' chain of
// rigid bodies.
#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "app/command.h"
#include "base/error.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/time_file.h"
#include "io/writable.h"
#include "stage/solution.h"
#include "steps/simulated.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

constexpr double kMostNumbers = 1e8;  // in a table of recordings: 2 GB of text

// The file for the recordings, or for the responses. A file of responses that an earlier run did
// not write is not overwritten.
fs::path target_of(const study::Study& study, show::Run& run) {
  if (study.experiment->leaves_time) return run / steps::kRecordingsFile;
  const bool stated = study.measurement && !study.measurement->frf.empty();
  const fs::path file = stated ? study.measurement->frf : run / "measured.csv";
  if (!stated || !fs::exists(file)) return file;
  std::string own;
  if (fs::exists(run / "simulated.json")) {
    try {
      own = io::parse_json(read_whole(run / "simulated.json")).at("sha256").string();
    } catch (const InvalidInput&) {
      own.clear();  // not ours, or from another version
    }
  }
  require(own == sha256(read_whole(file)),
          "measurement.frf: " + file.string() +
              " exists and is not what `simulate` left there before; it may be measured: move it "
              "away, or name another file");
  return file;
}

// Refuses names that the file cannot hold before anything is solved.
void refuse_names(const study::Study& study, const fs::path& file) {
  if (study.sensors.empty() || study.actuators.empty()) return;
  recordings::TimeData data;
  for (const auto& sensor : study.sensors) data.outputs.emplace_back().name = sensor.name;
  for (const auto& actuator : study.actuators) data.inputs.emplace_back().name = actuator.name;
  if (study.experiment->leaves_time) {
    io::require_writable_time(file, std::move(data));
  } else {
    io::require_writable_frf(file, data.outputs, data.inputs);
  }
}

void refuse_too_much(const study::Study& study) {
  const auto& plan = *study.experiment;
  const double numbers = static_cast<double>(study.actuators.size()) * plan.realisations *
                         plan.periods * plan.samples *
                         static_cast<double>(study.sensors.size() + 2 * study.actuators.size());
  require(
      !plan.leaves_time || numbers < kMostNumbers,
      fmt::format("experiment.leaves: the recordings are {:.3g} numbers; expected at most {:.3g}"
                  ": fewer realisations, periods or samples",
                  numbers, kMostNumbers));
}

io::JsonObject content_of(const study::Study& study, const steps::Bench& bench,
                          const steps::Simulated& found, const fs::path& file) {
  const auto& plan = *study.experiment;
  const auto& estimate = found.estimate;
  io::JsonArray notes;
  for (const auto& note : bench.notes) notes.emplace_back(note);
  for (const auto& note : estimate.notes) notes.emplace_back(note);
  const auto& rig = bench.rig;
  return {
      {"file", file.filename().string()},
      {"sha256", sha256(read_whole(file))},
      {"structure", plan.structure},
      {"modes", static_cast<long long>(bench.modes)},
      {"sample_rate_hz", plan.sample_rate_hz},
      {"samples", static_cast<long long>(bench.plan.multisine.period)},
      {"periods", plan.periods},
      {"realisations", static_cast<long long>(estimate.realisations)},
      {"inputs", plan.inputs},
      {"lines", plan.lines},
      {"amplitude_n", plan.amplitude},
      {"crest_factor", found.crest_factor},
      {"sensor_noise", io::Json(rig.sensor_noise)},
      {"delay", io::JsonObject{{"hardware_s", rig.delay_s},
                               {"hold_s", 0.5 * rig.sample_time_s},
                               {"from_phase_s", found.phase_delay_s},
                               {"from_phase_std_s", found.phase_delay_std_s},
                               {"compensated", plan.compensate}}},
      {"transient", io::JsonObject{{"seen", estimate.transient.seen},
                                   {"decay_per_period", estimate.transient.decay},
                                   {"periods_dropped", static_cast<long long>(estimate.dropped)},
                                   {"left_over_deviation", estimate.transient.remaining}}},
      {"line_count", static_cast<long long>(estimate.set.line_count())},
      {"averages", estimate.set.averages},
      {"notes", notes}};
}

std::string told(const study::Study& study, const steps::Bench& bench,
                 const steps::Simulated& found, const fs::path& file) {
  const auto& set = found.estimate.set;
  const auto& plan = *study.experiment;
  std::string text = fmt::format(
      "{} realisations of {} periods, {} sensors x {} actuators, {} lines {:.6g} to {:.6g} Hz\n"
      "crest factor {:.2f}, {} of {} periods dropped\n",
      found.estimate.realisations, plan.periods, set.outputs.size(), set.inputs.size(),
      set.line_count(), set.frequency_hz(0), set.frequency_hz.tail(1)(0), found.crest_factor,
      found.estimate.dropped, plan.periods);
  for (const auto& note : bench.notes) text += "note: " + note + "\n";
  for (const auto& note : found.estimate.notes) text += "note: " + note + "\n";
  return text + "left in " + file.string() + "\n";
}

void run_simulate(const study::Study& study, show::Run& run) {
  require(study.experiment.has_value(),
          "the study has no [experiment]; expected one, such as [experiment] noise = \"2 nm\"");
  const auto file = target_of(study, run);
  refuse_names(study, file);
  refuse_too_much(study);
  const steps::Bench bench = steps::bench_of(study, run);
  const steps::Simulated found =
      run.timed("experiment", [&] { return steps::simulated(study, bench, run); });
  const auto lost = study.experiment->leaves_time ? io::write_time(file, found.recordings)
                                                  : io::write_frf(file, found.estimate.set);
  for (const auto& what : lost) run.note(what);
  run.show(told(study, bench, found, file));
  run.leave("simulated.json", content_of(study, bench, found, file), true);
}

}  // namespace

constinit const Command simulate_command{
    .name = "simulate",
    .summary = "a virtual experiment: responses as a laboratory would measure them",
    .run = run_simulate,
};

}  // namespace chladni::app
