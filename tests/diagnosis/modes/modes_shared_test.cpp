#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "base/index.h"
#include "diagnosis/loaded_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A column, and the sum of it and the change that it should foresee, both without the scale of the
// shapes and without `more`.
struct Beside {
  double column, difference;
};
Beside beside(const ModeBlock& block, const MatrixXd& more, Index column, const VectorXd& change) {
  MatrixXd left_out(block.count(), block.free.cols() + more.cols());
  left_out << block.free, more;
  const Eigen::ColPivHouseholderQR<MatrixXd> basis(left_out);
  const auto without = [&](const VectorXd& of) {
    return VectorXd(of - left_out * basis.solve(of));
  };
  const VectorXd own = block.shared.col(column);
  return {without(own).norm(), without(own + change).norm()};
}

// Rigid-body motions of the sensors, of the actuators, and the residue: rows of a mode without a
// damping ratio.
MatrixXd rigid_motions() {
  MatrixXd all = MatrixXd::Zero(1 + 2 * (4 + 13) + 2, 7);
  const auto& plate = small_plate();
  for (Index i = 0; i < 4 + 13; ++i) {
    const auto place = i < 4 ? plate.outputs.places.row(i) : plate.inputs.places.row(i - 4);
    all.row(1 + 2 * i).segment(i < 4 ? 0 : 3, 3) << 1.0, place(0), place(1);
  }
  all(all.rows() - 2, 6) = 1.0;
  return all;
}

// Changes the model itself and compares with what the column says.
class SharedColumns : public testing::Test {
 protected:
  SharedColumns() : model_(modes_of(loaded())), measured_(measured_of(model_, 0.0)) {
    measured_.scaled = true;
    // Damping ratios have errors of their own that are far larger.
    measured_.damping_ratio.setConstant(std::numeric_limits<double>::quiet_NaN());
    matching_ = matched_by_shape(measured_, model_);
    errors_ = errors_of(measured_, model_, matching_);
  }
  static constexpr double kStep = 1e-6;
  /// @param part  of the column that may be wrong
  void expect(Index column, const std::function<void(State&, double step)>& change, double part,
              const std::string& what, const MatrixXd& apart_from = MatrixXd()) {
    State state = loaded();
    change(state, kStep);
    const auto other = errors_of(measured_, modes_of(state), matching_, false);
    double most = 0.0;
    for (std::size_t i = 0; i < errors_.blocks.size(); ++i) {
      if (matching_.span[i].size() > 1) continue;
      const auto& block = errors_.blocks[i];
      const VectorXd slope = (other.blocks[i].error - block.error) / kStep;
      const auto found = beside(
          block, apart_from.size() > 0 ? apart_from : MatrixXd(block.count(), 0), column, slope);
      most = std::max(most, found.column);
      EXPECT_LT(found.difference, part * found.column + 1e-4) << what << ", mode " << i;
    }
    EXPECT_GT(most, 1e-3) << what << ": nothing was compared";
  }
  RecordedModes model_;
  MeasuredModes measured_;
  Matching matching_;
  ModeErrors errors_;
};

constexpr Index kCommonGains = 2;  // of the sensors, of the actuators
constexpr Index kChannels = 4 + 13;

TEST_F(SharedColumns, AreThoseOfGains) {
  for (const Index i : {0, 2}) {
    const auto change = [&](State& state, double by) { state.output_paths[at(i)].gain += by; };
    expect(i, change, 1e-3, "sensor");
  }
  for (const Index j : {0, 6, 12}) {
    const auto change = [&](State& state, double by) { state.input_paths[at(j)].gain += by; };
    expect(4 + j, change, 1e-3, "actuator");
  }
}

TEST_F(SharedColumns, AreThoseOfPlaces) {
  const auto& plate = small_plate();
  for (const Index i : {0, 3}) {
    expect(
        kChannels + i,
        [&](State& state, double by) { state.outputs.row(i) += by * plate.outputs.slope_u.row(i); },
        1e-3, "sensor along u");
    expect(
        2 * kChannels + i,
        [&](State& state, double by) { state.outputs.row(i) += by * plate.outputs.slope_v.row(i); },
        1e-3, "sensor along v");
  }
  for (const Index j : {5, 9}) {
    expect(
        2 * kChannels + 4 + j,
        [&](State& state, double by) {
          state.inputs.col(j) += by * plate.inputs.slope_v.row(j).transpose();
        },
        1e-3, "actuator along v");
  }
}

