// From fits to the answer: names, places, sizes, probabilities.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// What ln evidence is divided by before it counts: χ²/N of the best fit, if that is above 1. An
/// unexplained residual makes all probabilities less certain.
[[nodiscard]] double temper(const Problem& problem, const Found& found);

/// The fits as explanations, each once, with their probabilities (evidence by `temper`). Of two
/// explanations within `equal` of evidence the simpler one comes first. So does a simpler one that
/// leaves no more of the other's gain than Simpler::share and its own errors; it then gets the
/// other's evidence.
[[nodiscard]] std::vector<Explanation> explanations(const Problem& problem, const Found& found,
                                                    double equal);

/// The probability that causes of one kind, at random places, are as near to each other as these; 1
/// if no two are of one kind.
[[nodiscard]] double by_chance_so_near(const Structure& structure,
                                       const std::vector<Cause>& causes);

/// Weight of cause `which` as a separate cause, 0 to 1. It is 1 if no other cause of its kind is
/// named. It is small if another is so near that two random places rarely are, like two parts of
/// one extended cause.
[[nodiscard]] double of_its_own(const Structure& structure, const std::vector<Cause>& causes,
                                std::size_t which);

/// The verdict on the explanations; `explanations.front()` is the best.
[[nodiscard]] Verdict judged(const Problem& problem, const Found& found,
                             const std::vector<Explanation>& explanations,
                             const DiagnosisOptions& options);

/// χ² per measured number of the residual of a fit.
[[nodiscard]] Residue residue(const Problem& problem, const Fit& fit);

}  // namespace chladni::diagnosis
