// Channels that are read in several wrong ways at once: sign, unit, quantity and delay. The truth
// is a Ritz plate (tests/simulators); the records are spoilt here, sample by sample.
#include "diagnosis/readings/readings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"
#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/prepared.h"
#include "rotation/turn.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Complex = std::complex<double>;

const double kPerG = 1.0 / 9.80665;

const Structure& plate() {
  static const Structure made = plate_of(40, 15);
  return made;
}

struct Wrong {
  double factor = 1.0, delay = 0.0;
  int power = 0;
};

// The record of sensor i (or of actuator j) is multiplied by factor (jω)^power e^{-jωτ}.
void spoil(modal::FrfSet& set, const Wrong& wrong, Index sensor, Index actuator = -1) {
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const double omega = 2.0 * 3.14159265358979 * set.frequency_hz(static_cast<Index>(k));
    const Complex by = wrong.factor * std::pow(Complex(0.0, omega), wrong.power) *
                       std::polar(1.0, -omega * wrong.delay);
    for (Index i = 0; i < set.value[k].rows(); ++i) {
      for (Index j = 0; j < set.value[k].cols(); ++j) {
        if (i != sensor && j != actuator) continue;
        set.value[k](i, j) *= by;
        set.variance[k](i, j) *= std::norm(by);
      }
    }
  }
}

// The first channels only.
modal::FrfSet part_of(modal::FrfSet set, Index outputs, Index inputs) {
  set.outputs.resize(static_cast<std::size_t>(outputs));
  set.inputs.resize(static_cast<std::size_t>(inputs));
  for (auto& value : set.value) value = value.topLeftCorner(outputs, inputs).eval();
  for (auto& variance : set.variance) variance = variance.topLeftCorner(outputs, inputs).eval();
  return set;
}

// Four sensors, three actuators.
modal::FrfSet measured(const std::vector<std::string>& kinds = {}, unsigned seed = 3) {
  simulators::HiddenOptions options;
  options.lines = 200;
  options.degree = 8;
  options.severity = 0.7;
  options.high_hz = 700.0;
  return part_of(simulators::hidden_case(kinds, seed, options).measured, 4, 3);
}

modal::FrfSet one_response(const modal::FrfSet& set) { return part_of(set, 1, 1); }

// A model that is off: 2 % in the frequency of each mode, 5 % in each shape.
Structure off(unsigned seed) {
  Structure model = plate();
  simulators::Dice dice(seed);
  for (Index k = model.rigid_count; k < model.mode_count(); ++k) {
    model.frequency_hz(k) *= 1.0 + 0.02 * dice.normal();
    for (auto* side : {&model.outputs, &model.inputs}) {
      const double rms = side->shapes.col(k).norm() / std::sqrt(static_cast<double>(side->count()));
      for (Index i = 0; i < side->count(); ++i) side->shapes(i, k) += 0.05 * rms * dice.normal();
    }
  }
  return model;
}

std::string told(const Diagnosis& diagnosis) {
  std::string text(name(diagnosis.verdict));
  for (const auto& cause : diagnosis.best.causes) {
    text += " | " + cause.effect;
    for (const auto& channel : cause.channels) text += " " + channel;
    if (!cause.option.empty()) text += ", " + cause.option;
    text += fmt::format(" {:.3f}", cause.probability);
  }
  return text;
}

Diagnosis diagnosed_with(const Structure& model, const modal::FrfSet& set,
                         const Tolerances& tolerances = exact_model()) {
  DiagnosisOptions options;
  options.tolerances = tolerances;
  return diagnosed(model, set, options);
}

// "effect channel", sorted.
std::vector<std::string> causes_of(const Diagnosis& diagnosis) {
  std::vector<std::string> all;
  for (const auto& cause : diagnosis.best.causes) {
    all.push_back(cause.effect);
    for (const auto& channel : cause.channels) all.back() += " " + channel;
  }
  std::ranges::sort(all);
  return all;
}

void expect_named(const Diagnosis& diagnosis, const std::vector<std::string>& causes) {
  EXPECT_EQ(diagnosis.verdict, Verdict::named) << told(diagnosis);
  EXPECT_EQ(causes_of(diagnosis), causes) << told(diagnosis);
  for (const auto& cause : diagnosis.best.causes) EXPECT_GT(cause.probability, 0.9);
}

