#include "recordings/data_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/upper_median.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;

constexpr int kParts = 6;
constexpr Index kFewestLines = 4;
constexpr double kSilent = 1e-6;   // of the power of the strongest line
constexpr double kNoChance = 5.0;  // deviations

double median_of(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return upper_median(values);
}

BandQuality quality_of(const modal::FrfSet& set, Index first, Index end) {
  const Index p = set.output_count();
  const Index q = set.input_count();
  BandQuality band{.low_hz = set.frequency_hz(first),
                   .high_hz = set.frequency_hz(end - 1),
                   .lines = end - first,
                   .deviation = Eigen::VectorXd(p * q),
                   .distortion = Eigen::VectorXd(p * q)};
  for (Index e = 0; e < p * q; ++e) {
    std::vector<double> relative, ratio;
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(end); ++k) {
      const double size = std::abs(set.value[k](e % p, e / p));
      if (!(size > 0.0) || set.variance.empty()) continue;
      const double variance = set.variance[k](e % p, e / p);
      relative.push_back(std::sqrt(variance) / size);
      if (set.noise_variance.empty()) continue;
      const double noise = set.noise_variance[k](e % p, e / p);
      if (noise > 0.0) ratio.push_back(variance / noise);
    }
    const double deviation = median_of(relative);
    band.deviation(e) = std::isnan(deviation) ? std::numeric_limits<double>::infinity() : deviation;
    band.distortion(e) = median_of(ratio);
  }
  return band;
}

std::string name_of(const modal::FrfSet& set, Index e) {
  const Index p = set.output_count();
  return set.outputs[static_cast<std::size_t>(e % p)].name + "/" +
         set.inputs[static_cast<std::size_t>(e / p)].name;
}

const char* word_of(double deviation) {
  if (deviation <= kGoodDeviation) return "good";
  return deviation <= kFairDeviation ? "fair" : "noise";
}

}  // namespace

std::vector<BandQuality> band_qualities(const modal::FrfSet& set) {
  std::vector<BandQuality> bands;
  const Index lines = set.line_count();
  const bool has_responses = set.output_count() > 0 && set.input_count() > 0;
  if (lines < kFewestLines || !has_responses) return bands;
  const double low = std::max(set.frequency_hz(0), 1e-3 * set.frequency_hz(lines - 1));
  const double wide = set.frequency_hz(lines - 1) / low;
  Index first = 0;
  for (int part = 1; part <= kParts; ++part) {
    const double limit = low * std::pow(wide, static_cast<double>(part) / kParts);
    Index end = first;
    while (end < lines && (part == kParts || set.frequency_hz(end) <= limit)) ++end;
    if (end - first < kFewestLines && part < kParts) continue;
    if (lines - end < kFewestLines) end = lines;
    if (end > first) bands.push_back(quality_of(set, first, end));
    first = end;
  }
  return bands;
}

std::string trusted_bands(const modal::FrfSet& set, const std::vector<BandQuality>& bands) {
  if (set.variance.empty())
    return "nothing tells the noise: one period of one realisation, or one hit";
  std::string text;
  for (std::size_t b = 0; b < bands.size();) {
    const auto word = [&](std::size_t i) { return word_of(bands[i].deviation.maxCoeff()); };
    std::size_t last = b;
    Index worst = 0;
    double deviation = bands[b].deviation.maxCoeff(&worst);
    while (last + 1 < bands.size() && word(last + 1) == word(b)) {
      Index at = 0;
      const double more = bands[++last].deviation.maxCoeff(&at);
      if (more > deviation) {
        deviation = more;
        worst = at;
      }
    }
    text += fmt::format("{}{} from {:.4g} to {:.4g} Hz ({}: {:.2g} %)", text.empty() ? "" : "; ",
                        word(b), bands[b].low_hz, bands[last].high_hz, name_of(set, worst),
                        100.0 * deviation);
    b = last + 1;
  }
  return text;
}

