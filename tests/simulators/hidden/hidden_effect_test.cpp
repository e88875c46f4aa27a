#include "simulators/hidden/hidden_effect.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "rotation/turn.h"
#include "simulators/tables/rig.h"

namespace chladni::simulators {
namespace {

HiddenOptions quick(double severity = -1.0) {
  HiddenOptions options;
  options.lines = 40;
  options.degree = 8;
  options.severity = severity;
  return options;
}

double misfit(const HiddenCase& made) {
  double sum = 0.0;
  for (std::size_t k = 0; k < made.exact.size(); ++k) {
    sum += ((made.measured.value[k] - made.exact[k]).cwiseAbs2().array() /
            made.measured.variance[k].array())
               .sum();
  }
  return sum;
}

TEST(HiddenEffect, IsWhatItsSeedSays) {
  for (const auto& kind : {"point_mass", "crosstalk"}) {
    const auto one = hidden_case({kind}, 7, quick());
    const auto same = hidden_case({kind}, 7, quick());
    const auto other = hidden_case({kind}, 8, quick());
    EXPECT_EQ(one.measured.value[3], same.measured.value[3]);
    EXPECT_EQ(one.truth[0].size, same.truth[0].size);
    EXPECT_NE(one.truth[0].size, other.truth[0].size);
  }
}

TEST(HiddenEffect, StatesTheVarianceThatItsNoiseHas) {
  auto options = quick();
  options.lines = 200;
  const auto none = hidden_case({}, 3, options);
  const double count = 200.0 * 52.0;
  EXPECT_EQ(none.evidence_there, 0.0);
  EXPECT_TRUE(none.truth.empty());
  EXPECT_NEAR(misfit(none), count, 4.0 * std::sqrt(count));
  EXPECT_NO_THROW(modal::check(none.measured));
}

TEST(HiddenEffect, DeviatesAsTablesDo) {
  auto built = quick();
  built.deviation = 1.0;
  const auto one = hidden_case({}, 3, built);
  const auto other = hidden_case({}, 4, built);
  EXPECT_GT(one.evidence_there, 1e3);
  EXPECT_NE(one.exact[5], other.exact[5]);
  built.deviation = 0.1;
  EXPECT_LT(hidden_case({}, 3, built).evidence_there, 0.1 * one.evidence_there);
}

// For every law a deviation is drawn once per seed. Heavy tails and shared parts change it.
TEST(HiddenEffect, DeviatesByOtherLawsThanTheDiagnosisHas) {
  auto built = quick();
  built.deviation = 1.0;
  const auto normal = hidden_case({}, 3, built);
  for (const auto law : {DeviationLaw::uniform, DeviationLaw::student}) {
    built.law = law;
    const auto one = hidden_case({}, 3, built);
    EXPECT_GT(one.evidence_there, 1e3);
    EXPECT_NE(one.exact[5], normal.exact[5]);
    EXPECT_EQ(one.exact[5], hidden_case({}, 3, built).exact[5]);
  }
  built.correlation = 0.9;
  EXPECT_NE(hidden_case({}, 3, built).exact[5], hidden_case({}, 4, built).exact[5]);
  built.own_delay_s = 1e-5;
  EXPECT_GT(hidden_case({}, 3, built).evidence_there, 1e3);
}

// A moved position is nearly the same as a tilt where the plate hardly shears and gains are not
// known better. The difference is small.
TEST(HiddenEffect, ATiltIsNearlyAPlace) {
  for (const auto& rig : rig_names()) {
    auto options = quick(1.0);
    options.rig = rig;
    options.deviation = 1e-9;
    for (const auto* kind : {"sensor_direction", "actuator_direction"}) {
      const auto made = hidden_case({kind}, 5, options);
      ASSERT_EQ(made.moved_instead.size(), made.exact.size());
      double apart = 0.0;
      for (std::size_t k = 0; k < made.exact.size(); ++k) {
        apart += ((made.exact[k] - made.moved_instead[k]).cwiseAbs2().array() /
                  made.measured.variance[k].array())
                     .sum();
      }
      EXPECT_LT(apart, 0.01 * made.evidence_there) << rig << " " << kind;
    }
  }
}

TEST(HiddenEffect, EveryKindOfEveryRigShows) {
  EVERY_FOURTH_LANDING();
  for (const auto* rig : {"table_few", "strip"}) {
    auto options = quick(1.0);
    options.rig = rig;
    options.degree = 6;
    options.lines = 15;
    const auto believed = rig_named(rig, options.degree);
    options.above_hz = 1.5 * believed.high_hz;
    for (const auto& kind : hidden_kinds()) {
      if (!believed.has(kind)) {
        EXPECT_THROW((void)hidden_case({kind}, 5, options), InvalidInput) << rig << " " << kind;
        continue;
      }
      EXPECT_GT(hidden_case({kind}, 5, options).evidence_there, 30.0) << rig << " " << kind;
    }
  }
  auto options = quick();
  options.rig = "boat";
  EXPECT_THROW((void)hidden_case({}, 1, options), InvalidInput);
}

TEST(HiddenEffect, EveryKindShowsAndGrows) {
  EVERY_FOURTH_LANDING();
  auto all = hidden_kinds();
  all.insert(all.end(), outside_kinds().begin(), outside_kinds().end());
  const auto only_one_size = [](const std::string& kind) {
    for (const auto* fixed : {"sign", "swapped", "quantity", "unit", "hysteretic", "other_plate"}) {
      if (kind.find(fixed) != std::string::npos) return true;
    }
    return false;
  };
  for (const auto& kind : all) {
    const auto faint = hidden_case({kind}, 5, quick(0.0));
    const auto strong = hidden_case({kind}, 5, quick(1.0));
    EXPECT_EQ(strong.truth.front().kind, kind);
    EXPECT_GT(strong.evidence_there, 300.0) << kind;
    if (!only_one_size(kind)) {
      EXPECT_LT(faint.evidence_there, strong.evidence_there / 5.0) << kind;
    }
    const auto& outside = outside_kinds();
    EXPECT_EQ(strong.outside, std::find(outside.begin(), outside.end(), kind) != outside.end());
  }
}

TEST(HiddenEffect, IsHiddenFromTheRecord) {
  const auto channels = table_channels();
  for (const auto& kind : hidden_kinds()) {
    const auto made = hidden_case({kind}, 11, quick(1.0));
    for (std::size_t i = 0; i < 13; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      EXPECT_EQ(made.measured.inputs[i].name, channels.input_names[i]) << kind;
      EXPECT_EQ(made.measured.inputs[i].position->x(), channels.inputs(row, 0)) << kind;
    }
    EXPECT_EQ(made.measured.outputs[0].kind, modal::FrfKind::receptance) << kind;
  }
}

TEST(HiddenEffect, ExchangesAndTurnsWholeChannels) {
  const auto none = hidden_case({}, 4, quick());
  const auto swapped = hidden_case({"swapped_actuators"}, 4, quick());
  const auto& names = table_channels().input_names;
  const auto index = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  const auto a = index(swapped.truth[0].channels[0]);
  const auto b = index(swapped.truth[0].channels[1]);
  EXPECT_LT(a, b);
  EXPECT_EQ(swapped.exact[9].col(a), none.exact[9].col(b));
  EXPECT_EQ(swapped.exact[9].col(b), none.exact[9].col(a));
  const auto turned = hidden_case({"sensor_sign"}, 4, quick());
  Eigen::MatrixXcd sum = turned.exact[9] + none.exact[9];
  EXPECT_EQ((sum.rowwise().norm().array() == 0.0).count(), 1);
}

TEST(HiddenEffect, PairsActOnDifferentChannels) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const auto pair = hidden_pair(seed);
    ASSERT_EQ(pair.size(), 2U);
    EXPECT_NE(pair[0], pair[1]);
    EXPECT_EQ(pair, hidden_pair(seed));
  }
  const auto made = hidden_case({"sensor_gain", "sensor_delay"}, 2, quick());
  EXPECT_NE(made.truth[0].channels, made.truth[1].channels);
}

TEST(HiddenEffect, SaysWhatIsWrong) {
  EXPECT_THROW((void)hidden_case({"gremlin"}, 1, quick()), InvalidInput);
  auto none = quick();
  none.lines = 1;
  EXPECT_THROW((void)hidden_case({}, 1, none), InvalidInput);
}

}  // namespace
}  // namespace chladni::simulators
