#include "diagnosis/measured_modes.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/compare.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

void check_side(const Eigen::MatrixXcd& shapes, const Eigen::MatrixXd& deviation,
                std::size_t channels, Index modes, const char* side) {
  require(shapes.rows() == static_cast<Index>(channels) && deviation.rows() == shapes.rows() &&
              shapes.cols() == modes && deviation.cols() == modes,
          fmt::format("measured modes: shapes of {}x{} and deviations of {}x{} for {} {}, {} modes",
                      shapes.rows(), shapes.cols(), deviation.rows(), deviation.cols(), channels,
                      side, modes));
  for (Index i = 0; i < shapes.size(); ++i) {
    const double std = deviation.data()[i];
    require(!std::isfinite(std::abs(shapes.data()[i])) || (std >= 0.0 && std::isfinite(std)),
            fmt::format("measured modes: a shape value with the deviation {}; expected 0 or more",
                        std));
  }
}

// Shapes with a phase at each channel. One deviation stands for both parts: the larger.
void take_shapes(const identification::ComplexShapes& shapes, const std::vector<Index>& columns,
                 MeasuredModes& modes) {
  modes.output_shapes = shapes.outputs(Eigen::all, columns);
  modes.output_std = shapes.output_real_std(Eigen::all, columns)
                         .cwiseMax(shapes.output_imaginary_std(Eigen::all, columns));
  modes.input_shapes = shapes.inputs(columns, Eigen::all).transpose();
  modes.input_std = shapes.input_real_std(columns, Eigen::all)
                        .cwiseMax(shapes.input_imaginary_std(columns, Eigen::all))
                        .transpose();
}

// The phases by which the delays of the fit turn each mode. Phases of complex shapes and a delay
// are hardly told apart, so the fit's choice of a delay is none of the modes' errors.
void put_delays(const identification::ModalFit& fit, MeasuredModes& modes) {
  const auto turn = [&](double delay, auto&& row) {
    for (Index k = 0; k < modes.count(); ++k) {
      row(k) *= std::polar(1.0, -2.0 * std::numbers::pi * modes.frequency_hz(k) * delay);
    }
  };
  for (Index j = 0; j < modes.input_shapes.rows(); ++j) {
    turn(fit.delay_s, modes.input_shapes.row(j));
  }
  const bool of_outputs = fit.delay_of == identification::DelayOf::outputs;
  for (Index i = 0; i < fit.channel_delay_s.size(); ++i) {
    if (of_outputs) {
      turn(fit.channel_delay_s(i), modes.output_shapes.row(i));
    } else {
      turn(fit.channel_delay_s(i), modes.input_shapes.row(i));
    }
  }
}

}  // namespace

void check(const MeasuredModes& modes) {
  const Index m = modes.count();
  require(m > 0, "measured modes: there is none");
  require(modes.frequency_std.size() == m && modes.damping_ratio.size() == m &&
              modes.damping_std.size() == m,
          "measured modes: frequencies, damping ratios and their deviations differ in number");
  for (Index k = 0; k < m; ++k) {
    const double hz = modes.frequency_hz(k);
    require(std::isfinite(hz) && hz > 0.0,
            fmt::format("measured modes: mode {} has the frequency {} Hz; expected above 0", k + 1,
                        hz));
    require(k == 0 || hz >= modes.frequency_hz(k - 1),
            fmt::format("measured modes: mode {} at {:.6g} Hz comes after {:.6g} Hz; expected "
                        "ascending frequencies",
                        k + 1, hz, modes.frequency_hz(std::max<Index>(k, 1) - 1)));
    require(std::isfinite(modes.frequency_std(k)) && modes.frequency_std(k) >= 0.0,
            fmt::format("measured modes: mode {} has the relative deviation {} of its frequency; "
                        "expected 0 or more",
                        k + 1, modes.frequency_std(k)));
    const double damping = modes.damping_std(k);
    require(!(modes.damping_ratio(k) > 0.0) || (std::isfinite(damping) && damping >= 0.0),
            fmt::format("measured modes: mode {} has the relative deviation {} of its damping "
                        "ratio; expected 0 or more",
                        k + 1, damping));
  }
  check_side(modes.output_shapes, modes.output_std, modes.outputs.size(), m, "sensors");
  check_side(modes.input_shapes, modes.input_std, modes.inputs.size(), m, "actuators");
}

MeasuredModes measured_modes(const identification::ModalFit& fit, std::vector<std::string> outputs,
                             std::vector<std::string> inputs, double low_hz, double high_hz) {
  const auto& model = fit.model;
  ComparisonOptions options;
  options.low_hz = low_hz;
  options.high_hz = high_hz;
  std::vector<Index> columns;
  for (Index k = 0; k < model.frequency_hz.size(); ++k) {
    const double hz = model.frequency_hz(k);
    const bool is_known = hz > 0.0 && std::isfinite(fit.frequency_std_hz(k));
    if (is_known && why_no_mode(fit, k, options).empty()) columns.push_back(k);
  }
  MeasuredModes modes;
  modes.outputs = std::move(outputs);
  modes.inputs = std::move(inputs);
  modes.frequency_hz = model.frequency_hz(columns);
  modes.frequency_std = fit.frequency_std_hz(columns).cwiseQuotient(modes.frequency_hz);
  modes.damping_ratio = model.damping_ratio(columns);
  modes.damping_std = fit.damping_std(columns).cwiseQuotient(modes.damping_ratio);
  for (Index k = 0; k < modes.count(); ++k) {
    if (std::isfinite(modes.damping_std(k))) continue;
    modes.damping_ratio(k) = kNotMeasured;
    modes.damping_std(k) = 0.0;
  }
  if (fit.complex) {
    take_shapes(*fit.complex, columns, modes);
  } else {
    modes.output_shapes = model.output_shapes(Eigen::all, columns).cast<std::complex<double>>();
    modes.output_std = fit.output_std(Eigen::all, columns);
    modes.input_shapes =
        model.input_shapes(columns, Eigen::all).transpose().cast<std::complex<double>>();
    modes.input_std = fit.input_std(columns, Eigen::all).transpose();
  }
  modes.scaled = true;
  put_delays(fit, modes);
  const auto drop = [](Eigen::MatrixXcd& shapes, Eigen::MatrixXd& deviation) {
    for (Index i = 0; i < shapes.size(); ++i) {
      if (std::isfinite(deviation.data()[i])) continue;
      shapes.data()[i] = {kNotMeasured, kNotMeasured};
      deviation.data()[i] = 0.0;
    }
  };
  drop(modes.output_shapes, modes.output_std);
  drop(modes.input_shapes, modes.input_std);
  return modes;
}

MeasuredModes part(const MeasuredModes& all, const std::vector<Index>& modes) {
  MeasuredModes result = all;
  result.frequency_hz = all.frequency_hz(modes);
  result.frequency_std = all.frequency_std(modes);
  result.damping_ratio = all.damping_ratio(modes);
  result.damping_std = all.damping_std(modes);
  result.output_shapes = all.output_shapes(Eigen::all, modes);
  result.output_std = all.output_std(Eigen::all, modes);
  result.input_shapes = all.input_shapes(Eigen::all, modes);
  result.input_std = all.input_std(Eigen::all, modes);
  return result;
}

std::string mode_name(const MeasuredModes& modes, Eigen::Index i) {
  return fmt::format("the mode at {:.6g} Hz", modes.frequency_hz(i));
}

}  // namespace chladni::diagnosis
