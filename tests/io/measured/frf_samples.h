// Measured responses for tests of their files.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <complex>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include "base/draw.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// A file of that name that is gone afterwards.
struct TemporaryFile {
  explicit TemporaryFile(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             ("chladni_" + std::to_string(getpid()) + "_" + name)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::filesystem::path path;
};

/// p outputs y1.., q inputs u1.., k lines, of every size a double has; one entry is not measured.
inline modal::FrfSet random_set(Eigen::Index p, Eigen::Index q, Eigen::Index k, unsigned seed) {
  Draw draw(seed);
  modal::FrfSet set;
  for (Eigen::Index i = 0; i < p; ++i)
    set.outputs.emplace_back().name = "y" + std::to_string(i + 1);
  for (Eigen::Index j = 0; j < q; ++j) set.inputs.emplace_back().name = "u" + std::to_string(j + 1);
  set.frequency_hz.resize(k);
  double f = 0.0;
  const auto any = [&] {
    const double exponent = 20.0 * draw.normal();
    return std::pow(10.0, exponent) * draw.normal();
  };
  for (Eigen::Index line = 0; line < k; ++line, f += draw.uniform()) {
    set.frequency_hz(line) = f;
    Eigen::MatrixXcd value(p, q);
    Eigen::MatrixXd variance(p, q), noise(p, q), coherence(p, q);
    for (Eigen::Index n = 0; n < p * q; ++n) {
      value(n) = {any(), 0.0};
      value(n).imag(any());
      variance(n) = std::abs(any());
      noise(n) = std::abs(any());
      coherence(n) = draw.uniform();
    }
    set.value.push_back(value);
    set.variance.push_back(variance);
    set.noise_variance.push_back(noise);
    set.coherence.push_back(coherence);
  }
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  set.value.back()(p - 1, 0) = {nothing, nothing};
  return set;
}

inline bool same_bits(double a, double b) { return (std::isnan(a) && std::isnan(b)) || a == b; }

template <typename Matrix>
bool same_lines(const std::vector<Matrix>& a, const std::vector<Matrix>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].rows() != b[k].rows() || a[k].cols() != b[k].cols()) return false;
    for (Eigen::Index n = 0; n < a[k].size(); ++n) {
      if (!same_bits(std::real(a[k](n)), std::real(b[k](n)))) return false;
      if (!same_bits(std::imag(a[k](n)), std::imag(b[k](n)))) return false;
    }
  }
  return true;
}

/// Names, lines, values and what is known of their noise.
inline void expect_same(const modal::FrfSet& found, const modal::FrfSet& expected) {
  ASSERT_EQ(found.output_count(), expected.output_count());
  ASSERT_EQ(found.input_count(), expected.input_count());
  for (std::size_t i = 0; i < expected.outputs.size(); ++i) {
    EXPECT_EQ(found.outputs[i].name, expected.outputs[i].name);
  }
  for (std::size_t j = 0; j < expected.inputs.size(); ++j) {
    EXPECT_EQ(found.inputs[j].name, expected.inputs[j].name);
  }
  EXPECT_EQ(found.frequency_hz, expected.frequency_hz);
  EXPECT_TRUE(same_lines(found.value, expected.value));
  EXPECT_TRUE(same_lines(found.variance, expected.variance));
  EXPECT_TRUE(same_lines(found.noise_variance, expected.noise_variance));
  EXPECT_TRUE(same_lines(found.coherence, expected.coherence));
}

}  // namespace chladni::io
