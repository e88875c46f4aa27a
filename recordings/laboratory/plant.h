// A structure in the time domain: small independent blocks of states, sampled exactly.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "modal/reduced_model.h"
#include "recordings/rigid_chain.h"

namespace chladni::recordings {

/// What velocities and accelerations take from the forces without any state: D₀ u + D₁ u̇ + D₂ ü.
/// Static flexibility moves at once, so its velocity follows u̇ and its acceleration ü.
struct RatePath {
  Eigen::MatrixXd force, rate, second;  ///< D₀, D₁, D₂: p×q; 0 in rows of displacements
  std::vector<bool> is_displacement;    ///< p
};

/// ẋ_i = A_i x_i + B_i u, y = Σ C_i x_i + D u + the path of rates; p outputs, q forces.
struct Plant {
  struct Block {
    Eigen::MatrixXd a, b, c;  ///< s×s, s×q, p×s
  };
  std::vector<Block> blocks;
  Eigen::MatrixXd d;              ///< p×q
  std::optional<RatePath> rates;  ///< of velocities and accelerations; a loop can take none

  [[nodiscard]] Eigen::Index output_count() const { return d.rows(); }
  [[nodiscard]] Eigen::Index input_count() const { return d.cols(); }
};

/// The model with its modes above `high_hz` at rest: their static flexibility joins the residual
/// one, at channels and dashpots.
/// @throws InvalidInput  the model does not fit together
[[nodiscard]] modal::ReducedModel at_rest_above(const modal::ReducedModel& model, double high_hz);

/// One block of two states for each mode; one block for all states where dashpots couple the modes.
/// `kinds`: the quantity of each output; empty: displacements. Each is (jω)ⁿ of its displacement,
/// residual flexibility included; velocities and accelerations lack what the residual flexibility
/// does to forces of dashpots.
/// @throws InvalidInput  the model does not fit together, the number of kinds differs
[[nodiscard]] Plant plant(const modal::ReducedModel& model,
                          const std::vector<modal::FrfKind>& kinds = {});

/// The chain with its own damping: pole pairs of (M, C, K) [rad/s] up to `highest_hz`. Poles above
/// add their static flexibility. The outputs are displacements.
/// @throws InvalidInput      places off the strip, a chain without flexures (the poles of its
///                           rigid-body modes are not independent)
[[nodiscard]] Plant plant(const ChainMatrices& chain, const Eigen::VectorXd& sensors_m,
                          const Eigen::VectorXd& actuators_m, double highest_hz);

/// x⁺ = A x + B_late u_late + B u. This is exact for u held between samples and a delay of a
/// fraction of a sample: u_late, the previous value, still acts during that fraction.
struct SampledBlock {
  Eigen::MatrixXd a, b, b_late, c;
};

/// @throws InvalidInput  the sample time is not positive, the fraction is not in [0, 1)
[[nodiscard]] std::vector<SampledBlock> sampled(const Plant& plant, double sample_time_s,
                                                double late_fraction = 0.0);

/// The delay as whole samples and a fraction in [0, 1).
struct SampledDelay {
  Eigen::Index whole = 0;
  double fraction = 0.0;
  /// Weights of the held u[k − whole − i], i = 0, 1, 2, that D sees at sample k. They are the mean
  /// over one sample around k (a sensor does not see a jump at one instant), so D has the same
  /// delay as the states.
  Eigen::Vector3d weight = Eigen::Vector3d(0.5, 0.5, 0.0);
};

/// @throws InvalidInput  the delay is negative or more than 10 000 samples
[[nodiscard]] SampledDelay sampled_delay(double delay_s, double sample_time_s);

}  // namespace chladni::recordings
