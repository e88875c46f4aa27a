// The designed experiment as text: the verdict first.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "io/result_table.h"
#include "show/experiment.h"
#include "show/experiment/experiment_words.h"
#include "show/readable.h"

namespace chladni::show {
namespace {

constexpr double kWorthSaying = 1.5;

// "0.05 Hz and 5 % of damping"
std::string wanted_text(const study::ExcitationPlan& plan) {
  const auto damping = fmt::format("{:.3g} % of damping", 100.0 * plan.damping_deviation);
  if (!plan.frequency_deviation) return damping;
  return fmt::format("{:.3g} Hz and {}", *plan.frequency_deviation, damping);
}

// How much lower the forces could be for the wanted deviations in the same time.
double spare_force(const identification::ExperimentDesign& design) {
  double needed = 0.0;
  for (const auto& mode : design.modes) {
    if (mode.reached) needed = std::max(needed, mode.seconds_needed);
  }
  const auto experiments =
      static_cast<double>(design.realisations.size()) * static_cast<double>(design.forces.size());
  const double recorded = experiments * static_cast<double>(design.periods) * design.period_s();
  return needed > 0.0 ? std::sqrt(recorded / needed) : 1.0;
}

std::string multisine_text(const study::Study& study,
                           const identification::ExperimentDesign& design) {
  const auto experiments = study.actuators.size();
  std::string text = fmt::format(
      "{} of {}, {}, sampled at {:.6g} Hz\n"
      "each: {} of {:.4g} s to settle, the force rising over {:.3g} s; then {} recorded periods; "
      "then {:.3g} s to fade out\n"
      "{} samples a period, {} lines from {:.6g} to {:.6g} Hz, {:.4g} Hz apart; crest factor "
      "{:.2f}\n",
      how_many(std::ssize(design.realisations), "realisation"),
      how_many(static_cast<std::ptrdiff_t>(experiments), "experiment"),
      study.experiment->inputs == "orthogonal" ? "all actuators at once" : "one actuator at a time",
      study.experiment->sample_rate_hz,
      design.settle == 1 ? "one period" : fmt::format("{} periods", design.settle),
      design.period_s(), static_cast<double>(design.ramp) * design.sample_time_s, design.periods,
      static_cast<double>(design.ramp) * design.sample_time_s, design.period, design.line_hz.size(),
      design.line_hz(0), design.line_hz.tail(1)(0), design.spacing_hz, design.crest_factor);
  if (design.flat_seconds > 1.05 * design.shaped_seconds && design.shaped_seconds > 0.0) {
    text += fmt::format(
        "shaped by the simulated modes: an even spectrum needs {:.3g} times the "
        "recording\n",
        design.flat_seconds / design.shaped_seconds);
  }
  if (const double spare = spare_force(design); spare > kWorthSaying) {
    text += "forces " + two_digits(spare) + " times lower would still give what is wanted\n";
  }
  const bool by_force = std::ranges::any_of(
      design.forces, [](const auto& force) { return !force.limited_by_stroke; });
  if (design.low_crest_factor > 0.0 && by_force) {
    const double gain = std::pow(design.crest_factor / design.low_crest_factor, 2.0);
    text += fmt::format(
        "phases = \"low_crest\" would have a crest factor of {:.2f} and need {:.2g} "
        "times less recording; realisations then no longer average distortion\n",
        design.low_crest_factor, gain);
  }
  return text;
}

std::string forces_table(const study::Study& study,
                         const identification::ExperimentDesign& design) {
  const auto q = std::ssize(design.forces);
  const auto p = std::ssize(study.sensors);
  Eigen::VectorXd rms(q), peak(q), stroke(q);
  std::vector<std::string> names, limits;
  for (Eigen::Index j = 0; j < q; ++j) {
    const auto& force = design.forces[static_cast<std::size_t>(j)];
    names.push_back(study.actuators[static_cast<std::size_t>(j)].name);
    rms(j) = force.rms_n;
    peak(j) = force.peak_n;
    stroke(j) = design.stroke_m(p + j);
    limits.push_back(limit_word(study, force));
  }
  io::ResultTable table{"Forces", {}};
  table.columns = {io::word_column("actuator", names, 12),
                   io::number_column("rms", "N", rms, {"{:.4g}"}, 10),
                   io::number_column("peak", "N", peak, {"{:.4g}"}, 10),
                   io::number_column("moves", "um", stroke, {"{:.4g}", 1e6}, 10),
                   io::word_column("limited by", limits)};
  table.columns.front().gap = 0;
  return "\n" + io::text(table);
}

std::string hammer_text(const steps::DesignedExperiment& designed) {
  const auto& design = *designed.hammer;
  std::string text = fmt::format(
      "{} blows of {:.4g} N at each of {} points; a soft enough tip: a blow lasts {:.3g} ms (its "
      "spectrum falls by {:.3g} dB in the band)\n"
      "records of {} samples, {:.4g} s; force window of {:.3g} ms{}\n",
      design.hits, design.peak_n, design.points.size(), 1e3 * design.pulse_s, design.fall_db,
      design.samples, design.record_s, 1e3 * design.force_window_s,
      design.exponential_s > 0.0
          ? fmt::format(", exponential window of {:.4g} s", design.exponential_s)
          : ", no exponential window: the responses come to rest");
  io::ResultTable table{"Points to hit", {}};
  std::vector<std::string> number;
  for (std::size_t i = 0; i < design.points.size(); ++i) number.push_back(fmt::to_string(i + 1));
  table.columns = {io::word_column("point", number, 5)};
  table.columns.front().gap = 0;
  for (const int axis : {0, 1, 2}) {
    table.columns.push_back(io::number_column(
        std::string(1, "xyz"[axis]), "mm", designed.points.position.col(axis), {"{:.2f}", 1e3}, 9));
  }
  return text + "\n" + io::text(table);
}

std::string modes_table(const steps::DesignedExperiment& designed) {
  const auto& modes = designed.modes();
  const auto n = std::ssize(modes);
  Eigen::VectorXd hz(n), ratio(n), hz_std(n), ratio_std(n), minutes(n);
  std::vector<std::string> number, why;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& mode = modes[static_cast<std::size_t>(i)];
    number.push_back(
        fmt::format("{} (flex {})", mode.mode + 1, mode.mode - designed.rigid_count + 1));
    hz(i) = mode.frequency_hz;
    ratio(i) = mode.damping_ratio;
    hz_std(i) = mode.frequency_std_hz;
    ratio_std(i) = mode.damping_std;
    minutes(i) = mode.seconds_needed;
    why.push_back(mode.why);
  }
  io::ResultTable table{"Expected deviations", {}};
  table.columns = {io::word_column("mode", number, 12),
                   io::number_column("frequency", "Hz", hz, {"{:.2f}"}, 10),
                   io::number_column("damping", "%", ratio, {"{:.3g}", 100.0}, 8),
                   io::number_column("+- Hz", "", hz_std, {"{:.2g}"}, 9),
                   io::number_column("+- % of damping", "", ratio_std, {"{:.3g}", 100.0}, 15),
                   io::number_column("needs", "min", minutes, {"{:.3g}", 1.0 / 60.0}, 9),
                   io::word_column("", why)};
  table.columns.front().gap = 0;
  table.columns.front().is_number = true;
  return "\n" + io::text(table);
}

std::string coherence_table(const study::Study& study, const steps::DesignedExperiment& designed) {
  const auto& all = designed.multisine ? designed.multisine->coherence : designed.hammer->coherence;
  std::vector<std::string> responses;
  Eigen::VectorXd median(std::ssize(all)), lowest(std::ssize(all)), at(std::ssize(all));
  for (std::size_t i = 0; i < all.size(); ++i) {
    responses.push_back(response_words(study, designed, all[i]));
    median(static_cast<Eigen::Index>(i)) = all[i].median;
    lowest(static_cast<Eigen::Index>(i)) = all[i].lowest;
    at(static_cast<Eigen::Index>(i)) = all[i].lowest_hz;
  }
  io::ResultTable table{"Expected coherence", {}};
  table.columns = {io::word_column("response", responses, 20),
                   io::number_column("median", "", median, {"{:.4f}"}, 8),
                   io::number_column("lowest", "", lowest, {"{:.4f}"}, 8),
                   io::number_column("at", "Hz", at, {"{:.4g}"}, 8)};
  table.columns.front().gap = 0;
  return fmt::format("\nexpected coherence of {}\n",
                     designed.multisine ? "one period" : "one blow") +
         io::text(table);
}

}  // namespace

