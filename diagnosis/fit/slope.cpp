#include <utility>
#include <vector>

#include "base/index.h"
#include "dense/algebra.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/search/experiments.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

// Nonzero entries of a diagonal difference of matrices.
using DiagonalChange = std::vector<std::pair<Index, double>>;

// Change of stiffness, loss, damping and mass. A diagonal one is some entries. The others are
// multiplied by the solution on all lines, each with its factor, on the side with fewer channels.
class StateChange {
 public:
  StateChange(const State& minus, const State& plus, double step, const Solved& solved)
      : solved_(solved),
        on_left_(solved.left_columns.cols() < solved.right_columns.cols()),
        stiffness_(taken(minus.stiffness, plus.stiffness, step, [](Complex) { return 1.0; })),
        loss_(taken(minus.loss, plus.loss, step, [](Complex) { return Complex(0.0, 1.0); })),
        damping_(taken(minus.damping, plus.damping, step, [](Complex s) { return s; })),
        mass_(taken(minus.mass, plus.mass, step, [](Complex s) { return s * s; })) {}

  // Subtracts the change of the responses on line k, p×q.
  void subtract(Index k, Complex s, MatrixXcd& sum) const {
    subtract(stiffness_, 1.0, k, sum);
    subtract(loss_, Complex(0.0, 1.0), k, sum);
    subtract(damping_, s, k, sum);
    subtract(mass_, s * s, k, sum);
    if (full_.size() == 0) return;
    const Index p = sum.rows();
    const Index q = sum.cols();
    const auto left = solved_.left_columns.middleCols(p * k, p);
    const auto right = solved_.right_columns.middleCols(q * k, q);
    if (on_left_) dense::add_transposed_product(full_.middleCols(p * k, p), right, -1.0, sum);
    if (!on_left_) dense::add_transposed_product(left, full_.middleCols(q * k, q), -1.0, sum);
  }

 private:
  template <typename Factor>
  [[nodiscard]] DiagonalChange taken(const MatrixXd& minus, const MatrixXd& plus, double step,
                                     const Factor& factor) {
    if (minus == plus) return {};
    const MatrixXd difference = (plus - minus) / step;
    DiagonalChange diagonal;
    if (!difference.isDiagonal(0.0)) {
      add(difference, factor);
      return diagonal;
    }
    for (Index i = 0; i < difference.rows(); ++i) {
      if (difference(i, i) != 0.0) diagonal.emplace_back(i, difference(i, i));
    }
    return diagonal;
  }

  template <typename Factor>
  void add(const MatrixXd& difference, const Factor& factor) {
    const auto& columns = on_left_ ? solved_.left_columns : solved_.right_columns;
    MatrixXcd more = product(difference, columns);
    const Index count = columns.cols() / solved_.line_count();
    for (Index k = 0; k < solved_.line_count(); ++k) {
      more.middleCols(count * k, count) *= factor(Complex(0.0, solved_.omega(k)));
    }
    if (full_.size() == 0) {
      full_ = std::move(more);
    } else {
      full_ += more;
    }
  }

  void subtract(const DiagonalChange& diagonal, Complex factor, Index k, MatrixXcd& sum) const {
    for (const auto& [i, by] : diagonal) {
      sum.noalias() -= (factor * by) * (solved_.left(k).col(i) * solved_.right(k).row(i));
    }
  }

  const Solved& solved_;
  bool on_left_;
  MatrixXcd full_;  // r×pK or r×qK: the full changes times the solution; or empty
  DiagonalChange stiffness_, loss_, damping_, mass_;
};

// Rows (columns) of the channels that move, and their change.
struct MovedChannels {
  std::vector<Index> which;
  std::vector<Eigen::VectorXd> by;  // r each
  MovedChannels(const MatrixXd& minus, const MatrixXd& plus, double step) {
    for (Index i = 0; i < minus.rows(); ++i) {
      if (minus.row(i) == plus.row(i)) continue;
      which.push_back(i);
      by.emplace_back((plus.row(i) - minus.row(i)).transpose() / step);
    }
  }
};

class Slope {
 public:
  Slope(const State& at, const Solved& solved, const State& minus, const State& plus, double step)
      : at_(at),
        solved_(solved),
        minus_(minus),
        plus_(plus),
        step_(step),
        body_(minus, plus, step, solved),
        outputs_(minus.outputs, plus.outputs, step),
        inputs_(minus.inputs.transpose(), plus.inputs.transpose(), step),
        residual_moves_(minus.residual != plus.residual),
        paths_move_(!same_paths(minus, at) || !same_paths(plus, at)) {}

  [[nodiscard]] MatrixXcd value() const {
    MatrixXcd result(solved_.line_count(), solved_.value.cols());
    for (Index k = 0; k < result.rows(); ++k) result.row(k) = line(k).reshaped().transpose();
    return result;
  }

 private:
  [[nodiscard]] MatrixXcd line(Index k) const {
    const Complex s(0.0, solved_.omega(k));
    MatrixXcd structure = MatrixXcd::Zero(at_.output_count(), at_.input_count());
    body_.subtract(k, s, structure);
    add_channels(k, structure);
    add_attached(k, s, structure);
    if (residual_moves_) structure += ((plus_.residual - minus_.residual) / step_).cast<Complex>();
    add_frames(s, structure);
    return on_paths(k, s, structure);
  }

