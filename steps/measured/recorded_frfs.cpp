#include "steps/measured/recorded_frfs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/turn.h"
#include "identification/delay.h"
#include "io/recordings_file.h"
#include "recordings/closed_loop.h"
#include "recordings/frf_estimate.h"
#include "recordings/hammer.h"
#include "recordings/recordings.h"

namespace chladni::steps {
namespace {

using recordings::TimeData;

// With what a study says of its channels.
io::TimeOptions with_channels(const study::Study& study, io::TimeOptions options) {
  options.sensor_names = study::names_of(study.sensors);
  options.actuator_names = study::names_of(study.actuators);
  if (study.identification) options.unit = study.identification->unit;
  return options;
}

void require_sides(const study::MeasurementPlan& plan, const TimeData& head) {
  const auto missing = recordings::missing_side(head);
  require(missing.empty(), plan.time.string() + ": " + missing +
                               "; name the channels as the study names its sensors and actuators");
}

void refuse_losses(const study::MeasurementPlan& plan, const recordings::RecordingFaults& faults) {
  if (faults.lost.empty()) return;
  std::string text = plan.time.string() + ": " + faults.lost.front();
  if (faults.lost.size() > 1) {
    text += fmt::format("; and {} records more", faults.lost.size() - 1);
  }
  throw InvalidInput(text + "; expected recordings in which every period is whole");
}

void estimate_blows(const study::MeasurementPlan& plan, const recordings::Recordings& data,
                    std::vector<std::string>& notes, RecordedFrfs& result) {
  const auto& how = plan.recording;
  auto hits = recordings::hammer_estimate(
      data, {.force_window_s = how.force_window, .exponential_s = how.exponential_window});
  notes = std::move(hits.notes);
  result.set = how.hammer == "h2" ? std::move(hits.h2) : std::move(hits.h1);
  result.added_decay = hits.added_decay;
  auto& done = result.quality->done;
  done.push_back(fmt::format("{} blows, {}", data.records.size(),
                             how.hammer == "h2" ? "H2: noise of the force does not shift it"
                                                : "H1: noise of the sensors does not shift it"));
  if (how.force_window > 0.0) {
    done.push_back(fmt::format("force window of {:.4g} ms", 1e3 * how.force_window));
  }
  if (how.exponential_window > 0.0) {
    done.push_back(fmt::format(
        "exponential window of {:.4g} s; its decay of {:.4g} rad/s is taken off the modes",
        how.exponential_window, hits.added_decay));
  }
}

// Refuses records that are estimated as a whole and are too long for it: samples, spectra and sums.
void require_room_for_blows(const study::MeasurementPlan& plan, const recordings::Recordings& data,
                            std::size_t limit) {
  constexpr double per_sample = 32.0, per_response = 44.0;  // bytes, of each output
  Eigen::Index longest = 0;
  for (const auto& record : data.records) longest = std::max(longest, record.samples);
  const auto outputs = static_cast<double>(data.head.outputs.size());
  const auto inputs = static_cast<double>(data.head.inputs.size());
  io::require_room(
      static_cast<double>(longest) * outputs * (per_sample + per_response * inputs), limit,
      fmt::format("{}: {} samples of one recording without a period, which is taken as a whole, "
                  "of {} outputs and {} inputs",
                  plan.time.string(), longest, data.head.outputs.size(), data.head.inputs.size()));
}

// Part of a force that a hold takes away: 1 − sin x / x, x = ωT/2.
double hold_loss(double hz, double sample_time_s) {
  const double x = 0.5 * kTwoPi * hz * sample_time_s;
  return 1.0 - std::sin(x) / x;
}

// Takes off what the hold of commands does to the responses.
void take_off_hold(double sample_time_s, RecordedFrfs& result) {
  const auto free = [&](modal::FrfSet& set) {
    set = identification::without_delay(set, 0.0, sample_time_s);
  };
  free(result.set);
  for (auto& fold : result.folds.folds) {
    free(fold.rest);
    free(fold.left_out);
  }
  result.quality->done.push_back(
      fmt::format("the hold of the commands is taken off: half a sample, and {:.2g} % at {:.4g} Hz",
                  100.0 * hold_loss(result.set.frequency_hz.tail(1)(0), sample_time_s),
                  result.set.frequency_hz.tail(1)(0)));
}

// The estimate of all recordings, and where they are wanted those of their parts.
recordings::FrfEstimate estimate_of(const TimeData& data,
                                    const recordings::FrfEstimateOptions& options, bool with_folds,
                                    RecordedFrfs& result) {
  using namespace recordings;
  const identification::Estimator estimator = [&](const Spectra& spectra,
                                                  const FrfEstimateOptions& how) {
    return data.references.empty() ? frf_estimate(spectra, how)
                                   : closed_loop_estimate(spectra, how).estimate;
  };
  TransientReport about;
  const auto [all, own] = prepared(data, options, about);
  auto estimate = estimator(all, own);
  if (options.remove_transient) tell_removed(data, about, estimate);
  if (!with_folds) return estimate;
  const auto none = [&](const std::exception& failure) {  // the estimate of all is sound
    estimate.notes.push_back(std::string("nothing is left out in turn: ") + failure.what());
  };
  try {
    result.folds = identification::folds(data, all, options, estimate.dropped, estimator);
  } catch (const InvalidInput& failure) {
    none(failure);
  } catch (const NumericalFailure& failure) {
    none(failure);
  }
  return estimate;
}

// Estimate, silent lines and trends of recordings that are in memory.
recordings::PeriodicEstimate periodic_estimate(const TimeData& data,
                                               const recordings::FrfEstimateOptions& options,
                                               bool with_folds, RecordedFrfs& result) {
  recordings::PeriodicEstimate found{
      .estimate = estimate_of(data, options, with_folds, result), .detection = {}, .drift = {}};
  const auto all = recordings::spectra(data);
  const auto drop = recordings::first_steady_period(found.estimate);
  found.detection = recordings::detection_levels(all, drop);
  found.drift = recordings::period_drift(recordings::excited_part(all, {}), drop);
  return found;
}

// @param samples  of the first record
recordings::FrfEstimateOptions periodic_options(const study::MeasurementPlan& plan,
                                                Eigen::Index samples, Eigen::Index period) {
  const auto& how = plan.recording;
  require(how.force_window == 0.0 && how.exponential_window == 0.0 && how.hammer == "h1",
          plan.time.string() +
              ": windows and h2 are for blows of a hammer, and these recordings "
              "are periodic; expected neither");
  recordings::FrfEstimateOptions options;
  options.remove_transient = how.transient == "remove" && samples >= 2 * period;
  return options;
}

void take(const study::MeasurementPlan& plan, double sample_time_s,
          recordings::PeriodicEstimate found, bool removed, std::vector<std::string>& notes,
          RecordedFrfs& result) {
  auto& [estimate, detection, drift] = found;
  notes = std::move(estimate.notes);
  result.set = std::move(estimate.set);
  auto& quality = *result.quality;
  quality.done.push_back(fmt::format("{} realisations of {} periods, {} dropped{}",
                                     estimate.realisations, estimate.periods + estimate.dropped,
                                     estimate.dropped,
                                     removed ? "; the transient of the start is taken off" : ""));
  if (plan.recording.inputs == "commands") take_off_hold(sample_time_s, result);
  quality.detection = std::move(detection);
  quality.drift = std::move(drift);
}

void estimate_periods(const study::MeasurementPlan& plan, const TimeData& data, bool with_folds,
                      std::vector<std::string>& notes, RecordedFrfs& result) {
  const auto options = periodic_options(plan, data.records.front().outputs.rows(), data.period);
  take(plan, data.sample_time_s, periodic_estimate(data, options, with_folds, result),
       options.remove_transient, notes, result);
}

std::string verdict_of(const RecordedFrfs& result) {
  const auto& quality = *result.quality;
  std::string text = recordings::trusted_bands(result.set, quality.bands);
  if (!quality.faults.clipped.empty()) text += "; clipped: " + quality.faults.clipped.front();
  return text;
}

}  // namespace

io::TimeOptions recording_options(const study::Study& study, const std::filesystem::path& path,
                                  const stage::Work& work) {
  const auto& plan = *study.measurement;
  io::TimeOptions options;
  if (const auto stated = work.choices().memory_limit_bytes; stated > 0) {
    options.limit_bytes = std::min(options.limit_bytes, stated / 2);
  }
  if (path == plan.time) options.period = plan.recording.period;
  options.blows_in_pieces = true;
  if (plan.recording.sample_rate_hz > 0.0) {
    options.sample_time_s = 1.0 / plan.recording.sample_rate_hz;
  }
  return options;
}

io::TimeFile read_recordings(const study::Study& study, const std::filesystem::path& path,
                             io::TimeOptions options, stage::Work& work) {
  auto file = io::read_time(path, with_channels(study, std::move(options)));
  for (const auto& note : file.notes) work.note(path.string() + ": " + note);
  return file;
}

namespace {

void look_for_faults(const study::MeasurementPlan& plan, recordings::RecordingFaults faults,
                     stage::Work& work, RecordedFrfs& result) {
  result.quality.emplace();
  result.quality->faults = std::move(faults);
  refuse_losses(plan, result.quality->faults);
  for (const auto& fault : result.quality->faults.clipped) {
    work.warn(plan.time.string() + ": " + fault);
  }
}

// How good the responses are.
void judge(const study::MeasurementPlan& plan, const std::vector<std::string>& notes,
           stage::Work& work, RecordedFrfs& result) {
  auto& quality = *result.quality;
  for (const auto& note : notes) work.note(plan.time.string() + ": " + note);
  for (const auto& input : result.set.inputs) {
    for (const auto& output : result.set.outputs) {
      quality.responses.push_back(output.name + "/" + input.name);
    }
  }
  for (const auto& output : result.set.outputs) quality.outputs.push_back(output.name);
  quality.bands = recordings::band_qualities(result.set);
  quality.verdict = verdict_of(result);
  for (const auto& drift : quality.drift) {
    work.warn(
        fmt::format("{}: {} changes by {:.2g} % from the first to the last period, {:.0f} "
                    "deviations more than noise",
                    plan.time.string(), quality.outputs[static_cast<std::size_t>(drift.output)],
                    100.0 * drift.relative, drift.excess));
  }
}

// The responses of a file that is larger than the memory: period by period.
RecordedFrfs recorded_in_pieces(const study::Study& study, const io::TimeOptions& options,
                                bool with_folds, stage::Work& work) {
  const auto& plan = *study.measurement;
  const std::string file = plan.time.string();
  work.note(file + ": it is read in pieces, since as a whole it may not fit the memory");
  const auto pieces = io::read_in_pieces(plan.time, with_channels(study, options));
  for (const auto& note : pieces.notes) work.note(file + ": " + note);
  const auto& data = pieces.data;
  require_sides(plan, data.head);
  RecordedFrfs result;
  look_for_faults(plan, recordings::recording_faults(data), work, result);
  std::vector<std::string> notes;
  if (data.head.period == 0) {
    require_room_for_blows(plan, data, options.limit_bytes);
    estimate_blows(plan, data, notes, result);
    judge(plan, notes, work, result);
    return result;
  }
  const auto how = periodic_options(plan, data.records.front().samples, data.head.period);
  take(plan, data.head.sample_time_s, recordings::periodic_estimate(data, how),
       how.remove_transient, notes, result);
  if (with_folds) notes.emplace_back("no part of it is left out in turn: that needs all of it");
  judge(plan, notes, work, result);
  return result;
}

}  // namespace

RecordedFrfs recorded_frfs(const study::Study& study, stage::Work& work, bool with_folds) {
  const auto& plan = *study.measurement;
  const auto options = recording_options(study, plan.time, work);
  if (io::is_read_in_pieces(plan.time, options)) {
    return recorded_in_pieces(study, options, with_folds, work);
  }
  const auto data = read_recordings(study, plan.time, options, work).data;
  require_sides(plan, data);
  RecordedFrfs result;
  look_for_faults(plan, recordings::recording_faults(data), work, result);
  std::vector<std::string> notes;
  if (data.period == 0) {
    estimate_blows(plan, recordings::recordings_of(data), notes, result);
  } else {
    estimate_periods(plan, data, with_folds, notes, result);
  }
  judge(plan, notes, work, result);
  return result;
}

}  // namespace chladni::steps
