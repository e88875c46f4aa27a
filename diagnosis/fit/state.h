// The structure and its channels as a hypothesis has them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// What hangs on the body: force over displacement k + c s + m s², or of a mass carried on a spring
/// and dashpot, m s² (k + c s) / (m s² + c s + k).
struct Attached {
  Eigen::MatrixXd shapes;  ///< r×d: of the d displacements it acts on, all alike
  Eigen::MatrixXd upper;   ///< u×d: of the modes that yield at once; or empty
  double mass = 0.0, damping = 0.0, stiffness = 0.0;  ///< [kg], [N s/m], [N/m]
  bool carried = false;
};

/// A support that moves: a mass on spring and dashpot that the inputs push back and the outputs are
/// measured against; adds c(s) to_outputs from_inputs to the responses.
struct Frame {
  Eigen::VectorXd to_outputs, from_inputs;  ///< p, q [1]
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
};

/// Between a channel of the structure and its record.
struct Path {
  double gain = 1.0;
  double delay = 0.0;       ///< [s]
  double lag = 0.0;         ///< [s]: 1 / (1 + s lag)
  double derivative = 0.0;  ///< times s to this power; −1: integrated
};

/// K + jH + s D + s² M on the r modes of the structure, its channels, and what hangs on it. Every
/// effect and every tolerance is a change of one of these.
struct State {
  Eigen::MatrixXd stiffness, loss, damping, mass;  ///< r×r [s^-2], [s^-2], [1/s], [1]
  /// What in stiffness, damping and mass is not the body's own: r×r, or 0×0 for nothing.
  Eigen::MatrixXd springs, dashpots, masses;
  Eigen::MatrixXd outputs, inputs;            ///< p×r, r×q [kg^-1/2]
  Eigen::MatrixXd residual;                   ///< p×q [m/N]
  Eigen::MatrixXd output_upper, input_upper;  ///< p×u, q×u: ChannelSide::upper
  std::vector<Attached> attached;
  std::vector<Frame> frames;
  std::vector<Path> output_paths, input_paths;  ///< p, q
  /// Share in which damping ratios are those of the modes with all that hangs on the body: what
  /// that changes (loaded_damping.h) is in `damping` once all causes are there.
  double loaded_damping = 0.0;
  /// r, or empty for 0: by how much, relative, the loss of each mode deviates; it is in `damping`
  /// as that of the structure's modes.
  Eigen::VectorXd relative_damping;
  /// Which output (input) of the structure a row (column) of the record shows.
  std::vector<Eigen::Index> output_of, input_of;
  /// q, by columns of the record: by how much, relative, the body was stiffer while that column was
  /// measured; or empty.
  Eigen::VectorXd stiffening;

  [[nodiscard]] Eigen::Index mode_count() const { return stiffness.rows(); }
  [[nodiscard]] Eigen::Index output_count() const { return outputs.rows(); }
  [[nodiscard]] Eigen::Index input_count() const { return inputs.cols(); }
};

/// The simulation as it is.
[[nodiscard]] State state_of(const Structure& structure);

/// What a place of the body gains, (r + u)×(r + u) as FineCells': the u modes above yield at once,
/// so that stiffness, channels and residual all change. Guyan's condensation (1965), exact where
/// the modes above are far above the band. Cost: u² (r + u).
/// @throws NumericalFailure  a place that loses more stiffness than it has
void add_stiffness(State& state, const Eigen::MatrixXd& change);

/// What the modes above those in use yield, by a factor.
void scale_residual(State& state, double factor);

/// The whole body by a factor, what its modes above the band yield included; what is attached to it
/// (State::springs) keeps its stiffness.
void scale_stiffness(State& state, double factor);
/// The same of its mass and of the losses of its modes.
void scale_mass(State& state, double factor);
void scale_damping(State& state, double factor);

/// The loss of mode i by exp(by), in `damping` and in `relative_damping`.
void deviate_damping(State& state, Eigen::Index i, double by);

/// Something that is not the body: it stays when the body is scaled. r×r each.
void attach_stiffness(State& state, const Eigen::MatrixXd& springs);
void attach_damping(State& state, const Eigen::MatrixXd& dashpots);
void attach_mass(State& state, const Eigen::MatrixXd& masses);

}  // namespace chladni::diagnosis
