#include "placement/determinant.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/error.h"

namespace chladni::placement {
namespace {

// Free-free plate shapes in miniature: products of Legendre polynomials on an n by n grid.
DeterminantProblem on_grid(int n, int degree, Eigen::Index count) {
  std::vector<Eigen::VectorXd> rows;
  Points position(n * n, 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = 2.0 * i / (n - 1) - 1.0;
      const double y = 2.0 * j / (n - 1) - 1.0;
      position.row(i * n + j) << x, y, 0.0;
      std::vector<double> row;
      for (int a = 0; a <= degree; ++a) {
        for (int b = 0; a + b <= degree; ++b) {
          if (a + b >= 2)
            row.push_back(std::legendre(static_cast<unsigned>(a), x) *
                          std::legendre(static_cast<unsigned>(b), y));
        }
      }
      rows.push_back(
          Eigen::Map<Eigen::VectorXd>(row.data(), static_cast<Eigen::Index>(row.size())));
    }
  }
  DeterminantProblem problem;
  problem.rows.resize(n * n, rows[0].size());
  for (int c = 0; c < n * n; ++c) problem.rows.row(c) = 30.0 * rows[static_cast<std::size_t>(c)];
  const Eigen::Index r = problem.rows.cols();
  problem.prior = Eigen::MatrixXd::Zero(r, r);
  problem.count = count;
  problem.position = position;
  return problem;
}

DeterminantProblem at_random(Eigen::Index n, Eigen::Index r, Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  DeterminantProblem problem;
  problem.rows = Eigen::MatrixXd::NullaryExpr(n, r, [&] { return normal(random); });
  problem.prior = 0.1 * Eigen::MatrixXd::Identity(r, r);
  problem.count = count;
  return problem;
}

// The best of all choices, by looking at every one.
double exhaustive(const DeterminantProblem& problem) {
  std::vector<char> chosen(static_cast<std::size_t>(problem.rows.rows()), 0);
  std::fill(chosen.begin(), chosen.begin() + problem.count, 1);
  double best = -HUGE_VAL;
  do {
    std::vector<Eigen::Index> sites;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      if (chosen[c] == 1) sites.push_back(static_cast<Eigen::Index>(c));
    }
    best = std::max(best, log_determinant(problem, sites));
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return best;
}

TEST(Determinant, TheProvenOptimumIsThatOfLookingAtAllChoices) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto problem = at_random(14, 4, 6, seed);
    const auto choice = best_determinant(problem, {.starts = 0, .node_limit = 100000});
    EXPECT_TRUE(choice.proven) << "seed " << seed;
    EXPECT_NEAR(choice.score, exhaustive(problem), 1e-9) << "seed " << seed;
  }
}

TEST(Determinant, TheBoundIsNeverBelowTheOptimum) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto problem = at_random(12, 5, 5 + seed % 3, seed);
    const auto choice = best_determinant(problem);
    EXPECT_GE(choice.bound, exhaustive(problem) - 1e-9) << "seed " << seed;
    EXPECT_LE(choice.score, choice.bound + 1e-12);
  }
}

TEST(Determinant, GreedyGainsAtLeastItsShareOfTheBest) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto problem = at_random(12, 3, 5, seed);
    const double nothing = log_determinant(problem, {});
    const double gain = log_determinant(problem, greedy(problem)) - nothing;
    EXPECT_GE(gain, (1.0 - std::exp(-1.0)) * (exhaustive(problem) - nothing)) << "seed " << seed;
  }
}

TEST(Determinant, ExchangeNeverLosesAndEndsWhereNoSwapGains) {
  const auto problem = at_random(20, 4, 6, 3);
  const std::vector<Eigen::Index> start{0, 1, 2, 3, 4, 5};
  const auto sites = exchanged(problem, start);
  const double score = log_determinant(problem, sites);
  EXPECT_GE(score, log_determinant(problem, start));
  for (std::size_t k = 0; k < sites.size(); ++k) {
    for (Eigen::Index c = 0; c < 20; ++c) {
      if (std::count(sites.begin(), sites.end(), c) > 0) continue;
      auto other = sites;
      other[k] = c;
      EXPECT_LE(log_determinant(problem, other), score + 1e-8);
    }
  }
}

