// What explanations of measured modes foretell of further measurements.
#pragma once

#include <vector>

#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// An explanation with its posterior probability.
struct WeighedFit {
  const ModesFit* fit = nullptr;
  double probability = 0.0;
};

/// What an explanation says of all measurements. m measured modes, P places.
struct Outlook {
  Eigen::MatrixXd shapes;    ///< P×m: of each mode's partner, of root mean square 1 at the sensors
  Eigen::MatrixXd mobility;  ///< P×m [1/kg]: φ²
  double log_mass = 0.0;     ///< of the whole, over that of the study
};

/// What all explanations are asked: at these places, about these modes.
struct Question {
  const ModesProblem& problem;
  std::vector<Eigen::Index> places;
  Eigen::VectorXd lift;
  const ModesFit& best;
};
/// @param best  must outlive it, as the problem
[[nodiscard]] Question question_of(const ModesProblem& problem, const ModesFit& best);

/// An explanation, and by how much one deviation along each axis of its covariance changes it.
struct Explained {
  WeighedFit weighed;
  Outlook outlook;
  std::vector<Outlook> changes;
};

/// Explanations that the structure can be solved with, in their order; none if the first one
/// cannot. Cost: one eigenproblem for each explanation and each of its coordinates.
[[nodiscard]] std::vector<Explained> explained(const Question& question,
                                               const std::vector<WeighedFit>& all);

/// Forecasts of an explanation for one measurement of n numbers.
struct Forecast {
  Eigen::VectorXd mean;    ///< n; NaN: the explanation has no such number
  Eigen::MatrixXd spread;  ///< n×c: what its c uncertain sizes add, for one deviation each
};

/// Expected ln of the Bayes factor between two explanations: four times Bhattacharyya's distance of
/// their forecasts. For equal covariances this is half the squared distance of the means over the
/// deviations. @param variance  n, of the measurement and of the model's own errors
[[nodiscard]] double separation(const Forecast& a, const Forecast& b,
                                const Eigen::VectorXd& variance);

/// The forecast of numbers that `of` takes from an outlook.
template <class Of>
Forecast forecast(const Explained& one, const Of& of) {
  Forecast result{of(one.outlook), {}};
  result.spread.resize(result.mean.size(), static_cast<Eigen::Index>(one.changes.size()));
  for (std::size_t c = 0; c < one.changes.size(); ++c) {
    result.spread.col(static_cast<Eigen::Index>(c)) = of(one.changes[c]);
  }
  return result;
}

}  // namespace chladni::diagnosis
