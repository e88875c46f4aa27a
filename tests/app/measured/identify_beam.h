// The beam with coils, measured: what the tests of simulate, identify and interpolate share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "modal/frf.h"
#include "recordings/rigid_chain.h"
#include "tests/app/measured/identified_json.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {

namespace fs = std::filesystem;

inline const fs::path kModels = fs::path(CHLADNI_SOURCE_DIR) / "models";

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw InvalidInput("the study has no \"" + what + "\"");
  return text.replace(at, what.size(), by);
}

inline std::string model(const std::string& name) { return read_whole(kModels / name); }

inline modal::FrfSet named(const modal::Frf& frf, const std::vector<int>& coils) {
  modal::FrfSet set;
  for (int i = 1; i <= 5; ++i) {
    set.outputs.push_back({.name = "y" + std::to_string(i),
                           .node = {},
                           .position = {},
                           .unit = "m",
                           .kind = modal::FrfKind::receptance});
  }
  for (const int j : coils) {
    set.inputs.push_back(
        {.name = "u" + std::to_string(j), .node = {}, .position = {}, .unit = "N"});
  }
  set.frequency_hz = frf.frequency_hz;
  set.value = frf.value;
  return set;
}

// Responses of the chain's first modes and the flexibility of the rest, 0.25 Hz apart, with noise
// of 1 % of each one's median.
inline modal::FrfSet measured(const recordings::RigidChain& chain, Eigen::Index modes,
                              const std::vector<int>& coils) {
  Eigen::VectorXd at(std::ssize(coils));
  for (Eigen::Index j = 0; j < at.size(); ++j) {
    at(j) = kPlaces(coils[static_cast<std::size_t>(j)] - 1);
  }
  const auto model = recordings::reduced_model(recordings::matrices(chain), kPlaces, at, modes);
  auto set = named(modal::frf(model, Eigen::VectorXd::LinSpaced(997, 1.0, 250.0)), coils);
  Draw draw(7);
  Eigen::MatrixXd deviation(5, at.size());
  for (Eigen::Index e = 0; e < deviation.size(); ++e) {
    std::vector<double> size;
    for (const auto& value : set.value) size.push_back(std::abs(value.data()[e]));
    std::nth_element(size.begin(), size.begin() + 498, size.end());
    deviation.data()[e] = 0.01 * size[498];
  }
  for (auto& value : set.value) {
    for (Eigen::Index e = 0; e < value.size(); ++e) {
      const double real = draw.normal();
      const double imaginary = draw.normal();
      value.data()[e] +=
          deviation.data()[e] * std::sqrt(0.5) * std::complex<double>(real, imaginary);
    }
    set.variance.emplace_back(deviation.cwiseAbs2());
  }
  return set;
}

// The chain's modes at its five places, five columns or more.
inline modal::ReducedModel truth(const recordings::RigidChain& chain, Eigen::Index modes) {
  return recordings::reduced_model(recordings::matrices(chain), kPlaces, kPlaces, modes);
}

// The study with real modes, as the thesis has them.
inline std::string with_real_modes(const std::string& text) {
  const auto from = text.find("damping     = \"general\"");
  return std::string(text).erase(from, text.find('\n', from) - from);
}

// What the thesis' path is told of the 5 x 3 system: the number of modes and the thesis' iterations
// of Sanathanan and Koerner. The thesis states no degree; with the least the path finds 5 of 6
// modes (docs/reference/identification_studies.md).
inline const std::string kOwnSettings =
    "modes = 6\nsanathanan_koerner = 100\nfraction_degree = 8\n";

class Identify : public testing::Test {
 protected:
  // What the command said on the terminal.
  std::string run(const Command& command, const std::string& text, const std::string& out = "out",
                  const std::vector<fs::path>& allowed = {}) {
    const study::Study study = study::parse_study(text, folder_.path() / "study.toml", allowed);
    QuietRun quiet(study, folder_.path() / out);
    command.run(study, quiet.run());
    return quiet.said();
  }

  void write(const std::string& name, const modal::FrfSet& set) const {
    (void)io::write_frf(folder_.path() / name, set);
  }

  [[nodiscard]] io::Json left(const std::string& name, const std::string& out = "out") const {
    return io::parse_json(read_whole(folder_.path() / out / name));
  }

  void refused(const std::string& text, const std::string& word) {
    try {
      (void)run(identify_command, text);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }

  // The error of the default: |predicted − measured| over |measured| of the held-out rows together.
  double held_out_error(const std::string& text, const std::string& out) {
    (void)run(interpolate_command, text, out);
    return error_left(out);
  }

  double error_left(const std::string& out) const {
    const auto json = left("interpolation.json", out);
    double square = 0.0;
    const auto& rows = json.at("methods").array().front().at("held_out").array();
    for (const auto& row : rows) square += std::pow(row.at("frf_error").number(), 2);
    return std::sqrt(square / static_cast<double>(rows.size()));
  }

  // The same of a fit that may end as not to be trusted: its results are written all the same.
  double doubted_error(const std::string& text, const std::string& out) {
    try {
      return held_out_error(text, out);
    } catch (const NumericalFailure&) {
      return error_left(out);
    }
  }

  // The errors of the study as it is, and of the thesis' path on it, with what it gave itself.
  // Whether the latter is trusted depends on the kernel of the BLAS.
  std::pair<double, double> held_out_errors(const std::string& text) {
    const double ours = held_out_error(text, "ours");
    const auto path =
        replaced(with_real_modes(text), "[identification]\n",
                 "[identification]\nmethod = \"thesis\"\ngain = \"thesis\"\n" + kOwnSettings);
    return {ours,
            doubted_error(path + "[interpolation]\nmethods = [\"thin_plate_spline\"]\n", "theirs")};
  }

  TestFolder folder_{"identify"};
};

inline void expect_modes(const io::Json& json, const modal::ReducedModel& chain,
                         double coupled = 0.0) {
  const auto& modes = json.at("modes").array();
  ASSERT_EQ(std::ssize(modes), chain.mode_count());
  for (Eigen::Index m = 0; m < chain.mode_count(); ++m) {
    const auto& mode = modes[static_cast<std::size_t>(m)];
    EXPECT_FALSE(std::get<bool>(mode.at("rigid").value()));
    // Shaken, the chain shows that its damping couples its modes.
    EXPECT_NEAR(mode.at("frequency_hz").number(), chain.frequency_hz(m),
                4.0 * mode.at("frequency_std_hz").number() + coupled * chain.frequency_hz(m));
    EXPECT_NEAR(mode.at("damping_ratio").number(), chain.damping_ratio(m),
                4.0 * mode.at("damping_std").number() + 100.0 * coupled * chain.damping_ratio(m));
    EXPECT_LT(mode.at("frequency_std_hz").number(), 1e-3 * chain.frequency_hz(m));
  }
}

}  // namespace chladni::app
