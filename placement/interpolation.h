// Quality of a layout for the interpolation of mode shapes, before any measurement.
#pragma once

#include "base/arrays.h"
#include "placement/determinant.h"
#include "priors/dynamic_residual.h"

namespace chladni::placement {

/// Prior of m real shapes on r modes of the simulation, rigid-body modes included.
struct ShapePrior {
  Eigen::MatrixXd variance;  ///< r×m: variances of the coefficients of real shape i on the
                             ///< simulation's modes; the expected mean square on the surface is 1
  Eigen::MatrixXd gram;  ///< r×r: mean of ψ ψᵀ over the surface
};

/// @param shapes        n×r [kg^-1/2]: all modes of the simulation at points of the surface
/// @param area          n [m²]: the area of each point
/// @param frequency_hz  r
/// @param wanted        columns of the modes to be interpolated
[[nodiscard]] ShapePrior shape_prior(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                                     const Eigen::VectorXd& frequency_hz,
                                     const std::vector<Eigen::Index>& wanted,
                                     const priors::DynamicResidual& prior = {});

/// Expected squared errors of shapes interpolated from a layout under the prior, relative to the
/// mean square of the shape: 0 is perfect, 1 means no information.
struct ExpectedError {
  Eigen::VectorXd per_mode;  ///< m: mean over the surface
  [[nodiscard]] double mean() const { return per_mode.mean(); }
};

/// @param rows   s×r [kg^-1/2]: the simulation's modes at the layout's sites
/// @param noise  s×m: standard deviation of a sample, relative to the shape's root mean square
[[nodiscard]] ExpectedError expected_error(const ShapePrior& prior, const Eigen::MatrixXd& rows,
                                           const Eigen::MatrixXd& noise);

/// The standard deviation of each interpolated shape at n places, n×m, relative to the shape's root
/// mean square. @param places  n×r [kg^-1/2]
[[nodiscard]] Eigen::MatrixXd expected_deviation(const ShapePrior& prior,
                                                 const Eigen::MatrixXd& rows,
                                                 const Eigen::MatrixXd& noise,
                                                 const Eigen::MatrixXd& places);

/// Choose `count` of N candidates so that the mean expected error is smallest (I-optimality).
struct InterpolationProblem {
  Eigen::MatrixXd rows;         ///< N×r [kg^-1/2]
  Eigen::VectorXd noise;        ///< m: noise of a chosen site, as in `expected_error`
  Eigen::MatrixXd there;        ///< s×r: existing sites
  Eigen::MatrixXd there_noise;  ///< s×m
  ShapePrior prior;
  Eigen::Index count = 0;
  Points position;       ///< N×3 [m]
  double spacing = 0.0;  ///< [m]
};

struct InterpolationOptions {
  int starts = 3;
  unsigned seed = 1;
};

/// Exchange from several starts. Many candidates are first thinned to some hundreds; the result is
/// refined among the neighbours of the chosen sites, then among all candidates. `score` is the
/// negative mean expected error. There is no bound: the relaxation is useless here, since fractions
/// of a sensor everywhere cost almost nothing (`bound` is 0, which no layout reaches). Cost per
/// exchange of one site: N r² m.
/// @throws InvalidInput  as `greedy`
[[nodiscard]] Choice best_interpolation(const InterpolationProblem& problem,
                                        const InterpolationOptions& options = {});

}  // namespace chladni::placement
