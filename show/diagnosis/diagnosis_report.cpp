// The diagnosis as a section of the report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/percent.h"
#include "io/report_sections.h"
#include "show/comparison.h"
#include "show/diagnosis.h"
#include "show/diagnosis/constants_told.h"
#include "show/diagnosis/detectable_text.h"
#include "show/diagnosis/errors_told.h"
#include "show/diagnosis/gain_told.h"
#include "show/diagnosis/left_told.h"
#include "show/diagnosis/modes_told.h"
#include "show/readable.h"
#include "show/solution.h"
#include "steps/diagnosis.h"

namespace chladni::show {
namespace {

io::Table modes_table(const diagnosis::ModeComparison& modes) {
  io::Table table{"Simulated and measured modes",
                  {{"simulated [Hz]"},
                   {"measured [Hz]"},
                   {"+-"},
                   {"change [%]"},
                   {"MAC"},
                   {"paired by", false}},
                  {}};
  for (const auto& pair : modes.pairs) {
    table.rows.push_back(
        {{fmt::format("{:.2f}", pair.simulated_hz), fmt::format("{:.3f}", pair.measured_hz),
          deviation_text(pair.measured_std_hz), fmt::format("{:+.3f}", 100.0 * pair.change),
          fmt::format("{:.3f}", pair.mac), pair.by_shape ? "shape" : "frequency"}});
  }
  return table;
}

// A name at the front, as s1 or extended.toml, stays as it is.
std::string sentence(std::string line) {
  const auto word = line.substr(0, line.find_first_of(" :,"));
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  if (word.empty() || !std::ranges::all_of(word, is_letter)) return line + ".";
  line.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(line.front())));
  return line + ".";
}

void add_modes(io::Section& section, const diagnosis::ModeComparison& modes) {
  if (!modes.pairs.empty()) section.blocks.emplace_back(modes_table(modes));
  for (const auto& line : unpaired_lines(modes)) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, sentence(line)});
  }
}

void add_picture(io::Section& section, const Run* run, const char* file, const char* caption) {
  if (run == nullptr || !run->has_painted(file)) return;
  const auto picture = io::picture_section("", *run / file, caption);
  section.blocks.insert(section.blocks.end(), picture.blocks.begin(), picture.blocks.end());
}

void add_remarks(io::Section& section, const diagnosis::Diagnosis& result) {
  for (const auto& note : result.notes) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, sentence(note)});
  }
  for (const auto& breach : result.breaches) {
    section.blocks.emplace_back(
        io::Note{io::Note::Tone::warning, "Beyond its tolerance: " + breach + "."});
  }
}

void add_levels(io::Section& section, const diagnosis::Diagnosis& result) {
  if (auto levels = levels_sentence(result); !levels.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, std::move(levels)});
  }
}

void add_curves(io::Section& section, const steps::Diagnosed& one) {
  const auto& after = with_the_causes(one);
  auto curves =
      compared_responses(one.measured.all, one.predictions.before, after,
                         [&](Eigen::Index i, Eigen::Index j) { return is_fitted(one, i, j); });
  curves.caption =
      "Measured responses, the simulation, and the simulation with the cause. Drag "
      "over a range to zoom, double-click for all of it. " +
      curves.caption;
  section.blocks.emplace_back(std::move(curves));
}

// A matrix whose numbers are many is a picture, if there is one.
void add_matrix(io::Section& section, const Run* run, io::MatrixPicture matrix, const char* file,
                const char* caption) {
  constexpr Eigen::Index most_cells = 1600;
  if (matrix.value.size() == 0) return;
  if (matrix.value.size() > most_cells) return add_picture(section, run, file, caption);
  section.blocks.emplace_back(std::move(matrix));
}

void add_errors(io::Section& section, const steps::Diagnosed& one, const Run* run) {
  if (one.comparison.responses.error.size() < 2) return;
  add_matrix(section, run, errors_picture(one.comparison), "", "");
}

void add_mac(io::Section& section, const steps::Diagnosed& one, const Run* run) {
  add_matrix(section, run, mac_picture(one.comparison), "mac.png",
             "How much alike shapes are at the channels; repeated modes by themselves turn.");
}

// What only responses tell: the gain, their picture, their identified modes, what would be seen.
void add_responses(io::Section& section, const steps::Diagnosed& one, const Run* run) {
  section.blocks.emplace_back(io::report_table(gain_table(one)));
  for (auto line : gain_lines(one)) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::quiet, sentence(std::move(line))});
  }
  add_curves(section, one);
  add_picture(section, run, "errors_over_frequency.png",
              "Error of all responses together over frequency, before and after, above the band of "
              "noise and of the errors that a sound model has.");
  section.blocks.emplace_back(io::report_table(errors_table(one.errors)));
  add_errors(section, one, run);
  if (auto line = place_of_error(one); !line.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, sentence(std::move(line))});
  }
  if (!steps::is_of_modes(one) && !one.modes_compared.empty() && one.after) {
    section.blocks.emplace_back(io::report_table(modes_told_table(one.modes_compared, true)));
  }
  add_modes(section, one.comparison.modes);
  add_mac(section, one, run);
  if (auto sentence = detectable_sentence(one); !sentence.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, std::move(sentence)});
    section.blocks.emplace_back(detectable_sizes(one.detectable));
  }
}

}  // namespace

io::Section diagnosis_section(const steps::Diagnosed& one, const Run* run) {
  io::Section section{"What the simulation gets wrong, and why", {}};
  if (auto line = reference_line(one.result, one.reference_file); !line.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, sentence(std::move(line))});
  }
  add_levels(section, one.result);
  if (!one.result.best.causes.empty()) {
    section.blocks.emplace_back(io::report_table(causes_table(one.result)));
  }
  if (!one.result.constants.empty()) {
    section.blocks.emplace_back(constants_table(one.result));
  }
  if (one.result.map.explained.size() > 0) {
    add_picture(section, run, "cause_map.png",
                "How much of the difference one thing in one place would explain.");
  }
  if (one.modes) {
    section.blocks.emplace_back(
        io::report_table(modes_told_table(one.result.modes, changes_modes(one.result))));
  } else {
    add_responses(section, one, run);
  }
  add_remarks(section, one.result);
  if (one.extended) {
    section.blocks.emplace_back(
        io::Listing{"extended.toml: the study with the causes in it", one.extended->text});
  }
  return section;
}

}  // namespace chladni::show
