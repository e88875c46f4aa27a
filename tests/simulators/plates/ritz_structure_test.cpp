#include "simulators/plates/ritz_structure.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "diagnosis/body_fields.h"
#include "rotation/turn.h"
#include "simulators/plates/ritz_response.h"

namespace chladni::simulators {
namespace {

using std::numbers::pi;

const RitzModes& table() {
  static const RitzModes modes = ritz_modes(aluminium_table(10));
  return modes;
}

const diagnosis::Structure& structure() {
  static const auto made = ritz_structure(table(), table_channels());
  return made;
}

TEST(RitzStructure, IsWhole) {
  EVERY_FOURTH_LANDING();
  EXPECT_NO_THROW(diagnosis::check(structure()));
  EXPECT_EQ(structure().mode_count(), 64);
  EXPECT_NEAR(structure().mass_kg, 19.44, 1e-12);
  EXPECT_NEAR(structure().surface.area.sum(), 0.36, 1e-12);
  EXPECT_NEAR(structure().cells.area.sum(), 0.36, 1e-12);
}

TEST(RitzStructure, CellsSumToTheBody) {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(64, 64);
  Eigen::MatrixXd mass = stiffness;
  for (std::size_t c = 0; c < structure().cells.mass.size(); ++c) {
    stiffness += structure().cells.stiffness[c];
    mass += structure().cells.mass[c];
  }
  const Eigen::MatrixXd lambda = (2.0 * pi * structure().frequency_hz).cwiseAbs2().asDiagonal();
  EXPECT_LT((stiffness - lambda).norm(), 1e-8 * lambda.norm());
  EXPECT_TRUE(mass.isIdentity(1e-8));
  const auto& parts = structure().directional;
  EXPECT_LT((parts.along_u + parts.along_v + parts.across + parts.shear - lambda).norm(),
            1e-8 * lambda.norm());
}

// A solved plate with 4 % of taper and 2 % of bow, compared with the even plate changed by waves.
// Cells of constant thickness have an error of 3e-4.
TEST(RitzStructure, WavesTellATaperedPlate) {
  auto body = aluminium_table(10);
  const double t = body.thickness(0, 0);
  body.thickness = Eigen::MatrixXd::Zero(3, 1);
  body.thickness << t, 0.04 * t, -0.02 * t;
  const auto tapered = ritz_modes(body);
  const Eigen::VectorXd x = (Eigen::VectorXd(5) << 0.04, 0.0, -0.02, 0.0, 0.0).finished();
  const auto gain = diagnosis::thickened_smoothly(structure(), x);
  const Eigen::MatrixXd lambda = (2.0 * pi * structure().frequency_hz).cwiseAbs2().asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> told(
      lambda + gain.stiffness, Eigen::MatrixXd::Identity(64, 64) + gain.mass,
      Eigen::EigenvaluesOnly);
  for (Eigen::Index k = 3; k < 14; ++k) {
    EXPECT_NEAR(std::sqrt(told.eigenvalues()(k)) / (2.0 * pi), tapered.frequency_hz(k),
                5e-5 * tapered.frequency_hz(k))
        << k;
  }
}

// Modes and residual give the same responses as the plate itself.
TEST(RitzStructure, RespondsAsThePlate) {
  const auto channels = table_channels();
  const RitzStage stage{table(), modal_damping(table(), 5e-3), {}, {}, {}, {}};
  RitzGrid grid{channels.outputs, channels.inputs, Eigen::VectorXd::LinSpaced(40, 20.0, 900.0)};
  const auto exact = ritz_receptance(stage, grid);
  const auto& s = structure();
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const double omega = 2.0 * pi * grid.frequency_hz(static_cast<Eigen::Index>(k));
    const Eigen::ArrayXd own = 2.0 * pi * s.frequency_hz.array();
    const Eigen::VectorXcd dynamic =
        (own.square() - omega * omega).cast<std::complex<double>>() +
        std::complex<double>(0.0, 2.0 * omega) *
            (s.damping_ratio.array() * own).cast<std::complex<double>>();
    const Eigen::MatrixXcd g =
        s.outputs.shapes * dynamic.cwiseInverse().asDiagonal() * s.inputs.shapes.transpose() +
        s.residual;
    EXPECT_LT((g - exact[k]).norm(), 1e-4 * exact[k].norm()) << grid.frequency_hz(0);
  }
}

TEST(RitzStructure, KnowsItsSurface) {
  const auto& top = structure().surface;
  const auto there = top.at({0.1, -0.2});
  ASSERT_TRUE(there);
  constexpr double kStep = 1e-6;
  const Eigen::VectorXd by_x =
      (top.at({0.1 + kStep, -0.2})->shape - top.at({0.1 - kStep, -0.2})->shape) / (2.0 * kStep);
  EXPECT_LT((by_x - there->slope_u).norm(), 1e-6 * by_x.norm());
  EXPECT_FALSE(top.at({0.31, 0.0}));
  EXPECT_LT((top.at(top.places.row(77).transpose())->shape.transpose() - top.shapes.row(77)).norm(),
            1e-12);
  // A turn about x moves the top along y, against the slope.
  const auto& side = structure().outputs;
  EXPECT_LT((side.aside_v.leftCols(3) + 0.01 * side.slope_v.leftCols(3)).norm(),
            1e-9 * side.slope_v.leftCols(3).norm());
}

TEST(RitzStructure, SaysWhatIsWrong) {
  auto off = table_channels();
  off.inputs(2, 0) = 0.4;
  EXPECT_THROW((void)ritz_structure(table(), off), InvalidInput);
}

}  // namespace
}  // namespace chladni::simulators
