// A quick look at many causes beside one fit of modal data.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/modes/calibration/calibration.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// The levels at which causes are looked at: those of the fit, and those where one group of classes
/// (frequencies; gains and places; shapes; residues; fields) scatters less, by Constants::scattered
/// and by its square, but not less than usual. One bad channel, or one mode that a spring has
/// moved, is a scatter of all to a fit that does not know it, and nothing is left for a cause to
/// explain. The other classes keep their levels: what scatters for other reasons would speak
/// against any cause.
[[nodiscard]] std::vector<PerClass> levels_to_look_at(const ModesProblem& problem,
                                                      const ModesFit& base);

/// One more cause beside a fit, at given levels. Modes that have a partner, or none, as in the fit
/// keep the covariances of the fit. Modes and errors of a cause are computed once for all levels.
class ModesLook {
 public:
  /// Problem and fit must outlive it.
  ModesLook(const ModesProblem& problem, const ModesFit& base, std::vector<PerClass> levels);

  /// For each of the levels the objective with one more cause, less ln of the prior density of
  /// these levels over that of the fit's; infinite if it is impossible, or changes less than the
  /// errors at these levels hide.
  [[nodiscard]] std::vector<double> operator()(const Supposed& cause) const;
  [[nodiscard]] const std::vector<PerClass>& levels() const { return levels_; }
  /// The cause after a few steps of Gauss and Newton at one of the levels, and about its ln
  /// evidence there (Laplace; the volume is that of the last step): of two causes with one
  /// objective the one with fewer sizes is the more probable. A grid that is wider than the level
  /// sees a cause too far from its size to know it.
  struct Moved {
    Supposed cause;
    double log_evidence = 0.0;
  };
  [[nodiscard]] Moved moved(const Supposed& cause, std::size_t level) const;

 private:
  // A cause with its modes, paired in the likeliest way.
  struct Placed;
  [[nodiscard]] std::optional<Placed> placed(const Supposed& cause, std::size_t level) const;
  [[nodiscard]] Eigen::MatrixXd slopes(const Placed& at, const Eigen::VectorXd& steps) const;
  [[nodiscard]] std::vector<double> objectives(const RecordedModes& model,
                                               const Matching& matching) const;
  [[nodiscard]] std::vector<double> objectives_alike(const RecordedModes& model,
                                                     const Matching& matching) const;
  [[nodiscard]] std::vector<bool> alike_blocks(const Matching& matching) const;
  [[nodiscard]] Eigen::VectorXd shifted(const RecordedModes& model, const Matching& matching) const;
  [[nodiscard]] std::vector<Matching> matchings(const RecordedModes& model) const;
  [[nodiscard]] const Eigen::VectorXd* without_cause(const Matching& matching,
                                                     Eigen::Index count) const;
  [[nodiscard]] bool has_quick_pairs(const RecordedModes& model) const;
  [[nodiscard]] std::optional<RecordedModes> with(const Supposed& cause) const;

  const ModesProblem& problem_;
  const ModesFit& base_;
  std::vector<PerClass> levels_;
  ConstantColumns columns_;
  std::vector<LevelLikelihood> likelihoods_;  // of the base, for each of the levels
  std::vector<double> less_probable_;         // −ln prior of the levels, less the fit's
  Eigen::VectorXd own_;                       // errors of the base
  State state_;
  std::optional<BodyModes> body_;  // its modes without channels
  Eigen::VectorXd here_;
  RecordedModes quick_;  // of the base, in few coordinates
  Matching quick_matching_;
  // The pairings of the base, each with its errors.
  std::vector<std::pair<std::vector<Eigen::Index>, Eigen::VectorXd>> without_cause_;
  bool pairs_may_be_wrong_ = false;
};

}  // namespace chladni::diagnosis
