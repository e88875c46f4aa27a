// Plates for the interpolation of shapes: a believed model and a measured truth.
#pragma once

#include "priors/interpolator.h"
#include "simulators/plates/kirchhoff_plate.h"

namespace chladni::simulators {

/// Places in the plane z = 0, measured along z. The shapes come from `modes`. The harmonics come
/// from the rectangle without cut-outs: cos cos of up to nine half waves along each side.
/// @throws InvalidInput  a place is not on the plate
[[nodiscard]] priors::Places plate_places(const PlateModes& modes, const Eigen::MatrixX2d& places);

/// `believed` on the surface of another plate or of its own plate. The caller must first remove
/// points of `surface` that the model lacks.
[[nodiscard]] priors::Simulation plate_simulation(const PlateModes& believed,
                                                  const PlateSurface& surface);

/// The factor that makes the root mean square over the surface 1, per column.
[[nodiscard]] Eigen::VectorXd unit_rms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area);

/// The result of a simulated test: flexible modes 1 to `count` of the truth, each of rms 1 on its
/// surface, at `places`, with independent normal noise of deviation `noise`. Also the truth without
/// noise on the surface.
struct PlateTest {
  priors::MeasuredShapes measured;  ///< its places have the shapes of `believed`
  Eigen::MatrixXd truth;            ///< N×count, on `surface`
};
[[nodiscard]] PlateTest plate_test(const PlateModes& truth, const PlateModes& believed,
                                   const PlateSurface& surface, const Eigen::MatrixX2d& places,
                                   int count, double noise, unsigned seed);

}  // namespace chladni::simulators
