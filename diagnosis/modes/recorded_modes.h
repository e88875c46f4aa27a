// Modes of the structure under a hypothesis, as its channels record them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// n flexible modes, ascending; p sensors, q actuators.
struct RecordedModes {
  Eigen::VectorXd frequency_hz, damping_ratio;  ///< n
  Eigen::MatrixXd outputs, inputs;              ///< p×n, q×n: shapes behind each record [kg^-1/2]
  Eigen::MatrixXcd output_path, input_path;     ///< p×n, q×n: path of each record at each mode
  Eigen::MatrixXd motion;                       ///< r×n: in the coordinates of the structure
  std::vector<Eigen::Index> output_of, input_of;  ///< p, q: the channel that each record shows

  [[nodiscard]] Eigen::Index count() const { return frequency_hz.size(); }
};

/// Solves the modes of states that differ little from one state. A state whose body and attachments
/// are those of the first one costs no eigenproblem.
class ModeSolver {
 public:
  /// @param most  coordinates of the eigenproblems: the first modes of the structure. Fewer are
  ///              faster and less exact
  ModeSolver(State base, Eigen::Index most);

  /// Undamped modes from `low_hz` to `high_hz`, with the damping ratios of light damping. The
  /// body's own ratios are those of the modes as they are, whatever changes their stiffness and
  /// mass, as in a study that states them (loaded_damping.h). An attachment yields as the modes
  /// above do (State::output_upper); a carried mass adds its mode. Frames and the residual
  /// flexibility have no part in modes. Cost: 1 ms for 40 coordinates. @throws NumericalFailure  a
  /// mass that is not positive
  [[nodiscard]] RecordedModes modes(const State& state, double low_hz, double high_hz) const;

 private:
  struct Body {
    Eigen::VectorXd lambda;   ///< [s^-2], ascending
    Eigen::MatrixXd shapes;   ///< r×n: in the coordinates of the state
    Eigen::VectorXd damping;  ///< n: 2 ζ ω [1/s]
  };
  [[nodiscard]] Body solved(const State& state) const;
  [[nodiscard]] bool is_base(const State& state) const;
  void keep_ratios(const State& state, const Eigen::VectorXd& omega, Body& body) const;

  State base_;
  Eigen::Index most_;
  Body base_body_;
};

}  // namespace chladni::diagnosis
