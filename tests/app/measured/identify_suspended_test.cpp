// chladni identify where no sensor and actuator share a place: modes of the suspension are scaled
// by their motion, others are not.
#include <gtest/gtest.h>

#include <cmath>

#include "app/command.h"
#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "recordings/rigid_chain.h"
#include "tests/app/measured/identified_json.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

const std::vector<int> kSensors{1, 5};
const std::vector<int> kCoils{2, 3, 4};

Eigen::VectorXd places(const std::vector<int>& which) {
  Eigen::VectorXd at(std::ssize(which));
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    at(i) = kPlaces(which[static_cast<std::size_t>(i)] - 1);
  }
  return at;
}

modal::ReducedModel beam() {
  return recordings::reduced_model(recordings::matrices(recordings::beam_with_coils()),
                                   places(kSensors), places(kCoils), 5);
}

modal::FrfSet suspended_responses() {
  const auto frf = modal::frf(beam(), Eigen::VectorXd::LinSpaced(997, 1.0, 250.0));
  modal::FrfSet set;
  for (const int i : kSensors) {
    set.outputs.push_back({.name = "y" + std::to_string(i),
                           .node = {},
                           .position = {},
                           .unit = "m",
                           .kind = modal::FrfKind::receptance});
  }
  for (const int j : kCoils) {
    set.inputs.push_back(
        {.name = "u" + std::to_string(j), .node = {}, .position = {}, .unit = "N"});
  }
  set.frequency_hz = frf.frequency_hz;
  set.value = frf.value;
  Draw draw(3);
  for (auto& value : set.value) {
    set.variance.emplace_back((0.002 * value.cwiseAbs()).cwiseAbs2());
    for (auto& entry : value.reshaped()) {
      const double real = draw.normal();
      entry += 0.002 * std::abs(entry) * std::sqrt(0.5) * std::complex<double>(real, draw.normal());
    }
  }
  return set;
}

class IdentifySuspended : public testing::Test {
 protected:
  io::Json identified(const std::string& keys) {
    auto text =
        read_whole(std::filesystem::path(CHLADNI_SOURCE_DIR) / "models/beam/thesis_5x5.toml");
    const std::string table = "[identification]\n";
    text.insert(text.find(table) + table.size(), keys);
    const study::Study study = study::parse_study(text, folder_.path() / "study.toml", {});
    (void)io::write_frf(folder_.path() / "thesis_5x5.csv", suspended_responses());
    QuietRun quiet(study, folder_.path() / "out");
    identify_command.run(study, quiet.run());
    return io::parse_json(read_whole(folder_.path() / "out/identified.json"));
  }

  TestFolder folder_{"identify_suspended"};
};

std::vector<std::string> told_by(const io::Json& json) {
  std::vector<std::string> by;
  for (const auto& one : json.at("gain_match").at("by").array()) by.push_back(one.string());
  return by;
}

// Its first two columns: what is not known is null.
Eigen::MatrixXd two_columns(const io::Json& rows) {
  Eigen::MatrixXd result(std::ssize(rows.array()), 2);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    for (std::size_t m = 0; m < 2; ++m) {
      const auto& row = rows.array()[static_cast<std::size_t>(i)].array();
      result(i, static_cast<Eigen::Index>(m)) = row[m].number();
    }
  }
  return result;
}

TEST_F(IdentifySuspended, ScalesItsModesByTheirMotion) {
  const auto json = identified("");
  EXPECT_EQ(told_by(json),
            (std::vector<std::string>{"geometry", "geometry", "nothing", "nothing", "nothing"}));
  // Rows y1, y5, u2, u3, u4.
  const auto shapes = two_columns(json.at("shapes").at("value"));
  const auto deviation = two_columns(json.at("shapes").at("std"));
  const auto truth = beam();
  Eigen::MatrixXd exact(5, 5);
  exact << truth.output_shapes, truth.input_shapes.transpose();
  for (Eigen::Index m = 0; m < 2; ++m) {
    const double sign = shapes.col(m).dot(exact.col(m)) < 0.0 ? -1.0 : 1.0;
    const Eigen::ArrayXd off = (sign * shapes.col(m) - exact.col(m)).array().abs();
    const double size = exact.col(m).norm() / std::sqrt(5.0);
    EXPECT_LT(off.maxCoeff(), 0.02 * size) << m;  // it bends by (5 / 33)² of it
    EXPECT_LT((off / deviation.col(m).array()).maxCoeff(), 4.0) << m;
  }
}

TEST_F(IdentifySuspended, DoesWhatTheStudyStates) {
  EXPECT_EQ(told_by(identified("suspended_modes = 0\n")), std::vector<std::string>(5, "nothing"));
  EXPECT_EQ(told_by(identified("suspended_modes = 1\n")),
            (std::vector<std::string>{"geometry", "nothing", "nothing", "nothing", "nothing"}));
  EXPECT_THROW((void)identified("suspended_modes = 3\n"), InvalidInput);
}

}  // namespace
}  // namespace chladni::app
