// What the errors of a fit leave open of each mode, in the scale of a match.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/gain_match.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// The relative error a of all shapes of a mode at once, as the sensors' rows tell it.
struct ScaleSpread {
  double deviation = 0.0;          ///< of a; 0: not followed
  Eigen::Vector2d pole{0.0, 0.0};  ///< covariances of a with ω and ζ
  Eigen::RowVectorXd input;        ///< q: with the input vector
};

/// Covariances of ω, ζ, the input vector with the signs of the data, and the scale of the shapes.
struct ModeSpread {
  Eigen::Matrix2d pole = Eigen::Matrix2d::Zero();
  Eigen::RowVectorXd input;  ///< q: variances
  Eigen::MatrixX2d mixed;    ///< q×2: covariances with ω and ζ
  ScaleSpread scale;
};

/// One of each mode; those of modes at 0 Hz mean nothing (rigid_variance).
[[nodiscard]] std::vector<ModeSpread> mode_spreads(const ModalFit& fit, const GainMatch& match);

}  // namespace chladni::identification
