// Springs spread over a disc: as one spring where the disc is small, as springs in many places, and
// on the part of the disc that is on the body.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "diagnosis/effect.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;

constexpr double kStiffness = 4e5;

MatrixXcd with_pad(const Structure& plate, double radius, double u, double v) {
  State state = state_of(plate);
  effect("elastic_pad")
      .apply(state, plate, 0, Eigen::Vector4d(std::log(kStiffness), std::log(radius), u, v));
  return responses(state, some_lines());
}

MatrixXcd with_springs(const Structure& plate, const Eigen::MatrixX2d& places) {
  State state = state_of(plate);
  const double each = std::log(kStiffness / static_cast<double>(places.rows()));
  for (const auto place : places.rowwise()) {
    effect("ground_spring").apply(state, plate, 0, Eigen::Vector3d(each, place(0), place(1)));
  }
  return responses(state, some_lines());
}

// Part of the change by `a` that `b` does not make.
double apart(const Structure& plate, const MatrixXcd& a, const MatrixXcd& b) {
  return (a - b).norm() / (a - responses(state_of(plate), some_lines())).norm();
}

// What a body may stand on has the scale of the body, not that of what it stands on already.
TEST(ElasticPad, HasThePriorOfTheFreePlateBesideASoftSuspension) {
  auto held = small_plate();
  const auto first = held.rigid_count;
  held.springs = Eigen::MatrixXd::Zero(held.mode_count(), held.mode_count());
  const double suspended = 2.0 * std::numbers::pi * held.frequency_hz(first);
  held.springs(first, first) = 0.99 * suspended * suspended;
  const double bends = 2.0 * std::numbers::pi * held.frequency_hz(first + 1);
  for (const char* name : {"elastic_pad", "ground_spring"}) {
    EXPECT_NEAR(effect(name).parameters(held).front().centre,
                std::log(0.01 * held.mass_kg * bends * bends), 1e-12)
        << name;
  }
}

// So has what oscillates on it, and what may hold it as a whole beside a spring or two.
TEST(Oscillators, HaveTheFrequencyOfTheFreePlateBesideASoftSuspension) {
  const auto& free = small_plate();
  auto held = free;
  const auto soft = held.rigid_count;  // its first mode is the suspension's now
  held.frequency_hz(soft) = 0.1 * free.frequency_hz(soft);
  held.springs = Eigen::MatrixXd::Zero(held.mode_count(), held.mode_count());
  const double suspended = 2.0 * std::numbers::pi * held.frequency_hz(soft);
  held.springs(soft, soft) = suspended * suspended;
  const double later = std::log(free.frequency_hz(soft + 1) / free.frequency_hz(soft));
  for (const char* name : {"resonator", "frame", "suspension"}) {
    const auto own = effect(name).parameters(held);
    const auto usual = effect(name).parameters(free);
    for (std::size_t n = 0; n < own.size(); ++n) {
      const bool is_frequency = own[n].role == Parameter::Role::frequency;
      EXPECT_NEAR(own[n].centre, usual[n].centre + (is_frequency ? later : 0.0), 1e-12) << name;
    }
  }
}

TEST(ElasticPad, IsASpringWhereItIsSmall) {
  const auto& plate = small_plate();
  const auto spring = with_springs(plate, Eigen::RowVector2d(0.083, -0.127));
  EXPECT_LT(apart(plate, spring, with_pad(plate, 1e-3, 0.083, -0.127)), 1e-3);
  EXPECT_GT(apart(plate, spring, with_pad(plate, 0.1, 0.083, -0.127)), 0.01);
}

// Evenly spread places by the golden angle, on the part of the disc that is on the plate.
TEST(ElasticPad, IsSpringsInManyPlacesOfTheDisc) {
  const auto& plate = small_plate();
  for (const auto& centre : {Eigen::RowVector2d(0.05, 0.1), Eigen::RowVector2d(0.26, 0.05)}) {
    constexpr double kRadius = 0.1;
    constexpr Index kPlaces = 200;
    std::vector<Eigen::RowVector2d> on;
    for (Index n = 0; n < kPlaces; ++n) {
      const double far = kRadius * std::sqrt((static_cast<double>(n) + 0.5) / kPlaces);
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / std::numbers::phi;
      const Eigen::RowVector2d place =
          centre + far * Eigen::RowVector2d(std::cos(angle), std::sin(angle));
      if (plate.surface.at(place.transpose())) on.push_back(place);
    }
    Eigen::MatrixX2d places(std::ssize(on), 2);
    for (Index n = 0; n < places.rows(); ++n) places.row(n) = on[static_cast<std::size_t>(n)];
    const auto springs = with_springs(plate, places);
    const auto pad = with_pad(plate, kRadius, centre(0), centre(1));
    EXPECT_LT(apart(plate, springs, pad), 0.02) << centre;
  }
}

// A body that is twice as stiff has the same pad.
TEST(ElasticPad, IsNotTheBodysOwnStiffness) {
  const auto& plate = small_plate();
  const Eigen::Vector4d x(std::log(kStiffness), std::log(0.1), 0.05, 0.1);
  State pad_first = state_of(plate);
  effect("elastic_pad").apply(pad_first, plate, 0, x);
  const Eigen::MatrixXd own = pad_first.stiffness - pad_first.springs;
  EXPECT_LT((own - state_of(plate).stiffness).norm(), 1e-12 * own.norm());
  scale_stiffness(pad_first, 2.0);
  EXPECT_LT((pad_first.stiffness - pad_first.springs - 2.0 * own).norm(), 1e-12 * own.norm());
}

}  // namespace
}  // namespace chladni::diagnosis
