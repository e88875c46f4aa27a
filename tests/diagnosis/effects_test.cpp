// Laws of every effect of the catalogue, a newcomer's too.
#include "diagnosis/effect.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "base/error.h"
#include "diagnosis/body_fields.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/probe.h"
#include "diagnosis/small_plate.h"
#include "simulators/hidden/hidden_effect.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Coordinates of a size that is plain to see: half a prior width beside its centre, a place beside
// the middle.
VectorXd plain_size(const Effect& effect) {
  const auto parameters = effect.parameters(small_plate());
  VectorXd x(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < x.size(); ++i) {
    const auto& one = parameters[static_cast<std::size_t>(i)];
    x(i) = one.centre + 0.4 * one.width;
    if (one.role == Parameter::Role::place_u) x(i) = 0.083;
    if (one.role == Parameter::Role::place_v) x(i) = -0.127;
  }
  return x;
}

State with(const Effect& effect, Index option, const VectorXd& x) {
  State state = state_of(small_plate());
  effect.apply(state, small_plate(), option, x);
  return state;
}

class Effects : public testing::TestWithParam<const Effect*> {
 protected:
  void SetUp() override {
    if (effect().options(small_plate()) == 0) GTEST_SKIP() << "cannot be on this plate";
  }
  const Effect& effect() const { return *GetParam(); }
};

TEST_P(Effects, SayWhatTheyAre) {
  EXPECT_FALSE(effect().summary.empty());
  EXPECT_FALSE(effect().source.empty());
  EXPECT_FALSE(effect().confusable.empty());
  for (const auto& parameter : effect().parameters(small_plate())) {
    EXPECT_FALSE(parameter.name.empty());
    EXPECT_FALSE(parameter.unit.empty());
    EXPECT_GT(parameter.step, 0.0);
    EXPECT_NEAR(parameter.coordinate(parameter.value(0.3)), 0.3, 1e-12);
  }
  for (Index option = 0; option < std::min<Index>(4, effect().options(small_plate())); ++option) {
    for (const auto& name : effect().channels(small_plate(), option)) EXPECT_FALSE(name.empty());
  }
}

TEST_P(Effects, HaveRolesForTheirNumbers) {
  const auto parameters = effect().parameters(small_plate());
  if (parameters.empty()) return;
  EXPECT_TRUE(parameters.front().is_size);
  using Role = Parameter::Role;
  const auto count = [&](Role role) {
    return std::ranges::count(parameters, role, &Parameter::role);
  };
  EXPECT_EQ(count(Role::place_u), count(Role::place_v));
  EXPECT_LE(count(Role::place_u), 1);
  EXPECT_LE(count(Role::extent), count(Role::place_u));
  for (const auto& one : parameters) {
    EXPECT_TRUE(!one.is_size || one.scale == parameters.front().scale) << one.name;
    EXPECT_EQ(one.role == Role::frequency, one.unit == "Hz") << one.name;
    EXPECT_FALSE(one.is_place() && one.is_size) << one.name;
  }
}

// Each key of a study gets a number that the effect has.
TEST_P(Effects, SayWhatAStudySaysOfThem) {
  const auto& said = effect().in_study;
  EXPECT_EQ(said.table == InStudy::Table::none, said.keys.empty());
  EXPECT_TRUE(said.keys.empty() || said.refusal.empty());
  const bool has_kind = said.table == InStudy::Table::attachment ||
                        said.table == InStudy::Table::sensor_attachments ||
                        said.table == InStudy::Table::actuator_attachments ||
                        said.table == InStudy::Table::variation;
  EXPECT_EQ(has_kind, !said.kind.empty());
  const auto parameters = effect().parameters(small_plate());
  for (const auto& one : said.keys) {
    EXPECT_FALSE(one.key.empty());
    EXPECT_EQ(one.number.empty(), one.how == StudyKey::How::computed) << one.key;
    const bool fitted = std::ranges::count(parameters, one.number, &Parameter::name) == 1;
    EXPECT_TRUE(one.number.empty() || fitted || one.number == choice_of(effect(), 0).number)
        << one.key;
  }
}

