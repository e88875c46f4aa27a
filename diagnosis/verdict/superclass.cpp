#include "diagnosis/verdict/superclass.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;

struct View {
  const Problem& problem;
  const State& state;
  const Solved& now;
  double excess = 0.0;

  [[nodiscard]] Index lines() const { return problem.observed.line_count(); }
  [[nodiscard]] Index outputs() const { return problem.observed.outputs; }
  [[nodiscard]] Index inputs() const { return problem.observed.inputs; }
};

// Fits a free complex factor per line on `direction` (K×pq). Returns its curve, and the fall of χ²
// minus the two numbers that each line uses.
Superclass free_function(const View& view, const MatrixXcd& direction, std::string name,
                         std::string channel) {
  const auto& observed = view.problem.observed;
  Superclass found;
  found.name = std::move(name);
  found.channel = std::move(channel);
  found.frequency_hz = observed.omega / (2.0 * std::numbers::pi);
  found.curve = VectorXcd::Zero(view.lines());
  double fall = 0.0;
  for (Index k = 0; k < view.lines(); ++k) {
    const Eigen::RowVectorXd w2 = observed.weight.row(k).cwiseAbs2();
    const Eigen::RowVectorXcd error = observed.value.row(k) - view.now.value.row(k);
    const Complex along = (w2.array() * direction.row(k).conjugate().array() * error.array()).sum();
    const double power = (w2.array() * direction.row(k).array().abs2()).sum();
    if (power <= 0.0) continue;
    found.curve(k) = along / power;
    fall += std::norm(along) / power - 2.0;
  }
  found.explained = fall / view.excess;
  return found;
}

void keep_better(std::optional<Superclass>& best, Superclass other) {
  if (!best || other.explained > best->explained) best = std::move(other);
}

// What a support that moves along the normal does to all responses.
MatrixXcd shared_by_all(const View& view) {
  const auto& structure = view.problem.structure;
  const Eigen::VectorXd out = parts_along_normal(structure, structure.outputs);
  const Eigen::VectorXd in = parts_along_normal(structure, structure.inputs);
  const MatrixXd signs =
      (out * in.transpose())(view.state.output_of, view.state.input_of).reshaped().transpose();
  return signs.replicate(view.lines(), 1).cast<Complex>();
}

void try_channels(const View& view, std::optional<Superclass>& best) {
  const auto& structure = view.problem.structure;
  const auto only = [&](Index first, Index stride, Index count) {
    MatrixXcd direction = MatrixXcd::Zero(view.lines(), view.now.value.cols());
    for (Index n = 0; n < count; ++n) {
      direction.col(first + stride * n) = view.now.value.col(first + stride * n);
    }
    return direction;
  };
  // A single channel of a side has all responses, so it is the case "all channels". With a single
  // channel on the other side, a row is one response, which a free function fits exactly.
  if (view.inputs() > 1) {
    for (Index i = 0; i < view.outputs() && view.outputs() > 1; ++i) {
      keep_better(best, free_function(view, only(i, view.outputs(), view.inputs()), "sensor",
                                      structure.outputs.names[static_cast<std::size_t>(i)]));
    }
  }
  if (view.outputs() > 1) {
    for (Index j = 0; j < view.inputs() && view.inputs() > 1; ++j) {
      keep_better(best, free_function(view, only(j * view.outputs(), 1, view.outputs()), "actuator",
                                      structure.inputs.names[static_cast<std::size_t>(j)]));
    }
  }
  if (view.outputs() * view.inputs() < 2) return;
  keep_better(best, free_function(view, view.now.value, "all channels", ""));
  keep_better(best, free_function(view, shared_by_all(view), "support", ""));
}

void try_places(const View& view, std::optional<Superclass>& best) {
  if (view.outputs() * view.inputs() < 2) return;
  const auto scan = place_scan(view.problem.structure, view.problem.observed, view.now, view.state);
  if (scan.peaks.empty()) return;
  const Index n = scan.peaks.front();
  const VectorXcd shape = view.problem.structure.surface.shapes.row(n).transpose().cast<Complex>();
  MatrixXcd direction(view.lines(), view.now.value.cols());
  for (Index k = 0; k < view.lines(); ++k) {
    const MatrixXcd outer = (view.now.left(k) * shape) * (shape.transpose() * view.now.right(k));
    direction.row(k) = -recorded(view.state, outer, Complex(0.0, view.problem.observed.omega(k)))
                            .reshaped()
                            .transpose();
  }
  Superclass found = free_function(view, direction, "place", "");
  found.place = view.problem.structure.surface.places.row(n).transpose();
  keep_better(best, std::move(found));
}

