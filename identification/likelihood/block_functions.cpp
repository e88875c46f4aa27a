#include "identification/likelihood/block_functions.h"

#include <Eigen/LU>
#include <complex>

#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Index own_count(const Block& block) {
  return parameter_count(block) - block.size() * (block.left.rows() + block.right.cols());
}

// H and its derivatives at s: one column of g² entries for each.
void evaluate(const Block& block, Complex s, Eigen::MatrixXcd& result) {
  const auto g = block.size();
  if (block.rigid) {
    result.col(0) = (Eigen::MatrixXcd::Identity(g, g) / (s * s)).reshaped();
    return;
  }
  if (block.general) {
    const Complex from = s - block.pole.real();
    const Complex over = 1.0 / (from * from + block.pole.imag() * block.pole.imag());
    Eigen::Matrix2cd h;
    h << from, block.pole.imag(), -block.pole.imag(), from;
    h *= over;
    const Eigen::Matrix2cd turn{{0.0, 1.0}, {-1.0, 0.0}};
    result.col(0) = h.reshaped();
    result.col(1) = (h * h).eval().reshaped();
    result.col(2) = (h * turn * h).eval().reshaped();
    return;
  }
  const Eigen::MatrixXcd dynamic = s * s * Eigen::MatrixXcd::Identity(g, g) +
                                   s * block.damping.cast<Complex>() +
                                   block.stiffness.cast<Complex>();
  const Eigen::MatrixXcd h = dynamic.inverse();
  result.col(0) = h.reshaped();
  for (Index b = 0; b < g; ++b) {
    for (Index a = 0; a < g; ++a) {
      const auto t = 1 + a + g * b;
      result.col(t) = -(h.col(a) * h.row(b)).eval().reshaped();
      result.col(t + g * g) = s * result.col(t);
    }
  }
}

Eigen::MatrixXd values_of_single_mode(const Block& block, const Eigen::VectorXd& x) {
  const auto lines = x.size();
  Eigen::MatrixXd result(2 * lines, 3);
  for (Index k = 0; k < lines; ++k) {
    const Complex s(0.0, x(k));
    const Complex h = 1.0 / (s * s + s * block.damping(0, 0) + block.stiffness(0, 0));
    const Eigen::RowVector3cd row(h, -h * h, -s * h * h);
    result.row(k) = row.real();
    result.row(lines + k) = row.imag();
  }
  return result;
}

}  // namespace

std::vector<BlockFunctions> functions_of(const BlockModel& model, Index outputs, Index inputs) {
  std::vector<BlockFunctions> all;
  Index function = 0;
  Index mode = 0;
  Index parameter = 0;
  for (const auto& block : model.blocks) {
    BlockFunctions one{.size = block.size(), .kinds = 1 + own_count(block), .first = function};
    one.mode = mode;
    one.left = parameter;
    one.right = one.left + one.size * outputs;
    one.own = one.right + one.size * inputs;
    function += one.kinds * one.size * one.size;
    mode += one.size;
    parameter += parameter_count(block);
    all.push_back(one);
  }
  return all;
}

Index function_count(const std::vector<BlockFunctions>& all) {
  const auto& last = all.back();
  return last.first + last.kinds * last.size * last.size;
}

Eigen::MatrixXd function_values(const Block& block, const Eigen::VectorXd& x) {
  const auto g = block.size();
  if (!block.rigid && !block.general && g == 1) return values_of_single_mode(block, x);
  const auto lines = x.size();
  Eigen::MatrixXcd at(g * g, 1 + own_count(block));
  Eigen::MatrixXd result(2 * lines, at.size());
  for (Index k = 0; k < lines; ++k) {
    evaluate(block, Complex(0.0, x(k)), at);
    const auto row = at.reshaped().transpose();
    result.row(k) = row.real();
    result.row(lines + k) = row.imag();
  }
  return result;
}

}  // namespace chladni::identification
