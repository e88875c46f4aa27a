// Measured shapes as random fields on the harmonics of the surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "priors/constants.h"
#include "priors/methods/blocks.h"
#include "priors/methods/interpolators.h"
#include "priors/spline/surface_kernel.h"
#include "priors/spline/thin_plate_spline.h"

namespace chladni::priors {
namespace {

const Eigen::MatrixXd& harmonics_of(const Places& places, Eigen::Index count) {
  require(places.harmonics.rows() == places.count() && places.harmonics.cols() == count,
          "surface_matern needs the surface's harmonics at every place; expected " +
              fmt::to_string(places.count()) + "x" + fmt::to_string(count) + ", found " +
              fmt::to_string(places.harmonics.rows()) + "x" +
              fmt::to_string(places.harmonics.cols()));
  return places.harmonics;
}

// One shape on h harmonics and s places.
struct SurfaceShape {
  SurfaceFit fit;
  Smoother smoother;
  Eigen::MatrixXd images;  // h×s: harmonics at the places, times their variances
  Eigen::VectorXd coefficients;
  double constant = 0.0;

  SurfaceShape(SurfaceFit learned, const Eigen::MatrixXd& harmonics, const Eigen::VectorXd& values)
      : fit(std::move(learned)),
        smoother(surface_smoother(fit, harmonics)),
        images(fit.variances.asDiagonal() * harmonics.transpose()) {
    const auto function = smoother.fit(values, fit.smoothing.lambda);
    coefficients = images * function.weights;
    constant = function.trend(0);
  }

  [[nodiscard]] Eigen::VectorXd mean(const Eigen::MatrixXd& harmonics) const {
    return (harmonics * coefficients).array() + constant;
  }
  [[nodiscard]] Eigen::VectorXd variance(const Eigen::MatrixXd& harmonics) const {
    return smoother.variance(harmonics * images, harmonics.cwiseAbs2() * fit.variances,
                             Eigen::MatrixXd::Ones(harmonics.rows(), 1), {fit.smoothing});
  }
};

class SurfaceField final : public ModeField {
 public:
  SurfaceField(Eigen::Vector3d direction, std::vector<SurfaceShape> shapes, FitSummary summary)
      : ModeField(std::move(summary)),
        direction_(std::move(direction)),
        shapes_(std::move(shapes)) {}

  [[nodiscard]] Field field_at(const Places& places) const override {
    const auto& harmonics = harmonics_of(places, shapes_.front().coefficients.size());
    const Eigen::VectorXd sense = senses(direction_, places.direction);
    const auto n = places.count();
    const auto m = static_cast<Eigen::Index>(shapes_.size());
    Field field{Eigen::MatrixXd(n, m), Eigen::MatrixXd(n, m)};
    for_blocks(n, [&](Eigen::Index first, Eigen::Index count) {
      const Eigen::MatrixXd block = harmonics.middleRows(first, count);
      for (Eigen::Index i = 0; i < m; ++i) {
        const auto& shape = shapes_[static_cast<std::size_t>(i)];
        field.mean.col(i).segment(first, count) = shape.mean(block);
        field.deviation.col(i).segment(first, count) = shape.variance(block).cwiseSqrt();
      }
    });
    field.mean.array().colwise() *= sense.array();
    return field;
  }

 private:
  Eigen::Vector3d direction_;
  std::vector<SurfaceShape> shapes_;
};

// Expected relative error: variance over mean square plus variance, over the surface.
double expected_error(const SurfaceShape& shape, const Simulation& simulation) {
  const auto& harmonics = simulation.surface.harmonics;
  const double left = shape.variance(harmonics).dot(simulation.area);
  const double seen = shape.mean(harmonics).cwiseAbs2().dot(simulation.area);
  return left / (seen + left);
}

FitSummary summary_of(const std::vector<SurfaceShape>& shapes, const Simulation& simulation) {
  const auto m = static_cast<Eigen::Index>(shapes.size());
  FitSummary summary;
  Eigen::VectorXd length(m);
  Eigen::VectorXd expected(m);
  summary.log_evidence.resize(m);
  bool at_bound = false;
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto& shape = shapes[static_cast<std::size_t>(i)];
    length(i) = shape.fit.length;
    expected(i) = expected_error(shape, simulation);
    summary.log_evidence(i) = shape.fit.smoothing.log_likelihood;
    at_bound = at_bound || shape.fit.at_bound;
    if (std::isinf(shape.fit.smoothing.lambda)) {
      summary.notes.push_back(
          fmt::format("mode {}: nothing but a constant is found beyond the noise", i + 1));
    } else if (expected(i) > Constants::unseen) {
      summary.notes.push_back(fmt::format(
          "mode {}: the places do not see it, {:.0f} % of its mean square is expected to be wrong",
          i + 1, 100.0 * expected(i)));
    } else if (shape.fit.at_bound) {
      summary.notes.push_back(fmt::format(
          "mode {}: its length, {:.3g} m, is at the end of its range", i + 1, shape.fit.length));
    }
  }
  summary.parameters = {{"length", "m", length, at_bound}, {"expected_error", "1", expected}};
  return summary;
}

std::unique_ptr<ModeField> surface_matern(const MeasuredShapes& measured,
                                          const Simulation& simulation) {
  const auto h = simulation.harmonic_eigenvalue.size();
  require(h > 1, "surface_matern needs the harmonics of the surface; the simulation has " +
                     fmt::to_string(h));
  const auto& harmonics = harmonics_of(measured.places, h);
  const Eigen::VectorXd mean_square = harmonics_of(simulation.surface, h).cwiseAbs2().transpose() *
                                      simulation.area / simulation.area.sum();
  const Eigen::Vector3d direction = measured.places.direction.row(0).transpose().normalized();
  const Eigen::VectorXd sense = senses(direction, measured.places.direction);
  std::vector<SurfaceShape> shapes;
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const Eigen::VectorXd values = measured.values.col(i).cwiseProduct(sense);
    shapes.emplace_back(surface_fit(values, measured.noise.col(i), harmonics,
                                    simulation.harmonic_eigenvalue, mean_square),
                        harmonics, values);
  }
  auto summary = summary_of(shapes, simulation);
  return std::make_unique<SurfaceField>(direction, std::move(shapes), std::move(summary));
}

}  // namespace

const Interpolator surface_matern_interpolator{
    .name = "surface_matern",
    .summary =
        "a random field as smooth as the values make likely along the body's own surface; "
        "bridges no slots, knows no bending",
    .source = "Lindgren, Rue and Lindstrom 2011; Borovitskiy et al. 2020",
    .uses_modes = false,
    .has_deviation = true,
    .fit = surface_matern,
};

}  // namespace chladni::priors
