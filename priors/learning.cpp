#include "priors/learning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "base/diagonal.h"
#include "base/error.h"
#include "base/upper_median.h"
#include "priors/constants.h"
#include "priors/gaussian_process/line_search.h"
#include "priors/gaussian_process/optimum.h"

namespace chladni::priors {
namespace {

// Range of ln θ of the kernel, then of ln of the noise ratio if it is learned.
struct Range {
  Eigen::VectorXd low, high;
  std::vector<std::string> names;
};

Range range_of(const Kernel& kernel, const Points& points, const Learning& how) {
  const auto length = how.length_range.second > 0.0 ? how.length_range : length_range(points);
  require(length.first > 0.0 && length.first < length.second,
          "learning: the range of lengths is " + fmt::format("{:.6g}", length.first) + " m to " +
              fmt::format("{:.6g}", length.second) + " m; expected two positive ones, ascending");
  Range range;
  const Eigen::Index count = kernel.parameter_count() + (how.learn_noise ? 1 : 0);
  range.low.resize(count);
  range.high.resize(count);
  for (Eigen::Index k = 0; k < kernel.parameter_count(); ++k) {
    const auto& parameter = kernel.parameters()[static_cast<std::size_t>(k)];
    const bool is_length = parameter.unit == "m";
    range.low(k) = std::log(is_length ? length.first : parameter.least);
    range.high(k) = std::log(is_length ? length.second : parameter.most);
    range.names.push_back(parameter.name);
  }
  if (how.learn_noise) {
    range.low(count - 1) = std::log(how.noise_ratio);
    range.high(count - 1) = 0.0;
    range.names.emplace_back("noise");
  }
  return range;
}

void require_sound(const Kernel& kernel, const Points& points, const Eigen::MatrixXd& values,
                   const Learning& how) {
  require(values.rows() == points.rows() && values.cols() > 0 && values.allFinite(),
          "learning: " + fmt::to_string(values.rows()) + " values at " +
              fmt::to_string(points.rows()) + " points, or one is not finite; expected as many");
  require(how.noise.size() == 0 ||
              (how.noise.rows() == values.rows() && how.noise.cols() == values.cols() &&
               (how.noise.array() > 0.0).all() && !how.learn_noise),
          "learning: known noise must be positive, of the size of the values, and is not learned");
  require(how.noise_ratio >= Constants::least_noise_ratio,
          "learning: the noise ratio is " + fmt::format("{:.6g}", how.noise_ratio) +
              "; expected 1e-8 or more, lest rounding choose the length");
  require(how.priors.empty() ||
              static_cast<Eigen::Index>(how.priors.size()) == kernel.parameter_count(),
          "learning: as many priors as hyper-parameters are expected, or none");
  require(how.start.size() == 0 || how.start.size() == kernel.parameter_count(),
          "learning: a start of as many hyper-parameters as the kernel has is expected, or none");
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    require(values.col(i).squaredNorm() > 0.0,
            "learning: shape " + fmt::to_string(i + 1) + " is zero everywhere");
  }
}

// Results at one point of the range, per shape.
struct Seen {
  Seen() = default;
  explicit Seen(Eigen::Index count) : score(count), sigma(count), log_likelihood(count) {}
  Eigen::VectorXd score, sigma, log_likelihood;
  double jitter = 0.0;
};

// Scores of all shapes at one point of the range.
class Merits {
 public:
  Merits(const Kernel& kernel, const Points& points, const Eigen::MatrixXd& values,
         const Learning& how)
      : kernel_(kernel), points_(points), values_(values), how_(how) {}

  [[nodiscard]] Eigen::Index shape_count() const { return values_.cols(); }
  [[nodiscard]] bool noise_is_known() const { return how_.noise.size() > 0; }

  // Scores with the best amplitudes. One factorisation serves all, or one each if noise is known.
  [[nodiscard]] Seen seen(const Eigen::VectorXd& at,
                          const std::vector<Eigen::Index>& shapes) const {
    if (!noise_is_known()) {
      const auto shape_process = process(at);
      return seen(shape_process, values_(Eigen::all, shapes), true);
    }
    Seen scores(static_cast<Eigen::Index>(shapes.size()));
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      const auto shape_process = process(at, shapes[s]);
      const auto part = seen(shape_process, values_.col(shapes[s]), false);
      const auto i = static_cast<Eigen::Index>(s);
      scores.score(i) = part.score(0);
      scores.sigma(i) = shape_process.prior().amplitude;
      scores.log_likelihood(i) = part.log_likelihood(0);
      scores.jitter = std::max(scores.jitter, part.jitter / (scores.sigma(i) * scores.sigma(i)));
    }
    return scores;
  }

