// The numbers of a measured mode, row by row.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "diagnosis/modes/errors/levels.h"

namespace chladni::diagnosis {

/// Fills the rows of a block from its first to its last.
class Rows {
 public:
  /// @param stiffness, damping  numbers of modes that mix with this one by these
  Rows(Eigen::Index most, Eigen::Index shared, Eigen::Index stiffness, Eigen::Index damping,
       Eigen::Index smooth) {
    block_.error = Eigen::VectorXd::Zero(most);
    block_.noise = Eigen::VectorXd::Zero(most);
    block_.free = Eigen::MatrixXd::Zero(most, kFactors + damping);
    block_.mixed = Eigen::MatrixXd::Zero(most, stiffness);
    block_.shared = Eigen::MatrixXd::Zero(most, shared);
    block_.smooth = Eigen::MatrixXd::Zero(most, 2 * smooth);
    for (Eigen::Index c = 0; c < 2 * smooth; ++c) {
      block_.smooth_of.push_back(
          static_cast<int>(c < smooth ? ErrorClass::smooth_shape : ErrorClass::phase));
    }
  }
  // Adds a number and returns its row.
  Eigen::Index add(double error, double noise, int of, double weight = 1.0) {
    const Eigen::Index row = used_++;
    block_.error(row) = error;
    block_.noise(row) = noise;
    block_.weight.push_back(weight);
    block_.of.push_back(of);
    return row;
  }
  [[nodiscard]] double& free(Eigen::Index row, Eigen::Index column) {
    return block_.free(row, column);
  }
  /// Part of mode number `column` of those that damping mixes.
  [[nodiscard]] double& damped(Eigen::Index row, Eigen::Index column) {
    return block_.free(row, kFactors + column);
  }
  [[nodiscard]] double& mixed(Eigen::Index row, Eigen::Index column) {
    return block_.mixed(row, column);
  }
  [[nodiscard]] double& smooth(Eigen::Index row, Eigen::Index column) {
    return block_.smooth(row, column);
  }
  [[nodiscard]] double& shared(Eigen::Index row, Eigen::Index column) {
    return block_.shared(row, column);
  }
  void doubt(Eigen::Index row, double deviation) {
    block_.noise(row) = std::hypot(block_.noise(row), deviation);
  }
  [[nodiscard]] ModeBlock taken() {
    block_.error.conservativeResize(used_);
    block_.noise.conservativeResize(used_);
    for (auto* columns : {&block_.free, &block_.mixed, &block_.smooth, &block_.shared}) {
      columns->conservativeResize(used_, Eigen::NoChange);
    }
    return std::move(block_);
  }

 private:
  // Complex factors of the shapes at sensors and actuators.
  static constexpr Eigen::Index kFactors = 4;
  ModeBlock block_;
  Eigen::Index used_ = 0;
};

}  // namespace chladni::diagnosis