// A small effect with a tolerance is a combination of the deviations of that tolerance.
TEST_P(Effects, ActAsTheirTolerance) {
  if (effect().tolerance == nullptr) GTEST_SKIP() << "has none";
  Tolerances tolerances = no_tolerances();
  tolerances.*(effect().tolerance) = 1e-3;
  const auto tolerable = deviations(small_plate(), tolerances, 1e9);
  ASSERT_FALSE(tolerable.empty());
  const Observed observed = observed_in(state_of(small_plate()), 1.0);
  const Problem problem{small_plate(), observed, tolerable};
  const Probing probing(problem);
  const MatrixXd known =
      sensitivities(problem, {}, VectorXd::Zero(std::ssize(tolerable)), probing.now());
  for (const auto& probe : probing.probes(effect(), 2)) {
    const VectorXd by = probing.size_columns(effect(), std::span(&probe, 1)).col(0);
    const VectorXd left = by - known * known.colPivHouseholderQr().solve(by);
    EXPECT_LT(left.norm(), 0.05 * by.norm()) << probe.option;
  }
}

// At what the score test takes for next to nothing, taken to the end: a difference at 0, a strength
// at a trillionth of a trillionth, a corner or a support's mass as far beyond the usual.
TEST_P(Effects, ChangeNothingWhenTheyHaveNoSize) {
  constexpr double kFar = 60.0;  // of a logarithm
  const Observed observed = observed_in(state_of(small_plate()), 1.0);
  const std::vector<Deviation> none;
  const Probing probing({small_plate(), observed, none});
  for (const auto& probe : probing.probes(effect(), 2)) {
    VectorXd x = probe.x;
    if (probe.nothing == Nothing::zero) x(probe.size) = 0.0;
    if (probe.nothing == Nothing::minus_infinity) x(probe.size) -= kFar;
    if (probe.nothing == Nothing::plus_infinity) x(probe.size) += kFar;
    const MatrixXcd after = responses(with(effect(), probe.option, x), observed.omega);
    EXPECT_LT((after - observed.value).norm(), 1e-9 * observed.value.norm()) << x.transpose();
  }
}

TEST_P(Effects, ChangeTheResponsesWhenTheyHaveOne) {
  const auto omega = some_lines();
  const MatrixXcd before = responses(state_of(small_plate()), omega);
  const MatrixXcd after = responses(with(effect(), 0, plain_size(effect())), omega);
  EXPECT_TRUE(after.allFinite());
  EXPECT_GT((after - before).norm(), 1e-6 * before.norm());
}

TEST_P(Effects, HaveSlopesThatAreDifferences) {
  const auto omega = some_lines();
  const VectorXd x = plain_size(effect());
  const auto parameters = effect().parameters(small_plate());
  const State here = with(effect(), 0, x);
  const Solved now = solved(here, Body(here, omega));
  for (Index i = 0; i < x.size(); ++i) {
    const double h = parameters[static_cast<std::size_t>(i)].step;
    const State minus = with(effect(), 0, x - h * VectorXd::Unit(x.size(), i));
    const State plus = with(effect(), 0, x + h * VectorXd::Unit(x.size(), i));
    const MatrixXcd difference = (responses(plus, omega) - responses(minus, omega)) / (2.0 * h);
    const MatrixXcd found = slope(here, now, minus, plus, 2.0 * h);
    const bool placed = parameters[static_cast<std::size_t>(i)].is_place();
    // The slope of a place leaves out the modes far above.
    EXPECT_LT((found - difference).norm(), (placed ? 0.05 : 2e-3) * difference.norm() + 1e-20)
        << parameters[static_cast<std::size_t>(i)].name;
  }
}

// Else a choice cannot be told, or two that do different things count as one.
TEST_P(Effects, HaveChoicesOfDifferentNames) {
  std::set<std::pair<std::vector<std::string>, std::string>> names;
  for (Index option = 0; option < effect().options(small_plate()); ++option) {
    const auto channels = effect().channels(small_plate(), option);
    EXPECT_TRUE(names.insert({channels, choice_of(effect(), option).text}).second) << option;
  }
}

