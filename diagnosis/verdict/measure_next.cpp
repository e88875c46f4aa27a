#include "diagnosis/verdict/measure_next.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/upper_median.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/proposal.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

bool only_scales(const Fit& fit) {
  return !fit.causes.empty() && std::ranges::all_of(fit.causes, [](const Supposed& cause) {
    return cause.effect->is_scale;
  });
}

// Responses at some places of the surface to every actuator.
Eigen::MatrixXcd responses_at(const Problem& problem, const Fit& fit,
                              const std::vector<Index>& places, const Eigen::VectorXd& omega) {
  State state = state_of(problem, fit.causes, fit.eta);
  const auto count = static_cast<Index>(places.size());
  state.outputs = problem.structure.surface.shapes(places, Eigen::all);
  state.output_upper = Eigen::MatrixXd::Zero(count, state.output_upper.cols());
  state.residual = Eigen::MatrixXd::Zero(count, state.input_count());
  state.output_paths.assign(places.size(), Path{});
  state.output_of = {};
  for (Index i = 0; i < count; ++i) state.output_of.push_back(i);
  for (auto& frame : state.frames) frame.to_outputs = Eigen::VectorXd::Ones(count);
  return responses(state, omega);
}

// Least σ / |G|: of additive noise next to nothing, of proportional noise its share.
double relative_noise(const Observed& observed) {
  double least = HUGE_VAL;
  for (Index e = 0; e < observed.value.size(); ++e) {
    const double weight = observed.weight.reshaped()(e);
    const double size = std::abs(observed.value.reshaped()(e));
    if (weight > 0.0 && size > 0.0) least = std::min(least, std::sqrt(2.0) / (weight * size));
  }
  return std::isfinite(least) ? least : kConstants.next_noise;
}

// K×q: median of σ² over the sensors. Infinite where an actuator was not measured at all.
Eigen::MatrixXd floor_of_noise(const Observed& observed) {
  Eigen::MatrixXd floor =
      Eigen::MatrixXd::Constant(observed.line_count(), observed.inputs, HUGE_VAL);
  for (Index j = 0; j < observed.inputs; ++j) {
    for (Index k = 0; k < observed.line_count(); ++k) {
      std::vector<double> power;
      for (Index i = 0; i < observed.outputs; ++i) {
        const double weight = observed.weight(k, i + observed.outputs * j);
        if (weight > 0.0) power.push_back(2.0 / (weight * weight));
      }
      if (!power.empty()) floor(k, j) = upper_median(power);
    }
  }
  return floor;
}

// Σ |G_a − G_b|² / σ² of one more sensor at each place. σ is at least that of the sensors that are
// there: where the body is at rest there is noise, too. Noise that is proportional to the responses
// is larger where they are.
Eigen::VectorXd evidence_at(const Problem& problem, const Fit& a, const Fit& b,
                            const std::vector<Index>& places) {
  const Observed few = thinned(problem.observed, kConstants.next_lines);
  const auto here = responses_at(problem, a, places, few.omega);
  const auto other = responses_at(problem, b, places, few.omega);
  const double relative = relative_noise(few);
  const Eigen::ArrayXXd floor = floor_of_noise(few).array();
  const double lines =
      static_cast<double>(problem.observed.line_count()) / static_cast<double>(few.line_count());
  Eigen::VectorXd evidence = Eigen::VectorXd::Zero(static_cast<Index>(places.size()));
  for (Index j = 0; j < few.inputs; ++j) {
    for (Index n = 0; n < evidence.size(); ++n) {
      const Index c = n + evidence.size() * j;
      const Eigen::ArrayXd apart = (here.col(c) - other.col(c)).cwiseAbs2().array();
      const Eigen::ArrayXd noise = relative * relative * here.col(c).cwiseAbs2().array();
      evidence(n) += lines * (apart / noise.max(floor.col(j)).max(1e-300)).sum();
    }
  }
  return evidence;
}

}  // namespace

std::string measure_next(const Problem& problem, const Found& found, const Diagnosis& diagnosis) {
  if (diagnosis.verdict == Verdict::no_discrepancy || diagnosis.rivals.empty()) return "";
  const auto& best = diagnosis.best;
  const auto& rival = *std::ranges::max_element(diagnosis.rivals, {}, &Explanation::probability);
  const bool is_believed = diagnosis.verdict != Verdict::unexplained;
  if (is_believed && best.probability > std::exp(kConstants.next_enough) * rival.probability) {
    return diagnosis.verdict == Verdict::partial
               ? "no measurement tells more of what is named: mend that first, in the study or on "
                 "the structure, and compare again; what is left may then have a name"
               : "nothing is left to tell apart: mend what is named, in the study or on the "
                 "structure, and compare again";
  }
  return measure_next(problem, found.fits[best.fit], found.fits[rival.fit]);
}

std::string measure_next(const Problem& problem, const Fit& a, const Fit& b) {
  if (only_scales(a) && only_scales(b)) {
    return "weigh the body, or add a known mass to it: modulus, density, thickness and the scale "
           "of all channels differ in that";
  }
  const auto& surface = problem.structure.surface;
  if (surface.count() == 0) return "";
  const auto places = spread_places(surface, kConstants.next_places);
  const Eigen::VectorXd evidence = evidence_at(problem, a, b, places);
  Index best = 0;
  const double most = evidence.maxCoeff(&best);
  if (most < kConstants.next_evidence) {
    return "no further sensor on this surface tells them apart: add a known mass, or look";
  }
  const Eigen::Vector2d place = surface.places.row(places[static_cast<std::size_t>(best)]);
  return fmt::format("a sensor at {}: ln of the Bayes factor up to {:.3g}", place_in_words(place),
                     most);
}

}  // namespace chladni::diagnosis
