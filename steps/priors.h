// Hyper-parameters learned from a study's own modes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "placement/sites.h"
#include "priors/interpolator.h"
#include "priors/learning.h"
#include "stage/solution.h"

namespace chladni::steps {

/// The result for this number of samples of each mode.
struct LearnedAt {
  Eigen::Index samples = 0;
  std::vector<priors::Learned> per_mode;
  priors::Learned shared;
  /// For each mode, then shared: the change of ln σ and ln θ when the noise ratio is a hundred
  /// times larger (priors::noise_dependence); 0 if the noise is learned.
  Eigen::VectorXd noise_dependence;
  /// For each mode: squared error over the surface, relative to the shape's square, when the mode
  /// is interpolated with these hyper-parameters from its noise-free values at the study's
  /// channels. Empty if fewer than three channels look along the surface's direction.
  Eigen::VectorXd channel_error;
};

struct LearnedPriors {
  LearnedPriors(study::PriorsPlan wanted, priors::Kernel of)
      : plan(std::move(wanted)), kernel(of) {}

  study::PriorsPlan plan;
  priors::Kernel kernel;
  placement::Surface surface;
  std::vector<Eigen::Index> columns;  ///< of the study's modes
  Eigen::VectorXd rms;                ///< of these modes, over the surface [kg^-1/2]
  std::vector<LearnedAt> by_samples;  ///< ascending; the last one is the result
  int most_complex = 0;  ///< index in `columns`: shortest length of the modes that channels see
  /// For each mode the length of least expected error at the study's channels, and that error over
  /// the shape's square (priors::expected_length). Empty without channels, or for kernels with more
  /// than one length.
  Eigen::VectorXd matched_length, expected_error;
  std::vector<bool> matched_at_bound;  ///< that length is at the end of its range: none was found
  /// The same error for thin-plate splines, by name; they do not learn from samples.
  std::vector<std::pair<std::string, Eigen::VectorXd>> spline_error;
  std::vector<std::string> notes, warnings;

  [[nodiscard]] const LearnedAt& last() const { return by_samples.back(); }
};

/// @throws InvalidInput  a patch that does not exist, more modes than were computed, no mode that
///                       moves the surface
[[nodiscard]] LearnedPriors learned_priors(const study::Study& study,
                                           const stage::Solution& solution, stage::Work& work);

/// The study's channels that look along the surface's direction or against it (within 2.6 degrees),
/// all turned to look along it. A note names the others, for which the result does not apply.
[[nodiscard]] priors::Places channels_on_surface(const study::Study& study,
                                                 const stage::Solution& solution,
                                                 LearnedPriors& result);

/// The step of `learned_priors` that tests the result at these places; nothing if there are fewer
/// than three. Splines that cannot be used there (a surface of several directions, coincident
/// places) are left out with a note.
void add_channel_errors(const stage::Solution& solution, const priors::Places& places,
                        LearnedPriors& result);

}  // namespace chladni::steps
