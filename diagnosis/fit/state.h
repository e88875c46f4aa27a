// The structure and its channels under a hypothesis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// An attachment. Force over displacement is k + c s + m s², or m s² (k + c s) / (m s² + c s + k)
/// for a mass carried on a spring and dashpot.
struct Attached {
  Eigen::MatrixXd shapes;  ///< r×d: shapes of the d displacements it acts on, all alike
  Eigen::MatrixXd upper;   ///< u×d: the same for the modes above, which yield statically; or empty
  double mass = 0.0, damping = 0.0, stiffness = 0.0;  ///< [kg], [N s/m], [N/m]
  bool carried = false;
};

/// A moving support: a mass on a spring and a dashpot. The inputs push it back, and the outputs are
/// measured relative to it. It adds c(s) to_outputs from_inputs to the responses.
struct Frame {
  Eigen::VectorXd to_outputs, from_inputs;  ///< p, q [1]
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
};

/// Path between a channel of the structure and its record.
struct Path {
  double gain = 1.0;
  double delay = 0.0;       ///< [s]
  double lag = 0.0;         ///< [s]: 1 / (1 + s lag)
  double derivative = 0.0;  ///< factor s to this power; −1: integrated
  bool operator==(const Path&) const = default;
};

/// K + jH + s D + s² M in the r modes of the structure, its channels and its attachments. Every
/// effect and every tolerance changes one of these members.
struct State {
  Eigen::MatrixXd stiffness, loss, damping, mass;  ///< r×r [s^-2], [s^-2], [1/s], [1]
  /// Parts of stiffness, damping and mass that are not the body's own: r×r, or 0×0 for none.
  Eigen::MatrixXd springs, dashpots, masses;
  Eigen::MatrixXd outputs, inputs;            ///< p×r, r×q [kg^-1/2]
  Eigen::MatrixXd residual;                   ///< p×q [m/N]
  Eigen::MatrixXd output_upper, input_upper;  ///< p×u, q×u: ChannelSide::upper
  std::vector<Attached> attached;
  std::vector<Frame> frames;
  std::vector<Path> output_paths, input_paths;  ///< p, q
  /// Interpolates between two readings of the damping ratios. 0: they belong to the body alone. 1:
  /// they belong to the modes with all attachments. The change (loaded_damping.h) enters `damping`
  /// after all causes are known.
  double loaded_damping = 0.0;
  /// r, or empty for 0: relative deviation of the loss of each mode. `damping` contains it for the
  /// structure's modes.
  Eigen::VectorXd relative_damping;
  /// r, or empty for 1: factor by which the body's part of `damping` has grown in each mode for
  /// constants that leave its ratio.
  Eigen::VectorXd kept_ratios;
  /// Index of the structure's output (input) in each row (column) of the record.
  std::vector<Eigen::Index> output_of, input_of;
  /// q, by columns of the record: relative increase of the body's stiffness while that column was
  /// measured; or empty.
  Eigen::VectorXd stiffening;

  [[nodiscard]] Eigen::Index mode_count() const { return stiffness.rows(); }
  [[nodiscard]] Eigen::Index output_count() const { return outputs.rows(); }
  [[nodiscard]] Eigen::Index input_count() const { return inputs.cols(); }
};

/// The nominal simulation.
[[nodiscard]] State state_of(const Structure& structure);

/// Adds stiffness at a place of the body; `change` is (r + u)×(r + u), as in FineCells. The u modes
/// above yield statically, so stiffness, channels and residual all change. Guyan's condensation
/// (1965), exact if the modes above are far above the band. Cost: u² (r + u).
/// @throws NumericalFailure  a place loses more stiffness than it has
void add_stiffness(State& state, const Eigen::MatrixXd& change);

/// Multiplies the static flexibility of the modes above by a factor.
void scale_residual(State& state, double factor);

/// Multiplies the stiffness of the whole body by a factor and divides the flexibility of the modes
/// above by it. Springs attached to the body (State::springs) keep their stiffness.
void scale_stiffness(State& state, double factor);
/// The same for its mass and for the losses of its modes.
void scale_mass(State& state, double factor);
void scale_damping(State& state, double factor);

/// Notes such growth, r.
void note_kept_ratios(State& state, const Eigen::VectorXd& by);

/// Multiplies the loss of mode i by exp(by), in `damping` and in `relative_damping`.
void deviate_damping(State& state, Eigen::Index i, double by);

/// Adds parts that do not belong to the body: they do not change when the body is scaled. r×r each.
void attach_stiffness(State& state, const Eigen::MatrixXd& springs);
void attach_damping(State& state, const Eigen::MatrixXd& dashpots);
void attach_mass(State& state, const Eigen::MatrixXd& masses);

}  // namespace chladni::diagnosis
