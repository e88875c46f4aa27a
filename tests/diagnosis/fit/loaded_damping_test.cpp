// Damping ratios of the modes with what hangs on them: the same numbers, read otherwise.
#include "diagnosis/attached/loaded_damping.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/small_plate.h"
#include "rotation/turn.h"
#include "simulators/tables/loaded_table.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const Supposed kMass{&effect("point_mass"), 0, Eigen::Vector3d(0.4, 0.12, 0.08)};
const Supposed kSpring{&effect("ground_spring"), 0, Eigen::Vector3d(std::log(8e4), -0.21, 0.14)};
const Supposed kGain{&effect("sensor_gain"), 1, VectorXd::Constant(1, 0.1)};

Tolerances of_loaded_modes() {
  Tolerances tolerances = no_tolerances();
  tolerances.loaded_damping = 1.0;
  return tolerances;
}

// Responses of the plate, for hypotheses whose damping ratios are those of the loaded modes.
struct LoadedProblem {
  const Structure& plate = small_plate();
  Observed observed = observed_in(state_of(plate), 1.0);
  std::vector<Deviation> tolerable = deviations(plate, of_loaded_modes(), 500.0);
  Problem problem{plate, observed, tolerable};
  VectorXd eta = VectorXd::Ones(std::ssize(tolerable));
};

// By their own modes, rigid-body modes that a spring holds too.
TEST(LoadedDamping, GivesEachLoadedModeTheRatioOfTheStudy) {
  const auto& plate = small_plate();
  const State bare = state_of(plate);
  MatrixXd stiffness = bare.stiffness;
  MatrixXd mass = bare.mass;
  const VectorXd there = plate.surface.at({0.12, 0.08})->shape;
  const VectorXd foot = plate.surface.at({-0.21, 0.14})->shape;
  mass += 0.4 * there * there.transpose();
  stiffness += 8e4 * foot * foot.transpose();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness, mass);
  const MatrixXd damping = bare.damping + loaded_damping(plate, {kMass, kGain, kSpring}).gained({});
  const MatrixXd seen = modes.eigenvectors().transpose() * damping * modes.eigenvectors();
  const VectorXd expected = 0.01 * modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  EXPECT_LT((seen - MatrixXd(expected.asDiagonal())).norm(), 1e-6 * expected.norm());
  EXPECT_GT((bare.damping - damping).norm(), 1e-3 * damping.norm());
}

TEST(LoadedDamping, IsNoOtherWhereNothingHangs) {
  EXPECT_EQ(loaded_damping(small_plate(), {kGain}).gained({}).size(), 0);
  EXPECT_EQ(loaded_damping(small_plate(), {}).gained({}).size(), 0);
}

// Less than nothing is left of the mass near a corner, and such a body has no modes.
TEST(LoadedDamping, IsRefusedWhereNoPositiveMassIsLeft) {
  const auto gained = [](double mass) {
    const Supposed taken{&effect("point_mass"), 0, Eigen::Vector3d(mass, 0.28, 0.28)};
    return loaded_damping(small_plate(), {taken}).gained({}).norm();
  };
  EXPECT_LT(gained(-0.1), 0.1 * state_of(small_plate()).damping.norm());
  EXPECT_THROW(static_cast<void>(gained(-0.3)), NumericalFailure);
  EXPECT_THROW(static_cast<void>(gained(-2.0)), NumericalFailure);
}

// A tolerance of a mode's damping is that of the loaded mode where the ratios are.
TEST(LoadedDamping, DeviatesByLoadedModes) {
  const auto& plate = small_plate();
  Tolerances tolerances = no_tolerances();
  tolerances.damping = 0.2;
  tolerances.loaded_damping = 1.0;
  const auto tolerable = deviations(plate, tolerances, 500.0);
  const Observed observed = observed_in(state_of(plate), 1.0);
  const Problem problem{plate, observed, tolerable};
  VectorXd eta = VectorXd::Zero(std::ssize(tolerable));
  eta.tail(1).setOnes();
  const std::vector<Supposed> causes{kMass, kSpring};
  const State even = state_of(problem, causes, eta);
  const auto own = std::ranges::find(tolerable, true, [&](const Deviation& one) {
    return one.name.starts_with("damping of the mode");
  });
  ASSERT_NE(own, tolerable.end());
  eta(own - tolerable.begin()) = 2.0;
  const State uneven = state_of(problem, causes, eta);
  // One loaded mode alone is damped more: the change has rank one.
  const MatrixXd change = uneven.damping - even.damping;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(change);
  const VectorXd size = parts.eigenvalues().cwiseAbs();
  EXPECT_LT(size.head(size.size() - 1).maxCoeff(), 1e-9 * size.maxCoeff());
  // And it is that mode: its loss is larger by exp(0.4).
  MatrixXd stiffness = even.stiffness;
  MatrixXd mass = even.mass;
  for (const auto& one : even.attached) {
    stiffness += one.stiffness * one.shapes * one.shapes.transpose();
    mass += one.mass * one.shapes * one.shapes.transpose();
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness, mass);
  const auto losses = [&](const State& state) -> VectorXd {
    return (modes.eigenvectors().transpose() * state.damping * modes.eigenvectors()).diagonal();
  };
  const VectorXd times = losses(uneven).cwiseQuotient(losses(even).cwiseMax(1e-12));
  EXPECT_NEAR(times.maxCoeff(), std::exp(0.4), 1e-6);
}

