// Data that no structure gives: the library says so, or gives numbers; it never reads them as
// indices.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "identification/fit_data.h"
#include "identification/identified.h"
#include "identification/matrix_fraction.h"
#include "identification/poles/vector_fit.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

simulators::FrfCase unsound_beam() { return part(simulators::beam5x3(), {0, 1, 4}, {0, 2}); }

// Two ends are allowed: numbers, or words.
void expect_numbers_or_words(const modal::FrfSet& set, const std::string& what) {
  for (const Eigen::Index modes : {Eigen::Index{0}, Eigen::Index{3}}) {
    try {
      IdentificationOptions options;
      options.modes = modes;
      options.rigid_count = -1;
      const auto found = identified(fit_data(set), options);
      EXPECT_TRUE(found.fit.model.frequency_hz.allFinite()) << what;
      EXPECT_TRUE(found.fit.model.damping_ratio.allFinite()) << what;
      EXPECT_TRUE(found.fit.model.output_shapes.allFinite()) << what;
      EXPECT_FALSE(found.fit.frequency_std_hz.hasNaN()) << what;
      EXPECT_FALSE(found.fit.output_std.hasNaN()) << what;
    } catch (const InvalidInput& e) {
      EXPECT_GT(std::string(e.what()).size(), 20U) << what;
    } catch (const NumericalFailure& e) {
      EXPECT_GT(std::string(e.what()).size(), 20U) << what;
    }
  }
}

TEST(UnsoundData, OneCellOfAnySizeIsNumbersOrNamed) {
  for (const bool stated : {true, false}) {
    for (const double size : {1e12, 1e30, 1e60, 1e75, 1e150, 1e200, 1e300, 1e308}) {
      auto set = unsound_beam().measured;
      if (!stated) set.variance.clear();
      set.value[100](1, 1) = size;
      if (size <= 1e70) {
        expect_numbers_or_words(set, "a cell of " + std::to_string(std::log10(size)));
        continue;
      }
      try {
        (void)fit_data(set);
        ADD_FAILURE() << size;
      } catch (const InvalidInput& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find(set.outputs[1].name + "/" + set.inputs[1].name), std::string::npos)
            << text;
        EXPECT_NE(text.find("25.5 Hz"), std::string::npos) << text;
        EXPECT_NE(text.find("expected"), std::string::npos) << text;
      }
    }
  }
}

TEST(UnsoundData, ResponsesWithoutStructureAreNumbersOrWords) {
  const auto all = [](double value) {
    auto set = unsound_beam().measured;
    set.variance.clear();
    for (auto& line : set.value) line.setConstant(value);
    return set;
  };
  for (const double value : {0.0, 1.0, -3e-9, 1e-65, 1e65, 1e-75, 1e-310}) {
    expect_numbers_or_words(all(value), "all " + std::to_string(value));
  }
  auto accelerance = all(1.0);
  for (auto& output : accelerance.outputs) output.kind = modal::FrfKind::accelerance;
  expect_numbers_or_words(accelerance, "accelerance of 1");
  auto alternating = all(1.0);
  for (std::size_t k = 0; k < alternating.value.size(); k += 2) alternating.value[k] *= -1.0;
  expect_numbers_or_words(alternating, "of either sign in turns");
  auto quiet = unsound_beam().measured;
  for (auto& line : quiet.variance) line.setZero();
  expect_numbers_or_words(quiet, "variances of zero");
  auto loud = unsound_beam().measured;
  for (auto& line : loud.variance) line.setConstant(1e300);
  expect_numbers_or_words(loud, "variances of 1e300");
}

TEST(UnsoundData, FewLinesAreRefused) {
  const auto whole = unsound_beam().measured;
  for (const double high : {0.5, 1.0, 2.0}) {
    FitDataOptions options;
    options.high_hz = high;
    EXPECT_THROW((void)fit_data(whole, options), InvalidInput) << high;
  }
}

// Below fit_data, too: what reaches an eigenvalue problem is looked at.
TEST(UnsoundData, VectorFittingAndFractionsLookAtTheirMatrices) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double size : {1e155, 1e200, 1e300, inf, std::nan("")}) {
    auto data = fit_data(unsound_beam().measured);
    data.value(100, 3) = size;
    EXPECT_THROW((void)vector_fit(data, {.order = 6}), NumericalFailure) << size;
    EXPECT_THROW((void)matrix_fraction(data, {.degree = 4, .numerator_degree = 4}),
                 NumericalFailure)
        << size;
    IdentificationOptions options;
    options.modes = 4;
    try {
      const auto found = identified(data, options);
      EXPECT_TRUE(found.fit.model.frequency_hz.allFinite()) << size;
    } catch (const NumericalFailure&) {
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace
}  // namespace chladni::identification
