// Lengths in priors, starts and steps of the effects follow the size of the body.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "diagnosis/effect.h"
#include "diagnosis/search/scene.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kScale = 0.1;

/// small_plate() with all lengths times kScale. Its frequencies are 1/kScale times as high.
Structure scaled_plate() {
  auto body = simulators::believed_table(8).body;
  body.length *= kScale;
  body.width *= kScale;
  body.thickness *= kScale;
  auto channels = simulators::table_channels();
  channels.outputs *= kScale;
  channels.inputs *= kScale;
  simulators::RitzStructureOptions options;
  options.modes = small_plate().mode_count();
  options.cells = 6;
  options.fine = 12;
  options.scan = 11;
  return simulators::ritz_structure(simulators::ritz_modes(body), channels, options);
}

const Structure& scaled() {
  static const Structure made = scaled_plate();
  return made;
}

/// The coordinate of the same size on the scaled plate; what is no length stays.
double scaled_coordinate(const Parameter& parameter, double x) {
  if (parameter.unit != "m") return x;
  return parameter.scale == Parameter::Scale::logarithmic ? x + std::log(kScale) : kScale * x;
}

/// Both plates with a mass that is the same part of theirs, seen in the same part of their bands.
Observed loaded(const Structure& plate, double scale) {
  State state = state_of(plate);
  const Eigen::Vector3d x(0.02 * plate.mass_kg, 0.123 * scale, -0.081 * scale);
  effect("point_mass").apply(state, plate, 0, x);
  Observed observed;
  observed.outputs = state.output_count();
  observed.inputs = state.input_count();
  observed.omega = some_lines() / scale;
  observed.value = responses(state, observed.omega);
  observed.weight = 1e3 * observed.value.cwiseAbs().cwiseInverse();
  return observed;
}

Scene scene_of(const Structure& plate, double scale) {
  const auto observed = loaded(plate, scale);
  const auto none = MatrixXd::Zero(observed.value.rows(), observed.value.cols());
  return {plate, observed, state_of(plate), none};
}

class Lengths : public testing::TestWithParam<const Effect*> {
 protected:
  void SetUp() override {
    if (effect().options(small_plate()) == 0) GTEST_SKIP() << "cannot be on this plate";
  }
  const Effect& effect() const { return *GetParam(); }
};

TEST_P(Lengths, OfThePriorFollowTheBody) {
  const auto parameters = effect().parameters(small_plate());
  const auto small = effect().parameters(scaled());
  ASSERT_EQ(parameters.size(), small.size());
  for (std::size_t n = 0; n < small.size(); ++n) {
    const auto& one = parameters[n];
    if (one.unit != "m") continue;
    const double linear = one.scale == Parameter::Scale::logarithmic ? 1.0 : kScale;
    EXPECT_NEAR(small[n].centre, scaled_coordinate(one, one.centre), 1e-9) << one.name;
    EXPECT_NEAR(small[n].step, linear * one.step, 1e-9 * one.step) << one.name;
    if (one.is_place()) continue;  // uniform over the surface
    EXPECT_NEAR(small[n].width, linear * one.width, 1e-9 * one.width) << one.name;
  }
}

TEST_P(Lengths, OfTheStartsFollowTheBody) {
  static const Scene large = scene_of(small_plate(), 1.0);
  static const Scene small = scene_of(scaled(), kScale);
  const auto parameters = effect().parameters(small_plate());
  const auto starts = effect().starts(large);
  const auto found = effect().starts(small);
  ASSERT_EQ(starts.size(), found.size());
  for (std::size_t n = 0; n < starts.size(); ++n) {
    EXPECT_EQ(starts[n].option, found[n].option) << n;
    ASSERT_EQ(starts[n].x.size(), found[n].x.size()) << n;
    for (Index i = 0; i < starts[n].x.size(); ++i) {
      const auto& one = parameters[static_cast<std::size_t>(i)];
      if (one.unit != "m") continue;
      EXPECT_NEAR(found[n].x(i), scaled_coordinate(one, starts[n].x(i)), 1e-9)
          << n << ": " << one.name;
    }
  }
}

std::string effect_name(const testing::TestParamInfo<const Effect*>& tested) {
  return std::string(tested.param->name);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Lengths, testing::ValuesIn(effects().begin(), effects().end()),
                         effect_name);

}  // namespace
}  // namespace chladni::diagnosis
