#include "diagnosis/search/experiments.h"

namespace chladni::diagnosis {

using Eigen::Index;

bool drifts(const State& state) {
  return state.stiffening.size() > 0 && !state.stiffening.isZero(0.0);
}

State experiment(const State& state, Index j) {
  const Index input = state.input_of[static_cast<std::size_t>(j)];
  State one = state;
  one.inputs = state.inputs.col(input);
  one.residual = state.residual.col(input);
  if (state.input_upper.rows() > 0) one.input_upper = state.input_upper.row(input);
  for (auto& frame : one.frames) {
    frame.from_inputs = Eigen::VectorXd::Constant(1, frame.from_inputs(input));
  }
  one.input_paths = {state.input_paths[static_cast<std::size_t>(j)]};
  one.input_of = {0};
  one.stiffening.resize(0);
  if (state.stiffening.size() > 0) scale_stiffness(one, 1.0 + state.stiffening(j));
  return one;
}

Solved experiment(const Solved& solved, const State& state, Index j) {
  if (!solved.experiments.empty()) return solved.experiments[static_cast<std::size_t>(j)];
  const Index input = state.input_of[static_cast<std::size_t>(j)];
  const Index p = state.output_count();
  const Index q = state.input_count();
  Solved one;
  one.omega = solved.omega;
  one.left_columns = solved.left_columns;
  one.right_columns.resize(solved.right_columns.rows(), solved.line_count());
  for (Index k = 0; k < solved.line_count(); ++k) {
    one.right_columns.col(k) = solved.right_columns.col(q * k + input);
  }
  one.to_outputs = solved.to_outputs;
  one.to_inputs = solved.to_inputs.row(input);
  one.output_factors = solved.output_factors;
  one.input_factors = solved.input_factors.row(j);
  one.structure = solved.structure.middleCols(p * input, p);
  one.value = solved.value.middleCols(p * j, p);
  return one;
}

}  // namespace chladni::diagnosis
