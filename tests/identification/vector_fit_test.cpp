#include "identification/poles/vector_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/error.h"
#include "fit_errors.h"
#include "host/parallel.h"
#include "identification/poles/residue_problem.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;

// Largest relative distance from a true pole to the nearest found one.
double farthest(const Eigen::VectorXcd& truth, const Eigen::VectorXcd& found) {
  double all = 0.0;
  for (const auto& pole : truth) {
    all = std::max(all, (found.array() - pole).abs().minCoeff() / std::abs(pole));
  }
  return all;
}

TEST(VectorFit, IsExactWithoutNoise) {
  FrfFaults faults;
  faults.noisy = false;
  const auto made = simulators::beam5x3(faults);
  VectorFitOptions options;
  options.order = 5;
  const auto found = vector_fit(fit_data(made.measured), options);
  ASSERT_EQ(found.size(), 5);
  EXPECT_LT(farthest(start_at(made.truth).pole, found), 1e-9);
}

TEST(VectorFit, LeavesRigidBodyModesToTheirTerm) {
  FrfFaults faults;
  faults.noisy = false;
  const auto made = simulators::big(5, 4, 9, 500, faults);
  VectorFitOptions options;
  options.order = 9;  // a pair is found slowly without spare ones
  options.rigid = true;
  EXPECT_LT(farthest(start_at(made.truth).pole, vector_fit(fit_data(made.measured), options)),
            1e-9);
}

// A pole and its conjugate that are nearly one have a difference of nothing but rounding: its square
// may be below zero. The other poles' residues are those without that pole.
TEST(ResidueProblem, LeavesOutAPoleThatHasNoDigits) {
  const auto made = simulators::beam5x3();
  auto data = fit_data(made.measured);
  data.weight *= 1e8;  // where responses are small, scales of such functions reach beyond a double
  const auto truth = start_at(made.truth).pole;
  const auto without = ResidueProblem(data, truth, true).residues();
  for (int i = 0; i < 40; ++i) {
    const double decay = 200.0 + 30.0 * i;
    Eigen::VectorXcd poles(truth.size() + 1);
    poles << std::complex<double>(-decay, 1e-9 * decay), truth;
    const auto found = ResidueProblem(data, poles, true).residues();
    EXPECT_TRUE(found.significance.allFinite()) << decay;
    EXPECT_TRUE(found.rigid_worth.allFinite()) << decay;
    EXPECT_TRUE(found.of_pole[0].allFinite()) << decay;
    for (std::size_t m = 1; m < found.of_pole.size(); ++m) {
      EXPECT_LT((found.of_pole[m] - without.of_pole[m - 1]).norm(),
                1e-3 * without.of_pole[m - 1].norm())
          << decay;
    }
  }
}

// Poles are near enough to start from at any noise, and whatever order is asked for.
TEST(VectorFit, FindsEveryModeWithinAFractionOfItsBandwidth) {
  for (const double noise : {0.01, 0.1}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      FrfFaults faults;
      faults.relative_noise = noise;
      faults.seed = seed;
      const auto made = simulators::beam5x3(faults);
      VectorFitOptions options;
      options.order = 8;
      const auto found = vector_fit(fit_data(made.measured), options);
      for (const auto& pole : start_at(made.truth).pole) {
        EXPECT_LT((found.array() - pole).abs().minCoeff(), -0.3 * pole.real()) << noise << seed;
      }
    }
  }
}

// More poles than the data need leave functions that are nearly dependent: sums of products hold
// them no better than to the square root of rounding.
TEST(VectorFit, DeterminesPolesAtAnyOrder) {
  for (const double dashpot : {0.02, 0.05, 0.1, 0.2}) {
    FrfFaults faults;
    faults.dashpot = dashpot;
    faults.relative_noise = 1e-3;
    const auto made = simulators::beam5x3(faults);
    VectorFitOptions options;
    options.order = 5;  // as many as there are
    const auto enough = vector_fit(fit_data(made.measured), options);
    for (options.order = 6; options.order <= 30; options.order += 3) {
      const auto found = vector_fit(fit_data(made.measured), options);
      for (const auto& pole : enough) {
        EXPECT_LT((found.array() - pole).abs().minCoeff(), -0.3 * pole.real())
            << dashpot << " " << options.order;
      }
    }
  }
}

TEST(VectorFit, ScalesWithTheUnitOfTime) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  VectorFitOptions options;
  options.order = 7;
  const auto found = vector_fit(data, options);
  FitData other = data;
  other.frequency_hz *= std::ldexp(1.0, 20);
  other.value *= std::ldexp(1.0, -40);
  other.weight *= std::ldexp(1.0, 40);
  const auto scaled = vector_fit(other, options);
  ASSERT_EQ(scaled.size(), found.size());
  EXPECT_LT(farthest(found, scaled * std::ldexp(1.0, -20)), 1e-12);
}

TEST(VectorFit, IgnoresWhatIsNotMeasured) {
  FrfFaults faults;
  faults.missing = 0.2;
  const auto made = simulators::beam5x3(faults);
  auto data = fit_data(made.measured);
  data.weight.col(4).setZero();
  data.value.col(4).setZero();
  VectorFitOptions options;
  options.order = 7;
  const auto found = vector_fit(data, options);
  for (const auto& pole : start_at(made.truth).pole) {
    EXPECT_LT((found.array() - pole).abs().minCoeff(), -0.2 * pole.real());
  }
}

TEST(VectorFit, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  const int before = thread_count();
  std::vector<Eigen::VectorXcd> found;
  for (const int threads : {1, 2, 1}) {
    set_thread_count(threads);
    found.push_back(vector_fit(data, {.order = 8}));
  }
  set_thread_count(before);
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST(VectorFit, RefusesTooFewLines) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  EXPECT_THROW((void)vector_fit(data, {.order = 0}), InvalidInput);
  EXPECT_THROW((void)vector_fit(data, {.order = 400}), InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