// A change of mass also adds rigid-body motions, which no column has yet.
TEST_F(SharedColumns, AreThoseOfTheBody) {
  ASSERT_GE(body().size(), 8U);
  std::size_t stiff = 0;
  for (std::size_t b = 0; b < body().size(); ++b) {
    const auto& [of, stiffness, mass] = body()[b];
    const auto change = [&](State& state, double by) {
      if (stiffness.size() > 0) state.stiffness += by * stiffness;
      if (mass.size() > 0) state.mass += by * mass;
    };
    const bool has_mass = mass.size() > 0;
    stiff += has_mass ? 0 : 1;
    expect(3 * kChannels + kCommonGains + static_cast<Index>(b), change, 0.01,
           "body error " + std::to_string(b), has_mass ? rigid_motions() : MatrixXd());
  }
  EXPECT_EQ(stiff, 3U);  // modulus, two of orthotropy
}

// A block has the same numbers and the same errors whichever other blocks have shared ones.
TEST(Errors, OfABlockAreWhatTheyAreAmongOthers) {
  const auto& plate = small_plate();
  const auto model = modes_of(state_of(plate));
  const auto measured = measured_of(model, 0.05);
  const auto matching = matched_by_shape(measured, model);
  const auto all = errors_of(measured, model, matching);
  const auto none = errors_of(measured, model, matching, false);
  for (std::size_t b = 0; b < all.blocks.size(); ++b) {
    std::vector<bool> one(all.blocks.size(), false);
    one[b] = true;
    const auto some = errors_of(measured, model, matching, one);
    EXPECT_EQ(some.shared_of, all.shared_of);
    EXPECT_EQ(some.penalty, all.penalty);
    EXPECT_GT(all.blocks[b].shared.norm(), 0.0);
    for (std::size_t c = 0; c < all.blocks.size(); ++c) {
      const auto& expected = (c == b ? all : none).blocks[c];
      EXPECT_EQ(some.blocks[c].error, expected.error);
      EXPECT_EQ(some.blocks[c].noise, expected.noise);
      EXPECT_EQ(some.blocks[c].smooth, expected.smooth);
      EXPECT_EQ(some.blocks[c].shared, expected.shared);
    }
  }
}

// Two sensors that were exchanged, and the hypothesis that they are: the errors of places and of
// shapes that neighbours share belong to the sensors, not to the names of their records.
TEST(ExchangedChannels, AreAsProbableAsTheyWereInOrder) {
  const auto& plate = small_plate();
  auto measured = measured_of(modes_of(loaded()), 0.05);
  PerClass levels;
  levels << 0.01, 0.2, 0.02, 0.02, 0.03, 0.02, 2e-3, 2e-3, 0.06;
  const auto objective = [&](const State& state) {
    const auto model = modes_of(state);
    return LevelLikelihood(errors_of(measured, model, matched_by_shape(measured, model)), levels)
        .negative_log();
  };
  const double in_order = objective(loaded());
  for (const char* name : {"swapped_sensors", "swapped_actuators"}) {
    const auto& swap = effect(name);
    for (Index option = 0; option < swap.options(plate); ++option) {
      State state = loaded();
      swap.apply(state, plate, option, VectorXd());
      const auto kept = measured;
      measured.output_shapes = kept.output_shapes(state.output_of, Eigen::all);
      measured.input_shapes = kept.input_shapes(state.input_of, Eigen::all);
      EXPECT_NEAR(objective(state), in_order, 1e-7 * std::abs(in_order)) << name << option;
      EXPECT_GT(objective(loaded()), in_order + 5.0) << name << option;
      measured = kept;
    }
  }
}

// A mode of the model that nothing was measured of counts against it, but not one that lies on the
// nodes of all sensors.
TEST(UnmeasuredModes, CountAsFarAsTheChannelsSeeThem) {
  const auto model = modes_of(loaded());
  auto measured = measured_of(model, 0.02);
  const auto without = [](MeasuredModes of, Index k) {
    std::vector<Index> others;
    for (Index i = 0; i < of.count(); ++i) {
      if (i != k) others.push_back(i);
    }
    for (auto* rows : {&of.frequency_hz, &of.damping_ratio, &of.frequency_std, &of.damping_std}) {
      *rows = VectorXd((*rows)(others));
    }
    for (auto* shapes : {&of.output_shapes, &of.input_shapes}) {
      *shapes = Eigen::MatrixXcd((*shapes)(Eigen::all, others));
    }
    for (auto* std : {&of.output_std, &of.input_std}) *std = MatrixXd((*std)(Eigen::all, others));
    return of;
  };
  const auto penalty = [&](const RecordedModes& of) {
    const auto fewer = without(measured, 4);
    return errors_of(fewer, of, matched_by_shape(fewer, of)).penalty;
  };
  const double seen = penalty(model);
  RecordedModes hidden = model;
  hidden.outputs.col(4) *= 1e-3;
  EXPECT_GT(seen, 0.8 * kConstants.unmeasured);
  EXPECT_LT(seen, 1.01 * kConstants.unmeasured);
  EXPECT_LT(penalty(hidden), 0.01 * kConstants.unmeasured);
}

}  // namespace
}  // namespace chladni::diagnosis
