// experiment.json, experiment.png and the signals of a designed experiment.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/atomic_file.h"
#include "host/folder.h"
#include "io/csv.h"
#include "io/plot.h"
#include "io/time_file.h"
#include "io/wav.h"
#include "show/experiment.h"
#include "show/experiment/experiment_words.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;
using identification::ExperimentDesign;

constexpr double kMostNumbers = 2e7;  // in excitation.csv: 400 MB

io::Json modes_json(const steps::DesignedExperiment& designed) {
  io::JsonArray array;
  for (const auto& mode : designed.modes()) {
    array.push_back(
        io::JsonObject{{"mode", static_cast<long long>(mode.mode - designed.rigid_count + 1)},
                       {"frequency_hz", mode.frequency_hz},
                       {"damping_ratio", mode.damping_ratio},
                       {"frequency_std_hz", mode.frequency_std_hz},
                       {"damping_std", mode.damping_std * mode.damping_ratio},
                       {"needed_s", mode.seconds_needed},
                       {"reached", mode.reached},
                       {"drive", mode.drive},
                       {"sight", mode.sight},
                       {"why", mode.why}});
  }
  return array;
}

io::Json coherence_json(const study::Study& study, const steps::DesignedExperiment& designed) {
  io::JsonArray array;
  const auto& all = designed.multisine ? designed.multisine->coherence : designed.hammer->coherence;
  for (const auto& one : all) {
    array.push_back(io::JsonObject{{"response", response_words(study, designed, one)},
                                   {"median", one.median},
                                   {"lowest", one.lowest},
                                   {"lowest_hz", one.lowest_hz}});
  }
  return array;
}

io::Json forces_json(const study::Study& study, const ExperimentDesign& design) {
  io::JsonArray array;
  const auto p = std::ssize(study.sensors);
  for (std::size_t j = 0; j < design.forces.size(); ++j) {
    const auto& force = design.forces[j];
    array.push_back(io::JsonObject{{"actuator", study.actuators[j].name},
                                   {"rms_n", force.rms_n},
                                   {"peak_n", force.peak_n},
                                   {"stroke_m", design.stroke_m(p + static_cast<Eigen::Index>(j))},
                                   {"limited_by", limit_word(study, force)}});
  }
  return array;
}

io::Json strokes_json(const study::Study& study, const ExperimentDesign& design) {
  io::JsonArray array;
  for (std::size_t i = 0; i < study.sensors.size(); ++i) {
    array.push_back(io::JsonObject{{"sensor", study.sensors[i].name},
                                   {"stroke_m", design.stroke_m(static_cast<Eigen::Index>(i))}});
  }
  return array;
}

void add_multisine(const study::Study& study, const ExperimentDesign& design,
                   io::JsonObject& json) {
  const bool tried = design.low_crest_factor > 0.0;
  const double low_crest = tried ? design.low_crest_factor : std::nan("");
  json.insert(json.end(), {{"sample_rate_hz", study.experiment->sample_rate_hz},
                           {"samples", static_cast<long long>(design.period)},
                           {"period_s", design.period_s()},
                           {"settle_periods", static_cast<long long>(design.settle)},
                           {"periods", static_cast<long long>(design.periods)},
                           {"ramp_samples", static_cast<long long>(design.ramp)},
                           {"realisations", static_cast<long long>(design.realisations.size())},
                           {"experiments", static_cast<long long>(study.actuators.size())},
                           {"inputs", study.experiment->inputs},
                           {"phases", study.design->phases},
                           {"line_count", static_cast<long long>(design.line_hz.size())},
                           {"resolution_hz", design.spacing_hz},
                           {"crest_factor", design.crest_factor},
                           {"low_crest_factor", low_crest},
                           {"even_spectrum_needs_s", design.flat_seconds},
                           {"this_spectrum_needs_s", design.shaped_seconds},
                           {"forces", forces_json(study, design)},
                           {"sensors", strokes_json(study, design)}});
}

