// A small plate that a diagnosis starts from, quick to make.
#pragma once

#include "diagnosis/fit/responses.h"
#include "diagnosis/observed.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/plates/ritz_structure.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {

/// Degree 8, 6×6 cells.
[[nodiscard]] inline Structure plate_of(Eigen::Index modes, int scan = 11) {
  simulators::RitzStructureOptions options;
  options.modes = modes;
  options.cells = 6;
  options.fine = 12;
  options.scan = scan;
  return simulators::ritz_structure(simulators::believed_table(8), simulators::table_channels(),
                                    options);
}

/// The plate has 24 modes.
[[nodiscard]] inline const Structure& small_plate() {
  static const Structure made = plate_of(24);
  return made;
}

[[nodiscard]] inline Eigen::VectorXd some_lines() {
  return 2.0 * 3.14159265358979 * Eigen::VectorXd::LinSpaced(23, 31.0, 893.0);
}

/// A plate in that state, on some_lines(): each response weighted by `weight` over its size.
[[nodiscard]] inline Observed observed_in(const State& state, double weight) {
  Observed observed;
  observed.outputs = state.output_count();
  observed.inputs = state.input_count();
  observed.omega = some_lines();
  observed.value = responses(state, observed.omega);
  observed.weight = weight * observed.value.cwiseAbs().cwiseInverse();
  return observed;
}

/// The same with normal noise of the variances that its weights state.
[[nodiscard]] inline Observed with_noise(Observed observed, unsigned seed) {
  simulators::Dice dice(seed);
  Eigen::MatrixXcd noise(observed.value.rows(), observed.value.cols());
  noise.real() = dice.normal(noise.rows(), noise.cols());
  noise.imag() = dice.normal(noise.rows(), noise.cols());
  observed.value += noise.cwiseQuotient(observed.weight.cast<std::complex<double>>());
  return observed;
}

}  // namespace chladni::diagnosis