// A square plate with a repeated pair whose two ratios differ. A change of the whole body in the
// last digits gives the eigensolver other shapes of the pair, and the damping must not jump with
// them.
TEST(LoadedDamping, DoesNotJumpInARepeatedMode) {
  Structure plate = small_plate();
  const Index one = plate.rigid_count + 1;
  plate.frequency_hz(one + 1) = plate.frequency_hz(one);
  VectorXd relative = VectorXd::Zero(plate.mode_count());
  relative(one) = 0.4;
  const auto scaled = [&](double by) {
    const Supposed thicker{&effect("thickness"), 0, VectorXd::Constant(1, by)};
    return loaded_damping(plate, {thicker}).gained(relative);
  };
  double most = 0.0;
  for (int n = 1; n <= 20; ++n) {
    const MatrixXd change = scaled(0.01 + 1e-12 * n) - scaled(0.01);
    most = std::max(most, change.norm());
  }
  EXPECT_LT(most, 1e-7 * state_of(plate).damping.norm());
  // Each of the two keeps its own ratio, as it has beside no cause at all.
  const MatrixXd small = scaled(1e-9);
  EXPECT_LT(small.norm(), 1e-6 * state_of(plate).damping.norm());
}

// A step of a coordinate would leave no positive mass there: the slopes are those of shorter steps.
TEST(LoadedDamping, HasSlopesBesideABodyThatIsImpossible) {
  const LoadedProblem loaded;
  const auto& [plate, observed, tolerable, problem, eta] = loaded;
  const auto taken = [](double mass) {
    return std::vector<Supposed>{{&effect("point_mass"), 0, Eigen::Vector3d(mass, 0.28, 0.28)}};
  };
  double possible = -0.1;
  double impossible = -0.3;
  const double step = columns_of(plate, taken(0.1)).front().parameter.step;
  while (possible - impossible > 0.05 * step) {
    const double middle = 0.5 * (possible + impossible);
    try {
      static_cast<void>(loaded_damping(plate, taken(middle)));
      possible = middle;
    } catch (const NumericalFailure&) {
      impossible = middle;
    }
  }
  const auto causes = taken(possible + 0.2 * step);
  const State state = state_of(problem, causes, eta);
  const Solved now = solved(state, Body(state, observed.omega));
  const MatrixXd slopes = sensitivities(problem, causes, eta, now);
  EXPECT_TRUE(slopes.allFinite());
  for (const auto& column : slopes.leftCols(3).colwise()) EXPECT_GT(column.norm(), 0.0);
}

// What is taken away is possible beside what is added, and alone it is not.
TEST(LoadedDamping, OfACauseThatNeedsAnotherIsComparedWithNothing) {
  const LoadedProblem loaded;
  const auto& problem = loaded.problem;
  Fit nothing;
  nothing.eta = loaded.eta;
  nothing.log_evidence = -7.0;
  Fit both = nothing;
  both.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(0.5, 0.28, 0.28)},
                 {&effect("point_mass"), 0, Eigen::Vector3d(-0.45, 0.28, 0.28)}};
  EXPECT_EQ(without(problem, both, 0, nothing).log_evidence, -7.0);
  EXPECT_EQ(without(problem, both, 1, nothing).causes.size(), 1U);
}

