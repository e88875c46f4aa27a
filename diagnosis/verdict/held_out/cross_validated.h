// Cross-validation of an explanation, and what it does to the verdict.
#pragma once

#include <string>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// Holds out each part (held_out_parts) in turn, fits the numbers of the causes to the others, and
/// predicts the part: with the deviations at 0, for the errors, and with the deviations that suit
/// the part best (least_misfit), for the gain. A part whose rest tells nothing of a cause, not even
/// beside other deviations, is neither for the cause nor against it.
/// Cost: for n causes n + 1 fits for each part, each from the fit to all data: two or three
/// iterations; and for each part a few steps of its deviations, with each cause and without it.
/// @param problem  the lines and deviations of the fits
/// @param all      the lines on which errors are computed
/// @param best     its causes are tested
[[nodiscard]] CrossValidation cross_validated(const Problem& problem, const Observed& all,
                                              const Fit& best, const Fit& nothing);

/// Limits the probability of causes that do not pay on held-out parts to Constants::believed.
/// `named` and `ambiguous` become `partial`, or `unexplained` where all causes together do not pay.
/// @return a note that says so, or empty if all pay
[[nodiscard]] std::string doubt_what_does_not_pay(Diagnosis& diagnosis);

}  // namespace chladni::diagnosis
