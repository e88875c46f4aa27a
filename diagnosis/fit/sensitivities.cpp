#include "diagnosis/fit/sensitivities.h"

#include <functional>
#include <mutex>

#include "base/error.h"
#include "base/index.h"
#include "dense/blas.h"
#include "diagnosis/attached/loaded_damping.h"
#include "host/parallel.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// States about a fit, in which one coordinate of a cause or one deviation is moved.
class About {
 public:
  About(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta)
      : problem_(problem), causes_(causes), eta_(eta) {
    for (const auto& cause : causes) changes_.push_back(change_of(cause, problem.structure));
  }

  [[nodiscard]] State here() const { return changed(deviating_by(eta_)); }

  [[nodiscard]] State with_deviation(Index i, double by) const {
    return changed(deviating_by(eta_ + by * VectorXd::Unit(eta_.size(), i)));
  }

  [[nodiscard]] State with_coordinate(const Column& column, double by) const {
    State state = deviating_by(eta_);
    std::vector<Supposed> moved = causes_;
    moved[column.cause].x(column.coordinate) += by;
    for (std::size_t c = 0; c < changes_.size(); ++c) {
      if (c != column.cause) {
        changes_[c](state);
      } else {
        moved[c].effect->apply(state, problem_.structure, moved[c].option, moved[c].x);
      }
    }
    if (state.loaded_damping != 0.0) take_in(loaded_damping(problem_.structure, moved), state);
    return state;
  }

 private:
  [[nodiscard]] State deviating_by(const VectorXd& eta) const {
    return deviating(problem_.structure, problem_.deviations, eta);
  }
  [[nodiscard]] State changed(State state) const {
    for (const auto& change : changes_) change(state);
    if (state.loaded_damping == 0.0 || changes_.empty()) return state;
    std::call_once(once_, [&] { loaded_ = loaded_damping(problem_.structure, causes_); });
    take_in(loaded_, state);
    return state;
  }
  static void take_in(const LoadedDamping& loaded, State& state) {
    const MatrixXd gained = loaded.gained(state.relative_damping);
    if (gained.size() > 0) state.damping += state.loaded_damping * gained;
  }

  const Problem& problem_;
  const std::vector<Supposed>& causes_;
  const VectorXd& eta_;
  std::vector<std::function<void(State&)>> changes_;
  mutable std::once_flag once_;
  mutable LoadedDamping loaded_;  // for the causes, made on first use
};

// Weighted slopes of the responses about a fit.
class WeightedSlopes {
 public:
  WeightedSlopes(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta,
                 const Solved& now)
      : problem_(problem), causes_(causes), now_(now), about_(problem, causes, eta) {}

  // Beside an impossible state the step is shorter, until it does not reach that state.
  [[nodiscard]] VectorXd of_cause(const Column& column) const {
    constexpr int kSteps = 9;
    const auto [minus, plus] = sides_on_surface(problem_.structure, causes_[column.cause], column);
    double h = column.parameter.step;
    for (int step = 1;; ++step, h *= 0.25) {
      try {
        return sloping(about_.with_coordinate(column, -minus * h),
                       about_.with_coordinate(column, plus * h), (minus + plus) * h);
      } catch (const NumericalFailure&) {
        if (step == kSteps) throw;
      }
    }
  }

  [[nodiscard]] VectorXd of_deviation(Index i) const {
    constexpr double kStep = 1e-3;
    return sloping(about_.with_deviation(i, -kStep), about_.with_deviation(i, kStep), 2.0 * kStep);
  }

 private:
  [[nodiscard]] VectorXd sloping(const State& minus, const State& plus, double step) const {
    return weighted(problem_.observed, slope(here_, now_, minus, plus, step));
  }

  const Problem& problem_;
  const std::vector<Supposed>& causes_;
  const Solved& now_;
  About about_;
  State here_ = about_.here();
};

}  // namespace

std::vector<Column> columns_of(const Structure& structure, const std::vector<Supposed>& causes) {
  std::vector<Column> columns;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    Index i = 0;
    for (const auto& parameter : causes[c].effect->parameters(structure)) {
      columns.push_back({c, i++, parameter});
    }
  }
  return columns;
}

std::pair<double, double> sides_on_surface(const Structure& structure, const Supposed& cause,
                                           const Column& column) {
  if (!column.parameter.is_place()) return {1.0, 1.0};
  const auto is_there = [&](double by) {
    Supposed moved = cause;
    moved.x(column.coordinate) += by;
    const auto place = place_of(moved, structure);
    return !place || structure.surface.holds(*place);
  };
  const bool minus = is_there(-column.parameter.step);
  const bool plus = is_there(column.parameter.step);
  if (minus == plus) return {1.0, 1.0};
  return {minus ? 1.0 : 0.0, plus ? 1.0 : 0.0};
}

State state_of(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta) {
  return About(problem, causes, eta).here();
}

MatrixXd sensitivities(const Problem& problem, const std::vector<Supposed>& causes,
                       const VectorXd& eta, const Solved& now) {
  const auto columns = columns_of(problem.structure, causes);
  const auto count = static_cast<Index>(columns.size());
  const WeightedSlopes slopes(problem, causes, eta, now);
  MatrixXd jacobian(2 * problem.observed.value.size(), count + eta.size());
  const dense::OneBlasThread one_thread;
  parallel_tasks(at(jacobian.cols()), [&](std::size_t n) {
    const auto i = static_cast<Index>(n);
    jacobian.col(i) = i < count ? slopes.of_cause(columns[n]) : slopes.of_deviation(i - count);
  });
  return jacobian;
}

MatrixXd sensitivities_of_deviations(const Problem& problem, const std::vector<Supposed>& causes,
                                     const VectorXd& eta, const Solved& now) {
  const WeightedSlopes slopes(problem, causes, eta, now);
  MatrixXd jacobian(2 * problem.observed.value.size(), eta.size());
  const dense::OneBlasThread one_thread;
  parallel_tasks(at(jacobian.cols()), [&](std::size_t n) {
    const auto i = static_cast<Index>(n);
    jacobian.col(i) = slopes.of_deviation(i);
  });
  return jacobian;
}

}  // namespace chladni::diagnosis
