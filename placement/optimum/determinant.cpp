#include "placement/determinant.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <string>

#include "base/error.h"
#include "base/interrupt.h"
#include "placement/constants.h"
#include "placement/optimum/relaxation.h"
#include "placement/optimum/search_tree.h"
#include "placement/optimum/spacing.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;

bool fits(const DeterminantProblem& problem, const Indices& sites, Eigen::Index candidate) {
  return placement::fits(problem.position, problem.spacing, sites, candidate);
}

void check(const DeterminantProblem& problem) {
  require(problem.rows.allFinite() && problem.prior.allFinite(),
          "layout: what a candidate sees is not finite");
  require(problem.count >= 1 && problem.count <= problem.rows.rows(),
          "layout: " + fmt::to_string(problem.count) + " sites are wanted of " +
              fmt::to_string(problem.rows.rows()) + " candidates");
  require_positions(problem.position, problem.rows.rows(), problem.spacing);
  require(
      problem.prior.rows() == problem.rows.cols() && problem.prior.cols() == problem.rows.cols(),
      "layout: the prior does not fit the candidates");
}

[[noreturn]] void refuse_spacing(const DeterminantProblem& problem, std::size_t placed) {
  throw InvalidInput("layout: " + fmt::to_string(problem.count) + " sites at least " +
                     fmt::format("{:.6g}", 1e3 * problem.spacing) + " mm apart do not fit; " +
                     fmt::to_string(placed) + " do");
}

// A random set of sites that keeps the spacing; empty if none was found.
Indices random_sites(const DeterminantProblem& problem, std::mt19937& random) {
  Indices order(static_cast<std::size_t>(problem.rows.rows()));
  std::iota(order.begin(), order.end(), 0);
  Indices sites;
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::swap(order[k], order[k + random() % (order.size() - k)]);
    if (fits(problem, sites, order[k])) sites.push_back(order[k]);
    if (static_cast<Eigen::Index>(sites.size()) == problem.count) return sites;
  }
  return {};
}

struct Swap {
  std::size_t out = 0;
  Eigen::Index in = -1;
  double factor = 1.0;  // of the determinant
};

// det changes by (1 + d_in)(1 − d_out) + d_mixed² (Fedorov).
Swap best_swap(const DeterminantProblem& problem, const Indices& sites) {
  throw_if_interrupted();
  const Eigen::LLT<Eigen::MatrixXd> factor(information(problem, sites));
  const Eigen::MatrixXd seen = factor.matrixL().solve(problem.rows.transpose());
  const Eigen::VectorXd gain = seen.colwise().squaredNorm();
  const Eigen::MatrixXd mixed = seen(Eigen::all, sites).transpose() * seen;
  Swap best;
  best.factor = 1.0 + 1e-9;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const double kept = 1.0 - gain(sites[k]);
    const auto row = mixed.row(static_cast<Eigen::Index>(k));
    for (Eigen::Index c = 0; c < gain.size(); ++c) {
      const double change = (1.0 + gain(c)) * kept + row(c) * row(c);
      if (change <= best.factor) continue;
      Indices others = sites;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      if (fits(problem, others, c)) best = {k, c, change};
    }
  }
  return best;
}

// Candidates that a choice better than `target` can contain: if c is forced in, the relaxation's
// bound falls by at least last_in − d_c (reduced cost).
Indices worth_looking_at(const DeterminantProblem& problem, const Relaxation& root, double target) {
  Eigen::VectorXd sorted = root.gain;
  std::sort(sorted.data(), sorted.data() + sorted.size(), std::greater<>());
  const double last_in = sorted(problem.count - 1);
  Indices worth;
  for (Eigen::Index c = 0; c < root.gain.size(); ++c) {
    if (last_in - root.gain(c) <= root.bound - target) worth.push_back(c);
  }
  const auto enough = static_cast<std::size_t>(std::min(2 * problem.count, problem.rows.rows()));
  if (worth.size() >= enough) return worth;
  worth.resize(static_cast<std::size_t>(problem.rows.rows()));  // almost proven: use all
  std::iota(worth.begin(), worth.end(), 0);
  return worth;
}

DeterminantProblem part(const DeterminantProblem& problem, const Indices& candidates) {
  DeterminantProblem rest = problem;
  rest.rows = problem.rows(candidates, Eigen::all);
  if (problem.position.rows() > 0) rest.position = problem.position(candidates, Eigen::all);
  return rest;
}

