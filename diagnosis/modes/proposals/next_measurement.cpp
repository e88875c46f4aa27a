#include "diagnosis/modes/proposals/next_measurement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using What = Proposal::What;

// The rivals that matter: the likeliest ones, which share all of what the first explanation leaves
// but Constants::next_tail. A measurement that settles the others is not idle for what it cannot.
std::vector<const Explained*> rivals_that_matter(const std::vector<Explained>& all) {
  std::vector<const Explained*> rivals;
  double weights = 0.0;
  for (std::size_t b = 1; b < all.size(); ++b) {
    rivals.push_back(&all[b]);
    weights += all[b].weighed.probability;
  }
  std::ranges::stable_sort(rivals, std::ranges::greater{},
                           [](const Explained* one) { return one->weighed.probability; });
  double left = weights;
  std::size_t count = 0;
  while (count < rivals.size() && (count == 0 || left > kConstants.next_tail * weights)) {
    left -= rivals[count++]->weighed.probability;
  }
  rivals.resize(count);
  return rivals;
}

// −ln Σ v exp(−s) over these rivals with their shares.
template <class Separation>
double evidence_of(const std::vector<Explained>& all, const Separation& between) {
  double left = 0.0;
  double weights = 0.0;
  for (const auto* rival : rivals_that_matter(all)) {
    const double weight = std::max(rival->weighed.probability, 1e-12);
    left += weight * std::exp(-between(all.front(), *rival));
    weights += weight;
  }
  return weights > 0.0 ? -std::log(std::max(left / weights, 1e-300)) : 0.0;
}

double level(const ModesFit& fit, ErrorClass of) { return fit.levels(static_cast<Index>(of)); }

// Variance of each mode's shape at each place: noise, the model's error, and neighbours that mix.
MatrixXd shape_variance(const Question& question, const Explained& best) {
  const auto& fit = question.best;
  const double own = std::pow(kConstants.next_noise, 2) +
                     std::pow(level(fit, ErrorClass::shape), 2) +
                     std::pow(level(fit, ErrorClass::smooth_shape), 2);
  MatrixXd variance =
      MatrixXd::Constant(best.outlook.shapes.rows(), best.outlook.shapes.cols(), own);
  for (Index i = 0; i < variance.cols(); ++i) {
    const Index k = fit.matching.model[at(i)];
    for (Index j = 0; j < variance.cols(); ++j) {
      const Index l = fit.matching.model[at(j)];
      if (k < 0 || l < 0 || l == k) continue;
      const double apart =
          std::abs(std::log(fit.model.frequency_hz(l) / fit.model.frequency_hz(k)));
      if (apart >= kConstants.nearby) continue;
      const double part = level(fit, ErrorClass::frequency) *
                          (1.0 / std::max(apart, kConstants.least_gap) - 1.0 / kConstants.nearby);
      const VectorXd neighbour = best.outlook.shapes.col(j).cwiseAbs2();
      variance.col(i) += part * part * neighbour.array().isFinite().select(neighbour, 0.0);
    }
  }
  return variance;
}

// The better of two proposals of one kind.
void keep(std::optional<Proposal>& best, const Proposal& other) {
  if (!best || other.evidence > best->evidence) best = other;
}

std::optional<Proposal> sensor(const Question& question, const std::vector<Explained>& all,
                               double cost) {
  std::optional<Proposal> best;
  const MatrixXd variance = shape_variance(question, all.front());
  const auto& surface = question.problem.structure().surface;
  for (Index p = 0; p < variance.rows(); ++p) {
    const VectorXd of_place = variance.row(p);
    const auto read = [p](const Outlook& outlook) { return VectorXd(outlook.shapes.row(p)); };
    const double evidence = evidence_of(all, [&](const Explained& a, const Explained& b) {
      return separation(forecast(a, read), forecast(b, read), of_place);
    });
    keep(best, {What::sensor, "", surface.places.row(question.places[at(p)]).transpose(), 0.0,
                evidence, cost});
  }
  return best;
}

