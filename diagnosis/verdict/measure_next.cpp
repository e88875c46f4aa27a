#include "diagnosis/verdict/measure_next.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/constants.h"

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

// Median of σ / |G|.
double relative_noise(const Observed& observed) {
  std::vector<double> relative;
  for (Index e = 0; e < observed.value.size(); ++e) {
    const double weight = observed.weight.reshaped()(e);
    const double size = std::abs(observed.value.reshaped()(e));
    if (weight > 0.0 && size > 0.0) relative.push_back(std::sqrt(2.0) / (weight * size));
  }
  if (relative.empty()) return kConstants.next_noise;
  const auto middle = relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2);
  std::nth_element(relative.begin(), middle, relative.end());
  return *middle;
}

}  // namespace

std::string measure_next(const Problem& problem, const Fit& a, const Fit& b) {
  if (only_scales(a) && only_scales(b)) {
    return "weigh the body, or add a known mass to it: modulus, density, thickness and the scale "
           "of all channels differ in that";
  }
  const auto& surface = problem.structure.surface;
  if (surface.count() == 0) return "";
  const auto places = spread_places(surface, kConstants.next_places);
  const Observed few = thinned(problem.observed, kConstants.next_lines);
  const auto here = responses_at(problem, a, places, few.omega);
  const auto other = responses_at(problem, b, places, few.omega);
  const double noise = relative_noise(few);
  const double lines =
      static_cast<double>(problem.observed.line_count()) / static_cast<double>(few.line_count());
  Eigen::VectorXd evidence = Eigen::VectorXd::Zero(static_cast<Index>(places.size()));
  const Index q = problem.structure.input_count();
  for (Index n = 0; n < evidence.size(); ++n) {
    for (Index j = 0; j < q; ++j) {
      const Index c = n + evidence.size() * j;
      evidence(n) += ((here.col(c) - other.col(c)).cwiseAbs2().array() /
                      (noise * noise * here.col(c).cwiseAbs2().array()).max(1e-300))
                         .sum() *
                     lines;
    }
  }
  Index best = 0;
  const double most = evidence.maxCoeff(&best);
  if (most < kConstants.next_evidence) {
    return "no further sensor on this surface tells them apart: add a known mass, or look";
  }
  const auto place = surface.places.row(places[static_cast<std::size_t>(best)]);
  return fmt::format("a sensor at ({:.0f}, {:.0f}) mm: ln of the Bayes factor up to {:.3g}",
                     1e3 * place(0), 1e3 * place(1), most);
}

}  // namespace chladni::diagnosis
