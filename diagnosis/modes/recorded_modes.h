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

/// Modes of a body with its attachments in a band, without the channels.
struct BodyModes {
  Eigen::VectorXd frequency_hz, damping_ratio;  ///< n
  Eigen::MatrixXd motion;                       ///< r×n
};
/// What the channels of a state record of them.
[[nodiscard]] RecordedModes recorded(const State& state, const BodyModes& body);
/// True if both states have the same body and attachments, and so the same modes. Cost: r².
[[nodiscard]] bool have_same_body(const State& a, const State& b);

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
  /// Those of the body alone. States that differ in their channels have the same ones (`recorded`).
  [[nodiscard]] BodyModes body_modes(const State& state, double low_hz, double high_hz) const;

 private:
  struct Body {
    Eigen::VectorXd lambda;         ///< n [s^-2], ascending
    Eigen::MatrixXd turn;           ///< s×n: in the coordinates of the state, then carried masses
    Eigen::MatrixXd damping, loss;  ///< s×s: of the same coordinates
  };
  // The damping ratios of the modes of the study's structure.
  struct OwnRatios {
    Eigen::VectorXd omega, ratio;
    struct Factors {
      double viscous = 1.0, loss = 1.0;
    };
    // Factors of the viscous and of the hysteretic damping that fixed matrices have in a mode of
    // circular frequency `to`, so that it keeps the ratios. `motion` is its shape in the
    // coordinates of the structure, and `inertia` the part of its modal mass that is the body's.
    [[nodiscard]] Factors factors(const Eigen::VectorXd& motion, double inertia, double to) const;
  };
  [[nodiscard]] Body solved(const State& state) const;
  [[nodiscard]] OwnRatios own_ratios() const;
  // 2 ζ ω [1/s] of some modes.
  [[nodiscard]] Eigen::VectorXd damping(const State& state, const Body& body,
                                        const std::vector<Eigen::Index>& columns) const;

  State base_;
  Eigen::Index most_;
  OwnRatios own_;
  Body base_body_;
};

}  // namespace chladni::diagnosis