TEST(Readings, NameSignAndG) {
  EVERY_FOURTH_LANDING();
  auto set = measured();
  spoil(set, {-kPerG}, 1);
  expect_named(diagnosed_with(plate(), set), {"sensor_sign s2", "sensor_unit s2"});
}

TEST(Readings, NameSignAndMillimetres) {
  EVERY_FOURTH_LANDING();
  auto set = measured();
  spoil(set, {-1e3}, 0);
  expect_named(diagnosed_with(plate(), set), {"sensor_sign s1", "sensor_unit s1"});
}

TEST(Readings, NeedOneResponseOnly) {
  EVERY_FOURTH_LANDING();
  auto turned = one_response(measured());
  spoil(turned, {-1.0}, 0);
  expect_named(diagnosed_with(plate(), turned), {"sensor_sign s1"});
  auto in_g = one_response(measured());
  spoil(in_g, {kPerG}, 0);
  expect_named(diagnosed_with(plate(), in_g), {"sensor_unit s1"});
}

TEST(Readings, NameSignAndUnitOfOneResponse) {
  EVERY_FOURTH_LANDING();
  for (const double factor : {kPerG, 1e3}) {
    auto set = one_response(measured());
    spoil(set, {-factor}, 0);
    expect_named(diagnosed_with(plate(), set), {"sensor_sign s1", "sensor_unit s1"});
  }
}

TEST(Readings, LeaveAMassBesideThem) {
  EVERY_EIGHTH_LANDING();
  auto set = measured({"point_mass"});
  spoil(set, {-kPerG}, 1);
  expect_named(diagnosed_with(plate(), set), {"point_mass", "sensor_sign s2", "sensor_unit s2"});
}

TEST(Readings, LeaveAModulusBesideThem) {
  EVERY_EIGHTH_LANDING();
  auto set = measured({"youngs_modulus"});
  spoil(set, {-kPerG}, 1);
  expect_named(diagnosed_with(plate(), set),
               {"sensor_sign s2", "sensor_unit s2", "youngs_modulus"});
}

TEST(Readings, NameSignAndDelay) {
  EVERY_EIGHTH_LANDING();
  for (const double delay : {3e-4, 8e-4}) {
    auto set = measured();
    spoil(set, {-1.0, delay}, 1);
    const auto diagnosis = diagnosed_with(plate(), set);
    expect_named(diagnosis, {"sensor_delay s2", "sensor_sign s2"});
    for (const auto& cause : diagnosis.best.causes) {
      for (const auto& one : cause.parameters) EXPECT_NEAR(one.value, delay, 1e-5);
    }
  }
}

TEST(Readings, NameQuantityUnitAndDelay) {
  EVERY_EIGHTH_LANDING();
  auto set = measured();
  spoil(set, {kPerG, 2e-4, 1}, 1);
  expect_named(diagnosed_with(plate(), set),
               {"sensor_delay s2", "sensor_quantity s2", "sensor_unit s2"});
}

TEST(Readings, NameTwoChannels) {
  EVERY_EIGHTH_LANDING();
  auto set = measured();
  spoil(set, {-kPerG}, 0);
  spoil(set, {-1e3}, 2);
  expect_named(diagnosed_with(plate(), set),
               {"sensor_sign s1", "sensor_sign s3", "sensor_unit s1", "sensor_unit s3"});
}

TEST(Readings, NameASensorAndAnActuator) {
  EVERY_EIGHTH_LANDING();
  auto set = measured();
  spoil(set, {-kPerG}, 0);
  spoil(set, {-1.0, 3e-4}, -1, 0);
  expect_named(diagnosed_with(plate(), set),
               {"actuator_delay a1", "actuator_sign a1", "sensor_sign s1", "sensor_unit s1"});
}

TEST(Readings, AccuseNoSoundRig) {
  EVERY_FOURTH_LANDING();
  const auto diagnosis = diagnosed_with(plate(), measured());
  EXPECT_EQ(diagnosis.verdict, Verdict::no_discrepancy) << told(diagnosis);
}

