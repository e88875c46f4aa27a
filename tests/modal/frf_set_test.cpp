#include "modal/frf_set.h"

#include <gtest/gtest.h>

#include <complex>
#include <functional>
#include <limits>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "tests/modal/chain.h"

namespace chladni::modal {
namespace {

using Complex = std::complex<double>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<MeasuredChannel> channels(const std::string& letter, int count) {
  std::vector<MeasuredChannel> result;
  for (int c = 0; c < count; ++c) {
    result.emplace_back().name = letter + std::to_string(c + 1);
  }
  return result;
}

// Receptances of a chain that hangs, with made-up variances and coherences.
FrfSet measured(FrfKind kind, double from_hz = 10.0) {
  const auto model = reduced(chain(6, true), 4, {0, 3, 5}, {0, 3}, 0.01);
  const auto frf = modal::frf(model, Eigen::VectorXd::LinSpaced(20, from_hz, 900.0), kind);
  FrfSet set;
  set.outputs = channels("y", 3);
  set.inputs = channels("u", 2);
  set.frequency_hz = frf.frequency_hz;
  set.value = frf.value;
  set.averages = 6.0;
  Draw draw(3);
  for (auto& output : set.outputs) {
    output.kind = kind;
    output.unit = kind == FrfKind::receptance ? "m" : kind == FrfKind::mobility ? "m/s" : "m/s^2";
  }
  for (auto& input : set.inputs) input.unit = "N";
  for (const auto& value : set.value) {
    set.variance.emplace_back(1e-4 * value.cwiseAbs2());
    set.noise_variance.emplace_back(0.5 * set.variance.back());
    set.coherence.emplace_back(Eigen::MatrixXd::Constant(3, 2, draw.uniform()));
  }
  return set;
}

double distance(const std::vector<Eigen::MatrixXcd>& a, const std::vector<Eigen::MatrixXcd>& b) {
  double largest = a.size() == b.size() ? 0.0 : 1.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    largest = std::max(largest, (a[k] - b[k]).norm() / b[k].norm());
  }
  return largest;
}

TEST(FrfSet, ConvertsAsTheModelDoes) {
  for (const auto from : {FrfKind::receptance, FrfKind::mobility, FrfKind::accelerance}) {
    for (const auto to : {FrfKind::receptance, FrfKind::mobility, FrfKind::accelerance}) {
      const auto found = converted(measured(from), to);
      const auto expected = measured(to);
      EXPECT_LT(distance(found.value, expected.value), 1e-14);
      for (std::size_t k = 0; k < 20; ++k) {
        EXPECT_LT((found.variance[k] - expected.variance[k]).norm(),
                  1e-13 * expected.variance[k].norm());
        EXPECT_LT((found.noise_variance[k] - expected.noise_variance[k]).norm(),
                  1e-13 * expected.noise_variance[k].norm());
        EXPECT_EQ(found.coherence[k], expected.coherence[k]);
      }
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(found.outputs[i].unit, expected.outputs[i].unit);
        EXPECT_EQ(found.outputs[i].kind, to);
      }
      check(found);
    }
  }
}

TEST(FrfSet, ConvertsEveryOutputFromItsOwnKind) {
  auto mixed = measured(FrfKind::receptance);
  const auto accelerance = measured(FrfKind::accelerance);
  mixed.outputs[1] = accelerance.outputs[1];
  for (std::size_t k = 0; k < 20; ++k) mixed.value[k].row(1) = accelerance.value[k].row(1);
  EXPECT_LT(distance(converted(mixed, FrfKind::mobility).value, measured(FrfKind::mobility).value),
            1e-14);
}

TEST(FrfSet, LeavesTheLineAtRestOutOnlyWhereItCannotBeIntegrated) {
  const auto at_rest = measured(FrfKind::mobility, 0.0);
  EXPECT_EQ(converted(at_rest, FrfKind::accelerance).line_count(), 20);
  EXPECT_EQ(converted(at_rest, FrfKind::accelerance).value[0].norm(), 0.0);
  EXPECT_EQ(converted(at_rest, FrfKind::mobility).value[0], at_rest.value[0]);
  const auto integrated = converted(at_rest, FrfKind::receptance);
  EXPECT_EQ(integrated.line_count(), 19);
  EXPECT_EQ(integrated.frequency_hz(0), at_rest.frequency_hz(1));
  EXPECT_EQ(integrated.coherence[0], at_rest.coherence[1]);
  check(integrated);
}

TEST(FrfSet, KeepsWhatWasNotMeasuredUnknown) {
  auto set = measured(FrfKind::accelerance);
  set.value[4](2, 1) = Complex(kNan, kNan);
  check(set);
  const auto found = converted(set, FrfKind::receptance);
  EXPECT_TRUE(std::isnan(found.value[4](2, 1).real()));
  EXPECT_EQ(found.value[4].array().isNaN().count(), 1);
}

TEST(FrfSet, SaysTheUnitOfWhatHasNoneInSi) {
  auto set = measured(FrfKind::receptance);
  set.outputs[0].unit = "V";
  set.outputs[1].unit = "";
  const auto found = converted(set, FrfKind::accelerance);
  EXPECT_EQ(found.outputs[0].unit, "V/s^2");
  EXPECT_EQ(found.outputs[1].unit, "");
  EXPECT_EQ(converted(found, FrfKind::receptance).outputs[0].unit, "V");
  set.outputs[0].kind = FrfKind::accelerance;
  EXPECT_EQ(converted(set, FrfKind::receptance).outputs[0].unit, "V s^2");
}

