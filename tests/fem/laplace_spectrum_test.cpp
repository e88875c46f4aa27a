#include "fem/laplace_spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

constexpr double kPi = std::numbers::pi;

// (π/a)² m² + (π/b)² n², ascending, from m, n = `first` on.
Eigen::VectorXd of_rectangle(double a, double b, int first, Eigen::Index count) {
  std::vector<double> all;
  for (int m = first; m < 20; ++m) {
    for (int n = first; n < 20; ++n)
      all.push_back(std::pow(kPi * m / a, 2) + std::pow(kPi * n / b, 2));
  }
  std::ranges::sort(all);
  return Eigen::Map<const Eigen::VectorXd>(all.data(), count);
}

// To the error of linear cells of size h: μ h²/12 of each on a regular grid, somewhat more here.
void expect_near(const Eigen::VectorXd& found, const Eigen::VectorXd& known, double h) {
  for (Eigen::Index j = 0; j < known.size(); ++j) {
    EXPECT_NEAR(found(j), known(j), known(j) * known(j) * h * h / 8.0 + 1e-9) << j;
  }
}

TEST(LaplaceSpectrum, IsThatOfARectangleOnOneFace) {
  const auto mesh = mesh::layered(mesh::Plate{0.6, 0.4, 0.02}, 0.02, 1);
  const auto spectrum = laplace_spectrum(mesh::surface_laplacian(mesh, {"top"}), 12);
  expect_near(spectrum.eigenvalue.head(12), of_rectangle(0.6, 0.4, 0, 12), 0.02);
}

// Functions alike on both faces are free at the rim, those of opposite sign are held there.
TEST(LaplaceSpectrum, IsThatOfBothFacesOfAThinPlate) {
  const auto mesh = mesh::layered(mesh::Plate{1.0, 1.0, 1e-3}, 0.05, 1);
  const auto spectrum = laplace_spectrum(mesh::surface_laplacian(mesh), 9);
  std::vector<double> known;
  for (const double mu : of_rectangle(1.0, 1.0, 0, 9)) known.push_back(mu);
  for (const double mu : of_rectangle(1.0, 1.0, 1, 9)) known.push_back(mu);
  std::ranges::sort(known);
  expect_near(spectrum.eigenvalue, Eigen::Map<Eigen::VectorXd>(known.data(), 9), 0.05);
}

// Through a thin plate is near: no functions of opposite sign on its faces.
TEST(LaplaceSpectrum, IsThatOfOneFaceForTheBodyOfAThinPlate) {
  const auto mesh = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.4, 0.02}, 0.02, 1), 2);
  const auto spectrum = laplace_spectrum(mesh::body_laplacian(mesh), 12);
  expect_near(spectrum.eigenvalue, of_rectangle(0.6, 0.4, 0, 12), 0.02);
}

TEST(LaplaceSpectrum, HasTheMultiplicitiesOfTheSphere) {
  const mesh::Sphere sphere{2.0};
  auto mesh = mesh::with_order(mesh::layered(sphere, 0.25), 2);
  mesh::project_to_sphere(mesh, sphere);
  const auto spectrum = laplace_spectrum(mesh::surface_laplacian(mesh), 16);
  ASSERT_GE(spectrum.eigenvalue.size(), 16);
  Eigen::VectorXd known(16);
  known << 0.0, Eigen::VectorXd::Constant(3, 2.0), Eigen::VectorXd::Constant(5, 6.0),
      Eigen::VectorXd::Constant(7, 12.0);
  expect_near(spectrum.eigenvalue, known, 0.14);  // half of the longest edge
}

TEST(LaplaceSpectrum, ConvergesWithTheSquareOfTheCells) {
  const auto third = [](double edge) {
    const auto mesh = mesh::layered(mesh::Plate{0.6, 0.4, 0.02}, edge, 1);
    return laplace_spectrum(mesh::surface_laplacian(mesh, {"top"}), 4).eigenvalue(3);
  };
  const double known = of_rectangle(0.6, 0.4, 0, 4)(3);
  const double order = std::log2((third(0.05) - known) / (third(0.025) - known));
  EXPECT_NEAR(order, 2.0, 0.15);
}

TEST(LaplaceSpectrum, HasOrthonormalFunctionsAndOneZeroPerPiece) {
  const auto mesh = mesh::layered(mesh::Sphere{0.4, 0.2}, 0.06);
  const auto laplacian = mesh::surface_laplacian(mesh);
  const auto spectrum = laplace_spectrum(laplacian, 8);
  EXPECT_EQ(spectrum.eigenvalue(1), 0.0);
  EXPECT_GT(spectrum.eigenvalue(2), 1.0);
  const Eigen::MatrixXd there = laplacian.on_nodes.transpose() * spectrum.functions;
  const Eigen::MatrixXd gram =
      there.transpose() * (laplacian.mass.selfadjointView<Eigen::Lower>() * there);
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
            1e-8);
}

TEST(LaplaceSpectrum, IsSampledWhereDevicesSit) {
  const auto mesh = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.05, 1), 2);
  const auto spectrum = laplace_spectrum(mesh::surface_laplacian(mesh, {"top"}), 2);
  const mesh::SiteFinder finder(mesh);
  const auto values =
      functions_at(spectrum, {*finder.from_above(0.11, -0.2), *finder.from_above(0.11, 0.07)});
  EXPECT_NEAR(values(0, 0), 1.0 / 0.6, 1e-9);
  EXPECT_NEAR(values(1, 0), 1.0 / 0.6, 1e-9);
  EXPECT_THROW((void)laplace_spectrum(mesh::surface_laplacian(mesh), 1000000), InvalidInput);
}

}  // namespace
}  // namespace chladni::fem