  // The sum of the scores of some shapes with its gradient, including the priors.
  double total(const Eigen::VectorXd& at, const std::vector<Eigen::Index>& shapes,
               Eigen::VectorXd& gradient) const {
    gradient.setZero(at.size());
    double sum = 0.0;
    const Eigen::Index p = kernel_.parameter_count();
    const auto add = [&](const GaussianProcess& one, const Eigen::MatrixXd& values, bool profiled) {
      const auto score = one.score(how_.merit, values, profiled);
      const auto slopes = one.slopes(how_.merit, values, score.factor);
      sum += score.value.sum();
      gradient.head(p) += slopes.parameters.rowwise().sum();
      if (how_.learn_noise) gradient(p) += slopes.noise.sum();
    };
    if (noise_is_known()) {
      for (const auto i : shapes) add(process(at, i), values_.col(i), false);
    } else {
      add(process(at), values_(Eigen::all, shapes), true);
    }
    return sum + log_prior(at, gradient);
  }

  double log_prior(const Eigen::VectorXd& at, Eigen::VectorXd& gradient) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < how_.priors.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double off = (at(row) - std::log(how_.priors[k].median)) / how_.priors[k].log_deviation;
      sum -= 0.5 * off * off;
      gradient(row) -= off / how_.priors[k].log_deviation;
    }
    return sum;
  }

  [[nodiscard]] GaussianProcess process(const Eigen::VectorXd& at) const {
    return {prior(at, 1.0), points_, Eigen::VectorXd::Constant(points_.rows(), ratio(at))};
  }
  [[nodiscard]] GaussianProcess process(const Eigen::VectorXd& at, Eigen::Index shape) const {
    const Eigen::VectorXd variance = how_.noise.col(shape).cwiseAbs2();
    const Eigen::VectorXd theta = at.head(kernel_.parameter_count()).array().exp();
    const double amplitude = best_amplitude(covariance(kernel_, theta, points_), variance,
                                            how_.trend.at(points_), values_.col(shape));
    return {prior(at, amplitude), points_, variance};
  }
  [[nodiscard]] double ratio(const Eigen::VectorXd& at) const {
    return how_.learn_noise ? std::exp(at(at.size() - 1)) : how_.noise_ratio;
  }

 private:
  [[nodiscard]] Seen seen(const GaussianProcess& process, const Eigen::MatrixXd& values,
                          bool best_factor) const {
    Seen all;
    const auto score = process.score(how_.merit, values, best_factor);
    all.score = score.value;
    all.sigma = score.factor;
    all.jitter = process.jitter();
    const bool same = how_.merit == Merit::marginal_likelihood;
    all.log_likelihood =
        same ? score.value : process.score(Merit::marginal_likelihood, values, best_factor).value;
    return all;
  }
  [[nodiscard]] GaussianPrior prior(const Eigen::VectorXd& at, double amplitude) const {
    return {kernel_, at.head(kernel_.parameter_count()).array().exp(), amplitude, how_.trend};
  }

  const Kernel& kernel_;
  const Points& points_;
  const Eigen::MatrixXd& values_;
  const Learning& how_;
};

std::vector<Eigen::Index> all_of(Eigen::Index count) {
  std::vector<Eigen::Index> list(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) list[static_cast<std::size_t>(i)] = i;
  return list;
}

struct Found {
  Eigen::VectorXd at;
  double score = 0.0;
  int evaluations = 0;
  Seen seen;  // results at this point for the shapes
};

Seen part_of(const Seen& all, Eigen::Index shape) {
  Seen one(1);
  one.score(0) = all.score(shape);
  one.sigma(0) = all.sigma(shape);
  one.log_likelihood(0) = all.log_likelihood(shape);
  one.jitter = all.jitter;
  return one;
}

// Search with one hyper-parameter: all shapes use the same factorisations.
std::vector<Found> on_a_line(const Merits& merits, const Range& range, const Learning& how) {
  const auto shapes = all_of(merits.shape_count());
  std::map<double, Seen> seen_at;
  const auto values = [&](double at) -> Eigen::VectorXd {
    const Eigen::VectorXd point = Eigen::VectorXd::Constant(1, at);
    Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
    const double prior = merits.log_prior(point, none);
    const auto& seen = seen_at[at] = merits.seen(point, shapes);
    if (how.shared) return Eigen::VectorXd::Constant(1, seen.score.sum() + prior);
    return seen.score.array() + prior;
  };
  const auto best =
      maxima_on_a_line(values, range.low(0), range.high(0), Constants::length_grid, how.tolerance);
  std::vector<Found> found;
  for (const auto& maximum : best.maxima) {
    const auto shape = static_cast<Eigen::Index>(found.size());
    const auto& seen = seen_at.at(maximum.at);
    found.push_back({Eigen::VectorXd::Constant(1, maximum.at), maximum.value, best.evaluations,
                     how.shared ? seen : part_of(seen, shape)});
  }
  return found;
}

// The first start, then random ones; every standard library draws the same bits.
std::vector<Eigen::VectorXd> starts_in(const Range& range, const Learning& how) {
  std::vector<Eigen::VectorXd> starts;
  Eigen::VectorXd first = 0.5 * (range.low + range.high);
  first.head(how.start.size()) = how.start.array().log();
  starts.push_back(first.cwiseMax(range.low).cwiseMin(range.high));
  std::mt19937 random(how.seed);
  while (static_cast<int>(starts.size()) < how.starts) {
    Eigen::VectorXd one(range.low.size());
    for (Eigen::Index k = 0; k < one.size(); ++k) {
      const double part = static_cast<double>(random()) / 4294967296.0;
      one(k) = range.low(k) + part * (range.high(k) - range.low(k));
    }
    starts.push_back(one);
  }
  return starts;
}