namespace {

// 1 where a record excites the line, by its inputs (in a loop its references).
std::vector<char> excited_in(const SpectraSource& all) {
  Eigen::VectorXd power = Eigen::VectorXd::Zero(all.head.line_count());
  for (std::size_t i = 0; i < all.records.size(); ++i) {
    const auto last = all.period(i, all.records[i].periods - 1);
    const auto& side = all.head.references.empty() ? *last.inputs : *last.references;
    power = power.cwiseMax(side.cwiseAbs2().rowwise().maxCoeff());
  }
  std::vector<char> excited;
  for (const double one : power) excited.push_back(one > kSilent * power.maxCoeff() ? 1 : 0);
  return excited;
}

// Mean powers on each line, K×p: of the mean over periods, and of its noise.
struct MeanPower {
  Eigen::MatrixXd mean, noise;
};

MeanPower powers_of(const SpectraSource& all, Index drop) {
  const auto p = std::ssize(all.head.outputs);
  MeanPower power{Eigen::MatrixXd::Zero(all.head.line_count(), p),
                  Eigen::MatrixXd::Zero(all.head.line_count(), p)};
  const double records = static_cast<double>(all.records.size());
  for (std::size_t r = 0; r < all.records.size(); ++r) {
    const auto first = static_cast<std::size_t>(drop);
    const auto count = all.records[r].periods;
    const auto periods = static_cast<double>(count - first);
    Eigen::MatrixXcd mean = Eigen::MatrixXcd::Zero(all.head.line_count(), p);
    for (auto i = first; i < count; ++i) mean += *all.period(r, i).outputs / periods;
    power.mean += mean.cwiseAbs2() / records;
    for (auto i = first; i < count; ++i) {
      power.noise +=
          (*all.period(r, i).outputs - mean).cwiseAbs2() / (records * periods * (periods - 1.0));
    }
  }
  return power;
}

Eigen::VectorXd decibels(const Eigen::VectorXd& power, const Eigen::VectorXd& over) {
  return 10.0 * power.cwiseMax(0.0).cwiseQuotient(over).array().log10();
}

// What the lines hold of each output above noise, over its size [dB]; NaN where there is no line.
Eigen::VectorXd level_of(const MeanPower& power, const std::vector<Index>& lines,
                         const Eigen::VectorXd& size) {
  if (lines.empty()) {
    return Eigen::VectorXd::Constant(size.size(), std::numeric_limits<double>::quiet_NaN());
  }
  const Eigen::MatrixXd above = power.mean(lines, Eigen::all) - power.noise(lines, Eigen::all);
  return decibels(above.colwise().mean().transpose(), size);
}

}  // namespace

std::optional<DetectionLevels> detection_levels(const SpectraSource& source, Index drop) {
  for (const auto& record : source.records) {
    if (static_cast<Index>(record.periods) < drop + 2) return std::nullopt;
  }
  const auto& all = source.head;
  const auto excited = excited_in(source);
  const auto first = std::ranges::find(excited, 1) - excited.begin();
  const auto last =
      std::ssize(excited) - 1 - (std::find(excited.rbegin(), excited.rend(), 1) - excited.rbegin());
  std::vector<Index> driven, silent, odd, even;
  for (Index k = first; k <= last; ++k) {
    (excited[static_cast<std::size_t>(k)] != 0 ? driven : silent).push_back(k);
  }
  if (silent.empty() || driven.empty()) return std::nullopt;
  const auto power = powers_of(source, drop);
  const double amplitude = 2.0 / static_cast<double>(all.period);
  DetectionLevels found{.hz = Eigen::VectorXd(std::ssize(silent)),
                        .odd = {},
                        .level = amplitude * power.mean(silent, Eigen::all).cwiseSqrt(),
                        .noise = amplitude * power.noise(silent, Eigen::all).cwiseSqrt(),
                        .even_db = {},
                        .odd_db = {},
                        .noise_db = {}};
  for (std::size_t i = 0; i < silent.size(); ++i) {
    found.hz(static_cast<Index>(i)) = all.hz(static_cast<std::size_t>(silent[i]));
    const bool is_odd = all.line[static_cast<std::size_t>(silent[i])] % 2 != 0;
    found.odd.push_back(is_odd ? 1 : 0);
    (is_odd ? odd : even).push_back(silent[i]);
  }
  const Eigen::VectorXd size = power.mean(driven, Eigen::all).colwise().mean().transpose();
  found.even_db = level_of(power, even, size);
  found.odd_db = level_of(power, odd, size);
  found.noise_db = decibels(power.noise(silent, Eigen::all).colwise().mean().transpose(), size);
  return found;
}

