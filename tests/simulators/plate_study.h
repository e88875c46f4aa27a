// Plates as the interpolation of shapes sees them: a model that is believed, a truth that is
// measured.
#pragma once

#include "priors/interpolator.h"
#include "simulators/kirchhoff_plate.h"

namespace chladni::simulators {

/// Places in the plane z = 0, measured along z; `modes` gives the shapes, the rectangle (cut-outs
/// not known) the harmonics, cos cos of up to nine half waves along each side.
/// @throws InvalidInput  a place is not on the plate
[[nodiscard]] priors::Places plate_places(const PlateModes& modes, const Eigen::MatrixX2d& places);

/// `believed` seen on the surface of another plate (or its own): with points of `surface` that the
/// model lacks left out beforehand.
[[nodiscard]] priors::Simulation plate_simulation(const PlateModes& believed,
                                                  const PlateSurface& surface);

/// The factor that makes the root mean square over the surface 1, per column.
[[nodiscard]] Eigen::VectorXd unit_rms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area);

/// What a test would bring: flexible modes 1 to `count` of the truth, each of rms 1 on its surface,
/// at `places`, with independent normal noise of deviation `noise`; and the truth without noise on
/// the surface.
struct PlateTest {
  priors::MeasuredShapes measured;  ///< its places have the shapes of `believed`
  Eigen::MatrixXd truth;            ///< N×count, on `surface`
};
[[nodiscard]] PlateTest plate_test(const PlateModes& truth, const PlateModes& believed,
                                   const PlateSurface& surface, const Eigen::MatrixX2d& places,
                                   int count, double noise, unsigned seed);

}  // namespace chladni::simulators
