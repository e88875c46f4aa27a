#include "show/diagnosis/left_told.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/percent.h"
#include "diagnosis/compare.h"
#include "show/comparison.h"

namespace chladni::show {
namespace {

using diagnosis::ResponseComparison;
using Eigen::Index;

// What was seen beside the responses with the causes.
ResponseComparison compared_after(const steps::Diagnosed& one) {
  const auto& all = one.measured.all.frequency_hz;
  const auto& after = with_the_causes(one);
  std::vector<Eigen::MatrixXcd> seen;
  for (const double hz : one.seen.frequency_hz) {
    const auto line = static_cast<std::size_t>(std::ranges::lower_bound(all, hz) - all.begin());
    require(line < after.size() && all[line] == hz, "a line of the fit was not measured");
    seen.emplace_back(after[line](one.measured.outputs, one.measured.inputs));
  }
  return diagnosis::compared(one.seen, seen);
}

// Mean over the responses where it is known.
double mean_known(const Eigen::MatrixXd& values) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : values.reshaped()) {
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1.0;
  }
  return sum / count;
}

// Whether causes of responses, not those of modes, left a misfit of responses.
bool has_misfit(const steps::Diagnosed& one) {
  return !steps::is_of_modes(one) && !one.result.best.causes.empty();
}

}  // namespace

const std::vector<Eigen::MatrixXcd>& with_the_causes(const steps::Diagnosed& one) {
  return one.predictions.fitted.empty() ? one.predictions.extended : one.predictions.fitted;
}

io::JsonObject misfit_json(const diagnosis::Residue& residue, double excess) {
  return {{"excess", excess},
          {"chi_square_per_sensor", io::Json(residue.per_output)},
          {"chi_square_per_actuator", io::Json(residue.per_input)},
          {"chi_square_band_edges_hz", io::Json(residue.band_edges_hz)},
          {"chi_square_per_band", io::Json(residue.per_band)},
          {"misfit_lag_one", residue.lag_one}};
}

io::Json left_json(const steps::Diagnosed& one) {
  io::JsonObject json;
  if (has_misfit(one)) {
    json.emplace_back("misfit", misfit_json(one.result.after, one.result.best.excess));
  }
  if (!with_the_causes(one).empty()) {
    const auto after = compared_after(one);
    json.emplace_back("relative_error", after.overall_error);
    json.emplace_back("noise_floor", after.overall_noise);
    json.emplace_back("per_channel", per_channel_json(after));
  }
  return json.empty() ? io::Json() : io::Json(std::move(json));
}

std::string left_line(const steps::Diagnosed& one) {
  if (with_the_causes(one).empty()) return "";
  const auto after = compared_after(one);
  Index row = 0;
  Index col = 0;
  const double most =
      after.error.unaryExpr([](double error) { return std::isfinite(error) ? error : -1.0; })
          .maxCoeff(&row, &col);
  if (most < 0.0) return "";
  std::string text = fmt::format("left with the causes: most in {} by {}, {} of its size, noise {}",
                                 after.outputs[static_cast<std::size_t>(row)],
                                 after.inputs[static_cast<std::size_t>(col)],
                                 percent(after.error(row, col)), percent(after.noise(row, col)));
  const double lag = mean_known(after.lag_one);
  if (!std::isfinite(lag)) return text;
  return text + fmt::format(
                    "; errors of neighbouring lines correlate by {:.2f}, {:.2f} before "
                    "(0: noise alone, 1: errors of the model)",
                    lag, mean_known(one.comparison.responses.lag_one));
}

}  // namespace chladni::show
