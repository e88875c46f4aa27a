// Exchange for the layout with the smallest expected error of interpolation.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/algebra.h"
#include "host/parallel.h"
#include "placement/interpolation.h"
#include "placement/optimum/spacing.h"
#include "placement/optimum/thinned.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;
constexpr double kForbidden = -1.0;  // gain of a forbidden site

// One shape. Its rows are scaled by the prior, so that its coefficients start as the identity.
struct Shape {
  Eigen::MatrixXd rows;        // N×r
  Eigen::MatrixXd gram;        // r×r
  Eigen::MatrixXd covariance;  // r×r, posterior
  double variance = 0.0;       // noise variance of one site
};

// A layout with the remaining uncertainty.
class Layout {
 public:
  explicit Layout(const InterpolationProblem& problem) : problem_(problem) {
    const auto& prior = problem.prior;
    for (Eigen::Index i = 0; i < prior.variance.cols(); ++i) {
      const Eigen::VectorXd scale = prior.variance.col(i).cwiseSqrt();
      Shape shape;
      shape.rows = problem.rows * scale.asDiagonal();
      shape.gram = scale.asDiagonal() * prior.gram * scale.asDiagonal();
      shape.variance = problem.noise(i) * problem.noise(i);
      Eigen::MatrixXd known = Eigen::MatrixXd::Identity(scale.size(), scale.size());
      if (problem.there.rows() > 0) {
        const Eigen::MatrixXd staying = problem.there_noise.col(i).cwiseInverse().asDiagonal() *
                                        problem.there * scale.asDiagonal();
        known += staying.transpose() * staying;
      }
      shape.covariance = dense::inverse_of(known.llt());
      shapes_.push_back(std::move(shape));
    }
  }

  [[nodiscard]] const Indices& sites() const { return sites_; }

  [[nodiscard]] double error() const {
    double sum = 0.0;
    for (const auto& shape : shapes_) sum += shape.gram.cwiseProduct(shape.covariance).sum();
    return sum / static_cast<double>(shapes_.size());
  }

  void add(Eigen::Index site) {
    change(site, 1.0);
    sites_.push_back(site);
  }

  void remove(std::size_t k) {
    change(sites_[k], -1.0);
    sites_.erase(sites_.begin() + static_cast<std::ptrdiff_t>(k));
  }

  // Decrease of the error by each of `candidates`.
  [[nodiscard]] Eigen::VectorXd gains(const Indices& candidates) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(candidates.size()));
    const bool everywhere = sum.size() == problem_.rows.rows();
    for (const auto& shape : shapes_) {
      const Eigen::MatrixXd chosen =
          everywhere ? Eigen::MatrixXd() : shape.rows(candidates, Eigen::all);
      const Eigen::MatrixXd& rows = everywhere ? shape.rows : chosen;
      const Eigen::MatrixXd ahead = rows * shape.covariance;
      const Eigen::VectorXd seen = ahead.cwiseProduct(rows).rowwise().sum();
      const Eigen::MatrixXd weighed = ahead * shape.gram;
      sum.array() +=
          weighed.cwiseProduct(ahead).rowwise().sum().array() / (seen.array() + shape.variance);
    }
    for (Eigen::Index c = 0; c < sum.size(); ++c) {
      if (!fits(candidates[static_cast<std::size_t>(c)])) sum(c) = kForbidden;
    }
    return sum / static_cast<double>(shapes_.size());
  }

  // Adds the best of `candidates`; returns whether there was one.
  bool add_best(const Indices& candidates) {
    Eigen::Index best = 0;
    throw_if_interrupted();
    if (candidates.empty() || gains(candidates).maxCoeff(&best) < 0.0) return false;
    add(candidates[static_cast<std::size_t>(best)]);
    return true;
  }

 private:
  // Rank-one update (Sherman and Morrison).
  void change(Eigen::Index site, double sign) {
    for (auto& shape : shapes_) {
      const Eigen::VectorXd row = shape.rows.row(site).transpose();
      const Eigen::VectorXd ahead = shape.covariance * row;
      shape.covariance -=
          (sign / (shape.variance + sign * row.dot(ahead))) * ahead * ahead.transpose();
    }
  }

  [[nodiscard]] bool fits(Eigen::Index candidate) const {
    return placement::fits(problem_.position, problem_.spacing, sites_, candidate);
  }

  const InterpolationProblem& problem_;
  std::vector<Shape> shapes_;
  Indices sites_;
};

