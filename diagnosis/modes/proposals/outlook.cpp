#include "diagnosis/modes/proposals/outlook.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/coordinates.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// A rigid translation along the normal in the coordinates of the structure, which are of unit mass;
// empty if the structure has none.
VectorXd lift(const Structure& structure) {
  const MatrixXd rigid = structure.surface.shapes.leftCols(structure.rigid_count);
  if (rigid.cols() == 0) return {};
  const VectorXd ones = VectorXd::Ones(rigid.rows());
  const VectorXd parts = rigid.colPivHouseholderQr().solve(ones);
  const bool is_rigid = (rigid * parts - ones).norm() < kConstants.next_flat * ones.norm();
  return is_rigid ? parts : VectorXd();
}

double mass_of(const State& state, const VectorXd& lift) {
  const Index n = lift.size();
  double mass = lift.dot(state.mass.topLeftCorner(n, n) * lift);
  for (const auto& attached : state.attached) {
    mass += attached.mass * (attached.shapes.topRows(n).transpose() * lift).squaredNorm();
  }
  return mass;
}

double log_mass_of(const Question& question, const State& state) {
  if (question.lift.size() == 0) return 0.0;
  const double ratio = mass_of(state, question.lift) / question.lift.squaredNorm();
  return std::log(std::max(ratio, 1e-3));
}

// The structure of an explanation; none where no body is like that. A step from a size that is
// hardly known may take more stiffness than there is.
std::optional<State> state_with(const ModesProblem& problem, const ModesFit& fit) {
  try {
    return problem.with(fit);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

// The outlook of an explanation. Each shape has the sign of `like`, if there is one.
std::optional<Outlook> outlook_of(const Question& question, const ModesFit& fit,
                                  const MatrixXd& like) {
  const auto state = state_with(question.problem, fit);
  if (!state) return std::nullopt;
  const auto model = question.problem.modes(*state, false);
  if (!model || model->count() != fit.model.count()) return std::nullopt;
  const auto& motion = model->motion;
  const MatrixXd at_places = question.problem.structure()
                                 .surface.shapes(question.places, Eigen::all)
                                 .leftCols(motion.rows()) *
                             motion;
  const auto m = static_cast<Index>(fit.matching.model.size());
  Outlook outlook{MatrixXd::Constant(at_places.rows(), m, kNotMeasured),
                  MatrixXd::Constant(at_places.rows(), m, kNotMeasured),
                  log_mass_of(question, *state)};
  for (Index i = 0; i < m; ++i) {
    const Index k = fit.matching.model[at(i)];
    if (k < 0) continue;
    outlook.mobility.col(i) = at_places.col(k).cwiseAbs2();
    const auto sensors = static_cast<double>(model->outputs.rows());
    const double seen = model->outputs.col(k).norm() / std::sqrt(std::max(sensors, 1.0));
    if (sensors < 1.0 || seen < kConstants.next_seen * question.problem.units().outputs) continue;
    outlook.shapes.col(i) = at_places.col(k) / seen;
    const bool is_turned = like.size() > 0 && outlook.shapes.col(i).dot(like.col(i)) < 0.0;
    if (is_turned) outlook.shapes.col(i) *= -1.0;
  }
  return outlook;
}

// The explanation with a step of all coordinates: of its causes, then of the constants.
ModesFit stepped(const ModesFit& fit, const VectorXd& step) {
  ModesFit other = fit;
  const Index causes = step.size() - fit.constants.size();
  other.causes = moved(fit.causes, step.head(causes));
  other.constants += step.tail(fit.constants.size());
  return other;
}

std::vector<Outlook> changes_of(const Question& question, const ModesFit& fit, const Outlook& own) {
  std::vector<Outlook> changes;
  if (fit.covariance.size() == 0) return changes;
  const double part = kConstants.next_step;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(fit.covariance);
  for (Index c = 0; c < axes.eigenvalues().size(); ++c) {
    const VectorXd step =
        part * std::sqrt(std::max(axes.eigenvalues()(c), 0.0)) * axes.eigenvectors().col(c);
    for (const double sign : {1.0, -1.0}) {
      const auto other = stepped(fit, sign * step);
      const bool is_possible = std::ranges::all_of(other.causes, [&](const Supposed& cause) {
        return std::isfinite(log_prior(cause, question.problem.structure()));
      });
      const auto there = is_possible ? outlook_of(question, other, own.shapes) : std::nullopt;
      if (!there) continue;
      changes.push_back({(there->shapes - own.shapes) / part,
                         (there->mobility - own.mobility) / part,
                         (there->log_mass - own.log_mass) / part});
      break;
    }
  }
  return changes;
}

}  // namespace

Question question_of(const ModesProblem& problem, const ModesFit& best) {
  return {problem, spread_places(problem.structure().surface, kConstants.next_places),
          lift(problem.structure()), best};
}

std::vector<Explained> explained(const Question& question, const std::vector<WeighedFit>& all) {
  std::vector<Explained> result;
  for (const auto& one : all) {
    const MatrixXd like = result.empty() ? MatrixXd() : result.front().outlook.shapes;
    auto own = outlook_of(question, *one.fit, like);
    if (!own) {
      if (result.empty()) break;
      continue;
    }
    auto changes = changes_of(question, *one.fit, *own);
    result.push_back({one, std::move(*own), std::move(changes)});
  }
  return result;
}

double separation(const Forecast& a, const Forecast& b, const VectorXd& variance) {
  std::vector<Index> rows;
  for (Index i = 0; i < variance.size(); ++i) {
    const bool is_known = std::isfinite(a.mean(i)) && std::isfinite(b.mean(i)) &&
                          a.spread.row(i).allFinite() && b.spread.row(i).allFinite();
    if (is_known && std::isfinite(variance(i)) && variance(i) > 0.0) rows.push_back(i);
  }
  if (rows.empty()) return 0.0;
  // In units of the deviations, so that the covariances are 1 + spread spreadᵀ.
  const VectorXd unit = variance(rows).cwiseSqrt().cwiseInverse();
  const auto covariance = [&](const MatrixXd& spread) {
    const MatrixXd own = unit.asDiagonal() * spread(rows, Eigen::all);
    return MatrixXd(MatrixXd::Identity(unit.size(), unit.size()) + own * own.transpose());
  };
  const auto log_determinant = [](const Eigen::LLT<MatrixXd>& factor) {
    return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  };
  const MatrixXd first = covariance(a.spread);
  const MatrixXd second = covariance(b.spread);
  const Eigen::LLT<MatrixXd> mean(MatrixXd(0.5 * (first + second)));
  const VectorXd apart = unit.cwiseProduct(a.mean(rows) - b.mean(rows));
  const double volume =
      log_determinant(mean) - 0.5 * (log_determinant(first.llt()) + log_determinant(second.llt()));
  return 0.5 * apart.dot(mean.solve(apart)) + 2.0 * volume;
}

}  // namespace chladni::diagnosis
