// Most probable causes of what modal data say against a simulation, with the levels of the
// model-form error that they leave.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/effect.h"
#include "diagnosis/modes/calibration/constants_held.h"
#include "diagnosis/modes/errors/mode_errors.h"

namespace chladni::diagnosis {

/// A hypothesis about modal data, at its most probable numbers.
struct ModesFit {
  std::vector<Supposed> causes;
  Disturbed disturbed;
  PerClass levels = PerClass::Zero();
  PerClass determined = PerClass::Zero();  ///< number of errors of each class that the data show
  Matching matching;
  RecordedModes model;
  double objective = std::numeric_limits<double>::infinity();  ///< −ln of likelihood and priors
  double log_evidence = -std::numeric_limits<double>::infinity();
  Eigen::VectorXd constants;  ///< coordinates of the study's constants (HeldConstant)
  /// Other maxima of the constants with nearly the same evidence, of the fit without a cause.
  std::vector<Eigen::VectorXd> other_constants;
  Eigen::MatrixXd covariance;   ///< of all x, cause by cause, then of the constants
  bool has_clear_sizes = true;  ///< have_clear_sizes, where the fit was found by a search
};

/// True for the same effect and choice, at places that modes hardly tell apart.
[[nodiscard]] inline bool alike(const Structure& structure, const Supposed& a, const Supposed& b) {
  return same_choice(structure, a, b, 2.0 * kConstants.same_place);
}

/// What models of real structures are off by, where a study states less.
/// @param learned  false: what the study states
[[nodiscard]] Tolerances believable(Tolerances tolerances, bool learned);

/// What all hypotheses about one set of measured modes share.
class ModesProblem {
 public:
  /// Structure and modes must outlive it. @param learned  false: the levels are the tolerances
  /// @param constants  of the study, which every hypothesis may change
  ModesProblem(const Structure& structure, const MeasuredModes& measured,
               const Tolerances& tolerances, bool learned,
               std::vector<HeldConstant> constants = {});
  /// The same with errors of the body and a prior of the levels as they are given.
  ModesProblem(const Structure& structure, const MeasuredModes& measured,
               const Tolerances& tolerances, const LevelPrior& prior,
               std::vector<HeldConstant> constants = {});

  [[nodiscard]] const Structure& structure() const { return structure_; }
  [[nodiscard]] const MeasuredModes& measured() const { return measured_; }
  [[nodiscard]] const std::vector<HeldConstant>& constants() const { return constants_; }
  [[nodiscard]] const Tolerances& tolerances() const { return tolerances_; }
  [[nodiscard]] const LevelPrior& prior() const { return prior_; }
  [[nodiscard]] const ShapeUnits& units() const { return units_; }
  /// The ways to pair the modes: by shape, and by frequency where that is another one.
  [[nodiscard]] std::vector<Matching> matchings(const RecordedModes& model) const;

  /// Modes of a state of the structure; none if it is impossible.
  /// @param quick  with fewer coordinates, for a search
  [[nodiscard]] std::optional<RecordedModes> modes(const State& state, bool quick) const;
  /// The same where the modes of its body are known.
  [[nodiscard]] static std::optional<RecordedModes> modes(const State& state,
                                                          const BodyModes& body);
  /// Those of its body; none if it is impossible.
  [[nodiscard]] std::optional<BodyModes> body_modes(const State& state, bool quick) const;
  /// The structure with constants and causes of a hypothesis.
  /// @throws NumericalFailure  it is impossible
  [[nodiscard]] State with(const ModesFit& fit) const;
  /// @param with_shared  whether blocks have the errors that they share
  [[nodiscard]] ModeErrors errors(const ModesFit& hypothesis, const RecordedModes& model,
                                  const Matching& matching, bool with_shared = true) const;
  /// @param shares  for each measured mode, as for mode_errors
  [[nodiscard]] ModeErrors errors(const ModesFit& hypothesis, const RecordedModes& model,
                                  const Matching& matching, const std::vector<bool>& shares) const;
  /// The hypothesis at its most probable sizes and levels (Levenberg and Marquardt in the sizes,
  /// MacKay's update of the levels), and its evidence (Laplace). The fit starts at the causes and
  /// levels of `start`, and with its pairs if they are the most probable. In full (kRounds) the
  /// mode that suits its partner least may be left without one, where that is more probable. Cost:
  /// some 20 eigenproblems per coordinate, twice that where a mode is left alone.
  [[nodiscard]] ModesFit fitted(const ModesFit& start, int rounds = kRounds) const;
  static constexpr int kRounds = 8;
  /// The structure as it is, with its constants calibrated and levels learned.
  /// @throws InvalidInput  no simulated mode is in reach of the measured ones
  [[nodiscard]] ModesFit nothing(const Disturbed& disturbed = {}) const;

 private:
  const Structure& structure_;
  const MeasuredModes& measured_;
  std::vector<HeldConstant> constants_;
  Tolerances tolerances_;  // of the body, at least what real bodies have
  LevelPrior prior_;
  ShapeUnits units_;
  Eigen::MatrixXd smooth_;
  std::vector<BodyError> body_;
  ModeSolver solver_, quick_;
  double low_hz_ = 0.0, high_hz_ = 0.0;
};

}  // namespace chladni::diagnosis
