#include "identification/likelihood/uncertainty/untold.h"

#include <limits>

#include "identification/likelihood/general_mode.h"

namespace chladni::identification {
namespace {

constexpr double kUntold = std::numeric_limits<double>::infinity();

// The rules of ModalFit for a block that is seen in one part.
Block ruled(const Block& block) {
  if (block.general) return turned(block);
  Block result = balanced(block);
  Eigen::Index largest = 0;
  result.left.col(0).cwiseAbs().maxCoeff(&largest);
  if (result.left(largest, 0) < 0.0) {
    result.left *= -1.0;
    result.right *= -1.0;
  }
  return result;
}

// Infinite variances, and no covariance with the others.
void mark_rows(const std::vector<Eigen::Index>& rows, Eigen::MatrixXd& covariance) {
  for (const auto i : rows) {
    covariance.row(i).setZero();
    covariance.col(i).setZero();
    covariance(i, i) = kUntold;
  }
}

// The entries of (L, R) of a mode at some channels, from `first` on.
void add_rows(const ConnectedChannels& part, Eigen::Index outputs, Eigen::Index first,
              std::vector<Eigen::Index>& rows) {
  for (const auto i : part.outputs) rows.push_back(first + i);
  for (const auto j : part.inputs) rows.push_back(first + outputs + j);
}

void mark_complex(const ConnectedChannels& part, Eigen::Index m, ComplexShapes& shapes) {
  const auto p = shapes.outputs.rows();
  const auto both = p + shapes.inputs.cols();
  for (const auto i : part.outputs) {
    shapes.output_real_std(i, m) = shapes.output_imaginary_std(i, m) = kUntold;
  }
  for (const auto j : part.inputs) {
    shapes.input_real_std(m, j) = shapes.input_imaginary_std(m, j) = kUntold;
  }
  std::vector<Eigen::Index> rows;
  add_rows(part, p, 2, rows);
  add_rows(part, p, 2 + both, rows);
  mark_rows(rows, shapes.covariance[static_cast<std::size_t>(m)]);
}

void mark_rigid(const ConnectedChannels& part, Eigen::Index a, ModalFit& fit) {
  const auto p = fit.model.output_count();
  const auto g = fit.model.rigid_count;
  std::vector<Eigen::Index> rows;
  for (const auto i : part.outputs) rows.push_back(i + p * a);
  for (const auto j : part.inputs) rows.push_back(g * p + a + g * j);
  mark_rows(rows, fit.rigid_covariance);
}

void mark_mode(const ConnectedChannels& part, Eigen::Index m, ModalFit& fit) {
  for (const auto i : part.outputs) fit.output_std(i, m) = kUntold;
  for (const auto j : part.inputs) fit.input_std(m, j) = kUntold;
  std::vector<Eigen::Index> rows;
  add_rows(part, fit.model.output_count(), 2, rows);
  mark_rows(rows, fit.mode_covariance[static_cast<std::size_t>(m)]);
  if (fit.complex) mark_complex(part, m, *fit.complex);
  if (m < fit.model.rigid_count) mark_rigid(part, m, fit);
}

}  // namespace

Block block_at(const Block& block, const ConnectedChannels& part) {
  Block result = block;
  result.left.setZero();
  result.right.setZero();
  result.left(part.outputs, Eigen::all) = block.left(part.outputs, Eigen::all);
  result.right(Eigen::all, part.inputs) = block.right(Eigen::all, part.inputs);
  return result;
}

Block balanced_in_parts(const Block& block, const Parts& parts) {
  Block result = block;
  if (!block.general && block.size() > 1) return result;
  for (const auto& part : parts) {
    Block own = block_at(block, part);
    if (own.left.norm() > 0.0 && own.right.norm() > 0.0) {
      own = ruled(own);
    } else {
      own.left.setZero();
      own.right.setZero();
    }
    result.left(part.outputs, Eigen::all) = own.left(part.outputs, Eigen::all);
    result.right(Eigen::all, part.inputs) = own.right(Eigen::all, part.inputs);
  }
  return result;
}

std::size_t home_part(const Block& block, const Eigen::MatrixXd& weight, const Parts& parts) {
  const Eigen::MatrixXd squared = block.general
                                      ? Eigen::MatrixXd(block.left.rowwise().squaredNorm() *
                                                        block.right.colwise().squaredNorm())
                                      : Eigen::MatrixXd((block.left * block.right).cwiseAbs2());
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const auto& [outputs, inputs] = parts[n];
    const double seen = squared(outputs, inputs).cwiseProduct(weight(outputs, inputs)).sum();
    if (seen > most) {
      most = seen;
      best = n;
    }
  }
  return best;
}

void mark_other_parts(const Parts& parts, const std::vector<std::size_t>& home, ModalFit& fit) {
  for (std::size_t m = 0; m < home.size(); ++m) {
    for (std::size_t n = 0; n < parts.size(); ++n) {
      if (n != home[m]) mark_mode(parts[n], static_cast<Eigen::Index>(m), fit);
    }
  }
}

void mark_unmeasured(const Eigen::MatrixXd& weight, ModalFit& fit) {
  fit.residual_std = (weight.array() > 0.0).select(fit.residual_std, kUntold);
  ConnectedChannels none;
  for (Eigen::Index i = 0; i < weight.rows(); ++i) {
    if (!(weight.row(i).sum() > 0.0)) none.outputs.push_back(i);
  }
  for (Eigen::Index j = 0; j < weight.cols(); ++j) {
    if (!(weight.col(j).sum() > 0.0)) none.inputs.push_back(j);
  }
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) mark_mode(none, m, fit);
}

}  // namespace chladni::identification
