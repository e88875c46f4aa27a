#include "diagnosis/search/probe.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr std::size_t kTogether = 16;  // number of probes in one solve

// Meaning of the coordinates of an effect.
struct Roles {
  bool about_zero = false;
  std::vector<Index> sizes, frequencies;
  Index u = -1, v = -1;  // indices of the place
  VectorXd at_rest;      // sizes at 0, the others at the centres of their priors
};

Roles roles_of(const std::vector<Parameter>& parameters) {
  Roles roles;
  roles.about_zero = parameters.front().is_about_zero();
  roles.at_rest = VectorXd::Zero(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < roles.at_rest.size(); ++i) {
    const auto& parameter = parameters[at(i)];
    if (parameter.role == Parameter::Role::place_u) roles.u = i;
    if (parameter.role == Parameter::Role::place_v) roles.v = i;
    if (parameter.is_size) roles.sizes.push_back(i);
    if (parameter.is_size || parameter.is_place()) continue;
    roles.at_rest(i) = parameter.centre;
    if (parameter.role == Parameter::Role::frequency) roles.frequencies.push_back(i);
  }
  return roles;
}

// A very small size; zero if all coordinates are sizes.
double faint(const std::vector<Parameter>& parameters, Index size, Nothing nothing) {
  const auto& parameter = parameters[at(size)];
  if (nothing == Nothing::minus_infinity) return parameter.centre - kConstants.faint_strength;
  if (nothing == Nothing::plus_infinity) return parameter.centre + kConstants.faint_strength;
  const bool others = std::ranges::any_of(parameters, std::not_fn(&Parameter::is_about_zero));
  return others ? kConstants.faint * parameter.width : 0.0;
}

// Interleaves the bits of two numbers in [0, 1]: near numbers are near places.
std::uint64_t along_a_curve(double u, double v) {
  constexpr int kBits = 16;
  const auto a = static_cast<std::uint64_t>(u * ((1 << kBits) - 1));
  const auto b = static_cast<std::uint64_t>(v * ((1 << kBits) - 1));
  std::uint64_t sum = 0;
  for (int bit = 0; bit < kBits; ++bit) {
    sum |= ((a >> bit) & 1U) << (2 * bit);
    sum |= ((b >> bit) & 1U) << (2 * bit + 1);
  }
  return sum;
}

// Distance [m] from which on a place is off the rim: more than any step of its coordinates.
double rim_distance(const std::vector<Parameter>& parameters) {
  double step = 0.0;
  for (const auto& parameter : parameters) {
    if (parameter.is_place()) step = std::max(step, parameter.step);
  }
  return kConstants.rim_steps * step;
}

// True if there is surface at this distance all around a place.
bool is_within(const Surface& surface, const Eigen::Vector2d& place, double distance) {
  for (const double by : {-distance, distance}) {
    for (const auto& axis : {Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY()}) {
      if (!surface.holds(place + by * axis)) return false;
    }
  }
  return true;
}

// Indices of the scan along a curve that passes near places one after the other.
std::vector<Index> in_a_row(const Surface& surface) {
  const Eigen::RowVector2d low = surface.places.colwise().minCoeff();
  const Eigen::RowVector2d size =
      (surface.places.colwise().maxCoeff() - low).cwiseMax(1e-12 * low.norm() + 1e-12);
  std::vector<Index> order(at(surface.count()));
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::uint64_t> along;
  for (Index n = 0; n < surface.count(); ++n) {
    const Eigen::RowVector2d place = (surface.places.row(n) - low).cwiseQuotient(size);
    along.push_back(along_a_curve(place(0), place(1)));
  }
  std::ranges::stable_sort(order, [&](Index a, Index b) { return along[at(a)] < along[at(b)]; });
  return order;
}

// Places of the scan, each for an equal part of the area; off the rim if possible.
std::vector<Index> spread(const Surface& surface, Index count, double from_rim) {
  if (surface.count() == 0) return {};
  const auto order = in_a_row(surface);
  const double share = surface.area.sum() / static_cast<double>(count);
  std::vector<Index> chosen;
  for (const bool off_the_rim : {true, false}) {
    double passed = 0.0;
    for (const auto n : order) {
      passed += surface.area(n);
      const bool next = passed > (static_cast<double>(chosen.size()) + 0.5) * share;
      const Eigen::Vector2d place = surface.places.row(n).transpose();
      if (next && (!off_the_rim || is_within(surface, place, from_rim))) chosen.push_back(n);
    }
    if (!chosen.empty()) break;
  }
  return chosen;
}

