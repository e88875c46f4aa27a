// Exchange for the layout with the smallest expected error of interpolation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "base/error.h"
#include "base/interrupt.h"
#include "placement/interpolation.h"
#include "placement/layout_criteria/posterior.h"
#include "placement/optimum/spacing.h"
#include "placement/optimum/thinned.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;
constexpr double kForbidden = -1.0;  // gain of a forbidden site

// What the sites of a layout leave unknown of one shape: W with the coefficients' covariance W Wᵀ.
struct Unknown {
  Eigen::MatrixXd root;
  Eigen::MatrixXd gram;  // Wᵀ G W, whose trace is the error
};

// A layout with the remaining uncertainty of each shape.
class Layout {
 public:
  explicit Layout(const InterpolationProblem& problem) : problem_(problem) {
    const auto& prior = problem.prior;
    for (Eigen::Index i = 0; i < prior.variance.cols(); ++i) {
      const bool none = problem.there.rows() == 0;
      start_.push_back(root_of_posterior(
          prior.variance.col(i), problem.there,
          none ? Eigen::VectorXd() : Eigen::VectorXd(problem.there_noise.col(i))));
    }
    begin_anew();
  }

  [[nodiscard]] const Indices& sites() const { return sites_; }

  [[nodiscard]] double error() const {
    double sum = 0.0;
    for (const auto& shape : shapes_) sum += shape.gram.trace();
    return sum / static_cast<double>(shapes_.size());
  }

  void add(Eigen::Index site) {
    learn_from(site);
    sites_.push_back(site);
    weigh();
  }

  // The digits that a site took away do not come back: the others are added once more.
  void remove(std::size_t k) {
    sites_.erase(sites_.begin() + static_cast<std::ptrdiff_t>(k));
    begin_anew();
  }

  // Decrease of the error by each of `candidates`.
  [[nodiscard]] Eigen::VectorXd gains(const Indices& candidates) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(candidates.size()));
    const bool everywhere = sum.size() == problem_.rows.rows();
    const Eigen::MatrixXd chosen =
        everywhere ? Eigen::MatrixXd() : problem_.rows(candidates, Eigen::all);
    const Eigen::MatrixXd& rows = everywhere ? problem_.rows : chosen;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const double noise = problem_.noise(static_cast<Eigen::Index>(i));
      const Eigen::MatrixXd seen = rows * shapes_[i].root;
      const Eigen::MatrixXd weighed = seen * shapes_[i].gram;
      sum.array() += weighed.cwiseProduct(seen).rowwise().sum().array() /
                     (seen.rowwise().squaredNorm().array() + noise * noise);
    }
    sum = (sum / static_cast<double>(shapes_.size())).cwiseMax(0.0).eval();
    for (Eigen::Index c = 0; c < sum.size(); ++c) {
      if (!fits(candidates[static_cast<std::size_t>(c)])) sum(c) = kForbidden;
    }
    return sum;
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
  void learn_from(Eigen::Index site) {
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      learn(problem_.rows.row(site), problem_.noise(static_cast<Eigen::Index>(i)), shapes_[i].root);
    }
  }

  void weigh() {
    for (auto& shape : shapes_) {
      shape.gram = shape.root.transpose() * problem_.prior.gram * shape.root;
    }
  }

  void begin_anew() {
    shapes_.assign(start_.size(), {});
    for (std::size_t i = 0; i < shapes_.size(); ++i) shapes_[i].root = start_[i];
    for (const auto site : sites_) learn_from(site);
    weigh();
  }

  [[nodiscard]] bool fits(Eigen::Index candidate) const {
    return placement::fits(problem_.position, problem_.spacing, sites_, candidate);
  }

  const InterpolationProblem& problem_;
  std::vector<Eigen::MatrixXd> start_;  // W of each shape before any site
  std::vector<Unknown> shapes_;
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
