// What the tests of gain_match share: cases, their truth at the rows of a match.
#pragma once

#include <Eigen/Dense>

#include "identification/gain_match.h"
#include "simulators/frf_cases.h"
#include "tests/identification/known_fit.h"

namespace chladni::identification {

using simulators::FrfFaults;

inline FrfFaults quiet() {
  FrfFaults faults;
  faults.noisy = false;
  return faults;
}

inline GainMatchOptions with_pairs(const simulators::FrfCase& made) {
  GainMatchOptions options;
  options.pairs = collocated_pairs(made.measured.outputs, made.measured.inputs, 1e-6);
  return options;
}

inline GainMatch matched(const simulators::FrfCase& made, const ModalFit& fit,
                         const GainMatchOptions& options) {
  return gain_match(fit, made.measured.outputs, made.measured.inputs, options);
}

// The truth at the rows of a match.
inline Eigen::MatrixXd truth_at(const GainMatch& match, const modal::ReducedModel& truth) {
  Eigen::MatrixXd shapes(std::ssize(match.rows), truth.mode_count());
  for (Eigen::Index k = 0; k < shapes.rows(); ++k) {
    const auto& row = match.rows[static_cast<std::size_t>(k)];
    shapes.row(k) = row.actuator ? truth.input_shapes.col(row.channel).transpose().eval()
                                 : truth.output_shapes.row(row.channel).eval();
  }
  return shapes;
}

inline RigidGeometry geometry_of(const simulators::FrfCase& made, RigidMotion motion) {
  const auto places = [](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixX3d all(std::ssize(channels), 3);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      all.row(static_cast<Eigen::Index>(i)) = channels[i].position->transpose();
    }
    return all;
  };
  RigidGeometry geometry;
  geometry.outputs = rigid_directions(places(made.measured.outputs), motion);
  geometry.inputs = rigid_directions(places(made.measured.inputs), motion);
  return geometry;
}

inline const Eigen::VectorXd kScales{{3.0, -0.2, 1e4, 1.0, -7.0}};

// The thesis' 2-by-4 system (5.2.4): sensors 2 and 5, actuators 1 to 4, the pair at 2.
inline simulators::FrfCase two_by_four(const FrfFaults& faults = quiet()) {
  return part(simulators::beam5x5(faults), {1, 4}, {0, 1, 2, 3});
}

}  // namespace chladni::identification