// The number that a choice says is the one that it applies.
TEST_P(Effects, DoWhatTheirChoicesSay) {
  for (Index option = 0; option < effect().options(small_plate()); ++option) {
    const auto choice = choice_of(effect(), option);
    EXPECT_EQ(choice.text.empty(), choice.number.empty()) << option;
    if (choice.number.empty()) continue;
    const auto& path = with(effect(), option, VectorXd(0)).output_paths;
    const bool all = effect().channels(small_plate(), option).size() > 1;
    const auto i = all ? 0
                       : std::ranges::find(small_plate().outputs.names,
                                           effect().channels(small_plate(), option).front()) -
                             small_plate().outputs.names.begin();
    const auto& one = path[static_cast<std::size_t>(i)];
    ASSERT_TRUE(choice.number == "factor" || choice.number == "derivative") << choice.number;
    EXPECT_DOUBLE_EQ(choice.number == "factor" ? one.gain : one.derivative, choice.value);
  }
}

TEST_P(Effects, HaveAPriorThatIsADensity) {
  Supposed supposed{GetParam(), 0, plain_size(effect())};
  EXPECT_TRUE(std::isfinite(log_prior(supposed, small_plate())));
  Index i = 0;
  for (const auto& parameter : effect().parameters(small_plate())) {
    if (parameter.is_place()) {
      supposed.x(i) = 10.0;
      EXPECT_EQ(log_prior(supposed, small_plate()), -HUGE_VAL);
      return;
    }
    ++i;
  }
}

std::string name_of(const testing::TestParamInfo<const Effect*>& info) {
  return std::string(info.param->name);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Effects, testing::ValuesIn(effects().begin(), effects().end()),
                         name_of);

TEST(Catalogue, HasEachNameOnceAndSaysWhatThereIs) {
  std::set<std::string_view> names;
  for (const auto* one : effects()) EXPECT_TRUE(names.insert(one->name).second) << one->name;
  try {
    (void)effect("point_mas");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("point_mass"), std::string::npos);
  }
}

TEST(Deviations, MoveTheResponsesALittleAndCanBeUndone) {
  const auto& plate = small_plate();
  const auto omega = some_lines();
  const MatrixXcd before = responses(state_of(plate), omega);
  const auto all = deviations(plate, Tolerances{}, 1350.0);
  std::size_t seen = 0;
  for (const auto& deviation : all) {
    State off = state_of(plate);
    deviation.apply(off, 1.0);
    const double moved = (responses(off, omega) - before).norm() / before.norm();
    seen += moved > 0.0 ? 1 : 0;
    EXPECT_LT(moved, 0.3) << deviation.name;
    deviation.apply(off, -1.0);
    EXPECT_LT((responses(off, omega) - before).norm(), 1e-4 * before.norm()) << deviation.name;
  }
  // No channel sees the mode at 921 Hz, and without a cause nothing hangs on any mode.
  EXPECT_EQ(seen + 3, all.size());
}

// Six by six cells sum to the whole body.
TEST(Cells, SumToTheBody) {
  const auto& plate = small_plate();
  const VectorXd ones = VectorXd::Ones(plate.cells.count());
  const State state = state_of(plate);
  EXPECT_LT((sum_of(plate.cells.stiffness, ones) - state.stiffness).norm(),
            1e-9 * state.stiffness.norm());
  EXPECT_LT((sum_of(plate.cells.mass, ones) - state.mass).norm(), 1e-9 * state.mass.norm());
}

TEST(Cells, FineOnesSumToTheBodyAndTheModesAbove) {
  const auto& plate = small_plate();
  const MatrixXd sum = sum_of(plate.fine.stiffness, VectorXd::Ones(plate.fine.count()));
  const Index r = plate.mode_count();
  MatrixXd whole = MatrixXd::Identity(sum.rows(), sum.cols());
  whole.topLeftCorner(r, r) = state_of(plate).stiffness;
  EXPECT_GT(sum.rows(), r);
  const MatrixXd off = sum - whole;
  EXPECT_LT(off.topLeftCorner(r, r).norm(), 1e-9 * whole.norm());
  EXPECT_LT(off.rightCols(sum.rows() - r).norm(), 1e-6 * std::sqrt(whole.norm()));
}

// What the modes above yield stays as it was seen, whatever changes.
Structure with_modes_above_at_rest(Structure plate) {
  for (auto* side : {&plate.outputs, &plate.inputs}) side->upper.resize(side->count(), 0);
  return plate;
}

