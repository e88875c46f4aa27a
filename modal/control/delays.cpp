// Models with delays, sampled with a zero-order hold.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "dense/linear_systems.h"
#include "modal/control_model.h"

namespace chladni::modal {
namespace {

// Delays in samples: the whole ones below, and what is left of the last one [s].
struct SampledDelay {
  Eigen::VectorXd whole, rest;
};

SampledDelay in_samples(const Eigen::VectorXd& delay, const std::vector<Signal>& channels,
                        const char* side, double sample_time_s) {
  SampledDelay result{Eigen::VectorXd::Zero(delay.size()), Eigen::VectorXd::Zero(delay.size())};
  for (Eigen::Index i = 0; i < delay.size(); ++i) {
    const double samples = delay(i) / sample_time_s;
    require(
        samples <= kMostDelaySamples,
        fmt::format("control model: the delay of {} \"{}\" is {} s, {:.0f} samples at {:.6g} Hz; "
                    "expected at most {} samples",
                    side, channels[static_cast<std::size_t>(i)].name, delay(i), samples,
                    1.0 / sample_time_s, kMostDelaySamples));
    result.whole(i) = std::floor(samples + kSameSample);
    const double rest = samples - result.whole(i);
    if (rest > kSameSample) result.rest(i) = rest * sample_time_s;
  }
  return result;
}

// The state inside a sample, from the state at its beginning, the values that the inputs had before
// their fractional delay is over, and those that they have after it.
struct Inside {
  Eigen::MatrixXd state, before, after;  // n×n, n×q, n×q
};

class Sample {
 public:
  Sample(const StateSpace& space, const Eigen::VectorXd& rest) : space_(space), rest_(rest) {}

  [[nodiscard]] Inside at(double time) {
    const auto n = space_.a.rows();
    const auto q = space_.b.cols();
    Inside inside{over(time).exponential, Eigen::MatrixXd::Zero(n, q), Eigen::MatrixXd::Zero(n, q)};
    for (Eigen::Index j = 0; j < q; ++j) {
      const double until = rest_(j);
      const auto b = space_.b.col(j);
      if (time <= until) {
        inside.before.col(j) = over(time).integral * b;
        continue;
      }
      inside.after.col(j) = over(time - until).integral * b;
      if (until > 0.0) {
        inside.before.col(j) = over(time - until).exponential * (over(until).integral * b).eval();
      }
    }
    return inside;
  }

 private:
  const dense::ExponentialIntegral& over(double time) {
    const auto found = known_.find(time);
    if (found != known_.end()) return found->second;
    return known_.emplace(time, dense::exponential_with_integral(space_.a, time)).first->second;
  }

  const StateSpace& space_;
  const Eigen::VectorXd& rest_;
  std::map<double, dense::ExponentialIntegral> known_;
};

// Columns of inputs that keep their last value as a state.
std::vector<Eigen::Index> held(const Eigen::VectorXd& rest) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index j = 0; j < rest.size(); ++j) {
    if (rest(j) > 0.0) columns.push_back(j);
  }
  return columns;
}

// Rows of C and D of one output at `time` after the beginning of a sample.
void set_output(const StateSpace& from, Eigen::Index i, double time, const Eigen::VectorXd& rest,
                const std::vector<Eigen::Index>& columns, Sample& sample, StateSpace& into) {
  const auto inside = sample.at(time);
  const Eigen::RowVectorXd c = from.c.row(i);
  Eigen::RowVectorXd before = c * inside.before;
  Eigen::RowVectorXd after = c * inside.after;
  for (Eigen::Index j = 0; j < rest.size(); ++j) {
    (time < rest(j) - kSameSample * into.sample_time_s ? before : after)(j) += from.d(i, j);
  }
  into.c.row(i).head(from.a.rows()) = c * inside.state;
  into.c.row(i).tail(static_cast<Eigen::Index>(columns.size())) = before(columns);
  into.d.row(i) = after;
}

StateSpace enlarged(Eigen::Index n, Eigen::Index extra, const StateSpace& like) {
  StateSpace space;
  space.a.setZero(n + extra, n + extra);
  space.b.setZero(n + extra, like.b.cols());
  space.c.setZero(like.c.rows(), n + extra);
  space.d.setZero(like.c.rows(), like.b.cols());
  space.sample_time_s = like.sample_time_s;
  return space;
}