// The candidates of largest weight in a relaxation that keep the spacing.
Indices rounded(const DeterminantProblem& problem, const Eigen::VectorXd& weight) {
  Indices order(static_cast<std::size_t>(weight.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return weight(a) > weight(b); });
  Indices sites;
  for (const auto c : order) {
    if (static_cast<Eigen::Index>(sites.size()) == problem.count) break;
    if (fits(problem, sites, c)) sites.push_back(c);
  }
  return static_cast<Eigen::Index>(sites.size()) == problem.count ? sites : Indices{};
}

Indices among(const Indices& candidates, const Indices& chosen) {
  Indices result;
  for (const auto c : chosen) result.push_back(candidates[static_cast<std::size_t>(c)]);
  return result;
}

}  // namespace

double Choice::certificate(Eigen::Index r) const {
  return std::min(1.0, std::exp((score - bound) / static_cast<double>(r)));
}

Eigen::MatrixXd information(const DeterminantProblem& problem, const Indices& sites) {
  const Eigen::MatrixXd rows = problem.rows(sites, Eigen::all);
  Eigen::MatrixXd sum = problem.prior + rows.transpose() * rows;
  // So small that it matters only if no site sees a direction.
  sum.diagonal().array() += 1e-10 * problem.rows.rowwise().squaredNorm().maxCoeff();
  return sum;
}

double log_determinant(const DeterminantProblem& problem, const Indices& sites) {
  const Eigen::LLT<Eigen::MatrixXd> factor(information(problem, sites));
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

Indices greedy(const DeterminantProblem& problem) {
  check(problem);
  const Eigen::LLT<Eigen::MatrixXd> factor(information(problem, {}));
  const Eigen::MatrixXd seen = factor.matrixL().solve(problem.rows.transpose());
  Eigen::VectorXd gain = seen.colwise().squaredNorm();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(seen.rows(), seen.rows());
  Indices sites;
  while (static_cast<Eigen::Index>(sites.size()) < problem.count) {
    throw_if_interrupted();
    Eigen::Index best = -1;
    for (Eigen::Index c = 0; c < gain.size(); ++c) {
      if ((best < 0 || gain(c) > gain(best)) && fits(problem, sites, c)) best = c;
    }
    if (best < 0) refuse_spacing(problem, sites.size());
    sites.push_back(best);
    const Eigen::VectorXd ahead = inverse * seen.col(best);
    const double scale = 1.0 / (1.0 + gain(best));
    gain = (gain - scale * (seen.transpose() * ahead).cwiseAbs2()).cwiseMax(0.0);
    inverse -= scale * ahead * ahead.transpose();
  }
  std::sort(sites.begin(), sites.end());
  return sites;
}

Indices exchanged(const DeterminantProblem& problem, Indices sites) {
  check(problem);
  for (int swaps = 0; swaps < 1000; ++swaps) {
    const Swap swap = best_swap(problem, sites);
    if (swap.in < 0) break;
    sites[swap.out] = swap.in;
  }
  std::sort(sites.begin(), sites.end());
  return sites;
}

Choice best_determinant(const DeterminantProblem& problem, const DeterminantOptions& options) {
  check(problem);
  Choice best;
  best.sites = exchanged(problem, greedy(problem));
  best.score = log_determinant(problem, best.sites);
  const auto root = relaxed(problem.rows, information(problem, {}), problem.count,
                            best.score + options.enough, Constants::root_tolerance);
  const Indices worth = worth_looking_at(problem, root, best.score + options.enough);
  const DeterminantProblem rest = part(problem, worth);
  Choice found = best;
  found.sites.clear();
  std::mt19937 random(options.seed);
  for (int start = 0; start <= options.starts; ++start) {
    const Indices from = start == 0 ? rounded(rest, root.z(worth)) : random_sites(rest, random);
    if (from.empty()) continue;
    const Indices sites = exchanged(rest, from);
    const double score = log_determinant(rest, sites);
    if (score > found.score + 1e-12) found = {sites, score, 0.0, false, 0};
  }
  search(rest, options, found);
  if (!found.sites.empty()) best.sites = among(worth, found.sites);
  best.score = log_determinant(problem, best.sites);
  best.bound = std::max(best.score, std::min(root.bound, found.bound));
  best.proven = best.bound <= best.score + options.enough;
  best.nodes = found.nodes;
  return best;
}

}  // namespace chladni::placement
