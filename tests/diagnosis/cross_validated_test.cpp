// Data that are held out in turn, predicted with causes that were fitted to the others.
#include "diagnosis/verdict/held_out/cross_validated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "base/draw.h"
#include "base/index.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/held_out/held_out_parts.h"
#include "diagnosis/verdict/held_out/part_misfit.h"
#include "rotation/turn.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Kind = HeldOutPart::Kind;

constexpr double kTwoPi = 2.0 * 3.14159265358979;
constexpr double kNoise = 0.01;

// On 120 lines, without noise.
Observed exact(const std::vector<Supposed>& causes) {
  const auto& plate = small_plate();
  Observed observed;
  observed.outputs = plate.output_count();
  observed.inputs = plate.input_count();
  observed.omega = kTwoPi * VectorXd::LinSpaced(120, 31.0, 893.0);
  const std::vector<Deviation> none;
  observed.value =
      responses(state_of({plate, observed, none}, causes, VectorXd(0)), observed.omega);
  observed.weight = (std::sqrt(2.0) / kNoise) * observed.value.cwiseAbs().cwiseInverse();
  return observed;
}

void add_noise(Observed& observed, unsigned seed) {
  Draw draw(seed);
  for (Index i = 0; i < observed.value.size(); ++i) {
    const double real = draw.normal();
    observed.value.data()[i] +=
        std::complex<double>(real, draw.normal()) / observed.weight.data()[i];
  }
}

Observed noisy(const std::vector<Supposed>& causes, unsigned seed) {
  auto observed = exact(causes);
  add_noise(observed, seed);
  return observed;
}

Supposed mass(double kg) { return {&effect("point_mass"), 0, Eigen::Vector3d(kg, 0.1, -0.05)}; }
Supposed gain(Index sensor, double relative) {
  return {&effect("sensor_gain"), sensor, VectorXd::Constant(1, std::log1p(relative))};
}

struct Tested {
  Fit best, nothing;
  CrossValidation result;
};

Tested tested(const Observed& observed, const std::vector<Supposed>& causes,
              const std::vector<Deviation>& deviations = {}) {
  const Problem problem{small_plate(), observed, deviations};
  Fit start;
  start.eta = VectorXd::Zero(std::ssize(deviations));
  Tested made;
  made.nothing = fitted(problem, start);
  start.causes = causes;
  made.best = fitted(problem, start);
  made.result = cross_validated(problem, observed, made.best, made.nothing);
  return made;
}

TEST(HeldOutParts, HoldEachNumberOnceAmongSensorsAndOnceAmongLines) {
  const auto observed = exact({});
  const auto parts = held_out_parts(small_plate().outputs.names, observed);
  for (const auto kind : {Kind::sensors, Kind::lines}) {
    for (Index i = 0; i < observed.outputs; ++i) {
      for (const double omega : observed.omega) {
        const auto count = std::ranges::count_if(parts, [&](const DataPart& part) {
          return part.told.kind == kind && part.holds(i, omega);
        });
        ASSERT_EQ(count, 1) << "output " << i << " at " << omega;
      }
    }
  }
  const auto& upper = parts.back();
  ASSERT_EQ(upper.told.kind, Kind::upper_band);
  EXPECT_NEAR(upper.told.low_hz, 31.0 + 0.6 * 862.0, 862.0 / 119.0);
  EXPECT_NEAR(upper.told.high_hz, 893.0, 1e-9);
}

double largest_residue(Index mode) {
  const auto& plate = small_plate();
  return plate.outputs.shapes.col(mode).cwiseAbs().maxCoeff() *
         plate.inputs.shapes.col(mode).cwiseAbs().maxCoeff();
}

TEST(HeldOutParts, BeginAndEndBetweenResonances) {
  const auto& plate = small_plate();
  auto observed = exact({});
  observed.omega = kTwoPi * VectorXd::LinSpaced(1200, 31.0, 893.0);
  const std::vector<Deviation> none;
  observed.value = responses(state_of(plate), observed.omega);
  observed.weight = observed.value.cwiseAbs().cwiseInverse();
  int borders = 0;
  for (const auto& part : held_out_parts(plate.outputs.names, observed)) {
    if (part.told.kind != Kind::lines || part.told.low_hz < 32.0) continue;
    ++borders;
    for (Index k = plate.rigid_count; k < plate.mode_count(); ++k) {
      if (largest_residue(k) < 0.01 * largest_residue(plate.rigid_count)) continue;  // unseen
      const double bandwidth = 2.0 * plate.damping_ratio(k) * plate.frequency_hz(k);
      EXPECT_GT(std::abs(part.told.low_hz - plate.frequency_hz(k)), 2.0 * bandwidth)
          << "border at " << part.told.low_hz << " Hz";
    }
  }
  EXPECT_EQ(borders, 4);
}