std::string response_words(const study::Study& study, const steps::DesignedExperiment& designed,
                           const identification::ExpectedCoherence& response) {
  const auto& sensor = study.sensors[static_cast<std::size_t>(response.output)].name;
  return designed.multisine
             ? sensor + "/" + study.actuators[static_cast<std::size_t>(response.input)].name
             : fmt::format("{}/point {}", sensor, response.input + 1);
}

std::string limit_word(const study::Study& study, const identification::Force& force) {
  if (force.limited_by_stroke) return "stroke";
  const auto& limits = *study.design;
  const bool by_voltage = limits.voltage && limits.force.value_or(1e300) > limits.force_limit();
  return by_voltage ? "voltage" : "force";
}

std::string experiment_verdict(const study::Study& study,
                               const steps::DesignedExperiment& designed) {
  const auto& modes = designed.modes();
  std::vector<std::string> missed;
  for (const auto& mode : modes) {
    if (mode.reached) continue;
    missed.push_back(fmt::format("mode {} (flex {}, {:.6g} Hz): {}", mode.mode + 1,
                                 mode.mode - designed.rigid_count + 1, mode.frequency_hz,
                                 mode.why));
  }
  const auto band = fmt::format("from {:.4g} to {:.4g} Hz", designed.low_hz, designed.high_hz);
  if (missed.size() == modes.size()) {
    return fmt::format("no mode {} can be known to {} within these limits: {}", band,
                       wanted_text(*study.design), fmt::join(missed, "; "));
  }
  const double minutes = designed.duration_s() / 60.0;
  return fmt::format("{} of measuring {} {}{} to {}{}",
                     minutes < 1.5 ? fmt::format("{:.0f} seconds", designed.duration_s())
                                   : fmt::format("{:.3g} minutes", minutes),
                     modes.size() == 1 ? "give the mode" : "give every mode", band,
                     modes.size() > 1 ? fmt::format(" (of {})", modes.size()) : "",
                     wanted_text(*study.design),
                     missed.empty() ? "" : fmt::format(", but {}", fmt::join(missed, "; ")));
}

std::string experiment_text(const study::Study& study, const steps::DesignedExperiment& designed) {
  std::string text = experiment_verdict(study, designed) + "\n\n";
  if (designed.multisine) {
    text += multisine_text(study, *designed.multisine) + forces_table(study, *designed.multisine);
  } else {
    text += hammer_text(designed);
  }
  text += modes_table(designed) + coherence_table(study, designed);
  for (const auto& note : notes_of(designed)) text += "note: " + note + "\n";
  return text;
}

std::vector<std::string> notes_of(const steps::DesignedExperiment& designed) {
  auto notes = designed.notes;
  const auto& own = designed.multisine ? designed.multisine->notes : designed.hammer->notes;
  notes.insert(notes.end(), own.begin(), own.end());
  return notes;
}

}  // namespace chladni::show