// Replaces each site by the best of `candidates(site)` until a whole round brings no gain.
template <typename Candidates>
void exchange(Layout& layout, int rounds, const Candidates& candidates) {
  for (int round = 0; round < rounds; ++round) {
    const double before = layout.error();
    for (std::size_t k = 0; k < layout.sites().size(); ++k) {
      const Eigen::Index site = layout.sites()[0];  // the oldest site
      layout.remove(0);
      if (!layout.add_best(candidates(site))) layout.add(site);
    }
    if (layout.error() > before * (1.0 - 1e-9)) return;
  }
}

bool fill_greedily(Layout& layout, const Indices& candidates, Eigen::Index count) {
  while (static_cast<Eigen::Index>(layout.sites().size()) < count) {
    if (!layout.add_best(candidates)) return false;
  }
  return true;
}

void fill_at_random(Layout& layout, Indices candidates, Eigen::Index count, std::mt19937& random) {
  // Half of the sites are random, the rest greedy: different starts that are not poor.
  for (Eigen::Index k = 0; k < count / 2; ++k) {
    const Indices one{candidates[random() % candidates.size()]};
    layout.add_best(one);
  }
  fill_greedily(layout, candidates, count);
}

// Exchange among some hundreds of candidates, then among the neighbours of the chosen sites.
class ExchangeSearch {
 public:
  explicit ExchangeSearch(const InterpolationProblem& problem)
      : problem_(problem), empty_(problem), candidates_(problem.position, problem.rows.rows()) {}

  // The first start is greedy, the others are half random; none if the spacing leaves no room.
  [[nodiscard]] std::optional<Layout> from_a_start(int start, std::mt19937& random) const {
    const auto& coarse = candidates_.coarse();
    Layout layout = empty_;
    if (start > 0) fill_at_random(layout, coarse, problem_.count, random);
    if (!fill_greedily(layout, coarse, problem_.count) &&
        !fill_greedily(layout, candidates_.all(), problem_.count)) {
      return std::nullopt;
    }
    exchange(layout, 20, [&](Eigen::Index) -> const Indices& { return coarse; });
    if (candidates_.is_large()) {
      exchange(layout, 10, [&](Eigen::Index site) { return candidates_.near(site); });
    }
    return layout;
  }

  // One more exchange among all candidates, if the search used only a part of them.
  [[nodiscard]] Indices polished(const Indices& sites) const {
    if (!candidates_.is_large()) return sites;
    Layout layout = layout_at(sites);
    exchange(layout, 2, [&](Eigen::Index) -> const Indices& { return candidates_.all(); });
    return layout.sites();
  }

  [[nodiscard]] Layout layout_at(const Indices& sites) const {
    Layout layout = empty_;
    for (const auto site : sites) layout.add(site);
    return layout;
  }

 private:
  const InterpolationProblem& problem_;
  Layout empty_;
  SearchedCandidates candidates_;
};

void check(const InterpolationProblem& problem) {
  require(problem.rows.allFinite(), "layout: what a candidate sees is not finite");
  require(problem.count >= 1 && problem.count <= problem.rows.rows(),
          "layout: " + fmt::to_string(problem.count) + " sites are wanted of " +
              fmt::to_string(problem.rows.rows()) + " candidates");
  require(problem.noise.size() == problem.prior.variance.cols() &&
              problem.rows.cols() == problem.prior.variance.rows() &&
              problem.position.rows() == problem.rows.rows(),
          "layout: the candidates do not fit the prior");
  require(problem.noise.minCoeff() > 0.0, "interpolation: the noise must be more than 0");
}

}  // namespace

Choice best_interpolation(const InterpolationProblem& problem,
                          const InterpolationOptions& options) {
  check(problem);
  const ExchangeSearch search(problem);
  std::mt19937 random(options.seed);
  Choice best;
  double lowest = std::numeric_limits<double>::infinity();
  for (int start = 0; start < options.starts; ++start) {
    const auto layout = search.from_a_start(start, random);
    if (!layout) {
      require(start > 0, "layout: " + fmt::to_string(problem.count) + " sites at least " +
                             fmt::format("{:.6g}", 1e3 * problem.spacing) + " mm apart do not fit");
      continue;
    }
    if (layout->error() < lowest * (1.0 - 1e-9)) {
      lowest = layout->error();
      best.sites = layout->sites();
    }
  }
  best.sites = search.polished(best.sites);
  std::sort(best.sites.begin(), best.sites.end());
  best.score = -search.layout_at(best.sites).error();
  return best;
}

}  // namespace chladni::placement
