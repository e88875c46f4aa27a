// A block model with blocks of each sort, and data for it.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "base/draw.h"
#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {

inline Eigen::MatrixXd drawn(Eigen::Index rows, Eigen::Index columns, Draw& draw) {
  Eigen::MatrixXd result(rows, columns);
  for (double& value : result.reshaped()) value = draw.normal();
  return result;
}

/// Data and a block model of them.
struct Problem {
  BlockModel model;
  Target target;
};

/// A single mode, a pair and a triple that are coupled, a complex mode, two rigid-body modes; data
/// of nothing in particular.
inline Problem problem(unsigned seed) {
  Draw draw(seed);
  Problem result;
  const Eigen::Index p = 3;
  const Eigen::Index q = 2;
  const auto block = [&](Eigen::Index g, double own) {
    Block one{drawn(p, g, draw), drawn(g, q, draw), {}, {}, false};
    const Eigen::MatrixXd coupled = drawn(g, g, draw);
    one.stiffness = own * own * (Eigen::MatrixXd::Identity(g, g) + 0.02 * coupled);
    one.damping = 0.1 * own * (Eigen::MatrixXd::Identity(g, g) + 0.1 * coupled.transpose());
    return one;
  };
  const auto complex = [&](Eigen::Index rows, Eigen::Index columns) {
    const Eigen::MatrixXd real = drawn(rows, columns, draw);
    return Eigen::MatrixXcd(real + std::complex<double>(0.0, 1.0) * drawn(rows, columns, draw));
  };
  result.model.blocks = {block(1, 0.2), block(2, 0.5), block(3, 0.8)};
  result.model.blocks.push_back({drawn(p, 2, draw), drawn(2, q, draw), Eigen::MatrixXd::Zero(2, 2),
                                 Eigen::MatrixXd::Zero(2, 2), true});
  result.model.blocks.push_back(general_mode({-0.03, 0.6}, complex(p, 1), complex(1, q)));
  result.model.residual = Eigen::MatrixXd::Zero(p, q);
  result.model.delay = 0.3;
  auto& target = result.target;
  target.outputs = p;
  target.inputs = q;
  target.x = Eigen::VectorXd::LinSpaced(60, 0.05, 1.0);
  target.value = 20.0 * drawn(120, p * q, draw);
  target.squared = drawn(60, p * q, draw).cwiseAbs2();
  target.squared(7, 1) = 0.0;
  return result;
}

}  // namespace chladni::identification