TEST(HeldOutParts, AreNoneOfOneSensorWithFewLines) {
  Observed observed;
  observed.outputs = observed.inputs = 1;
  observed.omega = VectorXd::LinSpaced(12, 100.0, 200.0);
  observed.value = Eigen::MatrixXcd::Ones(12, 1);
  observed.weight = Eigen::MatrixXd::Ones(12, 1);
  EXPECT_TRUE(held_out_parts({"s1"}, observed).empty());
}

// What is held out may be anything: the fit to the others does not know it.
TEST(HeldOutParts, AreNotSeenByTheRest) {
  const auto observed = noisy({mass(0.04)}, 3);
  for (const auto& part : held_out_parts(small_plate().outputs.names, observed)) {
    auto wrong = observed;
    for (Index k = 0; k < wrong.line_count(); ++k) {
      for (Index c = 0; c < wrong.value.cols(); ++c) {
        if (part.holds(c % wrong.outputs, wrong.omega(k))) wrong.value(k, c) *= -3.0;
      }
    }
    const std::vector<Deviation> none;
    Fit start;
    start.causes = {mass(0.05)};
    const Observed rest = without(observed, part), rest_of_wrong = without(wrong, part);
    const auto right = fitted({small_plate(), rest, none}, start);
    const auto again = fitted({small_plate(), rest_of_wrong, none}, start);
    EXPECT_EQ(right.causes.front().x, again.causes.front().x);
    EXPECT_NEAR(right.causes.front().x(0), 0.04, 3e-3);
    EXPECT_EQ(rest.number_count() + only(observed, part).number_count(), observed.number_count());
  }
}

// A plate that is 5 % stiffer, with a mass: a constant that is fitted predicts the held-out data.
TEST(CrossValidation, PredictsWithTheConstantsOfTheFit) {
  const auto& plate = small_plate();
  const Supposed stiffer{&effect("youngs_modulus"), 0, VectorXd::Constant(1, std::log(1.05))};
  const auto modulus = [&](State& state, double eta) {
    stiffer.effect->apply(state, plate, 0, VectorXd::Constant(1, 0.1 * eta));
  };
  const auto made =
      tested(noisy({stiffer, mass(0.04)}, 4), {mass(0.05)}, {{"modulus", modulus, true}});
  for (const auto& part : made.result.parts) {
    EXPECT_LT(part.errors.relative(part.errors.after),
              1.5 * part.errors.relative(part.errors.noise))
        << part.low_hz << " Hz, " << part.sensors.front();
  }
}

// Stiffness off by 2 % moves the resonances by several of their widths. The tolerance has it, at
// one deviation: half its square is all that the data cost.
TEST(LeastMisfit, FollowsResonancesByMoreThanTheirWidths) {
  const auto& plate = small_plate();
  const auto& modulus = effect("youngs_modulus");
  const std::vector<Deviation> tolerance{{"modulus", [&](State& state, double eta) {
                                            modulus.apply(state, plate, 0,
                                                          VectorXd::Constant(1, 0.02 * eta));
                                          }}};
  const Supposed stiffer{&modulus, 0, VectorXd::Constant(1, 0.02)};
  const auto observed = exact({stiffer});
  const Problem problem{plate, observed, tolerance};
  const VectorXd none = VectorXd::Zero(1);
  EXPECT_GT(0.5 * residual(observed, responses(state_of(plate), observed.omega)).squaredNorm(),
            1e4);
  const double almost = kConstants.nothing_more;
  EXPECT_NEAR(least_misfit(problem, {}, {none}), 0.5, almost);
  EXPECT_NEAR(least_misfit(problem, {stiffer}, {none}), 0.0, almost);
  EXPECT_NEAR(least_misfit(problem, {stiffer}, {VectorXd::Constant(1, 1.0), none}), 0.0, almost);
}

