// The dynamic residual's prior, learned from all shapes together; the default method.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "priors/constants.h"
#include "priors/learned_corrections.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/modal_field.h"
#include "priors/residual/calibration.h"
#include "priors/residual/orthogonality.h"
#include "priors/residual/random_coefficients.h"
#include "priors/residual/residual_evidence.h"

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

FitSummary::Parameter parameter(const std::string& name, double value) {
  return {name, "1", Eigen::VectorXd::Constant(1, value)};
}

void add_errors(const ResidualErrors& errors, FitSummary& summary) {
  summary.parameters.push_back(parameter("eta", errors.prior.eta));
  summary.parameters.push_back(parameter("kappa", errors.prior.kappa));
  summary.parameters.push_back(parameter("gamma", errors.prior.gamma));
  summary.parameters.push_back(parameter("noise_ratio", errors.noise));
}

// A fit on given modes of the simulation, with the shapes' coefficients on these modes.
struct Fit {
  std::vector<ShapeCoefficients> shapes;
  FitSummary summary;
};

Fit fit_on(const MeasuredShapes& measured, const ModalBasis& basis, const ResidualErrors& errors) {
  const auto shapes = fitted_shapes(measured, basis, errors);
  Fit fit{{}, modal_summary(shapes)};
  add_errors(errors, fit.summary);
  for (const auto& shape : shapes) fit.shapes.push_back(shape.coefficients);
  return fit;
}

void make_orthogonal(Fit& fit, double least) {
  const double tolerance = std::max(least, learned_tolerance(fit.shapes));
  fit.summary.parameters.push_back(parameter("orthogonality_tolerance", tolerance));
  fit.shapes = orthogonal_shapes(fit.shapes, {.tolerance = tolerance});
}

std::unique_ptr<ModeField> plain_field(const MeasuredShapes& measured, const Simulation& simulation,
                                       bool orthogonal) {
  const auto basis = modal_basis(simulation);
  const auto learned = learned_errors(measured, basis);
  auto fit = fit_on(measured, basis, learned.errors);
  if (orthogonal) make_orthogonal(fit, 0.0);
  auto& notes = fit.summary.notes;
  notes.insert(notes.end(), learned.doubts.begin(), learned.doubts.end());
  return std::make_unique<ModalField>(std::move(fit.shapes), std::move(fit.summary));
}

// Mean coefficients of the shapes on the simulation's modes, r×m, for a corrected simulation.
Eigen::MatrixXd means_of(const MeasuredShapes& measured, const ModalBasis& basis,
                         const CorrectedSimulation& meant) {
  const auto there = corrected_measured(measured, meant.modes);
  const auto its = corrected_basis(basis, meant.modes);
  Eigen::MatrixXd means(basis.frequency_hz.size(), measured.mode_count());
  for (Eigen::Index i = 0; i < means.cols(); ++i) {
    const auto known = coefficient_prior(its, measured.frequency_hz(i), meant.errors.prior);
    const Eigen::VectorXd root = known.variance.cwiseSqrt();
    const auto noise = deviation_of_values(measured, i, meant.errors.noise, known.beyond);
    const RandomCoefficients shape(there.places.shapes * root.asDiagonal(), measured.values.col(i),
                                   noise);
    means.col(i) = meant.modes.turn * root.cwiseProduct(shape.mean());
  }
  return means;
}

// A square root matrix of the covariance A Aᵀ + B Bᵀ.
Eigen::MatrixXd joint_root(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd covariance = a * a.transpose() + b * b.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(covariance, "covariance of a shape"));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// Adds the uncertainty of the corrections to the shapes, which are on the most likely modes.
void add_uncertainty(const MeasuredShapes& measured, const ModalBasis& basis,
                     const LearnedCorrections& learned, std::vector<ShapeCoefficients>& shapes) {
  const Eigen::MatrixXd middle = means_of(measured, basis, learned.likeliest);
  const auto count = static_cast<Eigen::Index>(learned.aside.size());
  std::vector<Eigen::MatrixXd> moved(shapes.size(), Eigen::MatrixXd(middle.rows(), count));
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::MatrixXd away =
        means_of(measured, basis, learned.aside[static_cast<std::size_t>(k)]) - middle;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      moved[i].col(k) = away.col(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> onto(learned.likeliest.modes.turn);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    shapes[i].root = joint_root(shapes[i].root, onto.solve(moved[i]));
  }
}

