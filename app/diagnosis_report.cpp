// The diagnosis as a section of the report.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "app/detectable_text.h"
#include "app/diagnosis.h"
#include "app/percent.h"
#include "io/report_sections.h"

namespace chladni::app {
namespace {

io::Table causes_table(const Diagnosed& one) {
  io::Table table{
      "Causes", {{"cause", false}, {"probability"}, {"ln evidence"}, {"of the misfit [%]"}}, {}};
  for (const auto& cause : one.result.best.causes) {
    table.rows.push_back(
        {{cause_text(cause), fmt::format("{:.3f}", cause.probability),
          fmt::format("{:.1f}", cause.log_evidence_gain), percent_cell(cause.share)}});
  }
  return table;
}

io::Table gain_table(const Gain& gain) {
  io::Table table{"Relative error of the predicted responses [%]",
                  {{"", false}, {"before"}, {"after"}, {"noise"}},
                  {}};
  table.rows.push_back({{"seen by the fit", percent_cell(gain.fit_before),
                         percent_cell(gain.fit_after), percent_cell(gain.noise_floor)}});
  if (!gain.held_out.empty()) {
    table.rows.push_back({{fmt::format("held out: {}", fmt::join(gain.held_out, ", ")),
                           percent_cell(gain.held_out_before), percent_cell(gain.held_out_after),
                           percent_cell(gain.held_out_noise)}});
  }
  return table;
}

io::Table modes_table(const diagnosis::ModeComparison& modes) {
  io::Table table{"Simulated and measured modes",
                  {{"simulated [Hz]"}, {"measured [Hz]"}, {"+-"}, {"change [%]"}, {"MAC"}},
                  {}};
  for (const auto& pair : modes.pairs) {
    table.rows.push_back(
        {{fmt::format("{:.2f}", pair.simulated_hz), fmt::format("{:.3f}", pair.measured_hz),
          fmt::format("{:.2g}", pair.measured_std_hz), fmt::format("{:+.3f}", 100.0 * pair.change),
          fmt::format("{:.3f}", pair.mac)}});
  }
  return table;
}

void add_picture(io::Section& section, const Run& run, const char* file, const char* caption) {
  if (!run.options().pictures) return;
  const auto picture = io::picture_section("", run / file, caption);
  section.blocks.insert(section.blocks.end(), picture.blocks.begin(), picture.blocks.end());
}

}  // namespace

io::Section diagnosis_section(const Diagnosed& one, const Run& run) {
  io::Section section{"What the simulation gets wrong, and why", {}};
  const auto verdict = one.result.verdict;
  const bool settled =
      verdict == diagnosis::Verdict::named || verdict == diagnosis::Verdict::no_discrepancy;
  section.blocks.emplace_back(
      io::Note{settled ? io::Note::Tone::good : io::Note::Tone::warning, verdict_text(one.result)});
  if (!one.result.best.causes.empty()) section.blocks.emplace_back(causes_table(one));
  if (!one.result.measure_next.empty()) {
    section.blocks.emplace_back(
        io::Note{io::Note::Tone::plain, "Measure next: " + one.result.measure_next + "."});
  }
  if (one.result.map.explained.size() > 0) {
    add_picture(section, run, "cause_map.png",
                "How much of the difference one thing in one place would explain.");
  }
  section.blocks.emplace_back(gain_table(one.gain));
  add_picture(section, run, "prediction.png",
              "Measured responses, the simulation, and the simulation with the cause.");
  if (!one.comparison.modes.pairs.empty()) {
    section.blocks.emplace_back(modes_table(one.comparison.modes));
  }
  if (auto sentence = detectable_sentence(one.detectable); !sentence.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, std::move(sentence)});
    section.blocks.emplace_back(detectable_sizes(one.detectable));
  }
  for (const auto& breach : one.result.breaches) {
    section.blocks.emplace_back(
        io::Note{io::Note::Tone::warning, "Beyond its tolerance: " + breach + "."});
  }
  return section;
}

}  // namespace chladni::app
