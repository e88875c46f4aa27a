#include "recordings/recording_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;

constexpr Index kFewestClipped = 5;
constexpr double kMoreOften = 3.0;   // the largest value than the next one
constexpr double kSamePeriod = 0.9;  // correlation with the first period: it is in place
constexpr double kShifted = 0.9;     // correlation in another place: it is shifted

// How often the largest value occurs, and the next one.
struct Extremes {
  double largest = 0.0;
  Index count = 0, next_count = 0;
};

Extremes extremes_of(const Eigen::VectorXd& values) {
  Extremes found{.largest = values.maxCoeff()};
  double next = -HUGE_VAL;
  for (const double value : values) {
    if (value == found.largest) ++found.count;
    if (value < found.largest) next = std::max(next, value);
  }
  found.next_count = (values.array() == next).count();
  return found;
}

bool is_clipped(const Extremes& extremes) {
  return extremes.largest > 0.0 && extremes.count >= kFewestClipped &&
         static_cast<double>(extremes.count) >
             kMoreOften * static_cast<double>(std::max<Index>(1, extremes.next_count));
}

void look_for_clipping(const std::vector<modal::MeasuredChannel>& channels,
                       Eigen::MatrixXd Record::*side, const TimeData& data,
                       RecordingFaults& faults) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Index clipped = 0;
    Index samples = 0;
    std::size_t first = 0;
    double level = 0.0;
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      const Eigen::VectorXd values = (data.records[r].*side).col(static_cast<Index>(c));
      for (const double sign : {1.0, -1.0}) {
        const auto extremes = extremes_of(sign * values);
        if (!is_clipped(extremes)) continue;
        if (clipped == 0) first = r + 1;
        level = extremes.largest;
        clipped += extremes.count;
      }
      samples += values.size();
    }
    if (clipped == 0) continue;
    faults.clipped.push_back(fmt::format(
        "{} is clipped at {:.4g}: {} samples of {} have that value, the first in record {}",
        channels[c].name, level, clipped, samples, first));
  }
}

/// The place of a period against the first one.
struct Place {
  double here = 1.0;  // correlation in place
  double best = 1.0;  // in the best place
  Index shift = 0;    // samples that it comes early
};

Place place_of(const Eigen::VectorXcd& first, const Eigen::VectorXcd& other, Index period) {
  const Eigen::MatrixXcd product = first.conjugate().cwiseProduct(other);
  const Eigen::VectorXd correlation = inverse_fourier(product, period);
  const auto energy = [&](const Eigen::VectorXcd& lines) {
    return inverse_fourier(Eigen::MatrixXcd(lines.cwiseAbs2().cast<std::complex<double>>()),
                           period)(0, 0);
  };
  const double size = std::sqrt(energy(first) * energy(other));
  if (!(size > 0.0)) return {};
  Place place{.here = correlation(0) / size, .best = 0.0, .shift = 0};
  Index at = 0;
  place.best = correlation.maxCoeff(&at) / size;
  place.shift = at == 0 ? 0 : period - at;  // y(n) = x(n + shift)
  if (2 * place.shift > period) place.shift -= period;
  return place;
}

// The excitation of a record: references in a loop, else the strongest input.
Eigen::VectorXd excitation_of(const TimeData& data, const Record& record) {
  const auto& side = data.references.empty() ? record.inputs : record.references;
  if (side.cols() == 0) return {};
  Index strongest = 0;
  side.colwise().squaredNorm().maxCoeff(&strongest);
  return side.col(strongest);
}

void look_for_losses(const TimeData& data, RecordingFaults& faults) {
  if (data.period < 4) return;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto signal = excitation_of(data, data.records[r]);
    const auto periods = signal.size() / data.period;
    if (periods < 2) continue;
    const Eigen::VectorXcd first = fourier(signal.head(data.period)).col(0);
    for (Index p = 1; p < periods; ++p) {
      const Eigen::VectorXcd other = fourier(signal.segment(p * data.period, data.period)).col(0);
      const auto place = place_of(first, other, data.period);
      if (place.here >= kSamePeriod) continue;
      if (place.best < kShifted && p + 1 < periods) continue;  // the loss is within this period
      faults.lost.push_back(
          place.best >= kShifted
              ? fmt::format("record {}: from period {} on the excitation comes {} samples {}: "
                            "samples were {}",
                            r + 1, p + 1, std::abs(place.shift), place.shift > 0 ? "early" : "late",
                            place.shift > 0 ? "lost" : "recorded twice")
              : fmt::format(
                    "record {}: period {} of the excitation differs from the first: samples "
                    "were lost in it, or the stated period of {} samples is wrong",
                    r + 1, p + 1, data.period));
      break;
    }
  }
}

}  // namespace

RecordingFaults recording_faults(const TimeData& data) {
  check(data);
  RecordingFaults faults;
  look_for_clipping(data.outputs, &Record::outputs, data, faults);
  look_for_clipping(data.inputs, &Record::inputs, data, faults);
  look_for_losses(data, faults);
  return faults;
}

}  // namespace chladni::recordings
