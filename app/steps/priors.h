// Hyper-parameters that a study's own modes teach.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/stage/solution.h"
#include "placement/sites.h"
#include "priors/interpolator.h"
#include "priors/learning.h"

namespace chladni::app {

/// What so many samples of each mode say.
struct LearnedAt {
  Eigen::Index samples = 0;
  std::vector<priors::Learned> per_mode;
  priors::Learned shared;
  /// By modes, then shared: the change of ln σ and ln θ when the noise ratio is a hundred times as
  /// large (priors::noise_dependence); 0 where the noise is learned.
  Eigen::VectorXd noise_dependence;
  /// Per mode: squared error over the shape's square, over the surface, of the mode interpolated
  /// with these hyper-parameters from its noise-free values at the study's channels; empty where
  /// fewer than three of them look along the surface's direction.
  Eigen::VectorXd channel_error;
};

struct LearnedPriors {
  LearnedPriors(PriorsPlan wanted, priors::Kernel of) : plan(std::move(wanted)), kernel(of) {}

  PriorsPlan plan;
  priors::Kernel kernel;
  placement::Surface surface;
  std::vector<Eigen::Index> columns;  ///< of the study's modes
  Eigen::VectorXd rms;                ///< of those, over the surface [kg^-1/2]
  std::vector<LearnedAt> by_samples;  ///< ascending; the last one counts
  int most_complex = 0;  ///< of `columns`: the shortest length of those that the channels see
  /// Length of least expected error at the study's channels, per mode, and that error over the
  /// shape's square (priors::expected_length); empty without channels or for other kernels than
  /// those of one length.
  Eigen::VectorXd matched_length, expected_error;
  /// The same error of thin-plate splines, by name; they learn nothing from samples.
  std::vector<std::pair<std::string, Eigen::VectorXd>> spline_error;
  std::vector<std::string> notes, warnings;

  [[nodiscard]] const LearnedAt& last() const { return by_samples.back(); }
};

/// @throws InvalidInput  a patch that is not there, more modes than were computed, no mode that
///                       moves the surface
[[nodiscard]] LearnedPriors learned_priors(const Study& study, const Solution& solution, Run& run);

/// The study's channels that look along the surface's direction or against it (within 2.6 degrees),
/// all turned to look along it. Of the others there is a note: what was learned says nothing of
/// them.
[[nodiscard]] priors::Places channels_on_surface(const Study& study, const Solution& solution,
                                                 LearnedPriors& result);

/// The step of `learned_priors` that tries what was learned at these places; nothing where there
/// are fewer than three. Splines that cannot be used there (a surface of several directions, places
/// on one another) are left out with a note.
void add_channel_errors(const Solution& solution, const priors::Places& places,
                        LearnedPriors& result);

[[nodiscard]] std::string priors_table(const Solution& solution, const LearnedPriors& result);
[[nodiscard]] io::JsonObject priors_json(const Solution& solution, const LearnedPriors& result);

}  // namespace chladni::app