// The slopes by every coordinate and deviation, where the ratios are partly those of the loaded
// modes.
TEST(LoadedDamping, HasSlopesThatAreDifferences) {
  const auto& plate = small_plate();
  const Observed observed = observed_in(state_of(plate), 1.0);
  Tolerances tolerances;
  tolerances.position = tolerances.gain = 0.0;
  tolerances.residual = 0.0;  // what hangs sees of the modes above is left out of that slope
  const auto tolerable = deviations(plate, tolerances, 500.0);
  const Problem problem{plate, observed, tolerable};
  VectorXd eta = VectorXd::Constant(std::ssize(tolerable), 0.1);
  const auto own = std::ranges::find_if(tolerable, [&](const Deviation& one) {
    State state = state_of(plate);
    one.apply(state, 1.0);
    return state.loaded_damping != 0.0;
  });
  ASSERT_NE(own, tolerable.end());
  eta(own - tolerable.begin()) = 0.7;
  const std::vector<Supposed> causes{kMass, kSpring};
  const State state = state_of(problem, causes, eta);
  const Solved now = solved(state, Body(state, observed.omega));
  const MatrixXd slopes = sensitivities(problem, causes, eta, now);
  const auto value = [&](const std::vector<Supposed>& of, const VectorXd& at) {
    return weighted(observed, responses(state_of(problem, of, at), observed.omega));
  };
  for (Index n = 0; n < 6; ++n) {
    const double h = n % 3 == 0 ? 1e-4 : 1e-5;
    auto minus = causes;
    auto plus = causes;
    minus[static_cast<std::size_t>(n / 3)].x(n % 3) -= h;
    plus[static_cast<std::size_t>(n / 3)].x(n % 3) += h;
    const VectorXd difference = (value(plus, eta) - value(minus, eta)) / (2.0 * h);
    const double little = n % 3 == 0 ? 2e-3 : 0.05;  // of a place the modes far above are left out
    EXPECT_LT((slopes.col(n) - difference).norm(), little * difference.norm()) << n;
  }
  for (Index i = (own - tolerable.begin()) % 9; i < eta.size(); i += 9) {
    const VectorXd by = 1e-3 * VectorXd::Unit(eta.size(), i);
    const VectorXd difference = (value(causes, eta + by) - value(causes, eta - by)) / 2e-3;
    EXPECT_LT((slopes.col(6 + i) - difference).norm(), 2e-3 * difference.norm() + 1e-9)
        << tolerable[static_cast<std::size_t>(i)].name;
  }
}

// A table of the same polynomials with 400 g on it, each loaded mode damped by the ratio of the
// study: it differs from the model in that alone.
class LoadedTable : public testing::Test {
 protected:
  static constexpr double kCarried = 0.4;

  static Diagnosis told(double loaded_damping, double spread = 0.0) {
    static const Structure plate = plate_of(30, 15);
    simulators::LoadedTable table;
    table.mass = kCarried;
    table.noise = 1e-3;
    table.place = {0.12, 0.08};
    table.lines = 80;
    table.high_hz = 700.0;
    table.damping_spread = spread;
    const auto measured = simulators::loaded_table(simulators::believed_table(8), table);
    DiagnosisOptions options;
    options.lines = 60;
    options.tolerances.loaded_damping = loaded_damping;
    options.only = {"point_mass", "ground_damper", "resonator", "modal_damping", "ground_spring"};
    return diagnosed(plate, measured, options);
  }
  static bool names(const Diagnosis& diagnosis, std::string_view name) {
    return std::ranges::any_of(diagnosis.best.causes,
                               [&](const Cause& cause) { return cause.effect == name; });
  }
};

TEST_F(LoadedTable, HasAMassAndNoDamper) {
  EVERY_FOURTH_LANDING();
  const auto diagnosis = told(1.0);
  EXPECT_EQ(diagnosis.verdict, Verdict::named) << diagnosis.best.excess;
  ASSERT_EQ(diagnosis.best.causes.size(), 1U) << diagnosis.best.causes.back().effect;
  const Cause& mass = diagnosis.best.causes.front();
  EXPECT_EQ(mass.effect, "point_mass");
  const auto& size = mass.parameters.front();
  EXPECT_LT(std::abs(size.value - kCarried), 2.5 * size.std);
  EXPECT_LT(size.std, 0.03 * kCarried);
  EXPECT_LT((*mass.place - Eigen::Vector2d(0.12, 0.08)).norm(), 3e-3);
}

// No matrix that damps the modes of the bare table one by one does that.
TEST_F(LoadedTable, HasAMassAloneWhereEachLoadedModeHasARatioOfItsOwn) {
  EVERY_FOURTH_LANDING();
  const auto diagnosis = told(1.0, 0.3);
  EXPECT_EQ(diagnosis.verdict, Verdict::named) << diagnosis.best.excess;
  ASSERT_EQ(diagnosis.best.causes.size(), 1U) << diagnosis.best.causes.back().effect;
  EXPECT_EQ(diagnosis.best.causes.front().effect, "point_mass");
}

// Where the ratios are held to be those of the bare table, something is left or damps it.
TEST_F(LoadedTable, IsNotExplainedWhereItsRatiosAreTakenForThoseOfTheBareOne) {
  EVERY_FOURTH_LANDING();
  const auto diagnosis = told(0.0);
  const auto& best = diagnosis.best;
  EXPECT_TRUE(best.causes.size() > 1 || best.excess > 3.2)
      << best.excess << " " << best.causes.size() << " " << diagnosis.breaches.size();
}

}  // namespace
}  // namespace chladni::diagnosis