TEST(Determinant, DoesNotDependOnTheBasisOfTheModes) {
  auto problem = on_grid(9, 4, 13);
  const auto choice = best_determinant(problem);
  const auto turn = at_random(problem.rows.cols(), problem.rows.cols(), 1, 7);
  const Eigen::MatrixXd rotation = turn.rows.householderQr().householderQ();
  problem.rows = (problem.rows * rotation).eval();
  EXPECT_NEAR(best_determinant(problem).score, choice.score, 1e-9);
}

TEST(Determinant, TakesWhatIsThereIntoAccount) {
  auto problem = at_random(14, 4, 3, 5);
  const Eigen::RowVectorXd present = problem.rows.row(0);
  problem.prior += 100.0 * present.transpose() * present;
  const auto choice = best_determinant(problem, {.node_limit = 10000});
  EXPECT_EQ(std::count(choice.sites.begin(), choice.sites.end(), 0), 0);
}

TEST(Determinant, KeepsTheSpacing) {
  auto problem = on_grid(9, 4, 8);
  problem.spacing = 0.45;
  const auto choice = best_determinant(problem, {.node_limit = 50});
  for (const auto a : choice.sites) {
    for (const auto b : choice.sites) {
      if (a == b) continue;
      EXPECT_GE((problem.position.row(a) - problem.position.row(b)).norm(), 0.449);
    }
  }
  problem.spacing = 3.0;
  EXPECT_THROW((void)best_determinant(problem), InvalidInput);
}

// All choices that keep the spacing.
std::vector<std::vector<Eigen::Index>> spaced_choices(const DeterminantProblem& problem) {
  std::vector<std::vector<Eigen::Index>> choices{{}};
  for (Eigen::Index k = 0; k < problem.count; ++k) {
    std::vector<std::vector<Eigen::Index>> longer;
    for (const auto& choice : choices) {
      for (auto c = choice.empty() ? 0 : choice.back() + 1; c < problem.rows.rows(); ++c) {
        const auto is_apart = [&](Eigen::Index a) {
          return (problem.position.row(a) - problem.position.row(c)).norm() >= problem.spacing;
        };
        if (!std::ranges::all_of(choice, is_apart)) continue;
        longer.push_back(choice);
        longer.back().push_back(c);
      }
    }
    choices = std::move(longer);
  }
  return choices;
}

// A chosen place forbids those near it. The trees had 1373 nodes where only its leaves were looked
// at for that.
TEST(Determinant, TheSpacingCutsTheTree) {
  int nodes = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    auto problem = at_random(30, 4, 4, seed);
    problem.position = Points::Zero(30, 3);
    problem.position.col(0) = Eigen::VectorXd::LinSpaced(30, 0.0, 29.0);
    problem.spacing = 4.5;
    const auto choices = spaced_choices(problem);
    ASSERT_GT(choices.size(), 0U);
    double best = -HUGE_VAL;
    for (const auto& one : choices) best = std::max(best, log_determinant(problem, one));
    const auto choice = best_determinant(problem, {.starts = 0, .node_limit = 100000});
    EXPECT_TRUE(choice.proven) << "seed " << seed;
    EXPECT_NEAR(choice.score, best, 1e-9) << "seed " << seed;
    nodes += choice.nodes;
  }
  EXPECT_LT(nodes, 500);
}

TEST(Determinant, IsTheSameOnEveryRun) {
  const auto problem = on_grid(9, 4, 13);
  const auto one = best_determinant(problem, {.node_limit = 20});
  const auto two = best_determinant(problem, {.node_limit = 20});
  EXPECT_EQ(one.sites, two.sites);
  EXPECT_EQ(one.bound, two.bound);
}

TEST(Determinant, RefusesMoreSitesThanCandidates) {
  EXPECT_THROW((void)best_determinant(at_random(5, 2, 6, 1)), InvalidInput);
  auto broken = at_random(5, 2, 3, 1);
  broken.rows(2, 1) = std::nan("");
  EXPECT_THROW((void)best_determinant(broken), InvalidInput);
}

TEST(Determinant, RefusesFewerPositionsThanCandidates) {
  auto problem = at_random(5, 2, 3, 1);
  problem.position = Points::Zero(4, 3);
  EXPECT_THROW((void)best_determinant(problem), InvalidInput);
  problem.position.resize(0, 3);
  EXPECT_EQ(best_determinant(problem).sites.size(), 3U);
  problem.spacing = 0.1;
  EXPECT_THROW((void)best_determinant(problem), InvalidInput);
}

}  // namespace
}  // namespace chladni::placement
