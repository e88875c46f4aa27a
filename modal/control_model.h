// A state space as the designer of a controller takes it: named channels with units, delays of each
// channel, sampled for a computer, reduced with a bound of the error.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "modal/frf.h"
#include "modal/reduced_model.h"
#include "modal/state_space.h"

namespace chladni::modal {

struct Signal {
  std::string name, unit;
};

/// y_i(t) = the output i of `space` at t − output_delay_i, whose input j is u_j(t − input_delay_j).
struct ControlModel {
  StateSpace space;
  std::vector<Signal> states, inputs, outputs;
  Eigen::VectorXd input_delay, output_delay;  ///< q, p [s]; of a discrete model whole samples
};

/// An output of a control model: its name and whether it is a displacement, velocity or
/// acceleration.
struct OutputChannel {
  std::string name;
  FrfKind kind = FrfKind::receptance;
};

/// From a state space of displacements [m] under forces [N], without delays. Velocities and
/// accelerations are those that a proper model can have: the derivative of the direct path D, which
/// is the flexibility of omitted modes, is left out.
/// @throws InvalidInput  numbers of names differ from those of channels and states
[[nodiscard]] ControlModel control_model(const StateSpace& displacements,
                                         const std::vector<Signal>& states,
                                         const std::vector<OutputChannel>& outputs,
                                         const std::vector<std::string>& inputs);

/// From modes. The two states of a mode follow each other, so that A has blocks of two on its
/// diagonal: ω_k q_k (q_k at 0 Hz) and q̇_k, then the states of dashpots.
/// @throws InvalidInput  as above and as state_space
[[nodiscard]] ControlModel control_model(const ReducedModel& model,
                                         const std::vector<OutputChannel>& outputs,
                                         const std::vector<std::string>& inputs);

inline constexpr double kMostDelaySamples = 4096;
inline constexpr double kSameSample = 1e-9;  ///< fractions of a sample that are only rounding

/// @throws InvalidInput  sizes differ, an entry is not finite, a delay is negative, or that of a
///                       discrete model is not whole or longer than kMostDelaySamples + 1
void check(const ControlModel& model);

/// Poles of a continuous model [rad/s]: n, in no order.
struct Poles {
  Eigen::VectorXcd value;
  double integrator = 0.0;  ///< up to this size a pole is one of rigid-body motion, only rounding

  [[nodiscard]] bool is_integrator(std::complex<double> pole) const;
  /// Neither rigid-body motion nor undamped nor unstable, each beyond rounding.
  [[nodiscard]] bool is_damped(std::complex<double> pole) const;
  [[nodiscard]] bool is_unstable(std::complex<double> pole) const;
  /// The highest frequency of an oscillating pole [Hz]; real poles, as dashpots have, do not count.
  [[nodiscard]] double highest_hz() const;
};

/// Cost: about 25 n³. @throws InvalidInput  as check; a discrete model
[[nodiscard]] Poles poles(const ControlModel& model);

/// p×q at jω, or at e^{jωT} of a discrete model, delays included.
/// @throws InvalidInput  as check; f < 0
[[nodiscard]] Eigen::MatrixXcd response(const ControlModel& model, double frequency_hz);

/// Exact at the samples for inputs that are constant between them (zero-order hold). Whole samples
/// of a delay stay delays. A fraction is exact too: of an input delay by a state, the last value of
/// that input; of an output delay by the output between two samples (Franklin, Powell and Workman
/// 1998, 4.3.4). Cost: one matrix exponential for each fraction, and for each pair of both kinds.
/// @throws InvalidInput      as check; a discrete model; a sample time that is not positive; a
///                           delay of more than kMostDelaySamples samples
/// @throws NumericalFailure  an unstable model grows beyond all numbers within a sample
[[nodiscard]] ControlModel discretised(const ControlModel& model, double sample_time_s);

inline constexpr int kHighestPade = 10;

/// Delays as Padé approximations [order/order], in a realisation whose response has magnitude 1 at
/// all frequencies: a ladder, balanced. Each delay above 0 adds `order` states.
/// @throws InvalidInput  as check; a discrete model; an order outside 1 to kHighestPade
[[nodiscard]] ControlModel with_pade_delays(const ControlModel& model, int order);

/// The frequency [Hz] below which the phase of with_pade_delays is wrong by less than
/// `phase_error` [rad] for each delay, by the first term of the error. Infinite without a delay.
[[nodiscard]] double pade_limit_hz(const ControlModel& model, int order, double phase_error);

inline constexpr Eigen::Index kMostDelayStates = 4096;

/// Delays of a discrete model as states, one for each sample. Matrices are dense.
/// @throws InvalidInput  as check; a continuous model; more than kMostDelayStates states in all
[[nodiscard]] ControlModel with_delay_states(const ControlModel& model);

struct ReducedControlModel {
  ControlModel model;
  Eigen::VectorXd hankel;        ///< of the stable part, descending; [units of y over those of u]
  Eigen::Index integrators = 0;  ///< states of rigid-body motion, all kept
  double error_bound = 0.0;      ///< of the largest singular value of the error at any frequency
};

/// Balanced singular perturbation (dense::balanced_reduction): keeps rigid-body motion, the static
/// flexibility and the delays. The error is measured in the units of the outputs as they are.
/// @param states  that remain, `integrators` included
/// @throws InvalidInput  as check; a discrete model; a mode is unstable or has no damping; fewer
///                       states than integrators, or more than there are
[[nodiscard]] ReducedControlModel reduced(const ControlModel& model, Eigen::Index states);

}  // namespace chladni::modal
