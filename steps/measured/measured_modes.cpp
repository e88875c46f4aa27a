#include "steps/measured_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "diagnosis/diagnosed_modes.h"
#include "io/scan.h"
#include "steps/measured/modes_of_files.h"

namespace chladni::steps {
namespace {

using diagnosis::MeasuredModes;
using Eigen::Index;

// Ascending modes above 0 Hz within the band of the diagnosis.
MeasuredModes within_band(const MeasuredModes& all, const study::Study& study, stage::Work& work) {
  const auto plan = study.diagnosis.value_or(study::DiagnosisPlan{});
  const double high = plan.high_hz > 0.0 ? plan.high_hz : std::numeric_limits<double>::infinity();
  std::vector<Index> kept;
  for (Index k = 0; k < all.count(); ++k) {
    const double hz = all.frequency_hz(k);
    const bool held_out =
        plan.hold_out_high_hz > 0.0 && hz >= plan.hold_out_low_hz && hz <= plan.hold_out_high_hz;
    if (hz > 0.0 && hz >= plan.low_hz && hz <= high && !held_out) kept.push_back(k);
  }
  const auto left_out = all.count() - static_cast<Index>(kept.size());
  const auto file = study.measurement->modes_file.string();
  require(!kept.empty(), file + ": no mode above 0 Hz within the band of the diagnosis");
  if (left_out > 0) {
    work.note(fmt::format("{}: {} of {} modes lie at 0 Hz or outside the band: left out", file,
                          left_out, all.count()));
  }
  std::ranges::stable_sort(
      kept, [&](Index a, Index b) { return all.frequency_hz(a) < all.frequency_hz(b); });
  return diagnosis::part(all, kept);
}

// Gives values without a deviation the study's noise.
void state_noise(const Eigen::MatrixXcd& shapes, double noise, Eigen::MatrixXd& deviation) {
  for (Index k = 0; k < shapes.cols(); ++k) {
    double squares = 0.0;
    Index count = 0;
    for (Index i = 0; i < shapes.rows(); ++i) {
      if (!std::isfinite(std::abs(shapes(i, k)))) continue;
      squares += std::norm(shapes(i, k));
      ++count;
    }
    const double rms = std::sqrt(squares / static_cast<double>(std::max<Index>(count, 1)));
    deviation.col(k) = (deviation.col(k).array() > 0.0).select(deviation.col(k), noise * rms);
  }
}

void drop(const std::vector<std::string>& hold_out, std::vector<std::string>& names,
          Eigen::MatrixXcd& shapes, Eigen::MatrixXd& deviation) {
  std::vector<Index> kept;
  std::vector<std::string> kept_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::find(hold_out, names[i]) != hold_out.end()) continue;
    kept.push_back(static_cast<Index>(i));
    kept_names.push_back(names[i]);
  }
  names = kept_names;
  shapes = Eigen::MatrixXcd(shapes(kept, Eigen::all));
  deviation = Eigen::MatrixXd(deviation(kept, Eigen::all));
}

MeasuredModes read(const study::Study& study, stage::Work& work) {
  const auto& path = study.measurement->modes_file;
  const auto ending = io::upper(path.extension().string());
  if (ending == ".CSV") return modes_of_table(study, work);
  if (ending == ".UFF" || ending == ".UNV" || ending == ".UF") return modes_of_uff(study, work);
  if (ending == ".JSON") return modes_of_identified(study);
  throw InvalidInput(path.string() +
                     ": modes are read from .csv, .uff, .unv and the identified.json of chladni "
                     "identify; expected one of these");
}

}  // namespace

bool has_modes(const study::MeasurementPlan& plan) { return !plan.modes_file.empty(); }

MeasuredModes modes_below(double highest_hz, const MeasuredModes& all, const study::Study& study,
                          stage::Work& work) {
  const auto& modes_file = study.measurement->modes_file;
  const auto file = (modes_file.empty() ? study.file : modes_file).string();  // empty: of responses
  require(all.count() > 0, file + ": no mode was measured");
  const auto count = (all.frequency_hz.array() <= highest_hz).count();
  require(count > 0, fmt::format("{}: the lowest mode lies at {:.6g} Hz; expected one below {:.6g} "
                                 "Hz, where the simulation's modes end",
                                 file, all.frequency_hz(0), highest_hz));
  if (count == all.count()) return all;
  work.note(
      fmt::format("{}: {} modes above {:.6g} Hz, where the simulation's modes end, are left out",
                  file, all.count() - count, highest_hz));
  std::vector<Index> kept(static_cast<std::size_t>(count));
  std::iota(kept.begin(), kept.end(), Index{0});
  return diagnosis::part(all, kept);
}

MeasuredModes measured_modes(const study::Study& study, stage::Work& work) {
  require(study.measurement && has_modes(*study.measurement),
          study.file.string() +
              ": no modes are measured; expected [measurement] with modes = \"modes.csv\"");
  const auto& plan = *study.measurement;
  const auto file = plan.modes_file.string();
  require(std::filesystem::exists(plan.modes_file),
          file + ": there is no such file" + study::source_text(plan));
  require(std::filesystem::is_regular_file(plan.modes_file),
          file + " is a folder; expected a file such as modes.csv");
  auto modes = within_band(read(study, work), study, work);
  drop(plan.hold_out, modes.outputs, modes.output_shapes, modes.output_std);
  drop(plan.hold_out, modes.inputs, modes.input_shapes, modes.input_std);
  state_noise(modes.output_shapes, plan.noise, modes.output_std);
  state_noise(modes.input_shapes, plan.noise, modes.input_std);
  diagnosis::check(modes);
  return modes;
}

std::optional<MeasuredModes> reference_modes(const study::Study& study, const MeasuredModes& later,
                                             stage::Work& work) {
  const auto& file = study.measurement->reference;
  if (file.empty()) return std::nullopt;
  auto earlier = study;
  earlier.measurement->modes_file = file;
  auto modes = measured_modes(earlier, work);
  try {
    diagnosis::check_reference(later, modes);
  } catch (const InvalidInput& e) {
    throw InvalidInput(fmt::format("{} and {}: {}", file.string(),
                                   study.measurement->modes_file.string(), e.what()));
  }
  return modes;
}

}  // namespace chladni::steps