namespace {

/// Sums over lines and records, of each output.
struct Trend {
  Eigen::ArrayXd along;   // Σ |slope|² · Σ time²
  Eigen::ArrayXd around;  // what is left
  Eigen::ArrayXd size;    // of the mean
};

void add(const SpectraSource& excited, std::size_t record, Index drop, const Eigen::VectorXd& time,
         Trend& trend) {
  const auto outputs = [&](Index p) {
    return excited.period(record, static_cast<std::size_t>(drop + p));
  };
  const double squares = time.squaredNorm();
  Eigen::MatrixXcd mean = Eigen::MatrixXcd::Zero(excited.head.line_count(), trend.size.size());
  Eigen::MatrixXcd slope = mean;
  for (Index p = 0; p < time.size(); ++p) {
    const auto period = outputs(p);
    mean += *period.outputs / static_cast<double>(time.size());
    slope += *period.outputs * (time(p) / squares);
  }
  const Eigen::ArrayXd along = slope.colwise().squaredNorm().transpose().array() * squares;
  trend.along += along;
  trend.around -= along;
  for (Index p = 0; p < time.size(); ++p) {
    const auto period = outputs(p);
    trend.around += (*period.outputs - mean).colwise().squaredNorm().transpose().array();
  }
  trend.size += mean.colwise().squaredNorm().transpose().array();
}

}  // namespace

std::vector<PeriodDrift> period_drift(const SpectraSource& excited, Index drop) {
  std::vector<PeriodDrift> found;
  Index fewest = std::numeric_limits<Index>::max();
  for (const auto& record : excited.records) {
    fewest = std::min(fewest, static_cast<Index>(record.periods) - drop);
  }
  if (excited.records.empty() || fewest < 3) return found;
  const Eigen::VectorXd time =
      Eigen::VectorXd::LinSpaced(fewest, -0.5, 0.5);  // from the first to the last period
  const double lines =
      static_cast<double>(excited.head.line_count()) * static_cast<double>(excited.records.size());
  const auto count = std::ssize(excited.head.outputs);
  Trend trend{Eigen::ArrayXd::Zero(count), Eigen::ArrayXd::Zero(count),
              Eigen::ArrayXd::Zero(count)};
  for (std::size_t r = 0; r < excited.records.size(); ++r) add(excited, r, drop, time, trend);
  for (Index i = 0; i < count; ++i) {
    const double along = trend.along(i);
    const double size = trend.size(i);
    const double noise = std::max(trend.around(i), 1e-28 * size) / static_cast<double>(fewest - 2);
    // The ratio has 2·lines real numbers over 2·lines·(P − 2).
    const double spread = std::sqrt((1.0 + 1.0 / static_cast<double>(fewest - 2)) / lines);
    const double excess = (along / noise - 1.0) / spread;
    if (!(excess >= kNoChance)) continue;  // nor where the output is 0: 0/0
    found.push_back(
        {.output = i,
         .relative = std::sqrt(std::max(0.0, along - noise) / time.squaredNorm() / size),
         .excess = excess});
  }
  return found;
}

}  // namespace chladni::recordings