// The readings alone, on the lines of a search.
std::vector<std::string> read_of(const Structure& model, const modal::FrfSet& set) {
  const auto given = prepared(model, set, Tolerances{});
  const Observed lines = given.for_search(320);
  const auto causes =
      readings({*given.structure, lines, given.tolerable, given.solver_error}, catalogue_of({}));
  std::vector<std::string> all;
  for (const auto& cause : causes) {
    all.emplace_back(cause.effect->name);
    for (const auto& channel : cause.effect->channels(*given.structure, cause.option)) {
      all.back() += " " + channel;
    }
  }
  std::ranges::sort(all);
  return all;
}

TEST(Readings, AccuseNoRigWhoseModelIsOff) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    EXPECT_TRUE(read_of(off(seed), measured()).empty()) << seed;
    EXPECT_TRUE(read_of(off(seed), one_response(measured())).empty()) << seed;
  }
}

TEST(Readings, StandBesideAModelThatIsOff) {
  EVERY_FOURTH_LANDING();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto set = measured();
    spoil(set, {-kPerG}, 1);
    const std::vector<std::string> both{"sensor_sign s2", "sensor_unit s2"};
    EXPECT_EQ(read_of(off(seed), set), both) << seed;
    auto one = one_response(measured());
    spoil(one, {-kPerG}, 0);
    const std::vector<std::string> own{"sensor_sign s1", "sensor_unit s1"};
    EXPECT_EQ(read_of(off(seed), one), own) << seed;
  }
}

// Leaves out responses, and the lower half of the lines of others: a zero is not what was measured.
modal::FrfSet with_gaps(modal::FrfSet set) {
  const Complex none(std::nan(""), std::nan(""));
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k](0, 1) = set.value[k](0, 2) = set.value[k](2, 0) = none;
    set.value[k](3, 0) = set.value[k](3, 1) = set.value[k](3, 2) = none;
    if (2 * k < set.value.size()) set.value[k](1, 2) = set.value[k](2, 1) = none;
  }
  return set;
}

TEST(Readings, AreThoseOfWhatWasMeasured) {
  EXPECT_TRUE(read_of(off(1), with_gaps(measured())).empty());
  auto set = measured();
  spoil(set, {-kPerG}, 1);
  EXPECT_EQ(read_of(off(1), with_gaps(set)),
            (std::vector<std::string>{"sensor_sign s2", "sensor_unit s2"}));
  auto all = measured();
  for (const Index i : {0, 1, 2, 3}) spoil(all, {kPerG}, i);
  const auto complete = read_of(plate(), all);
  ASSERT_EQ(complete.size(), 1U);  // one unit of all sensors, also of that without a value
  EXPECT_EQ(read_of(plate(), with_gaps(all)), complete);
}

// What acts on the body, or exchanges channels, is no reading.
TEST(Readings, AreNotWhatElseIsHidden) {
  EVERY_FOURTH_LANDING();
  for (const auto& kind : simulators::hidden_kinds()) {
    if (kind.ends_with("_sign") || kind == "sensor_unit" || kind == "sensor_quantity") continue;
    std::string all;
    for (const auto& one : read_of(plate(), measured({kind}))) all += one + "; ";
    EXPECT_EQ(all, "") << kind;
  }
}

// Readings are put right before the search, and leave its causes their number.
TEST(Readings, DoNotCountAmongTheMostCauses) {
  auto set = measured({"point_mass"});
  spoil(set, {-kPerG}, 1);
  const auto given = prepared(plate(), set, exact_model());
  const Observed lines = given.for_search(80);
  const Problem problem{*given.structure, lines, given.tolerable, given.solver_error};
  DiagnosisOptions options;
  options.only = {"point_mass", "sensor_sign", "sensor_unit"};
  SearchLimits limits;
  limits.most_causes = 1;
  limits.is_look = true;
  const auto found = searched(problem, catalogue_of(options), limits);
  std::vector<std::string> names;
  for (const auto& cause : found.fits.front().causes) names.emplace_back(cause.effect->name);
  std::ranges::sort(names);
  EXPECT_EQ(names, options.only);
}

}  // namespace
}  // namespace chladni::diagnosis