// Without the sensor itself nothing tells of what another one leaks into it. That sensor is then
// neither for the cause nor against it, whatever the tolerances make of its row.
TEST(CrossValidation, HearsNothingOfCrosstalkWithoutItsSensor) {
  const auto& plate = small_plate();
  const auto leaking = [](double share) {
    return Supposed{&effect("sensor_crosstalk"), 0, VectorXd::Constant(1, share)};
  };
  auto tolerances = no_tolerances();
  tolerances.frequency = 1e-3;
  tolerances.position = 1e-3;
  tolerances.gain = 0.02;
  const auto made =
      tested(noisy({leaking(0.5)}, 3), {leaking(0.45)}, deviations(plate, tolerances, 900.0));
  for (const auto& part : made.result.parts) {
    if (part.kind == Kind::sensors && part.sensors.front() == plate.outputs.names.front()) {
      EXPECT_EQ(part.gain, 0.0);
    } else {
      EXPECT_GT(part.gain, -3.0) << part.low_hz << " Hz, " << part.sensors.front();
    }
  }
  EXPECT_TRUE(made.result.pays());
}

// The density goes with the tolerances of the modulus and the gains. Data without some of the lines
// have another set of them, which suits these lines as well.
TEST(CrossValidation, TakesTolerancesThatGoWithTheCause) {
  EVERY_FOURTH_LANDING();
  const auto& plate = small_plate();
  const auto& modulus = effect("youngs_modulus");
  const auto scale = [&](const char* of, double part) {
    return Supposed{&effect(of), 0, VectorXd::Constant(1, std::log1p(part))};
  };
  struct Widths {
    double modulus, gain, frequency;
  };
  for (const auto& [of_modulus, gain, frequency] :
       {Widths{0.02, 0.3, 1e-3}, Widths{0.1, 0.02, 1e-3}, Widths{0.1, 0.02, 5e-3}}) {
    auto tolerances = no_tolerances();
    tolerances.frequency = frequency;
    tolerances.damping = 0.1;
    tolerances.position = 1e-3;
    tolerances.gain = gain;
    auto free = deviations(plate, tolerances, 900.0);
    free.push_back({"modulus", [&, width = of_modulus](State& state, double eta) {
                      modulus.apply(state, plate, 0, VectorXd::Constant(1, width * eta));
                    }});
    const auto observed = noisy({scale("density", -0.045), scale("youngs_modulus", 0.03)}, 2);
    const auto made = tested(observed, {scale("density", -0.045)}, free);
    EXPECT_TRUE(made.result.pays()) << of_modulus << ", " << gain << ", " << frequency;
    for (const auto& part : made.result.parts) {
      EXPECT_GT(part.gain, -20.0) << part.low_hz << " Hz, " << part.sensors.front();
    }
  }
}

TEST(CrossValidation, OfATrueCauseLeavesNoiseInEveryPart) {
  const auto made = tested(noisy({mass(0.04)}, 1), {mass(0.05)});
  ASSERT_EQ(std::ssize(made.result.parts), small_plate().output_count() + 5 + 1);
  for (const auto& part : made.result.parts) {
    const auto& errors = part.errors;
    EXPECT_LT(errors.relative(errors.after), 1.3 * errors.relative(errors.noise))
        << part.low_hz << " Hz, " << part.sensors.front();
    EXPECT_GT(errors.relative(errors.before), errors.relative(errors.after));
    ASSERT_EQ(part.gain_of_cause.size(), 1U);
    EXPECT_EQ(part.gain_of_cause.front(), part.gain);
  }
  EXPECT_TRUE(made.result.pays());
  EXPECT_TRUE(made.result.pays(0));
  // Without deviations the gain is the fall of half the misfit; of well-known numbers little is
  // lost by holding a part out.
  const double fall = 0.5 * (made.nothing.chi_square - made.best.chi_square);
  EXPECT_NEAR(made.result.gain(Kind::lines), fall, 0.02 * fall);
  EXPECT_NEAR(made.result.gain(Kind::sensors), fall, 0.02 * fall);
}

