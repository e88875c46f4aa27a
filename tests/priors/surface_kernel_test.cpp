#include "priors/spline/surface_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/laplace_spectrum.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "priors/interpolator.h"
#include "simulators/portable_random.h"

namespace chladni::priors {
namespace {

using simulators::Dice;
constexpr double kPi = std::numbers::pi;

// The harmonics of a free rectangle, cos cos, in closed form.
struct Rectangle {
  double a = 1.0, b = 1.0;
  int count = 40;  // per direction

  [[nodiscard]] Eigen::VectorXd eigenvalue() const {
    Eigen::VectorXd mu(count * count);
    for (int j = 0; j < mu.size(); ++j) {
      mu(j) = std::pow(kPi * (j % count) / a, 2) + std::pow(kPi * (j / count) / b, 2);
    }
    return mu;
  }
  [[nodiscard]] Eigen::MatrixXd at(const Eigen::MatrixX2d& places) const {
    Eigen::MatrixXd values(places.rows(), count * count);
    for (int j = 0; j < values.cols(); ++j) {
      const double scale = (j % count > 0 ? std::numbers::sqrt2 : 1.0) *
                           (j / count > 0 ? std::numbers::sqrt2 : 1.0) / std::sqrt(a * b);
      values.col(j) = scale * (kPi * (j % count) / a * places.col(0)).array().cos() *
                      (kPi * (j / count) / b * places.col(1)).array().cos();
    }
    return values;
  }
  [[nodiscard]] Eigen::VectorXd mean_square() const {
    return Eigen::VectorXd::Constant(count * count, 1.0 / (a * b));
  }
};

Eigen::MatrixX2d within(const Rectangle& rectangle, Eigen::Index n, unsigned seed) {
  Dice dice(seed);
  Eigen::MatrixX2d places(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    places.row(k) << dice.between(0.0, rectangle.a), dice.between(0.0, rectangle.b);
  }
  return places;
}

TEST(SurfaceKernel, IsTheMaternKernelOfThePlaneFarFromTheRims) {
  const Rectangle square{1.0, 1.0, 120};
  constexpr double kLength = 0.06;
  Eigen::MatrixX2d places(6, 2);
  places << 0.5, 0.5, 0.52, 0.5, 0.5, 0.56, 0.44, 0.47, 0.6, 0.5, 0.55, 0.62;
  const Eigen::MatrixXd u = square.at(places);
  const auto compare = [&](double smoothness, auto known) {
    const auto variances =
        harmonic_variances(square.eigenvalue(), square.mean_square(), kLength, smoothness);
    const Eigen::MatrixXd k = surface_covariance(variances, u, u);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double r = (places.row(i) - places.row(0)).norm() / kLength;
      EXPECT_NEAR(k(i, 0) / k(0, 0), known(r), 2e-3) << i;
    }
  };
  compare(2.5, [](double r) {
    return (1.0 + std::sqrt(5.0) * r + 5.0 * r * r / 3.0) * std::exp(-std::sqrt(5.0) * r);
  });
  compare(1.5, [](double r) { return (1.0 + std::sqrt(3.0) * r) * std::exp(-std::sqrt(3.0) * r); });
  compare(kInfinitelySmooth, [](double r) { return std::exp(-0.5 * r * r); });
}

TEST(SurfaceKernel, HasTheMeanVarianceOneAndTheSpectrumOfItsSource) {
  const Rectangle rectangle{0.6, 0.4, 12};
  const auto mu = rectangle.eigenvalue();
  const auto square = rectangle.mean_square();
  for (const double length : {0.03, 0.2, 1.0}) {
    for (const double smoothness : {0.5, 2.5, kInfinitelySmooth}) {
      EXPECT_NEAR(harmonic_variances(mu, square, length, smoothness).dot(square), 1.0, 1e-12);
    }
    const auto s = harmonic_variances(mu, square, length, 1.5);
    const double a = 3.0 / (length * length);
    EXPECT_NEAR(s(7) / s(20), std::pow((a + mu(20)) / (a + mu(7)), 2.5), 1e-9 * s(7) / s(20));
    // The heat kernel is the limit of ever smoother ones.
    const auto heat = harmonic_variances(mu, square, length, kInfinitelySmooth);
    const auto smooth = harmonic_variances(mu, square, length, 1e7);
    EXPECT_LT((heat - smooth).norm(), 1e-3 * heat.norm());
  }
}

TEST(SurfaceKernel, IsPositiveSemidefiniteOnRandomPoints) {
  const Rectangle rectangle{0.6, 0.4, 8};
  const Eigen::MatrixXd u = rectangle.at(within(rectangle, 80, 3));
  for (const double smoothness : {0.5, 2.5, kInfinitelySmooth}) {
    const auto variances =
        harmonic_variances(rectangle.eigenvalue(), rectangle.mean_square(), 0.1, smoothness);
    const Eigen::MatrixXd k = surface_covariance(variances, u, u);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(k);
    EXPECT_GT(eigen.eigenvalues()(0), -1e-12 * eigen.eigenvalues()(79));
  }
}

// Slots from the middle of each edge halfway to the centre.
TEST(SurfaceKernel, DoesNotReachAcrossASlot) {
  mesh::WaferTable table{.length = 0.6, .width = 0.6, .height = 0.02, .face_sheet = 0.02};
  table.edge_cutout_length = 0.01;
  table.edge_cutout_depth = 0.2;
  const auto slotted = mesh::layered(table, 0.03, 1);
  const auto whole = mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.03, 1);
  const auto correlation = [](const mesh::TetMesh& body, const mesh::Laplacian& laplacian) {
    const auto spectrum = fem::laplace_spectrum(laplacian, 60);
    const mesh::SiteFinder finder(body);
    const Eigen::MatrixXd u = fem::functions_at(
        spectrum, {*finder.from_above(-0.02, 0.28), *finder.from_above(0.02, 0.28),
                   *finder.from_above(-0.06, 0.28)});
    const double area = 0.36;  // a scale; correlations do not feel it
    const auto variances =
        harmonic_variances(spectrum.eigenvalue,
                           Eigen::VectorXd::Constant(spectrum.eigenvalue.size(), 1.0 / area), 0.12);
    const Eigen::MatrixXd k = surface_covariance(variances, u, u);
    return Eigen::Vector2d(k(0, 1) / std::sqrt(k(0, 0) * k(1, 1)),
                           k(0, 2) / std::sqrt(k(0, 0) * k(2, 2)));
  };
  for (const bool as_body : {false, true}) {
    const auto cut = correlation(slotted, as_body ? mesh::body_laplacian(slotted)
                                                  : mesh::surface_laplacian(slotted, {"top"}));
    const auto sound = correlation(
        whole, as_body ? mesh::body_laplacian(whole) : mesh::surface_laplacian(whole, {"top"}));
    EXPECT_GT(sound(0), 0.85);  // 40 mm apart
    EXPECT_LT(cut(0), 0.2);     // 40 mm apart, 400 mm around the slot
    EXPECT_GT(cut(1), 0.85);    // 40 mm apart on one side of it
  }
}

