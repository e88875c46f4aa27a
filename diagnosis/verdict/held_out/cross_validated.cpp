#include "diagnosis/verdict/held_out/cross_validated.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/index.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/verdict/held_out/held_out_parts.h"
#include "diagnosis/verdict/held_out/part_misfit.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Fit quickly_fitted(const Problem& problem, const Fit& start) {
  return fitted(problem, start, {.iterations = kConstants.quick_iterations});
}

using Causes = std::vector<Supposed>;

// The problem with these data instead, which must outlive it.
Problem with_data(const Problem& problem, const Observed& data) {
  return {problem.structure, data, problem.deviations, problem.solver_error};
}

// A fit to all data, and the fits to the data without each part; none where no fit is possible.
struct Trained {
  Fit whole;
  std::vector<std::optional<Fit>> rest;
};

Trained trained(const Problem& problem, const std::vector<DataPart>& parts, Fit whole) {
  Trained result{std::move(whole), {}};
  for (const auto& part : parts) {
    throw_if_interrupted();
    const Observed data = without(problem.observed, part);
    result.rest.push_back(possible_fit(with_data(problem, data), result.whole,
                                       {.iterations = kConstants.quick_iterations}));
  }
  return result;
}

// True if the data are evidence for cause c of the fit `with`, which is `less` without it. That one
// may have stopped on its way, so where the cause hardly lowers the misfit, the fit without it is
// made again, beside the deviations of `with`.
bool is_told(const Problem& problem, const Fit& with, const Fit& less, std::size_t c) {
  if (!(with.evidence_at_best() > less.evidence_at_best())) return false;
  Fit start = with;
  start.causes.erase(start.causes.begin() + static_cast<std::ptrdiff_t>(c));
  const double removed = misfit_at(problem, start.causes, start.eta);
  if (removed > 0.5 * with.strained() + kConstants.sure_evidence) return true;
  const auto again = possible_fit(problem, start, {.iterations = kConstants.quick_iterations});
  return !again || with.evidence_at_best() > again->evidence_at_best() + kConstants.nothing_more;
}

// True for each cause that the data without a part are evidence for, beside the other causes.
std::vector<bool> supported(const Problem& problem, const DataPart& part, const Trained& all,
                            const std::vector<Trained>& less, std::size_t f) {
  const Observed data = without(problem.observed, part);
  const Problem rest = with_data(problem, data);
  std::vector<bool> is_supported(less.size(), false);
  for (std::size_t c = 0; c < less.size(); ++c) {
    if (!all.rest[f] || !less[c].rest[f]) continue;
    is_supported[c] = is_told(rest, *all.rest[f], *less[c].rest[f], c);
  }
  return is_supported;
}

// The supported causes of a fit that may lack cause `without`. The others are as `otherwise` has
// them, which has as many as the fit; or left out, if it is empty.
Causes kept(const std::optional<Fit>& fit, const std::vector<bool>& supported,
            std::optional<std::size_t> without, const Causes& otherwise) {
  Causes causes;
  std::size_t n = 0;
  for (std::size_t c = 0; c < supported.size(); ++c) {
    if (c == without) continue;
    if (supported[c] && fit) {
      causes.push_back(fit->causes[n]);
    } else if (!otherwise.empty()) {
      causes.push_back(otherwise[n]);
    }
    ++n;
  }
  return causes;
}

// ½(χ² + ηᵀη) of each part with its own causes, where the deviations suit it best. They go with the
// causes, so they are sought from those of all data and from those of the rest.
std::vector<double> misfits(const Problem& problem, const std::vector<DataPart>& parts,
                            const Trained& fits, const std::vector<Causes>& causes) {
  std::vector<double> misfit;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    throw_if_interrupted();
    const Observed data = only(problem.observed, parts[f]);
    std::vector<VectorXd> starts{fits.whole.eta};
    if (f < fits.rest.size() && fits.rest[f]) starts.push_back(fits.rest[f]->eta);
    misfit.push_back(least_misfit(with_data(problem, data), causes[f], starts));
  }
  return misfit;
}

// Σ |G − Ĝ|² over what was measured.
double squared_error(const State& state, const Observed& data) {
  const Eigen::MatrixXcd value = responses(state, data.omega);
  return (data.weight.array() > 0.0).select((data.value - value).cwiseAbs2().array(), 0.0).sum();
}

// The constants as a fit has them, with all other deviations at 0.
VectorXd constants_alone(const Problem& problem, const VectorXd& eta) {
  VectorXd alone = VectorXd::Zero(std::ssize(problem.deviations));
  for (Eigen::Index i = 0; i < eta.size(); ++i) {
    if (problem.deviations[at(i)].is_constant) alone(i) = eta(i);
  }
  return alone;
}