// Its own sensor held out, nothing tells of a gain; the lines that are held out do.
TEST(CrossValidation, KnowsAGainFromOtherLinesOnly) {
  const auto made = tested(noisy({gain(1, 0.05)}, 2), {gain(1, 0.03)});
  const auto& name = small_plate().outputs.names[1];
  for (const auto& part : made.result.parts) {
    const auto& errors = part.errors;
    if (part.kind == Kind::sensors && part.sensors.front() == name) {
      EXPECT_EQ(errors.after, errors.before);
      EXPECT_GT(errors.relative(errors.before), 4.0 * kNoise);
      EXPECT_EQ(part.gain, 0.0);
    } else if (part.kind == Kind::lines) {
      EXPECT_LT(errors.after, errors.before);
      EXPECT_GT(part.gain, 0.0);
    }
  }
  EXPECT_TRUE(made.result.pays());
}

// The held-out sensor reads five times too much, and nothing else tells so: a mass is judged with
// that gain as it is, not on a row that is wrong by five either way.
TEST(CrossValidation, JudgesACauseBesideOthersThatAPartAloneKnows) {
  const auto made = tested(noisy({gain(1, 1.6), mass(0.04)}, 6), {gain(1, 1.5), mass(0.05)});
  const auto& name = small_plate().outputs.names[1];
  for (const auto& part : made.result.parts) {
    if (part.kind != Kind::sensors) continue;
    EXPECT_EQ(part.gain_of_cause[0] == 0.0, part.sensors.front() == name);
    EXPECT_GT(part.gain_of_cause[1], 0.0);
  }
  EXPECT_TRUE(made.result.pays(0));
  EXPECT_TRUE(made.result.pays(1));
}

// A tolerance that may stretch is no reason to do without a cause, nor one for a cause.
TEST(CrossValidation, WeighsTolerancesInBothAlike) {
  EVERY_FOURTH_LANDING();
  const auto& plate = small_plate();
  const auto allowed = deviations(plate, Tolerances{}, 900.0);
  const auto real =
      tested(noisy({gain(1, 0.06), mass(0.04)}, 4), {gain(1, 0.05), mass(0.04)}, allowed);
  EXPECT_TRUE(real.result.pays(0));
  EXPECT_TRUE(real.result.pays(1));
  EXPECT_TRUE(real.result.pays());
}

// The last block of lines is another body's. A mass explains them in part, with evidence;
// it predicts those lines from no others, and makes others worse.
TEST(CrossValidation, DoubtsACauseThatOneBlockOfLinesAsksFor) {
  auto observed = exact({});
  const auto other = exact({mass(0.06)});
  const auto parts = held_out_parts(small_plate().outputs.names, observed);
  for (const auto& part : parts) {
    if (part.told.kind != Kind::lines || part.told.high_hz < 892.0) continue;
    for (Index k = 0; k < observed.line_count(); ++k) {
      if (part.holds(0, observed.omega(k))) observed.value.row(k) = other.value.row(k);
    }
  }
  add_noise(observed, 5);
  const auto made = tested(observed, {mass(0.02)});
  ASSERT_GT(made.best.log_evidence, made.nothing.log_evidence + kConstants.least_evidence);
  EXPECT_LT(made.result.gain(Kind::lines), 0.0);
  EXPECT_FALSE(made.result.pays());

  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::named;
  diagnosis.best.causes.resize(1);
  diagnosis.best.causes.front().effect = "point_mass";
  diagnosis.best.causes.front().probability = 0.99;
  diagnosis.cross_validation = made.result;
  EXPECT_NE(doubt_what_does_not_pay(diagnosis).find("point_mass"), std::string::npos);
  EXPECT_EQ(diagnosis.best.causes.front().probability, 0.5);
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
}

// A gain of another sensor beside a true one is fitted to noise: it alone loses its name.
TEST(CrossValidation, TellsAPhantomFromTheTruthBesideIt) {
  EVERY_FOURTH_LANDING();
  int paying = 0;
  for (const unsigned seed : {6U, 7U, 8U, 9U}) {
    const auto made = tested(noisy({gain(1, 0.05)}, seed), {gain(1, 0.05), gain(2, 0.0)});
    EXPECT_TRUE(made.result.pays(0)) << seed;
    paying += made.result.pays(1) ? 1 : 0;
  }
  EXPECT_EQ(paying, 0);
}

}  // namespace
}  // namespace chladni::diagnosis
