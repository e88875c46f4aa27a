#include "identification/cross_validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "recordings/recordings.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

constexpr std::size_t kMostFolds = 10;
constexpr Index kFewestPeriods = 2;  // of a stretch

// The realisations of each fold.
std::vector<std::set<int>> groups_of(const recordings::Spectra& all) {
  std::set<int> numbers;
  for (const auto& record : all.records) numbers.insert(record.realisation);
  std::vector<std::set<int>> groups(std::min(kMostFolds, numbers.size()));
  std::size_t at = 0;
  for (const int number : numbers) groups[at++ % groups.size()].insert(number);
  return groups;
}

recordings::Spectra chosen(const recordings::Spectra& all, const std::set<int>& realisations,
                           bool in) {
  auto result = recordings::source_of(all).head;
  for (const auto& record : all.records) {
    if (realisations.contains(record.realisation) == in) result.records.push_back(record);
  }
  return result;
}

std::string name_of(const std::string& what, const std::set<int>& numbers) {
  std::string text = what + (numbers.size() > 1 ? "s " : " ");
  for (const int number : numbers) {
    text += fmt::format("{}{}", number == *numbers.begin() ? "" : ", ", number + 1);
  }
  return text;
}

modal::FrfSet at_lines(const modal::FrfSet& set, const std::vector<double>& hz) {
  auto result = set;
  result.frequency_hz = Eigen::Map<const Eigen::VectorXd>(hz.data(), std::ssize(hz));
  std::vector<std::size_t> places;
  for (const double line : hz) {
    places.push_back(static_cast<std::size_t>(
        std::lower_bound(set.frequency_hz.begin(), set.frequency_hz.end(), line) -
        set.frequency_hz.begin()));
  }
  const auto choose = [&](auto& of, const auto& whole) {
    of.clear();
    if (whole.empty()) return;
    for (const auto k : places) of.push_back(whole[k]);
  };
  choose(result.value, set.value);
  choose(result.variance, set.variance);
  choose(result.noise_variance, set.noise_variance);
  choose(result.coherence, set.coherence);
  return result;
}

// A line may be excited enough in some realisations only.
void keep_common_lines(std::vector<Fold>& folds) {
  std::map<double, std::size_t> count;
  for (const auto& fold : folds) {
    for (const double hz : fold.rest.frequency_hz) ++count[hz];
    for (const double hz : fold.left_out.frequency_hz) ++count[hz];
  }
  std::vector<double> common;
  for (const auto& [hz, times] : count) {
    if (times == 2 * folds.size()) common.push_back(hz);
  }
  for (auto& fold : folds) {
    fold.rest = at_lines(fold.rest, common);
    fold.left_out = at_lines(fold.left_out, common);
  }
}

void scale_variance(Fold& fold) {
  auto& part = fold.left_out;
  part.variance = fold.rest.variance;
  for (auto& line : part.variance) line *= fold.times;
  part.averages = fold.rest.averages;
  part.noise_variance.clear();
}

std::vector<Fold> folds_of(const recordings::Spectra& all,
                           const recordings::FrfEstimateOptions& options,
                           const Estimator& estimator, const std::string& what) {
  std::vector<Fold> result;
  const auto groups = groups_of(all);
  if (groups.size() < 2) return result;
  double realisations = 0.0;
  for (const auto& group : groups) realisations += static_cast<double>(group.size());
  for (const auto& group : groups) {
    const auto count = static_cast<double>(group.size());
    auto rest = estimator(chosen(all, group, false), options).set;
    if (rest.variance.empty()) return {};  // nothing tells the noise
    result.push_back({.name = name_of(what, group),
                      .left_out = estimator(chosen(all, group, true), options).set,
                      .rest = std::move(rest),
                      .times = (realisations - count) / count});
  }
  keep_common_lines(result);
  for (auto& fold : result) scale_variance(fold);
  return result;
}

