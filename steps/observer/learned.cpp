// An observer with the noise that its recordings ask for.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "steps/observer/deviations.h"
#include "steps/observer/stated.h"

namespace chladni::steps {
namespace {

constexpr Eigen::Index kMostSamples = 200'000;  // of all records, for each of some forty filters

// The first samples of the records that are longer than the filter settles.
std::vector<modal::RecordedSamples> samples_of(const Recordings& recordings, Eigen::Index from) {
  const auto most = from + kMostSamples / std::max<Eigen::Index>(1, std::ssize(recordings.records));
  std::vector<modal::RecordedSamples> samples;
  for (const auto& record : recordings.records) {
    const auto n = std::min(record.sensors.rows(), most);
    if (n > from) samples.push_back({record.inputs.topRows(n), record.sensors.topRows(n)});
  }
  return samples;
}

// The largest of the finite values, or 1.
double largest_above_one(const Eigen::VectorXd& values) {
  double largest = 1.0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace

Observer with_learned_noise(const study::Study& study, Observer observer,
                            const Recordings& recordings) {
  const auto& system = observer.filter.system;
  const double settle_s = settling_time(*study.observer, observer.filter, recordings.sample_time_s);
  const auto from = first_settled(settle_s, recordings.sample_time_s);
  const auto samples = samples_of(recordings, from);
  require(!samples.empty(), nothing_settles(recordings.file, settle_s));
  const auto factors = modal::learned_noise(system, samples, from);
  if (factors.at_end) {
    observer.notes.push_back(
        "the recordings do not tell disturbances from noise of the sensors: both are as the study "
        "states them");
    return observer;
  }
  const auto learned = modal::with_noise(system, factors);
  observer.noise = factors;
  observer.filter = modal::kalman_filter(learned);
  observer.left_out = modal::left_out_errors(learned, samples, from);
  observer.band_factor = largest_above_one(observer.left_out);
  set_deviations(observer);
  return observer;
}

}  // namespace chladni::steps
