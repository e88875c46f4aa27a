// chladni identify with damping = "general": complex shapes, what it leaves and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/command.h"
#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "io/mat.h"
#include "modal/state_space.h"
#include "recordings/rigid_chain.h"
#include "tests/app/measured/identified_json.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

// The chain's first modes with a dashpot of c [N s/m] at the first sensor.
modal::ReducedModel damped_chain(double c) {
  auto model = recordings::reduced_model(recordings::matrices(recordings::beam_with_coils()),
                                         kPlaces, kPlaces, 5);
  model.residual.setZero(5, 5);
  model.dampers = {std::sqrt(c) * model.output_shapes.row(0), Eigen::MatrixXd::Zero(5, 1),
                   Eigen::MatrixXd::Zero(1, 5), Eigen::MatrixXd::Zero(1, 1)};
  return model;
}

modal::FrfSet general_responses(const modal::ReducedModel& model) {
  const auto frf = modal::frf(model, Eigen::VectorXd::LinSpaced(997, 1.0, 250.0));
  modal::FrfSet set;
  for (int i = 1; i <= 5; ++i) {
    set.outputs.push_back({.name = "y" + std::to_string(i),
                           .node = {},
                           .position = {},
                           .unit = "m",
                           .kind = modal::FrfKind::receptance});
    set.inputs.push_back(
        {.name = "u" + std::to_string(i), .node = {}, .position = {}, .unit = "N"});
  }
  set.frequency_hz = frf.frequency_hz;
  set.value = frf.value;
  Draw draw(3);
  for (auto& value : set.value) {
    set.variance.emplace_back((0.01 * value.cwiseAbs()).cwiseAbs2());
    for (auto& entry : value.reshaped()) {
      const double real = draw.normal();
      entry += 0.01 * std::abs(entry) * std::sqrt(0.5) * std::complex<double>(real, draw.normal());
    }
  }
  return set;
}

class IdentifyGeneral : public testing::Test {
 protected:
  // What was shown. A fit by real modes may end as not to be trusted, by the last bits of a
  // processor: its results are written all the same.
  std::string run(const Command& command, const std::string& damping,
                  const std::string& more = "") {
    auto text =
        read_whole(std::filesystem::path(CHLADNI_SOURCE_DIR) / "models/beam/thesis_5x5.toml");
    const std::string table = "[identification]\n";
    const std::string unsure = "model_error";
    text.replace(text.find(unsure), text.find('\n', text.find(unsure)) - text.find(unsure),
                 "model_error = 0");
    text.insert(text.find(table) + table.size(), "damping = \"" + damping + "\"\n" + more);
    const study::Study study = study::parse_study(text, folder_.path() / "study.toml", {});
    QuietRun quiet(study, folder_.path() / damping);
    try {
      command.run(study, quiet.run());
    } catch (const NumericalFailure& e) {
      if (damping != "modal" ||
          std::string(e.what()).find("not to be trusted") == std::string::npos)
        throw;
    }
    return quiet.shown();
  }

  void write(const modal::ReducedModel& model) const {
    (void)io::write_frf(folder_.path() / "thesis_5x5.csv", general_responses(model));
  }

  [[nodiscard]] io::Json left(const std::string& damping) const {
    return io::parse_json(read_whole(folder_.path() / damping / "identified.json"));
  }

  void refused(const Command& command, const std::string& more, const std::string& word) {
    try {
      (void)run(command, "general", more);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }

  TestFolder folder_{"identify_general"};
};

TEST_F(IdentifyGeneral, FitsADashpotThatRealModesDoNot) {
  const auto chain = damped_chain(1.0);
  write(chain);
  const std::string known = "delay = false\n";
  EXPECT_EQ(run(identify_command, "modal", "modes = 5\n" + known).find("collinearity"),
            std::string::npos);
  const auto shown = run(identify_command, "general", known);
  EXPECT_NE(shown.find("phase collinearity at sensors"), std::string::npos) << shown;
  const auto real = left("modal");
  const auto json = left("general");
  EXPECT_EQ(real.at("damping").string(), "modal");
  EXPECT_EQ(json.at("damping").string(), "general");
  ASSERT_EQ(json.at("modes").array().size(), 5U);
  const auto ratio = [](const io::Json& one) {
    return one.at("fit").at("cost").number() / one.at("fit").at("expected_cost").number();
  };
  EXPECT_GT(ratio(real), 2.0);
  EXPECT_NEAR(ratio(json), 1.0, 0.03);
  const auto& shapes = json.at("complex_shapes");
  // Sensors and coils are at the same places: one shape seen from both sides, phases and all.
  const auto deviation = matrix(shapes.at("output_imaginary_std"));
  const Eigen::MatrixXd off =
      matrix(shapes.at("output_imaginary")) - matrix(shapes.at("input_imaginary")).transpose();
  EXPECT_LT((off.array() / deviation.array()).abs().maxCoeff(), 6.0);
  EXPECT_GT(matrix(shapes.at("output_imaginary")).norm(), 50.0 * deviation.norm());
  for (const auto& one : shapes.at("output_phase_collinearity").array()) {
    EXPECT_GT(one.number(), 0.5);
    EXPECT_LT(one.number(), 1.0);
  }
}

TEST_F(IdentifyGeneral, LeavesAStateSpaceThatRespondsAsTheFit) {
  const auto chain = damped_chain(1.0);
  write(chain);
  (void)run(identify_command, "general", "delay = false\n");
  const auto file = io::read_mat(folder_.path() / "general/identified.mat", std::size_t{1} << 30);
  const auto variable = [&](const std::string& name) {
    for (const auto& [key, value] : file.variables) {
      if (key == name) return Eigen::MatrixXd(value.real.reshaped(value.dims[0], value.dims[1]));
    }
    ADD_FAILURE() << name;
    return Eigen::MatrixXd();
  };
  const modal::StateSpace space{variable("A"), variable("B"), variable("C"), variable("D")};
  ASSERT_EQ(space.c.rows(), 5);
  const Eigen::VectorXd frequency{{4.0, 32.0, 100.0, 200.0}};
  const auto exact = modal::frf(chain, frequency);
  for (Eigen::Index k = 0; k < frequency.size(); ++k) {
    const auto& there = exact.value[static_cast<std::size_t>(k)];
    EXPECT_LT((modal::response(space, frequency(k)) - there).norm(), 0.01 * there.norm());
  }
}

TEST_F(IdentifyGeneral, RefusesTheThesisPath) {
  write(damped_chain(1.0));
  refused(identify_command, "method = \"thesis\"\nmodes = 5\n", "real modes");
}

}  // namespace
}  // namespace chladni::app
