// The tolerances of a structure as parameters, each of unit normal prior.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/state.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// One thing that may be off: `apply(state, eta)` takes it eta deviations away.
struct Deviation {
  std::string name;  ///< "gain of sensor s1", "frequency of the mode at 183.8 Hz"
  std::function<void(State&, double eta)> apply;
};

/// In the order in which they act; before any effect. Modes up to 1.5 times `high_hz` have their
/// own frequency and damping; neighbours nearer than two half-power bandwidths have a
/// symmetric block of both.
/// The structure must outlive them. Deviations of zero are left out.
[[nodiscard]] std::vector<Deviation> deviations(const Structure& structure,
                                                const Tolerances& tolerances, double high_hz);

/// Smooth fields over the body, Legendre's polynomials of u and v over the cells (columns, each of
/// largest value 1): (1,0), (0,1), (2,0), (1,1), (0,2); without those along a side that the cells
/// do not resolve. b×5 or fewer.
[[nodiscard]] Eigen::MatrixXd smooth_fields(const BodyCells& cells);

/// Σ_c weight_c A_c.
[[nodiscard]] Eigen::MatrixXd sum_of(const std::vector<Eigen::MatrixXd>& cells,
                                     const Eigen::VectorXd& weight);

}  // namespace chladni::diagnosis
