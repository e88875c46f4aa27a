#include "diagnosis/detectable.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "base/index.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "diagnosis/verdict/prepared.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// P(χ²(dof, λ) > threshold): a power of χ² is nearly normal.
double power_of(double lambda, double dof, double threshold) {
  const double mean = dof + lambda;
  const double more = dof + 2.0 * lambda;
  const double h = 1.0 - 2.0 * mean * (dof + 3.0 * lambda) / (3.0 * more * more);
  const double p = more / (mean * mean);
  const double m = (h - 1.0) * (1.0 - 3.0 * h);
  const double centre = 1.0 + h * p * (h - 1.0 - 0.5 * (2.0 - h) * m * p);
  const double width = h * std::sqrt(2.0 * p) * (1.0 + 0.5 * m * p);
  return 0.5 * std::erfc((std::pow(threshold / mean, h) - centre) / width / std::numbers::sqrt2);
}

// The effect of a probe at another amplitude. For a difference the amplitude is the coordinate; for
// a strength it is a multiple of the probe's own.
class Amplitude {
 public:
  Amplitude(const Structure& structure, const Effect& effect, const Probe& probe)
      : structure_(structure), probe_(probe), parameters_(effect.parameters(structure)) {
    choices_ = static_cast<double>(std::max<Index>(1, effect.options(structure)));
  }

  [[nodiscard]] double coordinate(double amplitude) const {
    if (probe_.nothing == Nothing::zero) return amplitude;
    return probe_.x(probe_.size) + probe_.sign() * std::log(amplitude);
  }

  [[nodiscard]] bool plausible(double amplitude) const {
    const auto& size = parameters_[at(probe_.size)];
    return std::abs(coordinate(amplitude) - size.centre) < kPlausible * size.width;
  }

  /// ln of Occam's factor.
  [[nodiscard]] double occam(const MatrixXd& information, double amplitude) const {
    const auto d = static_cast<Index>(parameters_.size());
    VectorXd scale(d);
    double beside = 0.0;
    for (Index i = 0; i < d; ++i) {
      const auto& parameter = parameters_[at(i)];
      const double width = prior_width(structure_, parameter);
      scale(i) = width * growth(i, amplitude);
      if (parameter.is_place()) continue;
      const double x = i == probe_.size ? coordinate(amplitude) : probe_.x(i);
      beside += 0.5 * std::pow((x - parameter.centre) / width, 2);
    }
    MatrixXd whole = scale.asDiagonal() * information * scale.asDiagonal();
    whole.diagonal().array() += 1.0;
    const MatrixXd lower = whole.llt().matrixL();
    return lower.diagonal().array().log().sum() + beside + std::log(choices_);
  }

 private:
  // Ratio of a coordinate's slope to that at the probe. The size multiplies the other slopes.
  [[nodiscard]] double growth(Index i, double amplitude) const {
    if (probe_.nothing != Nothing::zero) return amplitude;
    return parameters_[at(i)].is_about_zero() ? 1.0 : amplitude / probe_.x(probe_.size);
  }

  const Structure& structure_;
  const Probe& probe_;
  std::vector<Parameter> parameters_;
  double choices_ = 1.0;
};

Detectable described(const Structure& structure, const Effect& effect, const Probe& probe,
                     const LeastSize& least) {
  const auto parameters = effect.parameters(structure);
  const auto& size = parameters[at(probe.size)];
  Detectable detectable;
  detectable.effect = effect.name;
  detectable.parameter = size.name;
  detectable.unit = size.unit;
  detectable.channels = effect.channels(structure, probe.option);
  detectable.option = choice_of(effect, probe.option).text;
  detectable.place = place_of({&effect, probe.option, probe.x}, structure);
  for (Index i = 0; i < probe.x.size(); ++i) {
    const auto& parameter = parameters[at(i)];
    if (i != probe.size && parameter.role == Parameter::Role::frequency) {
      detectable.frequency_hz = parameter.value(probe.x(i));
    }
  }
  detectable.from_above = probe.nothing == Nothing::plus_infinity;
  detectable.size = std::isfinite(least.x) ? size.value(least.x) : kInfinite;
  detectable.log_evidence = least.log_evidence;
  return detectable;
}