// The same with causes and constants of a fit; none where they are impossible.
std::optional<double> error_with(const Problem& problem, const Observed& data, const Causes& causes,
                                 const Fit& fit) {
  try {
    return squared_error(state_of(problem, causes, constants_alone(problem, fit.eta)), data);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

// Errors of the study as it is, and with causes and constants of a fit that did not see the data;
// none: it failed.
PredictionErrors errors_of(const Problem& problem, const Observed& data,
                           const std::vector<Supposed>& causes, const std::optional<Fit>& fit) {
  const Eigen::ArrayXXd weight2 = data.weight.array().square();
  PredictionErrors errors;
  errors.before = squared_error(state_of(problem.structure), data);
  errors.after = errors.before;
  if (fit) errors.after = error_with(problem, data, causes, *fit).value_or(errors.before);
  errors.size = (weight2 > 0.0).select(data.value.cwiseAbs2().array(), 0.0).sum();
  errors.noise = (weight2 > 0.0).select(2.0 / weight2.max(1e-300), 0.0).sum();
  return errors;
}

// The causes that predict each part.
std::vector<Causes> predicting(const Trained& fits, const std::vector<std::vector<bool>>& used) {
  std::vector<Causes> causes;
  for (std::size_t f = 0; f < used.size(); ++f) {
    causes.push_back(kept(fits.rest[f], used[f], {}, {}));
  }
  return causes;
}

// The causes by which one of them is judged, beside it or without it: those that the rest of the
// data does not support are as all data have them. A held-out sensor with another sign stays wrong
// without that cause, and nothing beside it makes its row right.
std::vector<Causes> judging(const Trained& fits, const std::vector<std::vector<bool>>& used,
                            std::optional<std::size_t> without = {}) {
  std::vector<Causes> causes;
  for (std::size_t f = 0; f < used.size(); ++f) {
    causes.push_back(kept(fits.rest[f], used[f], without, fits.whole.causes));
  }
  return causes;
}

// A part at which one of the two is impossible says nothing of them.
double gained(double before, double after) {
  return std::isfinite(before) && std::isfinite(after) ? before - after : 0.0;
}

std::vector<Trained> trained_without_each(const Problem& problem,
                                          const std::vector<DataPart>& parts, const Fit& whole,
                                          const Fit& nothing) {
  std::vector<Trained> less;
  for (std::size_t c = 0; c < whole.causes.size(); ++c) {
    less.push_back(trained(problem, parts, without(problem, whole, c, nothing)));
  }
  return less;
}

}  // namespace

PredictionErrors& PredictionErrors::operator+=(const PredictionErrors& more) {
  before += more.before;
  after += more.after;
  size += more.size;
  noise += more.noise;
  return *this;
}

double CrossValidation::gain(HeldOutPart::Kind kind, std::optional<std::size_t> which) const {
  double total = 0.0;
  for (const auto& part : parts) {
    if (part.kind == kind) total += which ? part.gain_of_cause[*which] : part.gain;
  }
  return total;
}

bool CrossValidation::pays(std::optional<std::size_t> which) const {
  const auto [less, more] =
      std::minmax({gain(HeldOutPart::Kind::sensors, which), gain(HeldOutPart::Kind::lines, which)});
  return less + more > 0.0 && less >= -kConstants.held_out_loss * more;
}

PredictionErrors CrossValidation::errors(HeldOutPart::Kind kind) const {
  PredictionErrors total;
  for (const auto& part : parts) {
    if (part.kind == kind) total += part.errors;
  }
  return total;
}

PredictionErrors CrossValidation::errors() const {
  auto total = errors(HeldOutPart::Kind::sensors);
  total += errors(HeldOutPart::Kind::lines);
  return total;
}

CrossValidation cross_validated(const Problem& problem, const Observed& all, const Fit& best,
                                const Fit& nothing) {
  const dense::OneBlasThread one_thread;
  const auto count = problem.deviations.size();
  const Fit none = quickly_fitted(problem, with_deviations(nothing, count));
  const auto parts = held_out_parts(problem.structure.outputs.names, all);
  const auto with = trained(problem, parts, quickly_fitted(problem, with_deviations(best, count)));
  const auto less = trained_without_each(problem, parts, with.whole, none);
  std::vector<std::vector<bool>> used;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    used.push_back(supported(problem, parts[f], with, less, f));
  }
  const auto causes = predicting(with, used);
  const auto after = misfits(problem, parts, with, judging(with, used));
  const auto before = misfits(problem, parts, less.size() == 1 ? less.front() : Trained{none, {}},
                              std::vector<Causes>(parts.size()));
  std::vector<std::vector<double>> beside;
  for (std::size_t c = 0; c < less.size(); ++c) {
    beside.push_back(
        less.size() == 1 ? before : misfits(problem, parts, less[c], judging(less[c], used, c)));
  }
  CrossValidation result;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    auto& part = result.parts.emplace_back(parts[f].told);
    // A part without a cause says nothing of it: the fits that never had the cause stretch the
    // deviations of its channel for it, the others do not.
    const bool whole = std::ranges::find(used[f], false) == used[f].end();
    part.gain = whole ? gained(before[f], after[f]) : 0.0;
    for (std::size_t c = 0; c < beside.size(); ++c) {
      part.gain_of_cause.push_back(used[f][c] ? gained(beside[c][f], after[f]) : 0.0);
    }
    part.errors = errors_of(problem, only(all, parts[f]), causes[f], with.rest[f]);
  }
  return result;
}

std::string doubt_what_does_not_pay(Diagnosis& diagnosis) {
  const auto& unseen = *diagnosis.cross_validation;
  auto& causes = diagnosis.best.causes;
  std::string names;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    if (unseen.pays() && unseen.pays(c)) continue;
    causes[c].probability = std::min(causes[c].probability, kConstants.believed);
    names += (names.empty() ? "" : ", ") + causes[c].effect;
  }
  if (names.empty()) return "";
  diagnosis.best.probability = std::min(diagnosis.best.probability, kConstants.believed);
  diagnosis.verdict = unseen.pays() ? Verdict::partial : Verdict::unexplained;
  return fmt::format(
      "data that were held out are predicted no better with {} (fitted to the others): it has a "
      "probability of {} at most",
      names, kConstants.believed);
}

}  // namespace chladni::diagnosis
