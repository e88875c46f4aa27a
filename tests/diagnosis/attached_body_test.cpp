// A body that carries masses and stands on springs: what scales the body leaves them alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "diagnosis/effect.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Three springs with dashpots that hold the plate, two masses on it: r×r on the plate's modes.
struct Things {
  MatrixXd springs, dashpots, masses;
};

// Rows of the same, so that Σ rowᵀ row is the matrix.
// @param longer  the plate is stretched so much about its middle, and they stay in space
Things forms_on(const Structure& plate, double longer) {
  const Index r = plate.mode_count();
  Things all{MatrixXd(0, r), MatrixXd(0, r), MatrixXd(0, r)};
  const Eigen::Vector2d middle = plate.cells.from + 0.5 * plate.cells.size;
  const auto add = [&](double u, double v, MatrixXd& to, double by) {
    const Eigen::Vector2d on_it = middle + (Eigen::Vector2d(u, v) - middle) / longer;
    const VectorXd shape = plate.surface.at(on_it)->shape;
    to.conservativeResize(to.rows() + 1, Eigen::NoChange);
    to.bottomRows(1) = std::sqrt(by) * shape.transpose();
  };
  constexpr std::array<std::array<double, 2>, 3> kFeet{{{-0.2, -0.25}, {0.27, -0.1}, {0.0, 0.2}}};
  for (const auto& [u, v] : kFeet) {
    add(u, v, all.springs, 2e5);
    add(u, v, all.dashpots, 30.0);
  }
  add(0.12, 0.08, all.masses, 1.5);
  add(-0.21, 0.14, all.masses, 0.8);
  return all;
}

Things things_on(const Structure& plate, double longer = 1.0) {
  const Things forms = forms_on(plate, longer);
  return {forms.springs.transpose() * forms.springs, forms.dashpots.transpose() * forms.dashpots,
          forms.masses.transpose() * forms.masses};
}

// The small plate without modes above, whose flexibility a mass that hangs on it would see.
const Structure& bare() {
  static const Structure made = [] {
    Structure plate = small_plate();
    const Index r = plate.mode_count();
    for (auto* side : {&plate.outputs, &plate.inputs}) side->upper.resize(side->count(), 0);
    for (auto& cell : plate.fine.stiffness) cell = MatrixXd(cell.topLeftCorner(r, r));
    plate.surface.at = [at = plate.surface.at](const Eigen::Vector2d& place) {
      auto motion = at(place);
      for (auto* upper : {&motion->upper, &motion->upper_slope_u, &motion->upper_slope_v}) {
        if (motion) upper->resize(0);
      }
      return motion;
    };
    return plate;
  }();
  return made;
}

// The same on plates of three sizes.
BeneathAttached grown_things() {
  constexpr double kStep = 0.02;
  const Things here = forms_on(bare(), 1.0);
  const Things less = forms_on(bare(), 1.0 / (1.0 + kStep));
  const Things more = forms_on(bare(), 1.0 / (1.0 - kStep));
  const auto forms = [&](MatrixXd Things::*kind) {
    return GrownForms{here.*kind, VectorXd::Constant(1, kStep), {less.*kind}, {more.*kind}};
  };
  return {forms(&Things::springs), forms(&Things::masses), forms(&Things::dashpots)};
}

void turn(std::vector<MatrixXd>& matrices, const MatrixXd& by) {
  for (auto& one : matrices) one = MatrixXd(by.transpose() * one * by);
}

void turn(ChannelSide& side, const MatrixXd& by) {
  for (auto* rows : {&side.shapes, &side.slope_u, &side.slope_v, &side.aside_u, &side.aside_v}) {
    *rows = MatrixXd(*rows * by);
  }
}

// As a study would state the plate and the things: by the modes of both together.
const Structure& carrying() {
  static const Structure made = [] {
    Structure plate = bare();
    const Things things = things_on(plate);
    const State state = state_of(plate);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(state.stiffness + things.springs,
                                                                   state.mass + things.masses);
    const MatrixXd by = modes.eigenvectors();
    const auto turned = [&](const MatrixXd& matrix) {
      return MatrixXd(by.transpose() * matrix * by);
    };
    plate.frequency_hz = modes.eigenvalues().cwiseSqrt() / (2.0 * std::numbers::pi);
    plate.rigid_count = 0;
    plate.damping_ratio.setZero();
    plate.dashpots = turned(state.damping + things.dashpots);
    plate.springs = turned(things.springs);
    plate.masses = turned(things.masses);
    turn(plate.outputs, by);
    turn(plate.inputs, by);
    plate.surface.shapes *= by;
    plate.surface.at = [at = plate.surface.at, by](const Eigen::Vector2d& place) {
      auto motion = at(place);
      for (auto* shape : {&motion->shape, &motion->slope_u, &motion->slope_v}) {
        if (motion) *shape = VectorXd(by.transpose() * *shape);
      }
      return motion;
    };
    for (auto* cells : {&plate.cells.stiffness, &plate.cells.mass, &plate.cells.shear,
                        &plate.cells.rotary, &plate.cells.waves.modulus, &plate.cells.waves.bent,
                        &plate.cells.waves.thickened, &plate.fine.stiffness}) {
      turn(*cells, by);
    }
    auto& constants = plate.directional;
    for (auto* one :
         {&constants.along_u, &constants.along_v, &constants.across, &constants.shear}) {
      *one = turned(*one);
    }
    check(plate);
    return plate;
  }();
  return made;
}

