#include "io/figure/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace chladni::io {
namespace {

// The smallest number of the form 1, 2 or 5 times a power of ten that is not below `step`.
double nice(double step) {
  const double decade = std::pow(10.0, std::floor(std::log10(step)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (times * decade >= step * (1.0 - 1e-9)) return times * decade;
  }
  return 10.0 * decade;
}

// The label with as many decimals as the step has, or with a power of ten where the numbers are far
// from 1.
std::string number(double value, double step, double largest) {
  if (std::abs(value) < 1e-9 * step) return "0";
  if (largest >= 1e5 || largest < 1e-3) {
    const int digits = std::max(0, static_cast<int>(std::ceil(std::log10(largest / step) - 1e-9)));
    return fmt::format("{:.{}e}", value, std::min(digits, 6));
  }
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}

std::vector<PlotTick> linear_ticks(const PlotAxis& axis, double pixels, double between) {
  const double range = axis.high - axis.low;
  const double step = nice(range / std::max(2.0, std::floor(pixels / between)));
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  std::vector<PlotTick> ticks;
  const double first = std::ceil(axis.low / step - 1e-9);
  for (int k = 0; (first + k) * step <= axis.high + 1e-9 * range && k < 100; ++k) {
    const double value = (first + k) * step;
    ticks.push_back({value, number(value, step, largest), ""});
  }
  return ticks;
}

PlotTick power_of_ten(int exponent, bool plain) {
  const double value = std::pow(10.0, exponent);
  if (plain) return {value, fmt::format("{:.{}f}", value, std::max(0, -exponent)), ""};
  // U+2212, the minus sign.
  return {value, "10", (exponent < 0 ? "\xE2\x88\x92" : "") + fmt::to_string(std::abs(exponent))};
}

std::vector<PlotTick> logarithmic_ticks(const PlotAxis& axis, double pixels, double between) {
  const double low = std::log10(axis.low), high = std::log10(axis.high);
  const int first = static_cast<int>(std::floor(low + 1e-9));
  const int last = static_cast<int>(std::ceil(high - 1e-9));
  if (high - low < 0.7) return linear_ticks(axis, pixels, between);
  const bool plain = low > -3.01 && high < 5.01;
  const double decade = pixels / (high - low);
  const int stride = std::max(1, static_cast<int>(std::ceil(between / decade)));
  const bool between_decades = plain && decade > 3.2 * between;
  std::vector<PlotTick> ticks;
  for (int e = first; e <= last; ++e) {
    for (int times = 1; times < 10; ++times) {
      PlotTick tick = power_of_ten(e, plain);
      const bool shown =
          times == 1 ? (e % stride) == 0 : between_decades && (times == 2 || times == 5);
      if (times > 1 && decade < 25.0) break;
      if (times > 1 && shown) tick.words = number(times * tick.value, tick.value, 1.0);
      tick.value *= times;
      if (!shown) tick.words = tick.exponent = "";
      const double at = std::log10(tick.value);
      if (at >= low - 1e-9 && at <= high + 1e-9) ticks.push_back(tick);
    }
  }
  return ticks;
}

}  // namespace

std::vector<PlotTick> plot_ticks(const PlotAxis& axis, double pixels, double between) {
  if (!(axis.high > axis.low)) return {};
  return axis.logarithmic ? logarithmic_ticks(axis, pixels, between)
                          : linear_ticks(axis, pixels, between);
}

PlotAxis ranged(PlotAxis axis, const std::vector<double>& values, double room) {
  if (axis.high > axis.low) return axis;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value) || (axis.logarithmic && value <= 0.0)) continue;
    const double at = axis.logarithmic ? std::log10(value) : value;
    low = std::min(low, at);
    high = std::max(high, at);
  }
  if (!(low <= high)) low = 0.0, high = 1.0;
  if (high - low <= 1e-12 * std::max(std::abs(low), std::abs(high)) || high == low) {
    const double half = axis.logarithmic || low == 0.0 ? 0.5 : 0.5 * std::abs(low);
    low -= half;
    high += half;
  }
  const double more = room * (high - low);
  axis.low = axis.logarithmic ? std::pow(10.0, low - more) : low - more;
  axis.high = axis.logarithmic ? std::pow(10.0, high + more) : high + more;
  return axis;
}

double along(const PlotAxis& axis, double value) {
  if (!axis.logarithmic) return (value - axis.low) / (axis.high - axis.low);
  if (!(value > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::log(value / axis.low) / std::log(axis.high / axis.low);
}

}  // namespace chladni::io