TEST(FrfSet, PartIsTheChosenRowsAndColumnsInTheirOrder) {
  const auto set = measured(FrfKind::mobility);
  const auto some = part(set, {2, 0}, {1});
  check(some);
  EXPECT_EQ(some.outputs[0].name, "y3");
  EXPECT_EQ(some.outputs[1].name, "y1");
  EXPECT_EQ(some.inputs[0].name, "u2");
  EXPECT_EQ(some.averages, 6.0);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_EQ(some.value[k](0, 0), set.value[k](2, 1));
    EXPECT_EQ(some.value[k](1, 0), set.value[k](0, 1));
    EXPECT_EQ(some.variance[k](0, 0), set.variance[k](2, 1));
    EXPECT_EQ(some.coherence[k](1, 0), set.coherence[k](0, 1));
  }
  EXPECT_THROW((void)part(set, {3}, {0}), InvalidInput);
  EXPECT_THROW((void)part(set, {0}, {-1}), InvalidInput);
}

TEST(FrfSet, BandTakesItsEndsWithIt) {
  const auto set = measured(FrfKind::mobility);
  const auto some = band(set, set.frequency_hz(3), set.frequency_hz(7));
  check(some);
  ASSERT_EQ(some.line_count(), 5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    const auto line = static_cast<std::size_t>(k);
    EXPECT_EQ(some.frequency_hz(k), set.frequency_hz(k + 3));
    EXPECT_EQ(some.value[line], set.value[line + 3]);
    EXPECT_EQ(some.variance[line], set.variance[line + 3]);
    EXPECT_EQ(some.noise_variance[line], set.noise_variance[line + 3]);
  }
  EXPECT_THROW((void)band(set, 901.0, 950.0), InvalidInput);
}

TEST(FrfSet, WhatABandLeavesOutMayLieOnOneSideOfIt) {
  const auto set = measured(FrfKind::mobility);
  const auto& hz = set.frequency_hz;
  const auto last = set.line_count() - 1;
  const auto both = outside_band(set, hz(3), hz(7));
  EXPECT_EQ(both.line_count(), set.line_count() - 5);
  EXPECT_EQ(both.frequency_hz(2), hz(2));
  EXPECT_EQ(both.frequency_hz(3), hz(8));
  EXPECT_EQ(both.value[3], set.value[8]);
  EXPECT_EQ(both.variance.size(), both.value.size());
  EXPECT_NO_THROW(check(both));
  EXPECT_EQ(outside_band(set, hz(7), hz(last)).frequency_hz, hz.head(7));
  EXPECT_EQ(outside_band(set, 0.0, hz(7)).frequency_hz, hz.tail(last - 7));
  EXPECT_EQ(outside_band(set, hz(last) + 1.0, hz(last) + 2.0).line_count(), set.line_count());
  EXPECT_THROW((void)outside_band(set, 0.0, hz(last)), InvalidInput);
}

TEST(FrfSet, BandAndConversionCommute) {
  const auto set = measured(FrfKind::accelerance);
  EXPECT_EQ(distance(converted(band(set, 100.0, 500.0), FrfKind::receptance).value,
                     band(converted(set, FrfKind::receptance), 100.0, 500.0).value),
            0.0);
}

struct Fault {
  const char* word;
  std::function<void(FrfSet&)> make;
};

TEST(FrfSet, CheckNamesThePlace) {
  const Fault faults[] = {
      {"no output", [](FrfSet& s) { s.outputs.clear(); }},
      {"input 2 has no name", [](FrfSet& s) { s.inputs[1].name.clear(); }},
      {"two outputs are called \"y1\"", [](FrfSet& s) { s.outputs[2].name = "y1"; }},
      {"direction",
       [](FrfSet& s) {
         s.outputs[0].direction = {0.0, 2.0, 0.0};
       }},
      {"position", [](FrfSet& s) { s.inputs[0].position = Eigen::Vector3d(0.0, kNan, 0.0); }},
      {"line 4", [](FrfSet& s) { s.frequency_hz(3) = s.frequency_hz(2); }},
      {"line 1", [](FrfSet& s) { s.frequency_hz(0) = -1.0; }},
      {"line 20", [](FrfSet& s) { s.frequency_hz(19) = kNan; }},
      {"19 lines", [](FrfSet& s) { s.value.pop_back(); }},
      {"line 6 is 3 x 1", [](FrfSet& s) { s.value[5].resize(3, 1); }},
      {"y2/u1, line 3: the response is infinite",
       [](FrfSet& s) { s.value[2](1, 0) = std::numeric_limits<double>::infinity(); }},
      {"y3/u2, line 2: the variance is -", [](FrfSet& s) { s.variance[1](2, 1) = -1.0; }},
      {"the noise variance on 1 lines", [](FrfSet& s) { s.noise_variance.resize(1); }},
      {"the coherence is 1.5", [](FrfSet& s) { s.coherence[0](0, 0) = 1.5; }},
      {"degrees of freedom", [](FrfSet& s) { s.averages = -1.0; }},
  };
  check(measured(FrfKind::receptance));
  for (const auto& fault : faults) {
    auto set = measured(FrfKind::receptance);
    fault.make(set);
    try {
      check(set);
      ADD_FAILURE() << fault.word << " is taken";
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(fault.word), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace chladni::modal
