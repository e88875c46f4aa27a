// Shapes of a modal model at fewer places than cross-validation can carry.
#include "priors/residual/one_scale.h"

#include <fmt/format.h>

#include "priors/constants.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/modal_field.h"

namespace chladni::priors {
namespace {

FitSummary::Parameter one_value(const std::string& name, double value) {
  return {name, "1", Eigen::VectorXd::Constant(1, value)};
}

// Part of the shape's mean square over the surface that is expected to be wrong.
double expected_error(const ModalBasis& basis, const ShapeCoefficients& shape) {
  const double left = (basis.gram * shape.root).cwiseProduct(shape.root).sum() + shape.beyond;
  const double seen = shape.mean.dot(basis.gram * shape.mean);
  return left / (seen + left);
}

}  // namespace

std::unique_ptr<ModeField> one_scale_field(const MeasuredShapes& measured,
                                           const Simulation& simulation) {
  const auto basis = modal_basis(simulation);
  const OneScale body(measured, basis);
  const auto errors = body.learned();
  FitSummary summary;
  summary.includes_scale = true;
  std::vector<ShapeCoefficients> shapes;
  Eigen::VectorXd expected(measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    shapes.push_back(body.shape(i, errors));
    expected(i) = expected_error(basis, shapes.back());
    if (expected(i) <= kHardlySeen) continue;
    summary.notes.push_back(
        fmt::format("mode {}: the places hardly see it, {:.0f} % of its mean square is expected "
                    "to be wrong",
                    i + 1, 100.0 * expected(i)));
  }
  summary.parameters = {
      {"expected_error", "1", expected},      one_value("eta", errors.prior.eta),
      one_value("kappa", errors.prior.kappa), one_value("gamma", errors.prior.gamma),
      one_value("scale", errors.scale),       one_value("place_deviation", errors.deviation)};
  if (!simulation.corrections.empty()) {
    summary.notes.push_back(fmt::format(
        "{} places: the simulation is not corrected, with fewer than {} it could not be tested by "
        "leaving some out; all modes have one scale instead",
        measured.places.count(), Constants::fewest_places));
  }
  return std::make_unique<ModalField>(std::move(shapes), std::move(summary));
}

}  // namespace chladni::priors
