// A fit beside the truth that it should have found.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "identification/modal_fit.h"
#include "modal/mac.h"
#include "modal/reduced_model.h"

namespace chladni::identification {

/// The mode of the fit that is like each flexible mode of the truth: within half a half-power
/// bandwidth the one with the largest MAC, each once; −1 where there is none.
inline std::vector<Eigen::Index> partners(const modal::ReducedModel& truth,
                                          const modal::ReducedModel& found) {
  const Eigen::MatrixXd mac = modal::mac(truth.output_shapes, found.output_shapes);
  std::vector<bool> used(static_cast<std::size_t>(found.mode_count()), false);
  std::vector<Eigen::Index> list;
  for (auto m = truth.rigid_count; m < truth.mode_count(); ++m) {
    Eigen::Index best = -1;
    for (auto i = found.rigid_count; i < found.mode_count(); ++i) {
      const double off = std::abs(found.frequency_hz(i) - truth.frequency_hz(m));
      if (used[static_cast<std::size_t>(i)] ||
          off > truth.damping_ratio(m) * truth.frequency_hz(m)) {
        continue;
      }
      if (best < 0 || mac(m, i) > mac(m, best)) best = i;
    }
    if (best >= 0) used[static_cast<std::size_t>(best)] = true;
    list.push_back(best);
  }
  return list;
}

/// Errors of the flexible modes of the truth; NaN where one is missed.
struct FitErrors {
  Eigen::VectorXd frequency_hz, damping;          ///< n: estimate less truth
  Eigen::VectorXd frequency_std_hz, damping_std;  ///< n: as the fit states them
  Eigen::VectorXd mac;                            ///< n: of the output shapes
  Eigen::Index missed = 0;
};

inline FitErrors fit_errors(const modal::ReducedModel& truth, const ModalFit& fit) {
  const auto list = partners(truth, fit.model);
  const auto n = static_cast<Eigen::Index>(list.size());
  const Eigen::VectorXd nan = Eigen::VectorXd::Constant(n, std::nan(""));
  FitErrors errors{nan, nan, nan, nan, nan, 0};
  const Eigen::MatrixXd mac = modal::mac(truth.output_shapes, fit.model.output_shapes);
  for (Eigen::Index r = 0; r < n; ++r) {
    const auto i = list[static_cast<std::size_t>(r)];
    const auto m = truth.rigid_count + r;
    if (i < 0) {
      ++errors.missed;
      continue;
    }
    errors.frequency_hz(r) = fit.model.frequency_hz(i) - truth.frequency_hz(m);
    errors.damping(r) = fit.model.damping_ratio(i) - truth.damping_ratio(m);
    errors.frequency_std_hz(r) = fit.frequency_std_hz(i);
    errors.damping_std(r) = fit.damping_std(i);
    errors.mac(r) = mac(m, i);
  }
  return errors;
}

/// z of V = 2 cost against χ² of the numbers less the parameters.
inline double excess(const ModalFit& fit) {
  const double n = 2.0 * fit.expected_cost;
  return (2.0 * fit.cost - n) / std::sqrt(2.0 * n);
}

/// Sine of the largest angle between the spaces that some columns of two matrices span.
inline double largest_sine(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto basis = [](Eigen::MatrixXd m) {
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      for (int twice = 0; twice < 2; ++twice) {
        m.col(c) -= m.leftCols(c) * (m.leftCols(c).transpose() * m.col(c)).eval();
      }
      m.col(c).normalize();
    }
    return m;
  };
  const Eigen::MatrixXd p = basis(a);
  const Eigen::MatrixXd q = basis(b);
  return (q - p * (p.transpose() * q)).norm();
}

}  // namespace chladni::identification