Detectable described(const Structure& structure, const Effect& effect, Index option,
                     double log_evidence) {
  Detectable detectable;
  detectable.effect = effect.name;
  detectable.channels = effect.channels(structure, option);
  detectable.option = choice_of(effect, option).text;
  detectable.size = std::numeric_limits<double>::quiet_NaN();
  detectable.log_evidence = log_evidence;
  return detectable;
}

// Lower rank: easier to detect.
double rank(const Detectable& detectable) {
  if (detectable.parameter.empty()) return -detectable.log_evidence;
  return detectable.from_above && std::isfinite(detectable.size) ? -detectable.size
                                                                 : detectable.size;
}

// The weights of `all` on the lines of `part`, some of its own.
Observed weighted_as(const Observed& all, Observed part) {
  std::vector<Index> lines;
  for (Index k = 0; k < all.line_count() && std::ssize(lines) < part.line_count(); ++k) {
    if (all.omega(k) == part.omega(std::ssize(lines))) lines.push_back(k);
  }
  part.weight = all.weight(lines, Eigen::all);
  return part;
}

Experiment experiment_with(const Structure& structure, const modal::FrfSet& measured,
                           const DiagnosisOptions& options, const Calibration& calibration) {
  const auto given = prepared_with(structure, measured, options, calibration);
  Experiment experiment{given.structure, {}};
  experiment.looks.push_back({given.for_search(options.lines), given.tolerable});
  if (given.shapes.empty()) return experiment;
  const auto& lines = experiment.looks.front().observed;
  experiment.looks.push_back({weighted_as(given.observed, lines), given.all_deviations()});
  return experiment;
}

}  // namespace

double noncentrality(double threshold, double dof, double power) {
  double low = 0.0;
  double high = threshold + 10.0;
  while (power_of(high, dof, threshold) < power) high *= 2.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (power_of(middle, dof, threshold) < power ? low : high) = middle;
  }
  return high;
}

LeastSize least_size(const Structure& structure, const Effect& effect, const Probe& probe,
                     const MatrixXd& information, const DetectableOptions& options) {
  const Amplitude of(structure, effect, probe);
  const double own = information(probe.size, probe.size);
  const auto dof = static_cast<double>(information.rows());
  LeastSize least{kInfinite, 0.0};
  if (!(own > 0.0) || !information.allFinite()) return least;
  double lambda = 40.0;
  double occam = 0.0;
  for (int iteration = 0; iteration < 30; ++iteration) {
    occam = of.occam(information, std::sqrt(lambda / own));
    const double before = std::exchange(
        lambda, noncentrality(2.0 * (options.least_evidence + occam), dof, options.power));
    if (std::abs(lambda - before) < 1e-6 * lambda) break;
  }
  const double amplitude = std::sqrt(lambda / own);
  if (!of.plausible(amplitude)) return least;
  return {of.coordinate(amplitude), 0.5 * (lambda + dof) - occam};
}

Experiment experiment_of(const Structure& structure, const modal::FrfSet& measured,
                         const DiagnosisOptions& options) {
  return experiment_with(structure, measured, options, calibration_of(structure, options));
}

Detector::Detector(const Experiment& experiment, const DetectableOptions& options)
    : structure_(*experiment.structure),
      options_(options),
      probing_({structure_, experiment.looks.back().observed, experiment.looks.back().deviations}) {
  for (const auto& look : experiment.looks) {
    looks_.emplace_back(Problem{structure_, look.observed, look.deviations},
                        experiment.looks.back().observed);
  }
}