  void add_channels(Index k, MatrixXcd& sum) const {
    for (std::size_t n = 0; n < outputs_.which.size(); ++n) {
      sum.row(outputs_.which[n]) += outputs_.by[n].transpose().cast<Complex>() * solved_.right(k);
    }
    for (std::size_t n = 0; n < inputs_.which.size(); ++n) {
      sum.col(inputs_.which[n]) += solved_.left(k) * inputs_.by[n].cast<Complex>();
    }
  }

  void add_attached(Index k, Complex s, MatrixXcd& sum) const {
    const Index all = solved_.to_outputs.cols() / solved_.line_count();
    Index first = all * k;
    for (std::size_t n = 0; n < at_.attached.size(); ++n) {
      const auto& minus = minus_.attached[n];
      const auto& plus = plus_.attached[n];
      const auto& here = at_.attached[n];
      const Index count = here.shapes.cols();
      const auto to_outputs = solved_.to_outputs.middleCols(first, count);
      const auto to_inputs = solved_.to_inputs.middleCols(first, count);
      first += count;
      const Complex by = (dynamic_stiffness(plus, s) - dynamic_stiffness(minus, s)) / step_;
      if (by != 0.0) sum.noalias() -= by * (to_outputs * to_inputs.transpose());
      if (plus.shapes == minus.shapes) continue;
      const MatrixXcd moved = ((plus.shapes - minus.shapes) / step_).cast<Complex>();
      const Complex z = dynamic_stiffness(here, s);
      // The change of the modes far above is left out: they are a correction.
      sum.noalias() -= z * ((solved_.left(k) * moved) * to_inputs.transpose());
      sum.noalias() -= z * (to_outputs * (moved.transpose() * solved_.right(k)));
    }
  }

  void add_frames(Complex s, MatrixXcd& sum) const {
    for (std::size_t n = 0; n < at_.frames.size(); ++n) {
      sum += (frame_response(plus_.frames[n], s) - frame_response(minus_.frames[n], s)) / step_;
    }
  }

  [[nodiscard]] MatrixXcd on_paths(Index k, Complex s, const MatrixXcd& structure) const {
    const auto out = solved_.output_factors.col(k);
    const auto in = solved_.input_factors.col(k);
    const Index p = at_.output_count();
    MatrixXcd value(p, at_.input_count());
    for (Index j = 0; j < value.cols(); ++j) {
      const Index col = at_.input_of[at(j)];
      for (Index i = 0; i < p; ++i) {
        value(i, j) = out(i) * in(j)*structure(at_.output_of[at(i)], col);
      }
    }
    if (paths_move_) add_paths(k, s, value);
    return value;
  }

  // The change of the channels' paths.
  void add_paths(Index k, Complex s, MatrixXcd& value) const {
    const auto at_paths = [&](const State& moved) {
      return std::pair{
          factors_of(moved.output_paths, at_.output_paths, s, solved_.output_factors.col(k)),
          factors_of(moved.input_paths, at_.input_paths, s, solved_.input_factors.col(k))};
    };
    const auto minus = at_paths(minus_);
    const auto plus = at_paths(plus_);
    const Index p = at_.output_count();
    for (Index j = 0; j < value.cols(); ++j) {
      for (Index i = 0; i < p; ++i) {
        const Complex turned =
            (plus.first(i) * plus.second(j) - minus.first(i) * minus.second(j)) / step_;
        value(i, j) +=
            turned * solved_.structure(k, at_.output_of[at(i)] + p * at_.input_of[at(j)]);
      }
    }
  }

  // Factors of `paths`; those that are as `before` are known.
  [[nodiscard]] static Eigen::VectorXcd factors_of(const std::vector<Path>& paths,
                                                   const std::vector<Path>& before, Complex s,
                                                   Eigen::VectorXcd known) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i] != before[i]) known(static_cast<Index>(i)) = factor(paths[i], s);
    }
    return known;
  }

  [[nodiscard]] static bool same_paths(const State& a, const State& b) {
    return a.output_paths == b.output_paths && a.input_paths == b.input_paths;
  }

  const State& at_;
  const Solved& solved_;
  const State &minus_, &plus_;
  double step_;
  StateChange body_;
  MovedChannels outputs_, inputs_;
  bool residual_moves_, paths_move_;
};

}  // namespace

MatrixXcd slope(const State& at, const Solved& solved, const State& minus, const State& plus,
                double step) {
  if (!drifts(at) && !drifts(minus) && !drifts(plus)) {
    return Slope(at, solved, minus, plus, step).value();
  }
  const Index p = at.output_count();
  MatrixXcd value(solved.line_count(), solved.value.cols());
  for (Index j = 0; j < at.input_count(); ++j) {
    const State here = experiment(at, j);
    const Solved own = experiment(solved, at, j);
    value.middleCols(p * j, p) =
        Slope(here, own, experiment(minus, j), experiment(plus, j), step).value();
  }
  return value;
}

}  // namespace chladni::diagnosis
