#include "modal/control/linear_inputs.h"

#include <utility>
#include <vector>

namespace chladni::modal {

ControlModel under_rates(const ControlModel& model, Eigen::Index known) {
  const auto n = model.space.a.rows();
  const auto& from = model.space;
  ControlModel result = model;
  auto& to = result.space;
  to.a = Eigen::MatrixXd::Zero(n + known, n + known);
  to.b = Eigen::MatrixXd::Zero(n + known, from.b.cols());
  to.c = Eigen::MatrixXd::Zero(from.c.rows(), n + known);
  to.a.topLeftCorner(n, n) = from.a;
  to.a.topRightCorner(n, known) = from.b.leftCols(known);
  to.b.topRows(n) = from.b;
  to.b.topLeftCorner(n, known).setZero();
  to.b.bottomLeftCorner(known, known).setIdentity();
  to.c.leftCols(n) = from.c;
  to.c.rightCols(known) = from.d.leftCols(known);
  to.d.leftCols(known).setZero();
  for (Eigen::Index j = 0; j < known; ++j) {
    result.states.push_back(model.inputs[static_cast<std::size_t>(j)]);
  }
  return result;
}

Eigen::MatrixXd take_inputs_of_rates(Eigen::Index first, const Eigen::VectorXd& fraction,
                                     ControlModel& model) {
  auto& space = model.space;
  const double rate = 1.0 / space.sample_time_s;
  const auto n = space.a.rows();
  const auto q = fraction.size();
  // All states from those that remain and u. In the place of a last rate is u of the sample before.
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd of_u = Eigen::MatrixXd::Zero(n, q);
  std::vector<std::pair<Eigen::Index, Eigen::Index>> before;  // states and their inputs
  for (Eigen::Index j = 0; j < q; ++j) {
    whole.row(first + j).setZero();
    of_u(first + j, j) = 1.0 - fraction(j);
    if (fraction(j) == 0.0) continue;
    const auto last = first + q + std::ssize(before);
    whole(first + j, last) = fraction(j);
    whole(last, last) = -rate;
    of_u(last, j) = rate;
    before.emplace_back(last, j);
  }
  Eigen::MatrixXd a = space.a * whole;
  Eigen::MatrixXd now = space.a * of_u - rate * space.b.leftCols(q);
  Eigen::MatrixXd ahead = rate * space.b.leftCols(q);
  for (const auto& [state, j] : before) {
    a.row(state).setZero();
    now.row(state) = Eigen::RowVectorXd::Unit(q, j);
    ahead.row(state).setZero();
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i < first || i >= first + q) kept.push_back(i);
  }
  const Eigen::MatrixXd c = space.c * whole;
  const Eigen::MatrixXd through = space.c * of_u;
  ahead = ahead(kept, Eigen::all).eval();
  space.a = a(kept, kept);
  space.b = space.b(kept, Eigen::all).eval();
  space.b.leftCols(q) = space.a * ahead + now(kept, Eigen::all);
  space.c = c(Eigen::all, kept);
  space.d.leftCols(q) = space.c * ahead + through;
  model.states.erase(model.states.begin() + first, model.states.begin() + first + q);
  return ahead;
}

}  // namespace chladni::modal