// The periods of one realisation as stretches of equal length that count as realisations; periods
// that fill no stretch are left out at the start.
recordings::TimeData stretches(const recordings::TimeData& data, Index dropped) {
  auto result = data;
  result.records.clear();
  const Index periods = recordings::fewest_periods(recordings::recordings_of(data));
  const Index count =
      std::min<Index>(kMostFolds, std::max<Index>(0, periods - dropped) / kFewestPeriods);
  const Index rows = data.period * (count > 0 ? (periods - dropped) / count : 0);
  for (const auto& record : data.records) {
    for (Index s = 0; s < count; ++s) {
      const Index first = data.period * periods - (count - s) * rows;
      result.records.push_back(
          {record.outputs.middleRows(first, rows), record.inputs.middleRows(first, rows),
           record.references.middleRows(first, rows), record.experiment, static_cast<int>(s)});
    }
  }
  return result;
}

}  // namespace

Folds folds(const recordings::TimeData& data, const recordings::Spectra& all,
            const recordings::FrfEstimateOptions& options, Index dropped,
            const Estimator& estimator) {
  auto own = options;
  own.drop = dropped;
  if (groups_of(all).size() > 1) {
    return {"realisations", folds_of(all, own, estimator, "realisation")};
  }
  const auto parts = stretches(data, dropped);
  if (std::ssize(parts.records) < 2 * std::ssize(data.records)) return {"periods", {}};
  auto in_parts = options;
  in_parts.drop.reset();
  recordings::TransientReport about;
  const auto [spectra, prepared_options] = prepared(parts, in_parts, about);
  own.drop = 0;
  return {"periods", folds_of(spectra, own, estimator, "stretch")};
}

CrossValidation cross_validation(const std::string& by, const std::vector<PredictedPart>& parts,
                                 const Eigen::VectorXd& frequency_hz) {
  CrossValidation result{.by = by, .all = {}, .expected_level = 1.0, .parts = {}};
  const auto& first = parts.front().data;
  const auto columns = first.response_count();
  FitData together = first;
  together.inputs = first.inputs * std::ssize(parts);
  together.value.resize(first.line_count(), columns * std::ssize(parts));
  together.weight.resize(first.line_count(), columns * std::ssize(parts));
  // Their variances are estimated from nearly the same recordings.
  together.shared_lines = first.shared_lines * static_cast<double>(parts.size());
  Eigen::MatrixXcd predicted(first.line_count(), together.response_count());
  Index at = 0;
  double fit_error = 0.0;
  for (const auto& part : parts) {
    fit_error += part.fit_error;
    together.value.middleCols(at, columns) = part.data.value;
    together.weight.middleCols(at, columns) = part.data.weight;
    predicted.middleCols(at, columns) = part.predicted;
    at += columns;
    result.parts.push_back(
        {part.name, validation(part.data, part.predicted, Eigen::VectorXd(0)).whole});
  }
  result.all = validation(together, predicted, frequency_hz);
  result.expected_level = 1.0 + fit_error / static_cast<double>(parts.size());
  return result;
}

double fit_error_over_noise(const FitData& data, const FitData& seen, const ModalFit& fit) {
  double sum = 0.0;
  double numbers = 0.0;
  for (Index k = 0; k < data.line_count(); ++k) {
    const double hz = data.frequency_hz(k);
    Index near = std::lower_bound(seen.frequency_hz.begin(), seen.frequency_hz.end(), hz) -
                 seen.frequency_hz.begin();
    near = std::min(near, seen.line_count() - 1);
    if (near > 0 && hz - seen.frequency_hz(near - 1) < seen.frequency_hz(near) - hz) --near;
    for (Index e = 0; e < data.response_count(); ++e) {
      if (data.weight(k, e) <= 0.0 || seen.weight(near, e) <= 0.0) continue;
      sum += std::pow(data.weight(k, e) / seen.weight(near, e), 2);
      numbers += 1.0;
    }
  }
  const double part =
      static_cast<double>(fit.parameter_count) / static_cast<double>(seen.measured_count());
  return numbers > 0.0 ? part * sum / numbers : 0.0;
}

}  // namespace chladni::identification