TEST(SurfaceKernel, LearnsTheLengthAndAmplitudeOfItsOwnDraws) {
  const Rectangle rectangle{0.6, 0.4, 10};
  const auto mu = rectangle.eigenvalue();
  const auto square = rectangle.mean_square();
  const Eigen::MatrixXd u = rectangle.at(within(rectangle, 60, 5));
  Dice dice(6);
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(60, 0.01);
  for (const double length : {0.08, 0.15}) {
    double off = 0.0;
    double amplitude = 0.0;
    for (int draw = 0; draw < 20; ++draw) {
      const auto variances = harmonic_variances(mu, square, length);
      const Eigen::VectorXd values =
          3.0 * u * variances.cwiseSqrt().cwiseProduct(dice.normal(mu.size(), 1)) +
          0.01 * dice.normal(60, 1) + Eigen::VectorXd::Constant(60, 40.0);
      const auto fit = surface_fit(values, noise, u, mu, square);
      off += std::log(fit.length / length) / 20.0;
      amplitude += std::log(0.01 / std::sqrt(fit.smoothing.lambda) / 3.0) / 20.0;
    }
    EXPECT_NEAR(off, 0.0, 0.15) << length;
    EXPECT_NEAR(amplitude, 0.0, 0.25) << length;
  }
}