Found in_a_box(const Merits& merits, const std::vector<Eigen::Index>& shapes, const Range& range,
               const Learning& how) {
  Found best;
  best.score = -HUGE_VAL;
  int evaluations = 0;
  for (const auto& start : starts_in(range, how)) {
    const auto optimum = minimum(
        [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
          const double value = merits.total(at, shapes, gradient);
          gradient = -gradient;
          return -value;
        },
        start, range.low, range.high, {.tolerance = how.tolerance, .evaluations = 100});
    evaluations += optimum.evaluations;
    if (-optimum.value > best.score) best = {optimum.at, -optimum.value, 0, {}};
  }
  best.evaluations = evaluations;
  best.seen = merits.seen(best.at, shapes);
  return best;
}

Learned told(const Merits& merits, const Found& found, const std::vector<Eigen::Index>& shapes,
             const Range& range, const Learning& how, Eigen::Index parameter_count) {
  Learned result;
  result.parameters = found.at.head(parameter_count).array().exp();
  result.score = found.score;
  result.evaluations = found.evaluations;
  result.sigma = std::sqrt(found.seen.sigma.squaredNorm() / static_cast<double>(shapes.size()));
  result.log_likelihood = found.seen.log_likelihood.sum();
  result.jitter = found.seen.jitter;
  result.noise = result.sigma * std::sqrt(merits.ratio(found.at));
  if (merits.noise_is_known()) result.noise = how.noise(Eigen::all, shapes).mean();
  for (Eigen::Index k = 0; k < found.at.size(); ++k) {
    const double margin = 0.01;
    const bool low = found.at(k) < range.low(k) + margin;
    if (low || found.at(k) > range.high(k) - margin) {
      result.at_bound.push_back(range.names[static_cast<std::size_t>(k)]);
    }
  }
  return result;
}

}  // namespace

std::pair<double, double> length_range(const Points& points) {
  const double diagonal = diagonal_of(points);
  require(diagonal > 0.0, "learning: all points are one; expected points that lie apart");
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    double least = HUGE_VAL;
    for (Eigen::Index j = 0; j < points.rows(); ++j) {
      const double square = (points.row(i) - points.row(j)).squaredNorm();
      if (square > 1e-12 * diagonal * diagonal) least = std::min(least, square);
    }
    nearest.push_back(std::sqrt(least));
  }
  return {0.3 * upper_median(nearest), 5.0 * diagonal};
}

std::vector<Learned> learned(const Kernel& kernel, const Points& points,
                             const Eigen::MatrixXd& values, const Learning& how) {
  require_sound(kernel, points, values, how);
  const Range range = range_of(kernel, points, how);
  const Merits merits(kernel, points, values, how);
  std::vector<std::vector<Eigen::Index>> groups;
  if (how.shared) groups.push_back(all_of(values.cols()));
  for (Eigen::Index i = 0; !how.shared && i < values.cols(); ++i) groups.push_back({i});
  std::vector<Found> found;
  if (range.low.size() == 1) {
    found = on_a_line(merits, range, how);
  } else {
    for (const auto& shapes : groups) found.push_back(in_a_box(merits, shapes, range, how));
  }
  std::vector<Learned> results;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    results.push_back(told(merits, found[g], groups[g], range, how, kernel.parameter_count()));
  }
  return results;
}

Eigen::VectorXd noise_dependence(const std::vector<Learned>& found, const Kernel& kernel,
                                 const Points& points, const Eigen::MatrixXd& values,
                                 const Learning& how) {
  require(how.noise.size() == 0 && !how.learn_noise,
          "noise dependence: the noise is known or learned; expected a ratio");
  Learning louder = how;
  louder.noise_ratio *= 100.0;
  louder.starts = 1;
  std::vector<Learned> again;
  if (kernel.parameter_count() == 1) {
    again = learned(kernel, points, values, louder);
  } else {
    // From where each search ended: another start could end on another peak, or elsewhere along a
    // length that the points do not know, which has nothing to do with the noise.
    for (std::size_t i = 0; i < found.size(); ++i) {
      louder.start = found[i].parameters;
      const auto shape = static_cast<Eigen::Index>(i);
      again.push_back(
          learned(kernel, points, how.shared ? values : Eigen::MatrixXd(values.col(shape)), louder)
              .front());
    }
  }
  Eigen::VectorXd change(static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::ArrayXd moved =
        (again[i].parameters.array() / found[i].parameters.array()).log().abs();
    change(static_cast<Eigen::Index>(i)) =
        std::max(moved.maxCoeff(), std::abs(std::log(again[i].sigma / found[i].sigma)));
  }
  return change;
}

GaussianPrior prior_of(const Kernel& kernel, const Learned& what, const Trend& trend) {
  return {kernel, what.parameters, what.sigma, trend};
}

}  // namespace chladni::priors
