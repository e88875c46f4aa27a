// Sums of the simulation's modes with the same prior for every real shape.
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "dense/algebra.h"
#include "priors/constants.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/modal_field.h"

namespace chladni::priors {
namespace {

// Coefficients with the deviations `deviation`, up to a scale of each shape.
std::unique_ptr<ModeField> field_with(const MeasuredShapes& measured, const Simulation& simulation,
                                      const Eigen::VectorXd& deviation) {
  const auto basis = modal_basis(simulation);
  const Eigen::MatrixXd root = deviation.asDiagonal();
  std::vector<FittedShape> shapes;
  std::vector<ShapeCoefficients> known;
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    shapes.push_back(fitted_shape(measured, basis, i, root, 1.0, 0.0));
    known.push_back(shapes.back().coefficients);
  }
  return std::make_unique<ModalField>(std::move(known), modal_summary(shapes));
}

// Deviations λ_j^(−power/2) for flexible modes; rigid-body modes are free.
std::unique_ptr<ModeField> energy_spline(const MeasuredShapes& measured,
                                         const Simulation& simulation, double power) {
  const auto rigid = simulation.rigid_count();
  const auto r = simulation.mode_count();
  require(r > rigid, "energy spline: the simulation has no flexible modes");
  const double first = simulation.frequency_hz(rigid);
  Eigen::VectorXd deviation(r);
  for (Eigen::Index j = 0; j < r; ++j) {
    deviation(j) =
        j < rigid ? Constants::free_rigid : std::pow(simulation.frequency_hz(j) / first, -power);
  }
  return field_with(measured, simulation, deviation);
}

// The modes in the band that the places see, at most as many as there are places.
std::vector<Eigen::Index> modes_in_band(const MeasuredShapes& measured,
                                        const Simulation& simulation) {
  const double limit = Constants::serep_band * measured.frequency_hz.maxCoeff();
  const Eigen::VectorXd seen = measured.places.shapes.colwise().norm();
  const double least = Constants::unseen_mode * seen.maxCoeff();
  std::vector<Eigen::Index> columns;
  for (Eigen::Index j = 0; j < simulation.mode_count(); ++j) {
    const bool fits = static_cast<Eigen::Index>(columns.size()) < measured.places.count();
    if (fits && simulation.frequency_hz(j) <= limit && seen(j) > least) columns.push_back(j);
  }
  return columns;
}

std::unique_ptr<ModeField> least_squares(const MeasuredShapes& measured,
                                         const Simulation& simulation) {
  const auto columns = modes_in_band(measured, simulation);
  require(!columns.empty(),
          "serep: no simulated mode that the places see lies in the band of the measured ones; "
          "expected one or more, or another method");
  const Eigen::MatrixXd rows = measured.places.shapes(Eigen::all, columns);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(rows);
  std::vector<ShapeCoefficients> shapes;
  const auto r = simulation.mode_count();
  const auto k = static_cast<Eigen::Index>(columns.size());
  const Eigen::MatrixXd inverse = dense::inverse_of(factor);
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    ShapeCoefficients shape{Eigen::VectorXd::Zero(r), Eigen::MatrixXd::Zero(r, rows.rows()), 0.0};
    shape.mean(columns) = inverse * measured.values.col(i);
    shape.root(columns, Eigen::all) = inverse * measured.noise.col(i).asDiagonal();
    shapes.push_back(std::move(shape));
  }
  FitSummary summary;
  const auto diagonal = factor.matrixR().diagonal().head(std::min(k, rows.rows())).cwiseAbs();
  summary.parameters = {
      {"modes", "1", Eigen::VectorXd::Constant(1, static_cast<double>(k))},
      {"condition", "1",
       Eigen::VectorXd::Constant(1, diagonal.maxCoeff() / std::max(diagonal.minCoeff(), 1e-300))}};
  summary.notes.push_back("the deviation is that of the noise alone: what " + fmt::to_string(k) +
                          " modes cannot show is not in it");
  return std::make_unique<ModalField>(std::move(shapes), std::move(summary));
}

std::unique_ptr<ModeField> ridge(const MeasuredShapes& measured, const Simulation& simulation) {
  return field_with(measured, simulation, Eigen::VectorXd::Ones(simulation.mode_count()));
}

}  // namespace

const Interpolator energy_spline_interpolator{
    .name = "energy_spline",
    .summary =
        "the smoothest shape by the structure's own energy, |K phi| in the norm of M^-1; "
        "rigid-body motion free",
    .source = "Wahba 1990 (splines), Lindgren et al. 2011 (on the structure's own operator)",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return energy_spline(measured, simulation, 2.0); },
};

const Interpolator strain_energy_spline_interpolator{
    .name = "strain_energy_spline",
    .summary = "the shape of least strain energy, phi K phi; rigid-body motion free",
    .source = "Wahba 1990 (splines), on the structure's own stiffness",
    .uses_modes = true,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation& simulation) { return energy_spline(measured, simulation, 1.0); },
};

const Interpolator modal_expansion_interpolator{
    .name = "modal_expansion",
    .summary = "all modes of the simulation alike, damped by the evidence (ridge)",
    .source = "Balmes 1999 (modal expansion), ridge by evidence",
    .uses_modes = true,
    .has_deviation = true,
    .fit = ridge,
};

const Interpolator serep_interpolator{
    .name = "serep",
    .summary = "least squares on the modes of the band, fewer than places; explodes between them",
    .source = "O'Callahan, Avitabile and Riemer 1989",
    .uses_modes = true,
    .has_deviation = true,
    .fit = least_squares,
};

}  // namespace chladni::priors