void add_hammer(const steps::DesignedExperiment& designed, io::JsonObject& json) {
  const auto& design = *designed.hammer;
  io::JsonArray points;
  for (Eigen::Index i = 0; i < designed.points.count(); ++i) {
    const auto triple = [](const Eigen::RowVector3d& v) {
      return io::JsonArray{v.x(), v.y(), v.z()};
    };
    points.push_back(io::JsonObject{{"at_m", triple(designed.points.position.row(i))},
                                    {"normal", triple(designed.points.normal.row(i))}});
  }
  json.insert(json.end(), {{"points", points},
                           {"hits", static_cast<long long>(design.hits)},
                           {"peak_n", design.peak_n},
                           {"pulse_s", design.pulse_s},
                           {"fall_db", design.fall_db},
                           {"samples", static_cast<long long>(design.samples)},
                           {"record_s", design.record_s},
                           {"force_window_s", design.force_window_s},
                           {"exponential_s", design.exponential_s}});
}

void draw_amplitudes(const study::Study& study, const steps::DesignedExperiment& designed,
                     const io::PictureFile& png) {
  const auto& design = *designed.multisine;
  io::PlotPanel panel;
  panel.title = "Force on each line; dashed: simulated modes";
  panel.x = {.label = "frequency [Hz]",
             .logarithmic = design.line_hz.tail(1)(0) > 20.0 * design.line_hz(0)};
  panel.y = {.label = "amplitude [N]", .logarithmic = true};
  for (Eigen::Index j = 0; j < design.amplitude.cols(); ++j) {
    panel.series.push_back({.name = study.actuators[static_cast<std::size_t>(j)].name,
                            .x = design.line_hz,
                            .y = design.amplitude.col(j),
                            .upper = {},
                            .style = io::PlotSeries::Style::line,
                            .colour = 1 + static_cast<int>(j % 5),
                            .width = 1.2});
  }
  for (const auto& mode : designed.modes()) panel.verticals.push_back(mode.frequency_hz);
  io::draw_plot(png, {.title = study.title, .panels = {panel}, .columns = 1, .aspect = 0.5});
}

bool has(const study::Study& study, const std::string& format) {
  return std::ranges::find(study.design->files, format) != study.design->files.end();
}

// Signals of earlier runs, which may have had more realisations.
void remove_old_signals(const Run& run) {
  for (const auto* name : {"excitation.csv", "excitation.mat", "hammer_points.csv"}) {
    fs::remove(run / name);
  }
  for (const auto& file : entries_of(run / ".")) {
    const auto name = file.filename().string();
    if (name.starts_with("excitation_r") && name.ends_with(".wav")) fs::remove(file);
  }
}

double full_scale(const study::Study& study, const ExperimentDesign& design) {
  double largest = 0.0;
  for (const auto& force : design.forces) largest = std::max(largest, force.peak_n);
  return steps::command_per_newton(study) * largest;
}

std::string wav_name(std::size_t realisation, std::size_t experiment) {
  return fmt::format("excitation_r{}_e{}.wav", realisation + 1, experiment + 1);
}

// WAV files have sample rates in whole Hz.
bool leaves_wav(const study::Study& study) {
  const double rate = study.experiment->sample_rate_hz;
  return has(study, "wav") && rate == std::floor(rate);
}

double numbers_in_csv(const study::Study& study, const ExperimentDesign& design) {
  std::size_t records = 0;
  for (const auto& one : design.realisations) records += one.inputs.size();
  return static_cast<double>(design.period) * static_cast<double>(records * study.actuators.size());
}

bool leaves_csv(const study::Study& study, const ExperimentDesign& design) {
  return has(study, "csv") && numbers_in_csv(study, design) <= kMostNumbers;
}

io::JsonArray signal_files(const study::Study& study, const ExperimentDesign& design) {
  io::JsonArray files;
  for (std::size_t r = 0; leaves_wav(study) && r < design.realisations.size(); ++r) {
    for (std::size_t e = 0; e < design.realisations[r].inputs.size(); ++e) {
      files.emplace_back(wav_name(r, e));
    }
  }
  if (leaves_csv(study, design)) files.emplace_back("excitation.csv");
  if (has(study, "mat")) files.emplace_back("excitation.mat");
  return files;
}

