// The dynamic residual's prior, learned from all shapes together; the default.
#include <cmath>

#include "priors/interpolators.h"
#include "priors/modal_field.h"
#include "priors/orthogonality.h"
#include "priors/residual_evidence.h"

namespace chladni::priors {
namespace {

std::vector<FittedShape> fitted_shapes(const MeasuredShapes& measured, const ModalBasis& basis,
                                       const ResidualErrors& errors) {
  std::vector<FittedShape> shapes;
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto known = coefficient_prior(basis, measured.frequency_hz(i), errors.prior);
    const Eigen::MatrixXd root = known.variance.cwiseSqrt().asDiagonal();
    shapes.push_back(fitted_shape(measured, basis, i, root, errors.noise, known.beyond));
  }
  return shapes;
}

std::unique_ptr<ModeField> field(const MeasuredShapes& measured, const Simulation& simulation,
                                 bool orthogonal) {
  const auto basis = modal_basis(simulation);
  const auto learned = learned_errors(measured, basis);
  const auto shapes = fitted_shapes(measured, basis, learned.errors);
  auto summary = modal_summary(shapes);
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  const auto& prior = learned.errors.prior;
  summary.parameters.push_back({"eta", "1", one(prior.eta)});
  summary.parameters.push_back({"kappa", "1", one(prior.kappa)});
  summary.parameters.push_back({"gamma", "1", one(prior.gamma)});
  summary.parameters.push_back({"noise_ratio", "1", one(learned.errors.noise)});
  summary.notes.insert(summary.notes.end(), learned.doubts.begin(), learned.doubts.end());
  std::vector<ShapeCoefficients> known;
  for (const auto& shape : shapes) known.push_back(shape.coefficients);
  if (orthogonal) {
    const double tolerance = learned_tolerance(known);
    summary.parameters.push_back({"orthogonality_tolerance", "1", one(tolerance)});
    known = orthogonal_shapes(known, {.tolerance = tolerance});
  }
  return std::make_unique<ModalField>(std::move(known), std::move(summary));
}

}  // namespace

const Interpolator dynamic_residual_interpolator{
    .name = "dynamic_residual",
    .summary =
        "random sums of the simulation's modes, after how far each is from being one of the "
        "real structure; orthogonal shapes",
    .source = "Balmes 1999 (minimum dynamic residual), as a Gaussian process",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return field(measured, simulation, true); },
};

const Interpolator dynamic_residual_alone_interpolator{
    .name = "dynamic_residual_alone",
    .summary = "the same without the shapes' being orthogonal",
    .source = "Balmes 1999 (minimum dynamic residual), as a Gaussian process",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return field(measured, simulation, false); },
};

}  // namespace chladni::priors
