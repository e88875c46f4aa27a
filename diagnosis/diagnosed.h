// Why a simulation disagrees with measured responses: causes with their probabilities.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "diagnosis/calibrated.h"
#include "diagnosis/constants.h"
#include "diagnosis/cross_validation.h"
#include "diagnosis/learned_levels.h"
#include "diagnosis/mode_told.h"
#include "diagnosis/parameter.h"
#include "diagnosis/proposal.h"
#include "diagnosis/structure.h"
#include "diagnosis/tolerances.h"
#include "modal/frf_set.h"

namespace chladni::diagnosis {

enum class Verdict { no_discrepancy, named, ambiguous, partial, unexplained };
[[nodiscard]] std::string_view name(Verdict verdict);

/// A number of a cause, in `unit` (SI).
struct CauseParameter {
  std::string name, unit;
  double value = 0.0, std = 0.0;
  Parameter::Role role = Parameter::Role::strength;
};

struct Cause {
  std::string effect;                 ///< as effects() names it
  std::vector<std::string> channels;  ///< where it acts; empty for the body
  /// The channel that each record of `channels` really is, where channels are permuted; or empty.
  std::vector<std::string> truly;
  std::string option;  ///< Choice::text: "g taken for m/s^2"; or empty
  std::vector<CauseParameter> parameters;
  std::vector<CauseParameter> fixed;     ///< fixed by the option, std 0: "factor", "derivative"
  std::optional<Eigen::Vector2d> place;  ///< on the chart [m]: parameters "u" and "v"
  /// Loss of ln Z if only this cause is left out. Of modes it may be an upper bound
  /// (modes/modes_verdict.h).
  double log_evidence_gain = 0.0;
  double probability = 0.0;  ///< posterior that this cause, and no rival, is present
  double share = 0.0;        ///< part of the initial excess misfit that it removes
};

/// A set of causes that explains the data together.
struct Explanation {
  std::vector<Cause> causes;
  double log_evidence = 0.0;  ///< relative to the simulation with its tolerances
  double probability = 0.0;   ///< among the explanations found
  double excess = 0.0;        ///< z = (χ² − N + parameters) / sqrt(2N) of the remaining misfit
  double strained = 0.0;      ///< remaining penalised misfit χ² + ηᵀη
  double error_excess = 0.0;  ///< part of `excess` that errors of the causes may explain (error_of)
  std::size_t fit = 0;        ///< index in Found::fits
  double another_body = 0.0;  ///< probability that modes are of another body instead
  double promise = 0.0;       ///< possible gain of log_evidence; 0 if the fit has converged
};

/// The location of a cause that is not in the catalogue.
struct Superclass {
  std::string name;     ///< "sensor", "actuator", "place", "all sensors alike", "frequencies", ...
  std::string channel;  ///< for a row or a column
  std::optional<Eigen::Vector2d> place;
  /// Part of the excess misfit that a free function of frequency removes. NaN: not known, of modes.
  double explained = 0.0;
  Eigen::VectorXd frequency_hz;
  Eigen::VectorXcd curve;  ///< that function
};

/// The probability of a point attachment at each place of the scan (Structure::surface).
struct CauseMap {
  Eigen::VectorXd explained;  ///< n: part of the excess misfit
  Eigen::VectorXd posterior;  ///< n: sums to 1; zero where no place was named
};

/// Residual of a fit: χ² per measured number, 1 if only noise is left.
struct Residue {
  Eigen::VectorXd per_output, per_input;
  Eigen::VectorXd band_edges_hz, per_band;  ///< b + 1, b
  double lag_one = 0.0;                     ///< correlation of neighbouring lines
};

struct DiagnosisOptions {
  Tolerances tolerances;
  Levels levels = Levels::learned;
  /// Lines of the search, at most; the last fit takes twice as many.
  int lines = kConstants.lines_of_search;
  /// Causes that are added, at most. Of responses, wrong readings of channels (sign, unit,
  /// quantity, delay) are put right before and do not count.
  int most_causes = kConstants.most_causes;
  /// Asks responses only whether one cause explains much. A few quick fits on the lines of the
  /// search, no last fits, no test on held-out data. No verdict of it is final.
  bool is_look = false;
  /// ln of the Bayes factor that a cause needs.
  double least_evidence = kConstants.least_evidence;
  /// ln Z: the verdict is ambiguous if a rival is nearer than this.
  double rival_within = kConstants.rival_within;
  std::vector<std::string> only;  ///< names of effects; empty: all
  MeasurementCosts costs;         ///< of further measurements
  /// Calibrated in every hypothesis about measured modes.
  std::vector<CalibratedConstant> constants;
  Progress progress = {};
};

struct Diagnosis {
  Verdict verdict = Verdict::unexplained;
  Explanation best;                 ///< no causes where none is needed or found
  std::vector<Explanation> rivals;  ///< descending, without the best
  std::optional<Superclass> superclass;
  CauseMap map;
  std::string measure_next;         ///< what would decide between the best and its rivals; or empty
  std::vector<Proposal> proposals;  ///< of modes: measurements that would, best first
  double excess_before = 0.0;       ///< z of the simulation within its tolerances
  Residue before, after;
  /// Test of the best causes on parts of the data held out in turn; only where responses have
  /// causes.
  std::optional<CrossValidation> cross_validation;
  std::vector<std::string> breaches;  ///< tolerances stretched beyond three deviations
  /// Levels of the model's errors without a cause and beside the best causes; empty: known.
  std::vector<ErrorLevel> levels_before, levels_after;
  std::vector<ModeTold> modes;                     ///< of a diagnosis of measured modes
  std::vector<CalibratedNumber> constants;         ///< under the best explanation
  std::vector<CalibratedPair> constants_in_pairs;  ///< strongly correlated ones
  std::vector<std::string> notes;
  std::vector<std::string> data_notes;  ///< those of `notes` that hold whatever the causes are
};

struct Effect;  // diagnosis/effect.h
/// The effects that are looked for. @throws InvalidInput  `only` has a name that no effect has
[[nodiscard]] std::vector<const Effect*> catalogue_of(const DiagnosisOptions& options);

/// @param measured  receptances (modal::converted) with variances. Channels are matched by name;
///                  those that the structure lacks are left out with a note. NaN: not measured
/// @throws InvalidInput  no channel in common, no line within the structure's modes, variances
///                       missing or negative
[[nodiscard]] Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                                  const DiagnosisOptions& options = {});

}  // namespace chladni::diagnosis