// A simulation of N points of the rectangle, values drawn at 13 of them.
struct Experiment {
  Simulation simulation;
  MeasuredShapes measured;
  Eigen::MatrixXd truth;
};

Experiment experiment(Eigen::Index shapes, double noise) {
  const Rectangle rectangle{0.6, 0.4, 9};
  const auto xy = within(rectangle, 400, 7);
  Experiment e;
  auto& surface = e.simulation.surface;
  surface.position = Points::Zero(400, 3);
  surface.position.leftCols<2>() = xy;
  surface.direction = Points::Zero(400, 3);
  surface.direction.col(2).setOnes();
  surface.harmonics = rectangle.at(xy);
  e.simulation.area = Eigen::VectorXd::Constant(400, 0.24 / 400.0);
  e.simulation.harmonic_eigenvalue = rectangle.eigenvalue();
  Dice dice(8);
  const auto variances = harmonic_variances(rectangle.eigenvalue(), rectangle.mean_square(), 0.25);
  e.truth = surface.harmonics * variances.cwiseSqrt().asDiagonal() *
            dice.normal(variances.size(), shapes);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < 13; ++k) rows.push_back(30 * k);
  e.measured.places = part(surface, rows);
  e.measured.frequency_hz = Eigen::VectorXd::Constant(shapes, 100.0);
  e.measured.values = e.truth(rows, Eigen::all) + noise * dice.normal(13, shapes);
  e.measured.noise = Eigen::MatrixXd::Constant(13, shapes, noise);
  return e;
}

TEST(SurfaceMatern, FollowsTheValuesAndCoversDrawsOfItsPrior) {
  const auto quiet = experiment(3, 1e-5);
  const auto& method = interpolator("surface_matern");
  const auto field = mode_field(method, quiet.measured, quiet.simulation);
  EXPECT_LT((field->at(quiet.measured.places).mean - quiet.measured.values).norm(), 1e-3);

  const auto noisy = experiment(150, 0.02);
  const auto known = mode_field(method, noisy.measured, noisy.simulation);
  const double covered =
      coverage(known->at(noisy.simulation.surface), noisy.truth, noisy.simulation.area).mean();
  EXPECT_GT(covered, 0.88);  // the length is learned from 13 values
  EXPECT_LT(covered, 0.97);
}

// Modes of the plate with four slots, whose flaps move against each other; 36 places.
struct SlottedTest {
  Simulation simulation;
  MeasuredShapes measured;
  Eigen::MatrixXd truth;

  SlottedTest() {
    mesh::WaferTable table{.length = 0.6, .width = 0.6, .height = 0.02, .face_sheet = 0.02};
    table.edge_cutout_length = 0.01;
    table.edge_cutout_depth = 0.2;
    const auto body = mesh::with_order(mesh::layered(table, 0.05, 1), 2);
    const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
    auto modes = fem::modes(system, {.count = 8, .certificate = false}).modes;
    modes.shapes = fem::on_nodes(system.dofs, modes.shapes);
    const auto spectrum = fem::laplace_spectrum(mesh::body_laplacian(body), 150);
    const mesh::SiteFinder finder(body);
    const auto seen = [&](const std::vector<double>& along) {
      std::vector<mesh::Site> sites;
      for (const double x : along) {
        for (const double y : along) {
          const auto site = finder.from_above(x, y);
          if (site) sites.push_back(*site);
        }
      }
      return places_at(sites, body, modes, fem::functions_at(spectrum, sites));
    };
    measured.places = seen({-0.27, -0.15, -0.03, 0.03, 0.15, 0.27});
    std::vector<double> fine;
    for (int k = 0; k < 30; ++k) fine.push_back(-0.29 + 0.02 * k);
    simulation.surface = seen(fine);
    simulation.frequency_hz = modes.frequency_hz;
    simulation.harmonic_eigenvalue = spectrum.eigenvalue;
    measure();
  }