// What a soft place does to twice as many modes: with those above at rest, and with them yielding.
TEST(Cells, ASoftPlaceMovesTheModesAboveToo) {
  const auto& plate = small_plate();
  const auto more = plate_of(2 * plate.mode_count());
  const VectorXd omega = 2.0 * std::numbers::pi * VectorXd::LinSpaced(60, 50.0, 1000.0);
  VectorXd x(4);
  x << std::log(0.4), 0.083, -0.127, std::log(0.06);
  const auto softened = [&](const Structure& structure) {
    State state = state_of(structure);
    effect("local_stiffness").apply(state, structure, 0, x);
    return responses(state, omega);
  };
  const auto at_rest = with_modes_above_at_rest(plate);
  const MatrixXcd truth = softened(more);
  const double change = (truth - responses(state_of(more), omega)).norm();
  EXPECT_GT((softened(at_rest) - truth).norm(), 0.01 * change);
  EXPECT_LT((softened(plate) - truth).norm(), 0.002 * change);
}

// A channel elsewhere sees the modes above elsewhere, too: against a structure of twice as many.
TEST(MovedChannels, SeeTheModesAboveFromThere) {
  const auto& plate = small_plate();
  const auto more = plate_of(2 * plate.mode_count());
  const VectorXd omega = 2.0 * std::numbers::pi * VectorXd::LinSpaced(60, 50.0, 1000.0);
  const auto with_cause = [&](const Structure& structure, const char* name, const VectorXd& x) {
    State state = state_of(structure);
    effect(name).apply(state, structure, 0, x);
    return responses(state, omega);
  };
  const auto near_to = [&](const char* name, const VectorXd& x) {
    const auto at_rest = with_modes_above_at_rest(plate);
    const MatrixXcd change = with_cause(more, name, x) - responses(state_of(more), omega);
    const auto off = [&](const Structure& structure) {
      const MatrixXcd found =
          with_cause(structure, name, x) - responses(state_of(structure), omega);
      return (found - change).norm() / change.norm();
    };
    EXPECT_LT(off(plate), 0.3 * off(at_rest)) << name << ": " << off(plate) << " " << off(at_rest);
    EXPECT_LT(off(plate), 0.005) << name;
  };
  near_to("sensor_position", Eigen::Vector2d(0.015, -0.004));
  near_to("actuator_position", Eigen::Vector2d(-0.01, 0.012));
  near_to("size_error", VectorXd::Constant(1, 0.02));
}

// To first order: against the same tolerance in a structure of twice as many modes.
TEST(MovedChannels, SeeTheModesAboveWithinTheirTolerance) {
  const auto& plate = small_plate();
  const auto more = plate_of(2 * plate.mode_count());
  const VectorXd omega = 2.0 * std::numbers::pi * VectorXd::LinSpaced(60, 50.0, 1000.0);
  const auto at_rest = with_modes_above_at_rest(plate);
  auto tolerances = no_tolerances();
  tolerances.position = 1e-3;
  const auto changes = [&](const Structure& structure) {
    std::vector<MatrixXcd> all;
    for (const auto& one : deviations(structure, tolerances, 0.0)) {
      State state = state_of(structure);
      one.apply(state, 1.0);
      all.push_back(responses(state, omega) - responses(state_of(structure), omega));
    }
    return all;
  };
  const auto truth = changes(more);
  const auto found = changes(plate);
  const auto left = changes(at_rest);
  ASSERT_EQ(truth.size(), 2 * (plate.outputs.count() + plate.inputs.count()));
  for (std::size_t n = 0; n < truth.size(); ++n) {
    const double off = (found[n] - truth[n]).norm() / truth[n].norm();
    EXPECT_LT(off, 0.5 * (left[n] - truth[n]).norm() / truth[n].norm()) << n;
    EXPECT_LT(off, 0.01) << n;
  }
}

TEST(Cells, NoPlaceLosesMoreStiffnessThanItHas) {
  State state = state_of(small_plate());
  const auto& fine = small_plate().fine;
  const MatrixXd all = sum_of(fine.stiffness, VectorXd::Ones(fine.count()));
  EXPECT_THROW(add_stiffness(state, -1.01 * all), NumericalFailure);
}

}  // namespace
}  // namespace chladni::diagnosis
