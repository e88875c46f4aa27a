#include "recordings/recordings.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "base/error.h"
#include "recordings/closed_loop.h"
#include "recordings/estimate/local_transient.h"
#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;
using Sides = std::vector<Side>;

const Sides kAll{Side::outputs, Side::inputs, Side::references};
const Sides kExcitation{Side::inputs, Side::references};
const Sides kOutputs{Side::outputs};

bool has(const Sides& sides, Side side) { return std::ranges::find(sides, side) != sides.end(); }

// Only those sides have channels.
Spectra head_of(const Recordings& recordings, const std::vector<Index>& line, const Sides& sides) {
  auto head = lines_between(recordings.head, 0.0, 0.0);
  head.line = line;
  if (!has(sides, Side::outputs)) head.outputs.clear();
  if (!has(sides, Side::inputs)) head.inputs.clear();
  if (!has(sides, Side::references)) head.references.clear();
  return head;
}

struct OwnedPeriod {
  Eigen::MatrixXcd outputs, inputs, references;
};

PeriodSpectra shared(std::shared_ptr<const OwnedPeriod> own) {
  return {&own->outputs, &own->inputs, &own->references, own};
}

// The spectra of the periods as they were recorded.
SpectraSource with_start(const Recordings& recordings, const std::vector<Index>& line,
                         const Sides& sides) {
  SpectraSource source{head_of(recordings, line, sides), {}, {}};
  const auto n = recordings.head.period;
  for (const auto& place : recordings.records) {
    source.records.push_back(
        {place.experiment, place.realisation, static_cast<std::size_t>(place.samples / n)});
  }
  source.period = [&recordings, n, head = source.head](std::size_t i, std::size_t p) {
    const auto lines_of = [&](Side side, const std::vector<modal::MeasuredChannel>& channels) {
      Eigen::MatrixXcd result(head.line_count(), std::ssize(channels));
      for (Index c = 0; c < result.cols(); ++c) {
        const auto samples = recordings.samples(i, side, c, static_cast<Index>(p) * n, n);
        result.col(c) = fourier(samples)(head.line, 0);
      }
      return result;
    };
    return shared(std::make_shared<const OwnedPeriod>(
        OwnedPeriod{lines_of(Side::outputs, head.outputs), lines_of(Side::inputs, head.inputs),
                    lines_of(Side::references, head.references)}));
  };
  return source;
}

/// The records of the realisation that is looked at, without their starts.
struct Cleaned {
  RecordWithoutStart without_start;
  int realisation = -1;
  std::map<std::size_t, std::shared_ptr<const Spectra::Record>> records;
};

SpectraSource without_start(const Recordings& recordings, const std::vector<Index>& line,
                            const Sides& sides) {
  SpectraSource source{head_of(recordings, line, sides), {}, {}};
  source.head.cleaned_periods = fewest_periods(recordings);
  const auto periods = static_cast<std::size_t>(periods_without_start());
  for (const auto& place : recordings.records) {
    source.records.push_back({place.experiment, place.realisation, periods});
  }
  source.period = [cleaned = std::make_shared<Cleaned>(
                       Cleaned{record_without_start(recordings, line), -1, {}}),
                   sides, &recordings](std::size_t i, std::size_t p) {
    if (recordings.records[i].realisation != cleaned->realisation) {
      cleaned->records.clear();
      cleaned->realisation = recordings.records[i].realisation;
    }
    auto& record = cleaned->records[i];
    if (!record) {
      record = std::make_shared<const Spectra::Record>(cleaned->without_start(i, sides));
    }
    return PeriodSpectra{&record->outputs[p], &record->inputs[p], &record->references[p], record};
  };
  return source;
}

// The excited ones of the source's lines.
std::vector<Index> excited_of(const SpectraSource& source, const FrfEstimateOptions& options) {
  std::vector<Index> result;
  for (const auto k : excited_places(source, options)) {
    result.push_back(source.head.line[static_cast<std::size_t>(k)]);
  }
  return result;
}

FrfEstimate estimate_on(const SpectraSource& excited, const FrfEstimateOptions& options) {
  return excited.head.references.empty() ? frf_estimate_of_excited(excited, options)
                                         : closed_loop_of_excited(excited, options).estimate;
}

FrfEstimate estimate_of(const Recordings& recordings, const FrfEstimateOptions& options,
                        const std::vector<Index>& line) {
  const auto excited = excited_of(with_start(recordings, line, kExcitation), options);
  if (!options.remove_transient) {
    return estimate_on(with_start(recordings, excited, kAll), options);
  }
  const auto about = transient(with_start(recordings, excited, kOutputs));
  auto own = options;
  own.drop = 0;
  const auto cleaned = excited_of(without_start(recordings, line, kExcitation), own);
  auto estimate = estimate_on(without_start(recordings, cleaned, kAll), own);
  tell_removed(fewest_periods(recordings), about, estimate);
  return estimate;
}

}  // namespace

Recordings recordings_of(const TimeData& data) {
  Recordings result{.head = {.outputs = data.outputs,
                             .inputs = data.inputs,
                             .references = data.references,
                             .sample_time_s = data.sample_time_s,
                             .period = data.period,
                             .records = {}},
                    .records = {},
                    .samples = [&data](std::size_t i, Side side, Index channel, Index first,
                                       Index count) -> Eigen::VectorXd {
                      const auto& record = data.records[i];
                      const auto& of = side == Side::outputs  ? record.outputs
                                       : side == Side::inputs ? record.inputs
                                                              : record.references;
                      return of.col(channel).segment(first, count);
                    }};
  for (const auto& record : data.records) {
    result.records.push_back({record.outputs.rows(), record.experiment, record.realisation});
  }
  return result;
}

Index fewest_periods(const Recordings& recordings) {
  Index samples = recordings.records.front().samples;
  for (const auto& place : recordings.records) samples = std::min(samples, place.samples);
  return samples / recordings.head.period;
}

PeriodicEstimate periodic_estimate(const Recordings& recordings,
                                   const FrfEstimateOptions& options) {
  const auto missing = missing_side(recordings.head);
  require(missing.empty(), "FRF estimate: " + missing);
  std::vector<Index> samples;
  for (const auto& place : recordings.records) samples.push_back(place.samples);
  check_periods(recordings.head, samples);
  PeriodicEstimate result;
  result.estimate = estimate_of(
      recordings, options, lines_between(recordings.head, options.low_hz, options.high_hz).line);
  const auto drop = first_steady_period(result.estimate);
  const auto all = lines_between(recordings.head, 0.0, 0.0).line;
  result.detection = detection_levels(with_start(recordings, all, kAll), drop);
  const auto excited = excited_of(with_start(recordings, all, kExcitation), {});
  result.drift = period_drift(with_start(recordings, excited, kOutputs), drop);
  return result;
}

}  // namespace chladni::recordings
