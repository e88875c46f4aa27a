#include "recordings/recording_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "recordings/fft.h"
#include "recordings/recordings.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;

constexpr Index kFewestClipped = 5;
constexpr Index kPiece = 65536;      // samples of a channel that are looked at at once
constexpr double kMoreOften = 3.0;   // the largest value than the next one
constexpr double kSamePeriod = 0.9;  // correlation with the first period: it is in place
constexpr double kShifted = 0.9;     // correlation in another place: it is shifted
constexpr double kRounding = 1e-24;  // of the power of a constant: it excites nothing

// How often the largest value occurs, and the next one.
struct Extremes {
  double largest = -HUGE_VAL, next = -HUGE_VAL;
  Index count = 0, next_count = 0;

  void add(double value) {
    if (value > largest) {
      next = std::exchange(largest, value);
      next_count = std::exchange(count, 1);
    } else if (value == largest) {
      ++count;
    } else if (value > next) {
      next = value;
      next_count = 1;
    } else if (value == next) {
      ++next_count;
    }
  }
};

bool is_clipped(const Extremes& extremes) {
  return extremes.largest > 0.0 && extremes.count >= kFewestClipped &&
         static_cast<double>(extremes.count) >
             kMoreOften * static_cast<double>(std::max<Index>(1, extremes.next_count));
}

// Walks over one channel of a record in pieces.
template <typename Look>
void walk(const Recordings& recordings, std::size_t record, Side side, Index channel, Look look) {
  const Index samples = recordings.records[record].samples;
  for (Index first = 0; first < samples; first += kPiece) {
    look(recordings.samples(record, side, channel, first, std::min(kPiece, samples - first)));
  }
}

void look_for_clipping(const Recordings& recordings, Side side,
                       const std::vector<modal::MeasuredChannel>& channels,
                       RecordingFaults& faults) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Index clipped = 0;
    Index samples = 0;
    std::size_t first = 0;
    double level = 0.0;
    for (std::size_t r = 0; r < recordings.records.size(); ++r) {
      std::array<Extremes, 2> found;
      walk(recordings, r, side, static_cast<Index>(c), [&](const Eigen::VectorXd& values) {
        for (const double value : values) {
          found[0].add(value);
          found[1].add(-value);
        }
        samples += values.size();
      });
      for (const auto& extremes : found) {
        if (!is_clipped(extremes)) continue;
        if (clipped == 0) first = r + 1;
        level = extremes.largest;
        clipped += extremes.count;
      }
    }
    if (clipped == 0) continue;
    faults.clipped.push_back(fmt::format(
        "{} is clipped at {:.4g}: {} samples of {} have that value, the first in record {}",
        channels[c].name, level, clipped, samples, first));
  }
}

/// The place of a period against the first one, without their means: a mean is alike in any place.
struct Place {
  double here = 1.0;  // correlation in place
  double best = 1.0;  // in the best place
  Index shift = 0;    // samples that it comes early
};

Place place_of(const Eigen::VectorXcd& first, const Eigen::VectorXcd& other, Index period) {
  Eigen::MatrixXcd product = first.conjugate().cwiseProduct(other);
  product(0, 0) = 0.0;
  const Eigen::VectorXd correlation = inverse_fourier(product, period);
  const auto energy = [&](const Eigen::VectorXcd& lines) {
    Eigen::MatrixXcd power = lines.cwiseAbs2().cast<std::complex<double>>();
    power(0, 0) = 0.0;
    return inverse_fourier(power, period)(0, 0);
  };
  const double size = std::sqrt(energy(first) * energy(other));
  const double of_means = std::abs(first(0) * other(0)) / static_cast<double>(period);
  if (!(size > kRounding * of_means)) return {};
  Place place{.here = correlation(0) / size, .best = 0.0, .shift = 0};
  Index at = 0;
  place.best = correlation.maxCoeff(&at) / size;
  place.shift = at == 0 ? 0 : period - at;  // y(n) = x(n + shift)
  if (2 * place.shift > period) place.shift -= period;
  return place;
}

/// A channel that excites.
struct Excitation {
  Side side = Side::inputs;
  Index channel = -1;  ///< −1: there is none
};

// The excitation of a record: of the references in a loop, else of the inputs, the strongest. What
// does not change excites nothing.
Excitation excitation_of(const Recordings& recordings, std::size_t record) {
  const auto& head = recordings.head;
  Excitation found{head.references.empty() ? Side::inputs : Side::references};
  const auto channels = std::ssize(head.references.empty() ? head.inputs : head.references);
  double strongest = -1.0;
  for (Index c = 0; c < channels; ++c) {
    const double start = recordings.samples(record, found.side, c, 0, 1)(0);
    double sum = 0.0;
    double squares = 0.0;
    walk(recordings, record, found.side, c, [&](const Eigen::VectorXd& values) {
      sum += (values.array() - start).sum();
      squares += (values.array() - start).matrix().squaredNorm();
    });
    const auto samples = static_cast<double>(recordings.records[record].samples);
    const double power = squares - sum * sum / samples;
    if (power <= strongest) continue;
    strongest = power;
    found.channel = c;
  }
  return found;
}

void look_for_losses(const Recordings& recordings, std::size_t record, RecordingFaults& faults) {
  const Index n = recordings.head.period;
  if (n < 4) return;
  const Index periods = recordings.records[record].samples / n;
  const auto excitation = excitation_of(recordings, record);
  if (periods < 2 || excitation.channel < 0) return;
  const auto period = [&](Index p) -> Eigen::VectorXcd {
    return fourier(recordings.samples(record, excitation.side, excitation.channel, p * n, n))
        .col(0);
  };
  const auto first = period(0);
  for (Index p = 1; p < periods; ++p) {
    const auto place = place_of(first, period(p), n);
    if (place.here >= kSamePeriod) continue;
    if (place.best < kShifted && p + 1 < periods) continue;  // the loss is within this period
    faults.lost.push_back(
        place.best >= kShifted
            ? fmt::format("record {}: from period {} on the excitation comes {} samples {}: "
                          "samples were {}",
                          record + 1, p + 1, std::abs(place.shift),
                          place.shift > 0 ? "early" : "late",
                          place.shift > 0 ? "lost" : "recorded twice")
            : fmt::format("record {}: period {} of the excitation differs from the first: samples "
                          "were lost in it, or the stated period of {} samples is wrong",
                          record + 1, p + 1, n));
    return;
  }
}

}  // namespace

RecordingFaults recording_faults(const TimeData& data) {
  check(data);
  return recording_faults(recordings_of(data));
}

RecordingFaults recording_faults(const Recordings& recordings) {
  RecordingFaults faults;
  look_for_clipping(recordings, Side::outputs, recordings.head.outputs, faults);
  look_for_clipping(recordings, Side::inputs, recordings.head.inputs, faults);
  for (std::size_t r = 0; r < recordings.records.size(); ++r) {
    look_for_losses(recordings, r, faults);
  }
  return faults;
}

}  // namespace chladni::recordings