// Fits (I + Y) G or G (I + X) with a real matrix that is the same on all lines.
Superclass mixing(const View& view, bool sensors) {
  const auto& observed = view.problem.observed;
  const Index p = view.outputs();
  const Index q = view.inputs();
  const Index n = sensors ? p : q;
  double fall = 0.0;
  for (Index to = 0; to < n; ++to) {
    MatrixXd gram = MatrixXd::Zero(n, n);
    Eigen::VectorXd toward = Eigen::VectorXd::Zero(n);
    for (Index k = 0; k < view.lines(); ++k) {
      const MatrixXcd value = view.now.value.row(k).reshaped(p, q);
      const MatrixXcd error = (observed.value.row(k) - view.now.value.row(k)).reshaped(p, q);
      const MatrixXd w2 = observed.weight.row(k).cwiseAbs2().reshaped(p, q);
      const MatrixXcd regressors =
          sensors ? MatrixXcd(value) : MatrixXcd(value.transpose());  // n×m
      const VectorXcd target =
          sensors ? VectorXcd(error.row(to).transpose()) : VectorXcd(error.col(to));
      const Eigen::VectorXd weight =
          sensors ? Eigen::VectorXd(w2.row(to).transpose()) : Eigen::VectorXd(w2.col(to));
      const MatrixXcd weighted = regressors.conjugate() * weight.cast<Complex>().asDiagonal();
      gram += (weighted * regressors.transpose()).real();
      toward += (weighted * target).real();
    }
    gram.diagonal().array() += 1e-12 * gram.trace() + 1e-300;
    fall += toward.dot(gram.llt().solve(toward)) - static_cast<double>(n);
  }
  Superclass found;
  found.name = sensors ? "crosstalk of sensors" : "crosstalk of actuators";
  found.explained = fall / view.excess;
  return found;
}

// Free frequencies and dampings, with the causes included.
Superclass frequencies(const Problem& problem, const Fit& best, double excess) {
  Tolerances free = no_tolerances();
  free.frequency = kConstants.free_frequency;
  free.damping = kConstants.free_damping;
  free.residual = Tolerances{}.residual;
  const auto& omega = problem.observed.omega;
  const double band_hz = omega(omega.size() - 1) / (2.0 * std::numbers::pi);
  const auto loose = deviations(problem.structure, free, kConstants.free_modes * band_hz);
  std::vector<Deviation> deviating = problem.deviations;
  deviating.insert(deviating.end(), loose.begin(), loose.end());
  FitLimits limits;
  limits.iterations = kConstants.free_iterations;
  const Fit fit = fitted({problem.structure, problem.observed, deviating},
                         with_deviations(best, deviating.size()), limits);
  Superclass found;
  found.name = "modal frequencies and dampings";
  found.explained = (best.chi_square - fit.chi_square - static_cast<double>(loose.size())) / excess;
  return found;
}

}  // namespace

std::optional<Superclass> superclass(const Problem& problem, const Fit& best) {
  const State state = state_of(problem, best.causes, best.eta);
  const Solved now = solved(state, Body(state, problem.observed.omega));
  const double excess = best.chi_square - problem.observed.number_count();
  if (excess <= 0.0) return std::nullopt;
  const View view{problem, state, now, excess};
  std::optional<Superclass> found;
  try_channels(view, found);
  try_places(view, found);
  if (view.outputs() > 1) keep_better(found, mixing(view, true));
  if (view.inputs() > 1) keep_better(found, mixing(view, false));
  try {
    keep_better(found, frequencies(problem, best, excess));
  } catch (const NumericalFailure&) {
    // Then they are not a better explanation.
  }
  if (!found || found->explained < kConstants.least_explained) return std::nullopt;
  return found;
}

}  // namespace chladni::diagnosis