// The n-th of a series of frequencies that fill a band evenly in ln.
double frequency_in(const VectorXd& omega, std::size_t n) {
  const double part = std::fmod(0.5 + static_cast<double>(n) / std::numbers::phi, 1.0);
  const double low = std::log(omega(0) / (2.0 * std::numbers::pi));
  const double high = std::log(omega(omega.size() - 1) / (2.0 * std::numbers::pi));
  return low + part * (high - low);
}

// Index of a probe's first attachment and frame in a state that has those of all probes.
struct Hung {
  std::size_t attached = 0, frames = 0;
};

// Adds to `all` what `alone` attaches beyond `base`.
void hang(State& all, const State& alone, const State& base) {
  const auto past = [](const auto& these, const auto& known) {
    return std::span(these).subspan(known.size());
  };
  std::ranges::copy(past(alone.attached, base.attached), std::back_inserter(all.attached));
  std::ranges::copy(past(alone.frames, base.frames), std::back_inserter(all.frames));
}

// The state of one probe with the attachments of all probes; its own are those of `alone`.
State among(const State& all, State alone, const Hung& own, const State& base) {
  const auto put = [](auto all_of, const auto& of, std::size_t known, std::size_t where) {
    std::copy(of.begin() + static_cast<std::ptrdiff_t>(known), of.end(),
              all_of.begin() + static_cast<std::ptrdiff_t>(where));
    return all_of;
  };
  alone.attached = put(all.attached, alone.attached, base.attached.size(), own.attached);
  alone.frames = put(all.frames, alone.frames, base.frames.size(), own.frames);
  return alone;
}

}  // namespace

Probing::Probing(const Problem& problem) : Probing(problem, state_of(problem.structure)) {}

Probing::Probing(const Problem& problem, State state)
    : problem_(problem),
      state_(std::move(state)),
      body_(state_, problem.observed.omega),
      now_(solved(state_, body_)) {}

std::vector<Probe> Probing::probes(const Effect& effect, Index places) const {
  std::vector<Probe> every;
  if (effect.parameters(problem_.structure).empty()) return every;
  for (Index option = 0; option < effect.options(problem_.structure); ++option) {
    std::ranges::move(probes_of_choice(effect, option, places), std::back_inserter(every));
  }
  return every;
}

std::vector<Probe> Probing::probes_of_choice(const Effect& effect, Index option,
                                             Index places) const {
  const auto parameters = effect.parameters(problem_.structure);
  const Roles roles = roles_of(parameters);
  const auto& surface = problem_.structure.surface;
  const bool placed = roles.u >= 0;
  const auto where =
      placed ? spread(surface, places, rim_distance(parameters)) : std::vector<Index>{-1};
  const std::size_t frequencies =
      placed ? kConstants.frequencies_at_place : kConstants.probe_frequencies;
  const std::size_t times = roles.frequencies.empty() ? 1 : frequencies;
  Probe probe{option, roles.at_rest, 0, Nothing::zero};
  std::vector<Probe> probes;
  for (std::size_t n = 0; n < times * where.size(); ++n) {
    if (placed) {
      probe.x(roles.u) = surface.places(where[n % where.size()], 0);
      probe.x(roles.v) = surface.places(where[n % where.size()], 1);
    }
    for (const auto i : roles.frequencies) {
      probe.x(i) = frequency_in(problem_.observed.omega, n);
    }
    if (!roles.about_zero && n == 0) probe.nothing = direction(effect, probe);
    for (const auto size : roles.sizes) {
      probes.push_back(probe);
      probes.back().size = size;
      probes.back().x(size) = faint(parameters, size, probe.nothing);
    }
  }
  return probes;
}

// The infinity toward which the response depends less on the coordinate.
Nothing Probing::direction(const Effect& effect, Probe probe) const {
  const double centre = effect.parameters(problem_.structure).front().centre;
  std::vector<Probe> both(2, probe);
  both[0].x(0) = centre - kConstants.faint_strength;
  both[1].x(0) = centre + kConstants.faint_strength;
  const MatrixXd slopes = size_columns(effect, both);
  return slopes.col(0).norm() < slopes.col(1).norm() ? Nothing::minus_infinity
                                                     : Nothing::plus_infinity;
}

