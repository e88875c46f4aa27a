// Hyper-parameters from shapes: of a simulation, sampled densely, or of the measured points.
#pragma once

#include <limits>
#include <utility>

#include "priors/gaussian_process/gaussian_process.h"

namespace chladni::priors {

/// ln θ ~ N(ln median, log_deviation²); an infinite deviation gives no information.
struct LogNormal {
  double median = 1.0;
  double log_deviation = std::numeric_limits<double>::infinity();
};

struct Learning {
  Merit merit = Merit::marginal_likelihood;
  bool shared = false;        ///< one set for all shapes; each shape keeps its amplitude
  double noise_ratio = 1e-8;  ///< noise variance over σ²: 1e-8 or more, so that no factorisation
                              ///< fails and thereby chooses the length
  bool learn_noise = false;   ///< the ratio is a further parameter, from noise_ratio to 1
  Eigen::MatrixXd noise{};    ///< N×m: known standard deviations instead of a ratio; may be empty
  Trend trend{};
  std::pair<double, double> length_range{0.0, 0.0};  ///< [m]; zeros: taken from the points
  std::vector<LogNormal> priors{};                   ///< p, or empty
  Eigen::VectorXd start{};                           ///< p: start values, or empty
  int starts = 4;                                    ///< number of local searches if p > 1
  unsigned seed = 1;
  double tolerance = 5e-4;  ///< of ln θ
};

/// Result of learning for one shape, or for all.
struct Learned {
  Eigen::VectorXd parameters;         ///< p, of the kernel
  double sigma = 0.0;                 ///< amplitude, in the unit of the values
  double noise = 0.0;                 ///< standard deviation, same unit; its mean if it is known
  double score = 0.0;                 ///< value of the merit; the sum if shared
  double log_likelihood = 0.0;        ///< marginal, for every merit
  std::vector<std::string> at_bound;  ///< names of parameters at the end of their range
  double jitter = 0.0;  ///< variance added for the factorisation, over σ²
  int evaluations = 0;  ///< factorisations in the search, for all shapes together
};

/// The range from 0.3 times the median distance of nearest neighbours to five diagonals.
/// @throws InvalidInput  all points coincide
[[nodiscard]] std::pair<double, double> length_range(const Points& points);

/// One result per column of `values`, or one in total if shared. With one hyper-parameter a
/// grid over its range serves all shapes, since each factorisation gives all scores; parabolas
/// then refine it. With more, limited-memory BFGS runs from several starts; the first is
/// `start` or the middle. Cost with one hyper-parameter: about 35 factorisations of N³ / 3 in
/// total, if the noise is a ratio.
/// @throws InvalidInput      sizes that do not fit, a shape that is zero, a noise ratio below 1e-8
/// @throws NumericalFailure  as GaussianProcess
[[nodiscard]] std::vector<Learned> learned(const Kernel& kernel, const Points& points,
                                           const Eigen::MatrixXd& values, const Learning& how = {});

/// For each result of `learned`: the largest change of ln σ and ln θ when the noise ratio is
/// multiplied by 100. It is near 0 if the values determine the hyper-parameters. Shapes that are
/// smoother than any draw of the kernel and sampled densely without noise lie on a ridge: the ratio
/// then determines σ and the length, and the result is 0.05 or more. Cost: one more learning.
[[nodiscard]] Eigen::VectorXd noise_dependence(const std::vector<Learned>& found,
                                               const Kernel& kernel, const Points& points,
                                               const Eigen::MatrixXd& values, const Learning& how);

/// The learned prior.
[[nodiscard]] GaussianPrior prior_of(const Kernel& kernel, const Learned& what, const Trend& trend);

/// A simulated experiment for the choice of a length: f shapes measured at s places with noise, and
/// predicted on the surface.
struct Task {
  Points places;               ///< s×3 [m]
  Eigen::MatrixXd at_places;   ///< s×f
  Points surface;              ///< N×3 [m]
  Eigen::MatrixXd on_surface;  ///< N×f
  Eigen::VectorXd area;        ///< N
  double noise = 0.01;         ///< standard deviation over a shape's root mean square
  Trend trend{};
};

/// The length with the least mean squared error of the interpolated shapes, each relative to its
/// own square; amplitudes by marginal likelihood. It is larger than the length from dense data,
/// because it is matched to the spacing of the places.
struct MatchedLength {
  double length = 0.0;      ///< [m]
  double error = 0.0;       ///< mean over the f shapes
  Eigen::VectorXd lengths;  ///< g: the grid
  Eigen::VectorXd errors;   ///< g
  bool at_bound = false;    ///< at the shortest length the places do not resolve the shapes
};
/// @throws InvalidInput  sizes that do not fit; a kernel of more than one hyper-parameter
[[nodiscard]] MatchedLength matched_length(const Kernel& kernel, const Task& task,
                                           int lengths = 25);

/// The same for a random shape, the sum of the f shapes with independent coefficients of variance
/// 1: its expected squared error over its expected square, in closed form. The amplitude is the
/// random shape's own root mean square over the surface; `noise` is relative to it.
[[nodiscard]] MatchedLength expected_length(const Kernel& kernel, const Task& task,
                                            int lengths = 25);

}  // namespace chladni::priors