// A known mass of next_mass of the body's.
std::optional<Proposal> mass(const Question& question, const std::vector<Explained>& all,
                             double cost) {
  std::optional<Proposal> best;
  const auto& mobility = all.front().outlook.mobility;
  double sum = 0.0;
  double count = 0.0;
  for (const double one : mobility.reshaped()) {
    if (!std::isfinite(one)) continue;
    sum += one;
    count += 1.0;
  }
  if (!(sum > 0.0)) return best;
  const double known = kConstants.next_mass * count / sum;
  const auto& surface = question.problem.structure().surface;
  const double shape = level(question.best, ErrorClass::shape);
  for (Index p = 0; p < mobility.rows(); ++p) {
    const auto read = [p, known](const Outlook& outlook) {
      return VectorXd(-0.5 * known * outlook.mobility.row(p).transpose());
    };
    const VectorXd variance = (2.0 * shape * read(all.front().outlook)).cwiseAbs2().array() +
                              std::pow(kConstants.next_repeat, 2);
    const double evidence = evidence_of(all, [&](const Explained& a, const Explained& b) {
      return separation(forecast(a, read), forecast(b, read), variance);
    });
    keep(best, {What::mass, "", surface.places.row(question.places[at(p)]).transpose(), known,
                evidence, cost});
  }
  return best;
}

std::optional<Proposal> weighing(const Question& question, const std::vector<Explained>& all,
                                 double cost) {
  if (question.lift.size() == 0) return std::nullopt;
  const auto& tolerances = question.problem.tolerances();
  const double std = std::hypot(kConstants.next_scales, tolerances.density, tolerances.thickness);
  const auto read = [](const Outlook& outlook) {
    return VectorXd(VectorXd::Constant(1, outlook.log_mass));
  };
  const double evidence = evidence_of(all, [&](const Explained& a, const Explained& b) {
    return separation(forecast(a, read), forecast(b, read), VectorXd::Constant(1, std * std));
  });
  return Proposal{What::weighing, "the body", std::nullopt, 0.0, evidence, cost};
}

// The size of an effect in an explanation: 0 where it is no cause.
Forecast size_of(const Explained& one, std::string_view effect) {
  Forecast result{VectorXd::Zero(1), MatrixXd::Zero(1, 1)};
  Index first = 0;
  for (const auto& cause : one.weighed.fit->causes) {
    if (cause.effect->name == effect) {
      result.mean(0) = cause.x(0);
      result.spread(0, 0) = std::sqrt(one.weighed.fit->covariance(first, first));
    }
    first += cause.x.size();
  }
  return result;
}

std::optional<Proposal> dimension(const Question& question, const std::vector<Explained>& all,
                                  double cost) {
  std::optional<Proposal> best;
  using Dimension = std::pair<std::string_view, std::string_view>;
  for (const auto& [effect, text] :
       {Dimension{"thickness", "the thickness"}, Dimension{"size_error", "length and width"}}) {
    const double tolerance = effect == "thickness" ? question.problem.tolerances().thickness : 0.0;
    const double std = std::hypot(kConstants.next_callipers, tolerance);
    const double evidence = evidence_of(all, [&](const Explained& a, const Explained& b) {
      return separation(size_of(a, effect), size_of(b, effect), VectorXd::Constant(1, std * std));
    });
    keep(best, {What::dimension, std::string(text), std::nullopt, 0.0, evidence, cost});
  }
  return best;
}