MatrixXd Probing::columns(const Effect& effect, std::span<const Probe> probes) const {
  const auto count = static_cast<Index>(effect.parameters(problem_.structure).size());
  MatrixXd columns(2 * problem_.observed.value.size(), count * static_cast<Index>(probes.size()));
  for (std::size_t first = 0; first < probes.size(); first += kTogether) {
    const auto part = probes.subspan(first, std::min(kTogether, probes.size() - first));
    columns.middleCols(count * static_cast<Index>(first), count * static_cast<Index>(part.size())) =
        columns_together(effect, part, true);
  }
  return columns;
}

MatrixXd Probing::size_columns(const Effect& effect, std::span<const Probe> probes) const {
  if (!probes.empty() && only_hangs(effect, probes.front())) return hung_columns(effect, probes);
  MatrixXd columns(2 * problem_.observed.value.size(), static_cast<Index>(probes.size()));
  for (std::size_t first = 0; first < probes.size(); first += kTogether) {
    const auto part = probes.subspan(first, std::min(kTogether, probes.size() - first));
    columns.middleCols(static_cast<Index>(first), static_cast<Index>(part.size())) =
        columns_together(effect, part, false);
  }
  return columns;
}

MatrixXd Probing::columns_together(const Effect& effect, std::span<const Probe> probes,
                                   bool all) const {
  const auto with = [&](const Probe& probe, const VectorXd& x) {
    State state = state_;
    effect.apply(state, problem_.structure, probe.option, x);
    return state;
  };
  State here = state_;
  std::vector<Hung> hung;
  for (const auto& probe : probes) {
    hung.push_back({here.attached.size(), here.frames.size()});
    hang(here, with(probe, probe.x), state_);
  }
  const bool more =
      here.attached.size() + here.frames.size() > state_.attached.size() + state_.frames.size();
  const Solved together = more ? solved(here, body_) : Solved{};
  const Solved& now = more ? together : now_;
  const auto parameters = effect.parameters(problem_.structure);
  const std::size_t width = all ? parameters.size() : 1;
  MatrixXd columns(2 * problem_.observed.value.size(), static_cast<Index>(width * probes.size()));
  parallel_tasks(width * probes.size(), [&](std::size_t task) {
    const auto& probe = probes[task / width];
    const Index i = all ? static_cast<Index>(task % width) : probe.size;
    const double h = parameters[at(i)].step;
    const VectorXd by = h * VectorXd::Unit(probe.x.size(), i);
    const State minus = among(here, with(probe, probe.x - by), hung[task / width], state_);
    const State plus = among(here, with(probe, probe.x + by), hung[task / width], state_);
    columns.col(static_cast<Index>(task)) =
        weighted(problem_.observed, slope(here, now, minus, plus, 2.0 * h));
  });
  return columns;
}

MatrixXcd Probing::change(const Effect& effect, Index option) const {
  State state = state_;
  effect.apply(state, problem_.structure, option, {});
  const bool records_only = body_.same(state) && state.outputs == state_.outputs &&
                            state.inputs == state_.inputs && state.attached.empty() &&
                            state.frames.empty();
  if (!records_only) return responses(state, problem_.observed.omega) - now_.value;
  MatrixXcd value(now_.value.rows(), now_.value.cols());
  for (Index k = 0; k < value.rows(); ++k) {
    const MatrixXcd structure =
        now_.structure.row(k).reshaped(state.output_count(), state.input_count());
    value.row(k) = recorded(state, structure, Complex(0.0, now_.omega(k))).reshaped().transpose();
  }
  return value - now_.value;
}

MatrixXd Probing::changes(const Effect& effect) const {
  const Index options = effect.options(problem_.structure);
  MatrixXd columns(2 * problem_.observed.value.size(), options);
  parallel_tasks(at(options), [&](std::size_t n) {
    const auto option = static_cast<Index>(n);
    columns.col(option) = weighted(problem_.observed, change(effect, option));
  });
  return columns;
}

}  // namespace chladni::diagnosis
