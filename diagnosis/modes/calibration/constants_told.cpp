// What a diagnosis says of the constants that it calibrated.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/calibration.h"
#include "diagnosis/modes/calibration/constants_told.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Directions of the constants that keep their prior: columns, in units of the prior's widths.
MatrixXd open_directions(const std::vector<HeldConstant>& constants, const MatrixXd& covariance) {
  VectorXd width(covariance.rows());
  for (Index i = 0; i < width.size(); ++i) width(i) = constants[at(i)].width;
  const VectorXd per_width = width.cwiseInverse();
  const MatrixXd relative = per_width.asDiagonal() * covariance * per_width.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(relative);
  Index first = 0;
  while (first < width.size() && parts.eigenvalues()(first) < kConstants.not_determined) ++first;
  return parts.eigenvectors().rightCols(width.size() - first);
}

void note_open(const std::vector<HeldConstant>& constants, const MatrixXd& open,
               const VectorXd& kept, Diagnosis& diagnosis) {
  std::vector<std::string> alone, together;
  for (Index i = 0; i < open.rows(); ++i) {
    const auto& name = constants[at(i)].stated.name;
    if (kept(i) > kConstants.not_determined) {
      auto& told = diagnosis.constants[at(i)];
      told.determined = false;
      told.value = told.of_study;
      told.std = told.of_study * told.prior;
      alone.push_back(name);
    } else if (open.cols() > 0 && open.row(i).norm() > kConstants.share_told) {
      together.push_back(name);
    }
  }
  if (!alone.empty()) {
    diagnosis.notes.push_back(
        fmt::format("these data do not determine {}: held at the study's value, with its deviation",
                    fmt::join(alone, ", ")));
  }
  if (together.size() > 1) {
    diagnosis.notes.push_back(fmt::format(
        "these data do not tell {} apart: only a combination is determined, what is left of each "
        "is held at its prior",
        fmt::join(together, " and ")));
  }
}

void note_other(const std::vector<HeldConstant>& constants, const ModesFit& best,
                Diagnosis& diagnosis) {
  for (const auto& other : best.other_constants) {
    std::string text;
    for (Index i = 0; i < other.size(); ++i) {
      text += fmt::format("{}{} {:+.1f} %", text.empty() ? "" : ", ", constants[at(i)].stated.name,
                          100.0 * std::expm1(other(i)));
    }
    diagnosis.notes.push_back("without a cause other constants fit nearly as well: " + text);
  }
}

// Correlations of the coordinates.
MatrixXd correlation_of(const MatrixXd& covariance) {
  const VectorXd per_deviation = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return per_deviation.asDiagonal() * covariance * per_deviation.asDiagonal();
}

}  // namespace

void tell_constants(const std::vector<HeldConstant>& constants, const VectorXd& x,
                    const MatrixXd& covariance, Diagnosis& diagnosis) {
  const Index c = x.size();
  VectorXd kept(c);
  for (Index i = 0; i < c; ++i) {
    const auto& stated = constants[at(i)].stated;
    const double value = stated.value * std::exp(x(i));
    const double std = std::sqrt(covariance(i, i));
    kept(i) = covariance(i, i) / std::pow(constants[at(i)].width, 2);
    diagnosis.constants.push_back({stated.name, stated.unit, stated.effect, stated.value, value,
                                   value * std, constants[at(i)].width, true});
  }
  note_open(constants, open_directions(constants, covariance), kept, diagnosis);
  const MatrixXd correlation = correlation_of(covariance);
  for (Index i = 0; i < c; ++i) {
    for (Index j = 0; j < i; ++j) {
      if (std::abs(correlation(i, j)) < kConstants.strong_correlation) continue;
      diagnosis.constants_in_pairs.push_back(
          {constants[at(j)].stated.name, constants[at(i)].stated.name, correlation(i, j)});
    }
  }
}

void tell_constants(const ModesProblem& problem, const ModesFit& best, Diagnosis& diagnosis) {
  const auto& constants = problem.constants();
  const auto c = static_cast<Index>(constants.size());
  if (c == 0 || best.covariance.rows() < c) return;
  tell_constants(constants, best.constants, best.covariance.bottomRightCorner(c, c), diagnosis);
  note_other(constants, best, diagnosis);
}

}  // namespace chladni::diagnosis
