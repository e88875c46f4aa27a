// Kernels of a scaled distance: s = Σ_a (x_a − x'_a)² / l_a².
#pragma once

#include "priors/kernel.h"

namespace chladni::priors {

/// The parameter "length_scale", or one per axis.
[[nodiscard]] std::vector<Hyperparameter> length_scales(Scales scales);

/// The three lengths from the first parameters. There are one or three of them, besides `others`.
[[nodiscard]] Eigen::RowVector3d lengths(const Eigen::VectorXd& parameters, Eigen::Index others);

/// s of every point.
[[nodiscard]] Eigen::ArrayXd scaled_square(const CoordinatesView& points,
                                           const Eigen::RowVector3d& other,
                                           const Eigen::RowVector3d& lengths);

/// Sets the derivatives by the logarithm of each length from dk/ds. They fill the first columns of
/// the gradient, which has `others` more.
void set_length_gradient(const CoordinatesView& points, const Eigen::RowVector3d& other,
                         const Eigen::RowVector3d& lengths, Eigen::Index length_count,
                         const Eigen::ArrayXd& square, const Eigen::ArrayXd& slope,
                         KernelColumn& column, Eigen::Index others = 0);

}  // namespace chladni::priors
