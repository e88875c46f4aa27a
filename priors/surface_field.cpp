// Measured shapes as random fields on the surface's own harmonics.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "priors/interpolators.h"
#include "priors/modal_field.h"
#include "priors/surface_kernel.h"
#include "priors/thin_plate_spline.h"

namespace chladni::priors {
namespace {

constexpr double kSmoothness = 2.5;

// The places as a modal field wants them, with harmonics where modes would be.
Places on_harmonics(const Places& places, Eigen::Index count) {
  require(places.harmonics.rows() == places.count() && places.harmonics.cols() == count,
          "surface_matern needs the surface's harmonics at every place; expected " +
              std::to_string(count) + ", found " + std::to_string(places.harmonics.cols()));
  Places seen;
  seen.position = places.position;
  seen.direction = places.direction;
  seen.shapes = places.harmonics;
  return seen;
}

class SurfaceField final : public ModeField {
 public:
  SurfaceField(Eigen::Vector3d direction, std::vector<ShapeCoefficients> shapes, FitSummary summary)
      : ModeField(std::move(summary)),
        direction_(std::move(direction)),
        count_(shapes.front().mean.size()),
        field_(std::move(shapes), {}) {}

  [[nodiscard]] Field at(const Places& places) const override {
    auto field = field_.at(on_harmonics(places, count_));
    field.mean.array().colwise() *= senses(direction_, places.direction).array();
    return field;
  }

 private:
  Eigen::Vector3d direction_;
  Eigen::Index count_;
  ModalField field_;
};

// The gram matrix of the harmonics over the surface, where a modal method has that of the modes.
ModalBasis harmonic_basis(const Simulation& simulation) {
  const auto seen = on_harmonics(simulation.surface, simulation.harmonic_eigenvalue.size());
  ModalBasis basis;
  basis.frequency_hz = simulation.harmonic_eigenvalue.cwiseMax(0.0).cwiseSqrt();
  basis.gram = seen.shapes.transpose() * (simulation.area / simulation.area.sum()).asDiagonal() *
               seen.shapes;
  return basis;
}

std::unique_ptr<ModeField> surface_matern(const MeasuredShapes& measured,
                                          const Simulation& simulation) {
  const auto h = simulation.harmonic_eigenvalue.size();
  require(h > 1, "surface_matern needs the harmonics of the surface; the simulation has " +
                     std::to_string(h));
  const auto basis = harmonic_basis(simulation);
  const Eigen::Vector3d direction = measured.places.direction.row(0).transpose().normalized();
  auto seen = measured;
  seen.places = on_harmonics(measured.places, h);
  seen.values.array().colwise() *= senses(direction, measured.places.direction).array();
  std::vector<FittedShape> shapes;
  std::vector<std::string> doubts;
  Eigen::VectorXd length(measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto learned =
        learned_length(seen.values.col(i), seen.noise.col(i), seen.places.shapes,
                       simulation.harmonic_eigenvalue, basis.gram.diagonal(), kSmoothness);
    length(i) = learned.length;
    if (learned.at_bound) {
      doubts.push_back(fmt::format("mode {}: its length, {:.3g} m, is at the end of its range",
                                   i + 1, learned.length));
    }
    const auto variances = harmonic_variances(simulation.harmonic_eigenvalue, basis.gram.diagonal(),
                                              learned.length, kSmoothness);
    const Eigen::MatrixXd root = variances.value.cwiseSqrt().asDiagonal();
    shapes.push_back(fitted_shape(seen, basis, i, root, 1.0, 0.0));
  }
  auto summary = modal_summary(shapes);
  summary.parameters.push_back({"length", "m", length, !doubts.empty()});
  summary.notes.insert(summary.notes.end(), doubts.begin(), doubts.end());
  std::vector<ShapeCoefficients> known;
  for (auto& shape : shapes) known.push_back(std::move(shape.coefficients));
  return std::make_unique<SurfaceField>(direction, std::move(known), std::move(summary));
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
