// The smallest effects that an experiment can detect, before or after it is made.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/search/probe.h"

namespace chladni::diagnosis {

/// The smallest size of an effect that is found, at the worst, the median or the best of the
/// places, channels and frequencies that were tried.
struct Detectable {
  std::string effect;                    ///< as effects() names it
  std::string_view of;                   ///< "worst", "median", "best"
  std::string parameter, unit;           ///< the size parameter; empty for effects without numbers
  std::vector<std::string> channels;     ///< where it acts; empty for the body
  std::string option;                    ///< Choice::text, as Cause::option
  std::optional<Eigen::Vector2d> place;  ///< on the chart [m]
  std::optional<double> frequency_hz;    ///< for an effect that has one
  /// [unit]; for a factor, the factor. Infinite: never found. NaN: the effect has no numbers.
  double size = 0.0;
  bool from_above = false;  ///< true: effects below `size` are found, as for a low-pass corner
  /// Expected ln of the Bayes factor over no cause, at that size. For effects without numbers: that
  /// of the effect being present.
  double log_evidence = 0.0;
};

struct DetectableOptions {
  double power = kConstants.power;  ///< fraction of the experiments in which it is found
  /// ln of the Bayes factor that a cause needs, with Occam's factor.
  double least_evidence = kConstants.least_evidence;
  Eigen::Index places = kConstants.detectable_places;  ///< on the surface, spread evenly
};

/// Smallest detectable size of a probe's effect: its coordinate x, and the evidence at that size.
struct LeastSize {
  double x = 0.0;  ///< infinite if nothing within six widths of its prior would be found
  double log_evidence = 0.0;
};

/// The size x at which the effect is found with probability `power`. "Found" means that the ln of
/// the likelihood ratio against no cause exceeds `least_evidence` plus Occam's factor
/// ½ ln det(1 + W F W) + ln(choices) + ½ Σ (x − centre)²/width². Twice this ln is noncentral χ²
/// with one degree of freedom per coordinate of the effect and noncentrality F x². W are the widths
/// of the priors; that of a place is prior_width. The effect is taken as linear in its size up to
/// x.
/// @param information  d×d, for the columns of the probe
[[nodiscard]] LeastSize least_size(const Structure& structure, const Effect& effect,
                                   const Probe& probe, const Eigen::MatrixXd& information,
                                   const DetectableOptions& options);

/// The smallest λ with P(χ²(dof, λ) > threshold) ≥ power, by Sankaran's approximation (Biometrika
/// 46, 1959).
[[nodiscard]] double noncentrality(double threshold, double dof, double power);

/// The data of a diagnosis before it sees any measured value. A diagnosis looks at the data more
/// than once; a cause counts as found if every look finds it.
struct Experiment {
  struct Look {
    Observed observed;  ///< the same lines each time; no measured value is used
    std::vector<Deviation> deviations;
  };
  std::shared_ptr<const Structure> structure;  ///< with the measured channels only
  std::vector<Look> looks;
};

/// The looks of `diagnosed`, on the lines of its search. The first look is the search: it takes
/// errors of the mode shapes as noise. The second is the last fit: it takes them as parameters.
/// Both let the constants (options.constants) deviate as far as they are not known, about the
/// study's values.
/// @throws as diagnosed
[[nodiscard]] Experiment experiment_of(const Structure& structure, const modal::FrfSet& measured,
                                       const DiagnosisOptions& options);

/// Computes what an experiment would find. The experiment must outlive it.
class Detector {
 public:
  /// Cost: per look a slope per deviation and N (deviations)².
  explicit Detector(const Experiment& experiment, const DetectableOptions& options = {});

  [[nodiscard]] const Probing& probing() const { return probing_; }
  /// For each probe the larger size of the looks. Cost: a slope per coordinate, times N deviations.
  [[nodiscard]] std::vector<LeastSize> sizes(const Effect& effect,
                                             const std::vector<Probe>& probes) const;
  /// For an effect without numbers: ln of the Bayes factor over no cause for each choice, the
  /// smaller one of the looks.
  [[nodiscard]] Eigen::VectorXd log_evidence(const Effect& effect) const;
  /// Worst, median and best of all probes; for effects without numbers, ordered by evidence. Empty
  /// for an effect that is not possible here.
  [[nodiscard]] std::vector<Detectable> detectable(const Effect& effect) const;

 private:
  [[nodiscard]] LeastSize larger(const Effect& effect, const Probe& probe,
                                 const std::vector<Eigen::MatrixXd>& known, Eigen::Index from,
                                 Eigen::Index count) const;

  const Structure& structure_;
  DetectableOptions options_;
  Probing probing_;
  std::vector<Information> looks_;
};

/// For every effect that is looked for (options.only, and not what an unknown constant already
/// does), by the rule of a diagnosis (options.least_evidence). Cost: half a second of both cores
/// per hundred lines of four sensors and 13 actuators.
/// @throws as diagnosed
[[nodiscard]] std::vector<Detectable> detectable(
    const Structure& structure, const modal::FrfSet& measured, const DiagnosisOptions& options,
    Eigen::Index places = kConstants.detectable_places);

}  // namespace chladni::diagnosis