void attach(State& state, const Things& things) {
  attach_stiffness(state, things.springs);  // drift scales the body while it is measured
  attach_damping(state, things.dashpots);
  attach_mass(state, things.masses);
}

// The bare plate in that state with the things put on it afterwards.
MatrixXcd with_things(State state) {
  attach(state, things_on(bare()));
  return responses(state, some_lines());
}

VectorXd plain_size(const Effect& effect) {
  const auto parameters = effect.parameters(bare());
  VectorXd x(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < x.size(); ++i) {
    const auto& one = parameters[static_cast<std::size_t>(i)];
    x(i) = one.centre + 0.4 * one.width;
    if (one.role == Parameter::Role::place_u) x(i) = 0.083;
    if (one.role == Parameter::Role::place_v) x(i) = -0.127;
  }
  return x;
}

State changed(const Structure& structure, const Effect& effect, const VectorXd& x) {
  State state = state_of(structure);
  effect.apply(state, structure, 0, x);
  return state;
}

class AttachedBody : public testing::TestWithParam<const Effect*> {
 protected:
  void SetUp() override {
    if (effect().options(bare()) == 0 || effect().options(carrying()) == 0) {
      GTEST_SKIP() << "cannot be on both plates";
    }
    if (effect().name == "modal_damping" || effect().name == "hysteretic_damping") {
      GTEST_SKIP() << "the losses of this plate are stated as dashpots";
    }
  }
  const Effect& effect() const { return *GetParam(); }
};

TEST(AttachedBody, IsTheBodyWithWhatIsAttached) {
  const MatrixXcd expected = with_things(state_of(bare()));
  const MatrixXcd found = responses(state_of(carrying()), some_lines());
  EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm());
}

// First the cause in the body and then the things on it, or the other way round.
TEST_P(AttachedBody, IsScaledWithoutWhatIsAttached) {
  const VectorXd x = plain_size(effect());
  const MatrixXcd before = responses(state_of(carrying()), some_lines());
  const MatrixXcd expected = with_things(changed(bare(), effect(), x));
  const MatrixXcd found = responses(changed(carrying(), effect(), x), some_lines());
  const double change = (expected - before).norm();
  EXPECT_GT(change, 1e-6 * before.norm());
  EXPECT_LT((found - expected).norm(), 1e-5 * change + 1e-8 * before.norm());
}

TEST_P(AttachedBody, HasSlopesThatAreDifferences) {
  const VectorXd x = plain_size(effect());
  const auto parameters = effect().parameters(bare());
  const State here = changed(carrying(), effect(), x);
  const Solved now = solved(here, Body(here, some_lines()));
  for (Index i = 0; i < x.size(); ++i) {
    const double h = parameters[static_cast<std::size_t>(i)].step;
    const State minus = changed(carrying(), effect(), x - h * VectorXd::Unit(x.size(), i));
    const State plus = changed(carrying(), effect(), x + h * VectorXd::Unit(x.size(), i));
    const MatrixXcd difference =
        (responses(plus, some_lines()) - responses(minus, some_lines())) / (2.0 * h);
    EXPECT_LT((slope(here, now, minus, plus, 2.0 * h) - difference).norm(),
              2e-3 * difference.norm() + 1e-20)
        << parameters[static_cast<std::size_t>(i)].name;
  }
}

std::string name_of(const testing::TestParamInfo<const Effect*>& info) {
  return std::string(info.param->name);
}
INSTANTIATE_TEST_SUITE_P(Catalogue, AttachedBody,
                         testing::ValuesIn(effects().begin(), effects().end()), name_of);

