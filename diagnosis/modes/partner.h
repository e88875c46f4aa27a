// A measured mode and the mode of a hypothesis that it is compared with.
#pragma once

#include <vector>

#include "diagnosis/measured_modes.h"
#include "diagnosis/modes/recorded_modes.h"

namespace chladni::diagnosis {

/// Root mean square of the structure's own flexible modes over all channels of a side [kg^-1/2].
struct ShapeUnits {
  double outputs = 1.0, inputs = 1.0;
};
[[nodiscard]] ShapeUnits shape_units(const Structure& structure);

/// One side of a measured mode: the channels that have a value.
struct PartnerSide {
  std::vector<Eigen::Index> rows;
  /// Shapes of the model as they are recorded, and as measured, each of root mean square 1. The
  /// phase is that of the model.
  Eigen::VectorXd model;
  Eigen::VectorXcd measured;
  Eigen::VectorXd noise;     ///< deviations of `measured`
  Eigen::VectorXd recorded;  ///< `model` over the shape behind it [kg^1/2]
  Eigen::VectorXd weight;    ///< an error of ShapeUnits in the shape behind each value
  /// Measured over model: ratio of the sizes, and the phase of least squares.
  std::complex<double> factor{1.0, 0.0};

  [[nodiscard]] Eigen::Index count() const { return model.size(); }
  /// Two or more values: their ratios tell a shape.
  [[nodiscard]] bool is_shape() const { return count() > 1; }
  /// Root mean square of `weight`: large where these channels hardly see the mode.
  [[nodiscard]] double blindness() const;
};

/// Mode k of a model beside measured mode i.
struct Partner {
  /// n: the part of each mode of the model, of norm 1. Neighbours of mode k have the parts that fit
  /// the measured shape best, the less the farther they are; all others have 0.
  Eigen::VectorXd parts;
  PartnerSide sensors, actuators;

  /// MAC at the sensors times MAC at the actuators; 1 where no shape was measured.
  [[nodiscard]] double mac() const;
  /// The same for pairing: a side that hardly sees the mode has a value between that of a partner
  /// and that of a stranger.
  [[nodiscard]] double likeness() const;
};

/// How well the channels of one side see a mode, from 1 down to 0 where they hardly do.
/// @param shape  of the mode at the channels [kg^-1/2]; without channels it is 1
/// @param unit  ShapeUnits of the side
[[nodiscard]] double visibility(const Eigen::VectorXd& shape, double unit);

/// Channels that have a value in measured mode i.
[[nodiscard]] std::vector<Eigen::Index> rows_with_values(const Eigen::MatrixXcd& shapes,
                                                         Eigen::Index i);
/// The phase without which a shape is as real as it can be, up to its sign.
[[nodiscard]] std::complex<double> phase_of(const Eigen::VectorXcd& shape);

/// Deviation of the part that a mode has in another one, `apart` in ln f: as modes of the same
/// frequency turn into each other. It falls to 0 at Constants::neighbours, so that no part begins
/// at once.
[[nodiscard]] double part_deviation(double apart);

/// Mode k, then its neighbours, as far as the channels can tell them apart.
[[nodiscard]] std::vector<Eigen::Index> span_of(const MeasuredModes& measured,
                                                const RecordedModes& model, Eigen::Index i,
                                                Eigen::Index k);

/// @param span  of mode k, which comes first
[[nodiscard]] Partner partner(const MeasuredModes& measured, const RecordedModes& model,
                              const ShapeUnits& units, Eigen::Index i,
                              const std::vector<Eigen::Index>& span);

}  // namespace chladni::diagnosis