  void measure() {
    simulation.area = Eigen::VectorXd::Ones(simulation.surface.count());
    truth = simulation.surface.shapes.middleCols(6, 8);
    const Eigen::VectorXd rms = truth.cwiseAbs2().colwise().mean().cwiseSqrt();
    const Eigen::MatrixXd scale = rms.cwiseInverse().asDiagonal();
    truth *= scale;
    const auto n = measured.places.count();
    measured.frequency_hz = simulation.frequency_hz.segment(6, 8);
    measured.values = measured.places.shapes.middleCols(6, 8) * scale + 0.01 * Dice(2).normal(n, 8);
    measured.noise = Eigen::MatrixXd::Constant(n, 8, 0.01);
  }

  static Places places_at(const std::vector<mesh::Site>& sites, const mesh::TetMesh& body,
                          const modal::Modes& modes, Eigen::MatrixXd harmonics) {
    const auto n = static_cast<Eigen::Index>(sites.size());
    Places places{Points(n, 3), Points::Zero(n, 3), Eigen::MatrixXd(n, modes.mode_count())};
    places.direction.col(2).setOnes();
    places.harmonics = std::move(harmonics);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& site = sites[static_cast<std::size_t>(k)];
      places.position.row(k) = site.position.transpose();
      const auto row = mesh::row_at(site, Eigen::Vector3d::UnitZ(), body.node_count());
      places.shapes.row(k) = row.transpose() * modes.shapes;
    }
    return places;
  }
};

TEST(SurfaceMatern, MeetsShapesThatASlotParts) {
  const SlottedTest test;
  const auto field_of = [&](const char* name) {
    return mode_field(interpolator(name), test.measured, test.simulation)
        ->at(test.simulation.surface);
  };
  const auto along = field_of("surface_matern");
  const auto across = field_of("thin_plate_spline");
  const auto& area = test.simulation.area;
  const auto error = squared_error(along.mean, test.truth, area);
  EXPECT_LT(error.maxCoeff(), 0.025);
  EXPECT_GT(squared_error(across.mean, test.truth, area).maxCoeff(), 4.0 * error.maxCoeff());
  const double covered = coverage(along, test.truth, area).mean();
  EXPECT_GT(covered, 0.90);
  EXPECT_LT(covered, 0.98);
}

TEST(SurfaceMatern, TakesEitherSenseOfTheDirection) {
  auto e = experiment(2, 0.01);
  const auto& method = interpolator("surface_matern");
  const auto straight = mode_field(method, e.measured, e.simulation)->at(e.simulation.surface);
  e.measured.places.direction.row(5) *= -1.0;
  e.measured.values.row(5) *= -1.0;
  const auto turned = mode_field(method, e.measured, e.simulation)->at(e.simulation.surface);
  EXPECT_LT((turned.mean - straight.mean).norm(), 1e-9);
}

TEST(SurfaceMatern, RefusesPlacesWithoutHarmonics) {
  auto e = experiment(2, 0.01);
  const auto& method = interpolator("surface_matern");
  const auto field = mode_field(method, e.measured, e.simulation);
  auto bare = e.measured.places;
  bare.harmonics.resize(0, 0);
  EXPECT_THROW((void)field->at(bare), InvalidInput);
  e.measured.places = bare;
  EXPECT_THROW((void)mode_field(method, e.measured, e.simulation), InvalidInput);
  e.simulation.harmonic_eigenvalue.resize(0);
  EXPECT_THROW((void)mode_field(method, e.measured, e.simulation), InvalidInput);
  EXPECT_THROW((void)harmonic_variances(Eigen::VectorXd::Ones(3), Eigen::VectorXd::Ones(3), 0.0),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
