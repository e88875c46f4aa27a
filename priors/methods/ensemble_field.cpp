// Shapes from an ensemble of models that differ from the simulation in its uncertain parameters.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "base/error.h"
#include "priors/constants.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/modal_field.h"
#include "priors/residual/residual_evidence.h"

namespace chladni::priors {
namespace {

struct Mixture {
  double width = 0.0, residual = 0.0;
};

// Mean of c cᵀ over the members' shapes, weighted by their distance to the real frequency. No
// member's shape is paired with a real one. Scaled to mean square 1 over the surface.
Eigen::MatrixXd likeness(const std::vector<SimilarModel>& similar, const ModalBasis& basis,
                         double real_hz, double gamma, double width) {
  const auto r = basis.frequency_hz.size();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(r, r);
  for (const auto& member : similar) {
    for (Eigen::Index j = 0; j < member.frequency_hz.size(); ++j) {
      if (member.frequency_hz(j) <= 0.0) continue;
      const double away = std::log(std::sqrt(gamma) * member.frequency_hz(j) / real_hz) / width;
      if (std::abs(away) > 6.0) continue;
      const Eigen::VectorXd shape = member.turn.col(j);
      sum.selfadjointView<Eigen::Lower>().rankUpdate(shape, std::exp(-0.5 * away * away));
    }
  }
  const Eigen::MatrixXd whole = sum.selfadjointView<Eigen::Lower>();
  const double square = whole.cwiseProduct(basis.gram).sum();
  if (square <= 0.0) return Eigen::MatrixXd::Zero(r, r);
  return whole / square;
}

// Root of the prior covariance (1 − ρ) likeness + ρ dynamic residual.
Eigen::MatrixXd root_of(const MeasuredShapes& measured, Eigen::Index mode,
                        const std::vector<SimilarModel>& similar, const ModalBasis& basis,
                        const ResidualErrors& errors, const Mixture& mixture) {
  const double real_hz = measured.frequency_hz(mode);
  const auto residual = coefficient_prior(basis, real_hz, errors.prior);
  if (real_hz == 0.0) return residual.variance.cwiseSqrt().asDiagonal();
  Eigen::MatrixXd covariance = (1.0 - mixture.residual) *
                               likeness(similar, basis, real_hz, errors.prior.gamma, mixture.width);
  covariance.diagonal() +=
      mixture.residual * residual.variance / residual.variance.dot(basis.gram.diagonal());
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) {
    throw NumericalFailure("ensemble: mode " + fmt::to_string(mode + 1) +
                           " has no positive definite prior");
  }
  return factor.matrixL();
}

std::vector<FittedShape> fitted_shapes(const MeasuredShapes& measured,
                                       const std::vector<SimilarModel>& similar,
                                       const ModalBasis& basis, const ResidualErrors& errors,
                                       const Mixture& mixture) {
  std::vector<FittedShape> shapes;
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto root = root_of(measured, i, similar, basis, errors, mixture);
    const double beyond = coefficient_prior(basis, measured.frequency_hz(i), errors.prior).beyond;
    shapes.push_back(fitted_shape(measured, basis, i, root, errors.noise, beyond));
  }
  return shapes;
}

std::unique_ptr<ModeField> field(const MeasuredShapes& measured, const Simulation& simulation) {
  require(!simulation.similar.empty(),
          "ensemble: the simulation comes without models that are similar to it");
  const auto basis = modal_basis(simulation);
  const auto learned = learned_errors(measured, basis);
  double highest = -std::numeric_limits<double>::infinity();
  std::vector<FittedShape> best;
  Mixture chosen;
  for (const double width : Constants::ensemble_widths) {
    for (const double residual : Constants::ensemble_residuals) {
      auto shapes =
          fitted_shapes(measured, simulation.similar, basis, learned.errors, {width, residual});
      double evidence = 0.0;
      for (const auto& shape : shapes) evidence += shape.log_evidence;
      if (evidence <= highest) continue;
      highest = evidence;
      best = std::move(shapes);
      chosen = {width, residual};
    }
  }
  auto summary = modal_summary(best);
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  summary.parameters.push_back({"frequency_width", "1", one(chosen.width),
                                chosen.width == Constants::ensemble_widths.front() ||
                                    chosen.width == Constants::ensemble_widths.back()});
  summary.parameters.push_back({"residual_part", "1", one(chosen.residual),
                                chosen.residual == Constants::ensemble_residuals.back()});
  if (chosen.residual == Constants::ensemble_residuals.back()) {
    summary.notes.push_back(
        "the shapes are not those of any model of the ensemble: it leaves out what matters here");
  }
  summary.notes.insert(summary.notes.end(), learned.doubts.begin(), learned.doubts.end());
  std::vector<ShapeCoefficients> known;
  for (const auto& shape : best) known.push_back(shape.coefficients);
  return std::make_unique<ModalField>(std::move(known), std::move(summary));
}

}  // namespace

const Interpolator ensemble_interpolator{
    .name = "ensemble",
    .summary =
        "shapes of models that differ from the simulation in what is not known of it, and "
        "the dynamic residual for what they leave out",
    .source = "Karhunen 1947, Loeve 1948; weights by frequency instead of pairing",
    .uses_modes = true,
    .has_deviation = true,
    .fit = field,
};

}  // namespace chladni::priors
