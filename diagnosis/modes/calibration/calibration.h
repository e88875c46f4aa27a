// Calibration of constants of the study beside causes, and what is told of it.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// The hypothesis of `start` without causes, with its constants at the best of several maxima.
/// Each start of a fit multiplies all frequencies by a factor, with the most probable constants
/// that do so (closed form), and moves the stiffness of one direction within its prior.
/// ModesFit::other_constants has other maxima with nearly the same evidence.
/// Cost: some 20 fits of two rounds and four of all.
[[nodiscard]] ModesFit calibrated(const ModesProblem& problem, const ModesFit& start);

/// What the constants may change near a fit, as errors that all modes share. A hypothesis that is
/// looked at without a fit thus has its own constants, to first order.
class ConstantColumns {
 public:
  /// Both must outlive it. Cost: an eigenproblem for each constant.
  ConstantColumns(const ModesProblem& problem, const ModesFit& base);
  /// The errors with the constants at the centre of their prior, and free within it. Modes that
  /// have a partner in one of both hypotheses only are left as they are.
  [[nodiscard]] ModeErrors added(ModeErrors errors) const;

 private:
  Eigen::VectorXd width_, at_;
  std::vector<Eigen::MatrixXd> slope_;  // n×c of each mode
};

/// Sets the constants of a diagnosis, the strong correlations, and notes: what these data cannot
/// tell apart, and other constants that fit about as well.
void tell_constants(const ModesProblem& problem, const ModesFit& best, Diagnosis& diagnosis);

}  // namespace chladni::diagnosis
