#include "diagnosis/modes/deviations_by_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/draw.h"
#include "diagnosis/modes/calibration/constants_held.h"
#include "diagnosis/modes/recorded_modes.h"
#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/constants_fitted.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kBand = 900.0;  // Hz

// The usual tolerances, and a modulus that is known to 10 %.
std::vector<Deviation> deviations_of_plate() {
  const auto& plate = small_plate();
  auto all = deviations(plate, Tolerances{}, kBand);
  std::vector<std::string> notes;
  const auto constants = held_constants(plate,
                                        {{.name = "material.youngs_modulus",
                                          .unit = "Pa",
                                          .value = 70e9,
                                          .effect = "youngs_modulus",
                                          .deviation = 0.1,
                                          .kind = CalibratedConstant::Kind::known}},
                                        Tolerances{}, notes);
  for (auto& one : constant_deviations(plate, constants, VectorXd::Zero(1))) {
    all.push_back(std::move(one));
  }
  return all;
}

RecordedModes modes_at(const std::vector<Deviation>& all, const VectorXd& eta) {
  State state = state_of(small_plate());
  for (Index i = 0; i < eta.size(); ++i) all[static_cast<std::size_t>(i)].apply(state, eta(i));
  return ModeSolver(state, small_plate().mode_count()).modes(state, 0.0, kBand);
}

MeasuredModes measured_as(const RecordedModes& modes) {
  MeasuredModes measured;
  measured.outputs = small_plate().outputs.names;
  measured.inputs = small_plate().inputs.names;
  measured.frequency_hz = modes.frequency_hz;
  measured.frequency_std = VectorXd::Constant(modes.count(), 1e-5);
  measured.damping_ratio = modes.damping_ratio;
  measured.damping_std = VectorXd::Constant(modes.count(), 1e-2);
  measured.output_shapes = modes.output_path.cwiseProduct(modes.outputs);
  measured.input_shapes = modes.input_path.cwiseProduct(modes.inputs);
  measured.output_std = 1e-3 * measured.output_shapes.cwiseAbs();
  measured.input_std = 1e-3 * measured.input_shapes.cwiseAbs();
  return measured;
}

// Distances of frequencies in half-power bandwidths.
VectorXd bandwidths_between(const RecordedModes& a, const RecordedModes& b) {
  return (a.frequency_hz.cwiseQuotient(b.frequency_hz).array().log().abs() /
          (2.0 * b.damping_ratio.array()))
      .matrix();
}

TEST(DeviationsByModes, BringEachResonanceIntoItsBandwidth) {
  const auto all = deviations_of_plate();
  VectorXd truth(std::ssize(all));
  Draw draw(7);
  for (Index i = 0; i < truth.size(); ++i) truth(i) = draw.normal();
  truth.tail(1)(0) = 0.8;
  const auto there = modes_at(all, truth);
  const auto simulated = modes_at(all, VectorXd::Zero(truth.size()));
  const VectorXd eta = deviations_by_modes(small_plate(), all, measured_as(there));
  const auto found = modes_at(all, eta);
  ASSERT_EQ(found.count(), there.count());
  ASSERT_EQ(simulated.count(), there.count());
  EXPECT_GT(bandwidths_between(simulated, there).maxCoeff(), 1.0);
  EXPECT_LT(bandwidths_between(found, there).maxCoeff(), 0.3);
  EXPECT_LT((found.damping_ratio.cwiseQuotient(there.damping_ratio).array().log().abs()).maxCoeff(),
            0.5);
  EXPECT_LT(eta.squaredNorm(), truth.squaredNorm());  // the most probable ones
  EXPECT_NEAR(eta.tail(1)(0), 0.8, 0.3);
}

TEST(DeviationsByModes, AreNoneWhereNothingDiffers) {
  const auto all = deviations_of_plate();
  const VectorXd zero = VectorXd::Zero(std::ssize(all));
  const auto eta = deviations_by_modes(small_plate(), all, measured_as(modes_at(all, zero)));
  EXPECT_LT(eta.cwiseAbs().maxCoeff(), 1e-9);
}

// Gains change no mode; a mode without damping or far from any of the structure says nothing.
TEST(DeviationsByModes, LeaveOutWhatIsNotKnown) {
  const auto all = deviations_of_plate();
  VectorXd truth = VectorXd::Zero(std::ssize(all));
  truth.tail(1)(0) = 0.5;
  auto measured = measured_as(modes_at(all, truth));
  measured.damping_ratio(0) = std::numeric_limits<double>::quiet_NaN();
  measured.damping_std(1) = std::numeric_limits<double>::quiet_NaN();
  measured.frequency_std(1) = std::numeric_limits<double>::quiet_NaN();
  const auto eta = deviations_by_modes(small_plate(), all, measured);
  ASSERT_TRUE(eta.allFinite());
  EXPECT_NEAR(eta.tail(1)(0), 0.5, 0.3);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name.starts_with("gain")) {
      EXPECT_EQ(eta(static_cast<Index>(i)), 0.0) << all[i].name;
    }
  }
  EXPECT_EQ(deviations_by_modes(small_plate(), all, part(measured, {})),
            VectorXd::Zero(std::ssize(all)));
  EXPECT_EQ(deviations_by_modes(small_plate(), {}, measured).size(), 0);
}

}  // namespace
}  // namespace chladni::diagnosis