// Those of single modes are of the modes that there are.
TEST(AttachedBody, DeviatesWithoutWhatIsAttached) {
  const auto on_bare = deviations(bare(), Tolerances{}, 900.0);
  int compared = 0;
  for (const auto& deviation : deviations(carrying(), Tolerances{}, 900.0)) {
    if (deviation.name.ends_with("Hz")) continue;
    const auto same = std::ranges::find(on_bare, deviation.name, &Deviation::name);
    ASSERT_NE(same, on_bare.end()) << deviation.name;
    State plain = state_of(bare());
    same->apply(plain, 2.0);
    State loaded = state_of(carrying());
    deviation.apply(loaded, 2.0);
    const MatrixXcd expected = with_things(plain);
    EXPECT_LT((responses(loaded, some_lines()) - expected).norm(), 1e-6 * expected.norm())
        << deviation.name;
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

// A dashpot of the study, a loop's: no loss of the body's modes.
TEST(AttachedBody, LosesByItsModesAlone) {
  Structure plate = bare();
  plate.dashpots = things_on(plate).dashpots;
  const State before = state_of(plate);
  const MatrixXd own = before.damping - plate.dashpots;
  for (const auto* name : {"modal_damping", "hysteretic_damping"}) {
    const VectorXd x = plain_size(effect(name));
    const State scaled = changed(plate, effect(name), x);
    const State alone = changed(bare(), effect(name), x);
    EXPECT_GT((alone.damping - own).norm(), 0.1 * own.norm()) << name;
    EXPECT_LT((scaled.damping - plate.dashpots - alone.damping).norm(), 1e-12 * own.norm()) << name;
    EXPECT_LT((scaled.loss - alone.loss).norm(), 1e-12 * (alone.loss.norm() + 1.0)) << name;
  }
}

// A support or a mass that came before is not the body either, whichever cause is told first.
TEST(AttachedBody, IsScaledAlikeBeforeAndAfterItIsHeld) {
  const auto& hold = effect("suspension");
  for (const auto* name :
       {"youngs_modulus", "density", "thickness", "size_error", "modal_damping"}) {
    const VectorXd x = plain_size(effect(name));
    State first = changed(bare(), effect(name), x);
    hold.apply(first, bare(), 0, plain_size(hold));
    State last = changed(bare(), hold, plain_size(hold));
    effect(name).apply(last, bare(), 0, x);
    const MatrixXcd expected = responses(first, some_lines());
    EXPECT_LT((responses(last, some_lines()) - expected).norm(), 1e-9 * expected.norm()) << name;
  }
}

// What a study places by coordinates stays where it is in space, and moves on the larger body.
TEST(AttachedBody, LeavesWhatIsAttachedInItsPlaceWhenItGrows) {
  const auto& size = effect("size_error");
  const VectorXd x = VectorXd::Constant(1, 0.005);
  const auto with_size_error = [&](const Structure& plate) {
    State state = state_of(bare());
    attach(state, things_on(bare()));
    size.apply(state, plate, 0, x);
    return responses(state, some_lines());
  };
  State larger = changed(bare(), size, x);
  attach(larger, things_on(bare(), std::exp(x(0))));
  const MatrixXcd expected = responses(larger, some_lines());
  const MatrixXcd taken_along = with_size_error(bare());
  Structure plate = bare();
  plate.grown = grown_things();
  check(plate);
  EXPECT_GT((taken_along - expected).norm(), 1e-3 * expected.norm());
  EXPECT_LT((with_size_error(plate) - expected).norm(), 0.03 * (taken_along - expected).norm());
  plate.grown.masses.rows.resize(3, 3);
  EXPECT_THROW(check(plate), InvalidInput);
  plate.grown = grown_things();
  plate.grown.springs.larger.pop_back();
  EXPECT_THROW(check(plate), InvalidInput);
}

// --- What the mesh leaves of the frequencies.

// By how much a deviation of one moves the frequency of its mode, relative.
double moved(const Structure& plate, const Tolerances& tolerances, Index mode) {
  const auto name = fmt::format("frequency of the mode at {:.4g} Hz", plate.frequency_hz(mode));
  for (const auto& deviation : deviations(plate, tolerances, 900.0)) {
    if (deviation.name != name) continue;
    State state = state_of(plate);
    deviation.apply(state, 1.0);
    return 0.5 * std::log(state.stiffness(mode, mode) / state_of(plate).stiffness(mode, mode));
  }
  return 0.0;
}

TEST(FrequencyTolerance, IsWidenedModeByModeByWhatTheMeshLeaves) {
  Structure plate = small_plate();
  const Index first = plate.rigid_count;
  EXPECT_NEAR(moved(plate, Tolerances{}, first), 1e-3, 1e-9);
  plate.frequency_error = VectorXd::Zero(plate.mode_count());
  plate.frequency_error(first) = 0.01;
  plate.frequency_error(first + 1) = 1e-3;
  EXPECT_NEAR(moved(plate, Tolerances{}, first), std::hypot(1e-3, 0.01), 1e-9);
  EXPECT_NEAR(moved(plate, Tolerances{}, first + 1), std::hypot(1e-3, 1e-3), 1e-9);
  EXPECT_NEAR(moved(plate, Tolerances{}, first + 2), 1e-3, 1e-9);
  EXPECT_EQ(moved(plate, no_tolerances(), first), 0.0);  // known exactly stays known
  plate.frequency_error(first) = -0.01;
  EXPECT_THROW(check(plate), InvalidInput);
}

}  // namespace
}  // namespace chladni::diagnosis
