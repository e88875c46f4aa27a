// Hyper-parameters from shapes: of a simulation, densely sampled, or of the measured points.
#pragma once

#include <limits>
#include <utility>

#include "priors/gaussian_process/gaussian_process.h"

namespace chladni::priors {

/// ln θ ~ N(ln median, log_deviation²); an infinite deviation says nothing.
struct LogNormal {
  double median = 1.0;
  double log_deviation = std::numeric_limits<double>::infinity();
};

struct Learning {
  Merit merit = Merit::marginal_likelihood;
  bool shared = false;        ///< one set for all shapes; amplitudes stay their own
  double noise_ratio = 1e-8;  ///< variance of the noise over σ²: 1e-8 or more, so that no
                              ///< factorisation fails and chooses the length
  bool learn_noise = false;   ///< the ratio is one more parameter, from noise_ratio to 1
  Eigen::MatrixXd noise{};    ///< N×m: known standard deviations instead of a ratio; may be empty
  Trend trend{};
  std::pair<double, double> length_range{0.0, 0.0};  ///< [m]; zeros: from the points
  std::vector<LogNormal> priors{};                   ///< p, or empty
  Eigen::VectorXd start{};                           ///< p: a warm start, or empty
  int starts = 4;                                    ///< local searches where p > 1
  unsigned seed = 1;
  double tolerance = 5e-4;  ///< of ln θ
};

/// What was learned of one shape, or of all.
struct Learned {
  Eigen::VectorXd parameters;         ///< p, of the kernel
  double sigma = 0.0;                 ///< amplitude, in the unit of the values
  double noise = 0.0;                 ///< standard deviation, the same; its mean where it is known
  double score = 0.0;                 ///< of the merit; summed where shared
  double log_likelihood = 0.0;        ///< marginal, whatever the merit
  std::vector<std::string> at_bound;  ///< names of parameters at the end of their range
  double jitter = 0.0;  ///< variance added for the sake of the factorisation, over σ²
  int evaluations = 0;  ///< factorisations that the search needed, for all shapes together
};

/// From three tenths of the median distance of nearest neighbours to five diagonals.
/// @throws InvalidInput  all points are one
[[nodiscard]] std::pair<double, double> length_range(const Points& points);

/// Per column of `values`, or one where shared. With one hyper-parameter a grid over its range
/// serves all shapes, each factorisation giving the score of every one, and parabolas polish it;
/// with more, limited-memory BFGS from several starts, the first being `start` or the middle.
/// Cost of one hyper-parameter: about 35 factorisations of N³ / 3 in all, where the noise is a
/// ratio.
/// @throws InvalidInput      sizes that do not fit, a shape that is zero, a noise ratio below 1e-8
/// @throws NumericalFailure  as GaussianProcess
[[nodiscard]] std::vector<Learned> learned(const Kernel& kernel, const Points& points,
                                           const Eigen::MatrixXd& values, const Learning& how = {});

/// Per result of `learned`: the largest change of ln σ and ln θ when the noise ratio is a hundred
/// times as large. Near 0 where the values fix the hyper-parameters. Shapes that are smoother than
/// any draw of the kernel, seen densely without noise, lie on a ridge: σ and the length are what
/// the ratio says, and 0.05 or more comes out. Cost: learns once more.
[[nodiscard]] Eigen::VectorXd noise_dependence(const std::vector<Learned>& found,
                                               const Kernel& kernel, const Points& points,
                                               const Eigen::MatrixXd& values, const Learning& how);

/// The prior that was learned.
[[nodiscard]] GaussianPrior prior_of(const Kernel& kernel, const Learned& what, const Trend& trend);

/// An experiment that is simulated to choose a length for it: f shapes seen at s places with noise,
/// wanted on the surface.
struct Task {
  Points places;               ///< s×3 [m]
  Eigen::MatrixXd at_places;   ///< s×f
  Points surface;              ///< N×3 [m]
  Eigen::MatrixXd on_surface;  ///< N×f
  Eigen::VectorXd area;        ///< N
  double noise = 0.01;         ///< standard deviation over a shape's root mean square
  Trend trend{};
};

/// The length for which the mean squared error of the interpolated shapes, each over its own
/// square, is least; amplitudes by marginal likelihood. Larger than what dense data say: it is
/// matched to the spacing of the places.
struct MatchedLength {
  double length = 0.0;      ///< [m]
  double error = 0.0;       ///< mean over the f shapes
  Eigen::VectorXd lengths;  ///< g: the grid
  Eigen::VectorXd errors;   ///< g
  bool at_bound = false;    ///< a shortest one says that the places do not resolve the shapes
};
/// @throws InvalidInput  sizes that do not fit; a kernel of more than one hyper-parameter
[[nodiscard]] MatchedLength matched_length(const Kernel& kernel, const Task& task,
                                           int lengths = 25);

/// The same for a random shape that is the sum of the f with independent coefficients of variance
/// 1: its expected squared error over its expected square, in closed form. The amplitude is the
/// random shape's own root mean square over the surface; `noise` is in parts of it.
[[nodiscard]] MatchedLength expected_length(const Kernel& kernel, const Task& task,
                                            int lengths = 25);

}  // namespace chladni::priors
