// How well a layout lets the mode shapes be interpolated, before anything is measured.
#pragma once

#include "base/arrays.h"
#include "placement/determinant.h"
#include "priors/dynamic_residual.h"

namespace chladni::placement {

/// What is known of m real shapes from r modes of the simulation, rigid-body ones included.
struct ShapePrior {
  Eigen::MatrixXd variance;  ///< r×m: of the coefficients of real shape i on the simulation's
                             ///< modes, scaled so that its expected mean square on the surface is 1
  Eigen::MatrixXd gram;  ///< r×r: mean of ψ ψᵀ over the surface
};

/// @param shapes        n×r [kg^-1/2]: all modes of the simulation at points of the surface
/// @param area          n [m²]: that each point stands for
/// @param frequency_hz  r
/// @param wanted        columns of the modes that are to be interpolated
[[nodiscard]] ShapePrior shape_prior(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                                     const Eigen::VectorXd& frequency_hz,
                                     const std::vector<Eigen::Index>& wanted,
                                     const priors::DynamicResidual& prior = {});

/// Expected squared errors of shapes that are interpolated from a layout under the prior, relative
/// to the mean square of the shape: 0 is perfect, 1 is knowing nothing.
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
  Eigen::VectorXd noise;        ///< m: of a chosen site, as in `expected_error`
  Eigen::MatrixXd there;        ///< s×r: sites in place
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

/// Exchange from several starts. Many candidates are first thinned out to some hundreds, then
/// refined among the neighbours of what was chosen, then among all. `score` is the negative mean
/// expected error; there is no bound: the relaxation is useless here, fractions of a sensor
/// everywhere are almost free (`bound` is 0, what no layout can reach). Cost per exchange of one
/// site: N r² m.
/// @throws InvalidInput  as `greedy`
[[nodiscard]] Choice best_interpolation(const InterpolationProblem& problem,
                                        const InterpolationOptions& options = {});

}  // namespace chladni::placement
