// Effects at very small size: where each is tried, and the change of the responses.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// The value of the size coordinate at which an effect vanishes.
enum class Nothing {
  zero,            ///< a difference or a factor: x = 0, both ways from there
  minus_infinity,  ///< the logarithm of a strength: a mass, a stiffness
  plus_infinity,   ///< an effect that is weak if it is large: a low-pass corner, a support's mass
};

/// An effect in one place, of one channel, at one frequency, at a very small size.
struct Probe {
  Eigen::Index option = 0;
  Eigen::VectorXd x;      ///< coordinates of the parameters
  Eigen::Index size = 0;  ///< index of its size coordinate
  Nothing nothing = Nothing::zero;

  /// Direction of its coordinate away from no effect: −1 if the effect vanishes at plus infinity.
  [[nodiscard]] double sign() const { return nothing == Nothing::plus_infinity ? -1.0 : 1.0; }
};

/// Computes probes of one problem about one state of its structure, solved once.
class Probing {
 public:
  /// The simulation as it is. Cost: one solve of all lines.
  explicit Probing(const Problem& problem);
  /// @pre  `state` is a state of problem.structure
  Probing(const Problem& problem, State state);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const Solved& now() const { return now_; }

  /// The probes of an effect: for each choice and each size coordinate, at `places` places spread
  /// evenly over the surface. An effect with a place and a frequency has some at each place
  /// (Constants::frequencies_at_place), each at another frequency of the band. An effect with a
  /// frequency but no place has Constants::probe_frequencies. All other coordinates are at the
  /// centres of their priors. Empty for an effect that is not possible here
  /// or has no numbers.
  [[nodiscard]] std::vector<Probe> probes(const Effect& effect, Eigen::Index places) const;

  /// Weighted d value / dx of every coordinate of every probe in turn, about the state: N × (probes
  /// × parameters). The derivatives are taken at the size of the probe. Cost: one solve with all
  /// attachments of the probes, a slope per column.
  [[nodiscard]] Eigen::MatrixXd columns(const Effect& effect, std::span<const Probe> probes) const;

  /// The same for the size coordinates only: N × probes. Effects that only attach something cost
  /// less: K p q per column.
  [[nodiscard]] Eigen::MatrixXd size_columns(const Effect& effect,
                                             std::span<const Probe> probes) const;

  /// Weighted change of the responses by each choice of an effect without numbers: N × options.
  [[nodiscard]] Eigen::MatrixXd changes(const Effect& effect) const;

 private:
  [[nodiscard]] std::vector<Probe> probes_of_choice(const Effect& effect, Eigen::Index option,
                                                    Eigen::Index places) const;
  [[nodiscard]] Eigen::MatrixXd columns_together(const Effect& effect,
                                                 std::span<const Probe> probes, bool all) const;
  [[nodiscard]] bool only_hangs(const Effect& effect, const Probe& probe) const;
  [[nodiscard]] Eigen::MatrixXd hung_columns(const Effect& effect,
                                             std::span<const Probe> probes) const;
  [[nodiscard]] Nothing direction(const Effect& effect, Probe probe) const;
  [[nodiscard]] Eigen::MatrixXcd change(const Effect& effect, Eigen::Index option) const;

  Problem problem_;
  State state_;
  Body body_;
  Solved now_;
};

}  // namespace chladni::diagnosis
