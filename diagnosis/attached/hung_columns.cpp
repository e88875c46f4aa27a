// Probes of effects that only attach something: to first order each changes −Δ(s) to fromᵀ.
#include <algorithm>
#include <complex>
#include <span>
#include <vector>

#include "base/index.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/search/probe.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

// One attachment, with its size a step smaller and a step larger; its displacements start at column
// `first`.
struct Hanging {
  std::size_t probe = 0;
  Attached minus, plus;
  Index first = 0;
};

bool same(const std::vector<Path>& a, const std::vector<Path>& b) {
  return std::ranges::equal(a, b, [](const Path& one, const Path& other) {
    return one.gain == other.gain && one.delay == other.delay && one.lag == other.lag &&
           one.derivative == other.derivative;
  });
}

// The attachments of the probes on a state. Each probe must attach at least one.
std::vector<Hanging> hanging(const Structure& structure, const State& state, const Effect& effect,
                             std::span<const Probe> probes) {
  const auto parameters = effect.parameters(structure);
  std::vector<Hanging> all;
  Index count = 0;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const auto& probe = probes[n];
    const auto moved = [&](double by) {
      State with = state;
      auto x = probe.x;
      x(probe.size) += by * parameters[at(probe.size)].step;
      effect.apply(with, structure, probe.option, x);
      return with.attached;
    };
    const auto minus = moved(-1.0);
    const auto plus = moved(1.0);
    for (std::size_t a = state.attached.size(); a < plus.size(); ++a) {
      all.push_back({n, minus[a], plus[a], count});
      count += plus[a].shapes.cols();
    }
  }
  return all;
}

// Responses between channels and displacements, p×D and q×D on line k, with the modes far above.
struct Touching {
  MatrixXcd to, from;       // D×pK, D×qK
  MatrixXd to_up, from_up;  // p×D, q×D
};

Touching touching(const State& state, const Solved& now, const std::vector<Hanging>& all,
                  Index count) {
  MatrixXd shapes(state.mode_count(), count);
  MatrixXd upper = MatrixXd::Zero(state.output_upper.cols(), count);
  for (const auto& one : all) {
    const Index d = one.plus.shapes.cols();
    shapes.middleCols(one.first, d) = one.plus.shapes;
    if (one.plus.upper.rows() == upper.rows() && upper.rows() > 0) {
      upper.middleCols(one.first, d) = one.plus.upper;
    }
  }
  const MatrixXd rows = shapes.transpose();
  return {product(rows, now.left_columns), product(rows, now.right_columns),
          state.output_upper * upper, state.input_upper * upper};
}

}  // namespace

bool Probing::only_hangs(const Effect& effect, const Probe& probe) const {
  State state = state_;
  effect.apply(state, problem_.structure, probe.option, probe.x);
  return state.attached.size() > state_.attached.size() &&
         state.frames.size() == state_.frames.size() && body_.same(state) &&
         state.outputs == state_.outputs && state.inputs == state_.inputs &&
         same(state.output_paths, state_.output_paths) &&
         same(state.input_paths, state_.input_paths);
}

MatrixXd Probing::hung_columns(const Effect& effect, std::span<const Probe> probes) const {
  const auto parameters = effect.parameters(problem_.structure);
  const auto all = hanging(problem_.structure, state_, effect, probes);
  const Index count = all.back().first + all.back().plus.shapes.cols();
  const auto [to, from, to_up, from_up] = touching(state_, now_, all, count);
  const Index p = state_.output_count();
  const Index q = state_.input_count();
  std::vector<MatrixXcd> change(probes.size(), MatrixXcd::Zero(now_.line_count(), p * q));
  for (Index k = 0; k < now_.line_count(); ++k) {
    const Complex s(0.0, now_.omega(k));
    const MatrixXcd paths = recorded(state_, MatrixXcd::Ones(p, q), s);
    for (const auto& one : all) {
      const double step = 2.0 * parameters[at(probes[one.probe].size)].step;
      const Complex by = (dynamic_stiffness(one.minus, s) - dynamic_stiffness(one.plus, s)) / step;
      for (Index d = one.first; d < one.first + one.plus.shapes.cols(); ++d) {
        const Eigen::VectorXcd out = to.row(d).segment(p * k, p).transpose() + to_up.col(d);
        const Eigen::VectorXcd in = from.row(d).segment(q * k, q).transpose() + from_up.col(d);
        const MatrixXcd shown =
            (by * out * in.transpose())(state_.output_of, state_.input_of).cwiseProduct(paths);
        change[one.probe].row(k) += shown.reshaped().transpose();
      }
    }
  }
  MatrixXd columns(2 * problem_.observed.value.size(), static_cast<Index>(probes.size()));
  for (std::size_t n = 0; n < probes.size(); ++n) {
    columns.col(static_cast<Index>(n)) = weighted(problem_.observed, change[n]);
  }
  return columns;
}

}  // namespace chladni::diagnosis
