#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/percent.h"
#include "show/compared.h"
#include "show/comparison.h"
#include "show/figures/stored_curves.h"

namespace chladni::show {
namespace {

constexpr Eigen::Index kFewColumns = 10;

Eigen::VectorXd column(const std::vector<diagnosis::ModeTold>& modes,
                       double diagnosis::ModeTold::*value) {
  Eigen::VectorXd values(std::ssize(modes));
  std::ranges::transform(modes, values.begin(), [&](const auto& mode) { return mode.*value; });
  return values;
}

// The error of each response: a row per sensor, a column per actuator.
std::string errors_text(const diagnosis::ResponseComparison& r, bool all) {
  if (r.error.size() < 2 || (!all && r.error.cols() > kFewColumns)) return "";
  std::string text = fmt::format("\n{:>16}", "error of");
  for (const auto& input : r.inputs) text += fmt::format(" {:>10}", input);
  for (Eigen::Index i = 0; i < r.error.rows(); ++i) {
    text += fmt::format("\n{:>16}", r.outputs[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < r.error.cols(); ++j) {
      const double error = r.error(i, j);
      text += fmt::format(" {:>10}", std::isfinite(error) ? percent(error) : "-");
    }
  }
  return text + "\n";
}

}  // namespace

io::ResultTable modes_beside_table(const std::vector<diagnosis::ModeTold>& modes) {
  const auto measured = column(modes, &diagnosis::ModeTold::measured_hz);
  const auto simulated = column(modes, &diagnosis::ModeTold::before_hz);
  const Eigen::VectorXd change = measured.array() / simulated.array() - 1.0;
  return {"Measured and simulated modes",
          {io::number_column("simulated", "Hz", simulated, {"{:.3f}"}, 13, "simulated_hz"),
           io::number_column("measured", "Hz", measured, {"{:.3f}"}, 13, "measured_hz"),
           io::number_column("difference", "%", change, {"{:+.3f}", 100.0}, 12, "change"),
           io::number_column("MAC", "", column(modes, &diagnosis::ModeTold::mac_before), {"{:.3f}"},
                             8, "mac")}};
}

std::string compared_text(const steps::StudyComparison& one, bool all) {
  if (one.modes) return io::text(modes_beside_table(one.modes_beside));
  return comparison_table(one.comparison) + errors_text(one.comparison.responses, all);
}

io::JsonObject compared_json(const steps::StudyComparison& one) {
  if (one.modes) return {{"modes", io::json_rows(modes_beside_table(one.modes_beside))}};
  return comparison_json(one.comparison);
}

void leave_compared(const steps::StudyComparison& one, Run& run) {
  run.leave("comparison.json", compared_json(one), true);
  if (one.modes) {
    return;
  }
  run.paint("responses.png", [&](const auto& png) {
    draw_responses(png, one.measured.all, one.predictions.before);
  });
  leave_curves(run, "responses_curves.json", [&] {
    return compared_responses(one.measured.all, one.predictions.before, {}, {}, kStoredCurvesBytes);
  });
  run.paint("errors.png", [&](const auto& png) { draw_errors(png, one.comparison); });
  run.paint("mac.png", [&](const auto& png) { draw_mac(png, one.comparison); });
}

}  // namespace chladni::show