std::vector<LeastSize> Detector::sizes(const Effect& effect,
                                       const std::vector<Probe>& probes) const {
  constexpr std::size_t kTogether = 32;  // limits the memory of the columns
  std::vector<LeastSize> sizes;
  for (std::size_t first = 0; first < probes.size();) {
    // Probes that differ only in the choice of the size coordinate have the same columns.
    std::vector<Probe> different;
    std::vector<std::size_t> which;
    std::size_t next = first;
    for (; next < probes.size() && different.size() < kTogether; ++next) {
      const auto& probe = probes[next];
      const bool again = !different.empty() && different.back().option == probe.option &&
                         different.back().x == probe.x;
      if (!again) different.push_back(probe);
      which.push_back(different.size() - 1);
    }
    const MatrixXd columns = probing_.columns(effect, different);
    std::vector<MatrixXd> known;
    for (const auto& look : looks_) known.push_back(look.of(columns));
    const Index d = columns.cols() / static_cast<Index>(different.size());
    for (std::size_t n = first; n < next; ++n) {
      sizes.push_back(
          larger(effect, probes[n], known, d * static_cast<Index>(which[n - first]), d));
    }
    first = next;
  }
  return sizes;
}

LeastSize Detector::larger(const Effect& effect, const Probe& probe,
                           const std::vector<MatrixXd>& known, Index from, Index count) const {
  LeastSize most;
  for (const auto& of : known) {
    const auto least =
        least_size(structure_, effect, probe, of.block(from, from, count, count), options_);
    const bool more = !std::isfinite(least.x) || probe.sign() * least.x > probe.sign() * most.x;
    if (&of == &known.front() || (more && std::isfinite(most.x))) most = least;
  }
  return most;
}

VectorXd Detector::log_evidence(const Effect& effect) const {
  const MatrixXd changes = probing_.changes(effect);
  VectorXd lambda = VectorXd::Constant(changes.cols(), kInfinite);
  for (const auto& look : looks_) lambda = lambda.cwiseMin(look.of(changes).diagonal());
  return 0.5 * lambda.array() - std::log(static_cast<double>(lambda.size()));
}

std::vector<Detectable> Detector::detectable(const Effect& effect) const {
  if (effect.options(structure_) == 0) return {};
  std::vector<Detectable> each;
  if (effect.parameters(structure_).empty()) {
    const VectorXd evidence = log_evidence(effect);
    for (Index option = 0; option < evidence.size(); ++option) {
      each.push_back(described(structure_, effect, option, evidence(option)));
    }
  } else {
    const auto probes = probing_.probes(effect, options_.places);
    const auto least = sizes(effect, probes);
    for (std::size_t n = 0; n < probes.size(); ++n) {
      each.push_back(described(structure_, effect, probes[n], least[n]));
    }
  }
  if (each.empty()) return {};
  std::ranges::stable_sort(each, {}, rank);
  std::vector<Detectable> quantiles{each.back(), each[each.size() / 2], each.front()};
  quantiles[0].of = "worst";
  quantiles[1].of = "median";
  quantiles[2].of = "best";
  return quantiles;
}

std::vector<Detectable> detectable(const Structure& structure, const modal::FrfSet& measured,
                                   const DiagnosisOptions& options, Index places) {
  DetectableOptions own;
  own.places = places;
  own.least_evidence = options.least_evidence;
  const auto calibration = calibration_of(structure, options);
  const auto experiment = experiment_with(structure, measured, options, calibration);
  const Detector detector(experiment, own);
  const auto catalogue =
      sought_beside(calibration.constants, catalogue_of(options), *experiment.structure);
  std::vector<std::vector<Detectable>> each(catalogue.size());
  const dense::OneBlasThread one_thread;
  parallel_tasks(each.size(), [&](std::size_t n) {
    throw_if_interrupted();
    each[n] = detector.detectable(*catalogue[n]);
  });
  std::vector<Detectable> flat;
  for (auto& of_effect : each) std::ranges::move(of_effect, std::back_inserter(flat));
  return flat;
}

}  // namespace chladni::diagnosis