// The whole sequences, one file per experiment and realisation, all with one factor.
void write_wavs(const study::Study& study, const ExperimentDesign& design, Run& run) {
  const double rate = study.experiment->sample_rate_hz;
  const double full = full_scale(study, design);
  std::size_t files = 0;
  for (std::size_t r = 0; r < design.realisations.size(); ++r) {
    for (std::size_t e = 0; e < design.realisations[r].inputs.size(); ++e, ++files) {
      io::write_wav(run / wav_name(r, e), steps::sequence_of(study, design, r, e), rate,
                    full * (1.0 + 1e-12));
    }
  }
  run.show(
      fmt::format("WAV: full scale is {:.6g} {}; {} files with {} channels each, settling, "
                  "recorded periods and fades included\n",
                  full, steps::command_unit(study), files, study.actuators.size()));
}

void write_signals(const study::Study& study, const ExperimentDesign& design, Run& run) {
  const auto data = steps::excitation_of(study, design);
  if (leaves_wav(study)) {
    write_wavs(study, design, run);
  } else if (has(study, "wav")) {
    run.note(fmt::format("no WAV files: they have sample rates in whole Hz, and this is {:.9g} Hz",
                         study.experiment->sample_rate_hz));
  }
  if (leaves_csv(study, design)) {
    (void)io::write_time(run / "excitation.csv", data);
  } else if (has(study, "csv")) {
    run.note(fmt::format("no excitation.csv: it would hold {:.3g} numbers; take the others",
                         numbers_in_csv(study, design)));
  }
  if (has(study, "mat")) (void)io::write_time(run / "excitation.mat", data);
}

void write_points(const steps::DesignedExperiment& designed, const fs::path& file) {
  const auto& points = designed.points;
  write_atomically(file, io::csv({{"x_m", Eigen::VectorXd(points.position.col(0))},
                                  {"y_m", Eigen::VectorXd(points.position.col(1))},
                                  {"z_m", Eigen::VectorXd(points.position.col(2))},
                                  {"normal_x", Eigen::VectorXd(points.normal.col(0))},
                                  {"normal_y", Eigen::VectorXd(points.normal.col(1))},
                                  {"normal_z", Eigen::VectorXd(points.normal.col(2))}}));
}

}  // namespace

io::JsonObject experiment_json(const study::Study& study,
                               const steps::DesignedExperiment& designed) {
  io::JsonObject json{{"verdict", experiment_verdict(study, designed)},
                      {"kind", study.design->kind},
                      {"duration_s", designed.duration_s()},
                      {"band_hz", io::JsonArray{designed.low_hz, designed.high_hz}},
                      {"modes", modes_json(designed)},
                      {"coherence", coherence_json(study, designed)}};
  if (designed.multisine) {
    const auto& design = *designed.multisine;
    add_multisine(study, design, json);
    if (leaves_wav(study)) json.emplace_back("wav_full_scale", full_scale(study, design));
    json.emplace_back("unit", steps::command_unit(study));
    json.emplace_back("files", signal_files(study, design));
  } else {
    add_hammer(designed, json);
    json.emplace_back("files", io::JsonArray{"hammer_points.csv"});
  }
  json.emplace_back("notes", io::Json::texts(notes_of(designed)));
  return json;
}

void leave_experiment(const study::Study& study, const steps::DesignedExperiment& designed,
                      Run& run) {
  remove_old_signals(run);
  if (designed.multisine) {
    write_signals(study, *designed.multisine, run);
    run.paint("experiment.png", [&](const auto& png) { draw_amplitudes(study, designed, png); });
  } else {
    write_points(designed, run / "hammer_points.csv");
  }
  run.leave("experiment.json", experiment_json(study, designed), true);
}

}  // namespace chladni::show