// The fit on the corrected simulation; its coefficients are on the modes of the original one.
Fit corrected_fit(const MeasuredShapes& measured, const ModalBasis& basis,
                  const std::vector<Correction>& corrections) {
  const auto learned = learned_corrections(measured, basis, corrections);
  const auto& modes = learned.likeliest.modes;
  auto fit = fit_on(corrected_measured(measured, modes), corrected_basis(basis, modes),
                    learned.likeliest.errors);
  add_uncertainty(measured, basis, learned, fit.shapes);
  make_orthogonal(fit, Constants::least_tolerance);
  for (auto& shape : fit.shapes) {
    shape.mean = modes.turn * shape.mean;
    shape.root = modes.turn * shape.root;
  }
  for (std::size_t f = 0; f < corrections.size(); ++f) {
    fit.summary.parameters.push_back(
        parameter(corrections[f].name, learned.parameters(static_cast<Eigen::Index>(f))));
  }
  auto& notes = fit.summary.notes;
  for (const auto* doubts : {&learned.doubts, &learned.correction_doubts}) {
    notes.insert(notes.end(), doubts->begin(), doubts->end());
  }
  return fit;
}

std::unique_ptr<ModeField> corrected_field(const MeasuredShapes& measured,
                                           const Simulation& simulation) {
  const auto basis = modal_basis(simulation);
  auto fit = corrected_fit(measured, basis, simulation.corrections);
  const double factor = band_factor(measured, [&](const MeasuredShapes& part) {
    auto of_part = corrected_fit(part, basis, simulation.corrections);
    return std::make_unique<ModalField>(std::move(of_part.shapes), std::move(of_part.summary));
  });
  for (auto& shape : fit.shapes) {
    shape.root *= factor;
    shape.beyond *= factor * factor;
  }
  fit.summary.parameters.push_back(parameter("band_factor", factor));
  return std::make_unique<ModalField>(std::move(fit.shapes), std::move(fit.summary));
}

// With fewer places nothing can be left out to test what is learned.
bool has_few_places(const MeasuredShapes& measured) {
  return measured.places.count() < Constants::fewest_places;
}

}  // namespace

const Interpolator dynamic_residual_interpolator{
    .name = "dynamic_residual",
    .summary =
        "random sums of the simulation's modes, corrected where it has corrections, after how far "
        "each is from being one of the real structure; orthogonal shapes",
    .source = "Balmes 1999 (minimum dynamic residual), as a Gaussian process",
    .uses_modes = true,
    .has_deviation = true,
    .fit =
        [](const MeasuredShapes& measured, const Simulation& simulation) {
          if (measured.sides && has_few_places(measured)) {
            return one_scale_field(measured, simulation);
          }
          return simulation.corrections.empty() ? plain_field(measured, simulation, true)
                                                : corrected_field(measured, simulation);
        },
};

const Interpolator dynamic_residual_alone_interpolator{
    .name = "dynamic_residual_alone",
    .summary = "the same without the shapes' being orthogonal",
    .source = "Balmes 1999 (minimum dynamic residual), as a Gaussian process",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return plain_field(measured, simulation, false); },
};

const Interpolator dynamic_residual_orthogonal_interpolator{
    .name = "dynamic_residual_orthogonal",
    .summary = "the default without corrections of the simulation",
    .source = "Balmes 1999 (minimum dynamic residual), as a Gaussian process",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return plain_field(measured, simulation, true); },
};

}  // namespace chladni::priors