// Registers of input j from state `first` on: the last one drives the model. Returns their number.
Eigen::Index put_input_registers(const StateSpace& from, Eigen::Index j, Eigen::Index first,
                                 Eigen::Index length, StateSpace& to) {
  if (length == 0) return 0;
  const auto last = first + length - 1;
  to.a.block(0, last, from.a.rows(), 1) = from.b.col(j);
  to.c.col(last) = from.d.col(j);
  to.b.col(j).setZero();
  to.d.col(j).setZero();
  to.b(first, j) = 1.0;
  for (auto s = first + 1; s <= last; ++s) to.a(s, s - 1) = 1.0;
  return length;
}

// Registers of output i: the first one takes what the model gives. Returns their number.
Eigen::Index put_output_registers(Eigen::Index i, Eigen::Index first, Eigen::Index length,
                                  StateSpace& to) {
  if (length == 0) return 0;
  const auto last = first + length - 1;
  to.a.row(first) = to.c.row(i);
  to.b.row(first) = to.d.row(i);
  to.c.row(i).setZero();
  to.d.row(i).setZero();
  to.c(i, last) = 1.0;
  for (auto s = first + 1; s <= last; ++s) to.a(s, s - 1) = 1.0;
  return length;
}

void name_registers(const Signal& channel, double count, std::vector<Signal>& states) {
  for (int k = 1; k <= static_cast<int>(count); ++k) {
    states.push_back({fmt::format("{}_delayed_{}", channel.name, k), channel.unit});
  }
}

}  // namespace

ControlModel discretised(const ControlModel& model, double sample_time_s) {
  check(model);
  require(model.space.sample_time_s == 0.0, "control model: the model is discrete already");
  require(std::isfinite(sample_time_s) && sample_time_s > 0.0,
          "control model: the sample time is " + fmt::to_string(sample_time_s) +
              " s; expected a positive number");
  const auto input = in_samples(model.input_delay, model.inputs, "input", sample_time_s);
  const auto output = in_samples(model.output_delay, model.outputs, "output", sample_time_s);
  const auto columns = held(input.rest);
  const auto& from = model.space;
  const auto n = from.a.rows();
  const auto extra = static_cast<Eigen::Index>(columns.size());
  Sample sample(from, input.rest);
  const auto whole = sample.at(sample_time_s);
  ControlModel result = model;
  result.space = enlarged(n, extra, from);
  result.space.sample_time_s = sample_time_s;
  result.space.a.topLeftCorner(n, n) = whole.state;
  result.space.a.topRightCorner(n, extra) = whole.before(Eigen::all, columns);
  result.space.b.topRows(n) = whole.after;
  for (Eigen::Index e = 0; e < extra; ++e) {
    const auto& signal =
        model.inputs[static_cast<std::size_t>(columns[static_cast<std::size_t>(e)])];
    result.space.b(n + e, columns[static_cast<std::size_t>(e)]) = 1.0;
    result.states.push_back({signal.name + "_before", signal.unit});
  }
  result.input_delay = input.whole;
  result.output_delay = output.whole;
  for (Eigen::Index i = 0; i < from.c.rows(); ++i) {
    const bool between = output.rest(i) > 0.0;
    if (between) result.output_delay(i) += 1.0;
    set_output(from, i, between ? sample_time_s - output.rest(i) : 0.0, input.rest, columns, sample,
               result.space);
  }
  return result;
}

ControlModel with_delay_states(const ControlModel& model) {
  check(model);
  require(model.space.sample_time_s > 0.0,
          "control model: a delay of a continuous model has no finite number of states; expected "
          "a discrete model, or a Padé approximation");
  const auto& from = model.space;
  const auto n = from.a.rows();
  const auto extra = static_cast<Eigen::Index>(model.input_delay.sum() + model.output_delay.sum());
  require(n + extra <= kMostDelayStates,
          fmt::format("control model: with its delays as states the model has {} states; expected "
                      "at most {}",
                      n + extra, kMostDelayStates));
  ControlModel result = model;
  auto& to = result.space = enlarged(n, extra, from);
  to.a.topLeftCorner(n, n) = from.a;
  to.b.topRows(n) = from.b;
  to.c.leftCols(n) = from.c;
  to.d = from.d;
  auto next = n;
  for (Eigen::Index j = 0; j < from.b.cols(); ++j) {
    next += put_input_registers(from, j, next, static_cast<Eigen::Index>(model.input_delay(j)), to);
    name_registers(model.inputs[static_cast<std::size_t>(j)], model.input_delay(j), result.states);
  }
  for (Eigen::Index i = 0; i < from.c.rows(); ++i) {
    next += put_output_registers(i, next, static_cast<Eigen::Index>(model.output_delay(i)), to);
    name_registers(model.outputs[static_cast<std::size_t>(i)], model.output_delay(i),
                   result.states);
  }
  result.input_delay.setZero();
  result.output_delay.setZero();
  return result;
}

}  // namespace chladni::modal
