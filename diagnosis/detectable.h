// The smallest effects that an experiment would find, before or after it is made.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/search/probe.h"

namespace chladni::diagnosis {

/// The size from which on an effect is found, at the worst, the median or the best of the places,
/// channels and frequencies where it was tried.
struct Detectable {
  std::string effect;                    ///< as effects() names it
  std::string_view of;                   ///< "worst", "median", "best"
  std::string parameter, unit;           ///< that is its size; empty for effects without numbers
  std::vector<std::string> channels;     ///< it acts on; empty for the body
  std::string option;                    ///< Choice::text, as Cause::option
  std::optional<Eigen::Vector2d> place;  ///< on the chart [m]
  std::optional<double> frequency_hz;    ///< of an effect that has one
  /// [unit]; of a factor the factor. Infinite: never found. NaN for effects without numbers.
  double size = 0.0;
  bool from_above = false;  ///< what is smaller than `size` is found: a corner of a low-pass
  /// ln of the Bayes factor to be expected over nothing at that size; of effects without numbers,
  /// which are there or not, over nothing.
  double log_evidence = 0.0;
};

struct DetectableOptions {
  double power = 0.99;          ///< part of the experiments in which it is found
  double least_evidence = 8.0;  ///< ln of the Bayes factor that a cause needs, Occam's factor in it
  Eigen::Index places = 12;     ///< of the surface, spread evenly
};

/// How much of a probe's effect is found: its coordinate x of the size, and the evidence then.
struct LeastSize {
  double x = 0.0;  ///< infinite where none within six widths of its prior would be found
  double log_evidence = 0.0;
};

/// The size x at which the likelihood ratio against nothing, noncentral χ² of as many degrees of
/// freedom as the effect has coordinates and of noncentrality F x², is with probability `power`
/// enough for `least_evidence` beyond Occam's factor ½ ln det(1 + W F W) + ln(choices) +
/// ½ Σ (x − centre)²/width². W are the priors' widths; a place counts as one of width √(area/2π).
/// Effects are taken as linear in their size, up to there.
/// @param information  d×d of the probe's columns
[[nodiscard]] LeastSize least_size(const Structure& structure, const Effect& effect,
                                   const Probe& probe, const Eigen::MatrixXd& information,
                                   const DetectableOptions& options);

/// λ from which on P(χ²(dof, λ) > threshold) ≥ power, by Sankaran's approximation (Biometrika 46,
/// 1959).
[[nodiscard]] double noncentrality(double threshold, double dof, double power);

/// What a diagnosis knows before it looks at a value. It looks more than once; a cause is found
/// that is found each time.
struct Experiment {
  struct Look {
    Observed observed;  ///< the same lines each time; no value is used
    std::vector<Deviation> deviations;
  };
  std::shared_ptr<const Structure> structure;  ///< its channels those that are measured
  std::vector<Look> looks;
};

/// As `diagnosed` sees it, on the lines of its search: the tolerances with errors of the mode
/// shapes as noise, which is the search, and as parameters, which is its last word.
/// @throws as diagnosed
[[nodiscard]] Experiment experiment_of(const Structure& structure, const modal::FrfSet& measured,
                                       const DiagnosisOptions& options);

/// What an experiment, which must outlive it, would find.
class Detector {
 public:
  /// Cost: per look a slope per deviation and N (deviations)².
  explicit Detector(const Experiment& experiment, const DetectableOptions& options = {});

  [[nodiscard]] const Probing& probing() const { return probing_; }
  /// The larger one of the looks, per probe. Cost: a slope per coordinate, times N deviations.
  [[nodiscard]] std::vector<LeastSize> sizes(const Effect& effect,
                                             const std::vector<Probe>& probes) const;
  /// ln of the Bayes factor over nothing that an effect without numbers has, the smaller one of the
  /// looks, per choice.
  [[nodiscard]] Eigen::VectorXd log_evidence(const Effect& effect) const;
  /// Worst, median and best of all probes, of effects without numbers by their evidence; nothing of
  /// an effect that cannot be here.
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

/// Of every effect that is looked for (options.only), found by the rule of a diagnosis
/// (options.least_evidence). Cost: half a second of both cores per hundred lines of four
/// sensors and 13 actuators.
/// @throws as diagnosed
[[nodiscard]] std::vector<Detectable> detectable(const Structure& structure,
                                                 const modal::FrfSet& measured,
                                                 const DiagnosisOptions& options,
                                                 Eigen::Index places = 12);

}  // namespace chladni::diagnosis