// What an explanation blames alone: a mode or a channel.
std::vector<std::string> blamed(const ModesProblem& problem, const ModesFit& fit) {
  const auto& measured = problem.measured();
  const auto i = fit.disturbed.index;
  switch (fit.disturbed.what) {
    case Disturbed::What::mode:
      return {mode_name(measured, i)};
    case Disturbed::What::sensor:
      return {measured.outputs[at(i)]};
    case Disturbed::What::actuator:
      return {measured.inputs[at(i)]};
    case Disturbed::What::nothing:
      break;
  }
  std::vector<std::string> names;
  for (const auto& cause : fit.causes) {
    const auto channels = cause.effect->channels(problem.structure(), cause.option);
    names.insert(names.end(), channels.begin(), channels.end());
  }
  return names;
}

// The least ln evidence of all: that of the structure as it is, where it is among them.
double least_evidence(const std::vector<Explained>& all) {
  const auto evidence = [](const Explained& one) { return one.weighed.fit->log_evidence; };
  return evidence(*std::ranges::min_element(all, {}, evidence));
}

// A mode measured again, or another channel in the place of one: what is wrong with it alone is
// gone then. Explanations that blame it lose or confirm what they gain.
std::optional<Proposal> another(What what, const Question& question,
                                const std::vector<Explained>& all, double cost) {
  std::optional<Proposal> best;
  const auto names_of = [&](const Explained& one) {
    const auto& fit = *one.weighed.fit;
    const bool is_mode = fit.disturbed.what == Disturbed::What::mode;
    const bool is_asked = is_mode == (what == What::repetition);
    return is_asked ? blamed(question.problem, fit) : std::vector<std::string>();
  };
  const auto blames = [&](const Explained& one, const std::string& name) {
    const auto names = names_of(one);
    return std::ranges::find(names, name) != names.end();
  };
  const double none = least_evidence(all);
  for (const auto& one : all) {
    for (const auto& name : names_of(one)) {
      const double evidence = evidence_of(all, [&](const Explained& a, const Explained& b) {
        if (blames(a, name) == blames(b, name)) return 0.0;
        return (blames(a, name) ? a : b).weighed.fit->log_evidence - none;
      });
      keep(best, {what, name, std::nullopt, 0.0, evidence, cost});
    }
  }
  return best;
}

// Where no measurement tells the explanations apart: what the first one blames, exchanged or
// measured again. That confirms it against the structure as it is.
std::vector<Proposal> confirmation(const Question& question, const std::vector<Explained>& all,
                                   const MeasurementCosts& costs) {
  const auto& fit = *all.front().weighed.fit;
  const bool is_mode = fit.disturbed.what == Disturbed::What::mode;
  std::vector<Proposal> proposals;
  for (const auto& name : blamed(question.problem, fit)) {
    proposals.push_back({is_mode ? What::repetition : What::exchange, name, std::nullopt, 0.0,
                         fit.log_evidence - least_evidence(all),
                         is_mode ? costs.repetition : costs.exchange});
  }
  return proposals;
}

double worth(const Proposal& one) {
  return std::min(one.evidence, kConstants.next_enough) - one.cost;
}

}  // namespace

std::vector<Proposal> next_measurements(const ModesProblem& problem,
                                        const std::vector<WeighedFit>& explanations,
                                        const MeasurementCosts& costs) {
  const Question question = question_of(problem, *explanations.front().fit);
  const auto all = explained(question, explanations);
  std::vector<Proposal> proposals;
  if (all.size() < 2) return proposals;
  const std::array<std::optional<Proposal>, 6> candidates{
      another(What::repetition, question, all, costs.repetition),
      another(What::exchange, question, all, costs.exchange),
      mass(question, all, costs.mass),
      dimension(question, all, costs.dimension),
      sensor(question, all, costs.sensor),
      weighing(question, all, costs.weighing)};
  for (const auto& one : candidates) {
    if (one && one->evidence >= kConstants.next_evidence) proposals.push_back(*one);
  }
  if (proposals.empty()) return confirmation(question, all, costs);
  std::ranges::stable_sort(proposals, std::ranges::greater{}, worth);
  return proposals;
}

}  // namespace chladni::diagnosis
