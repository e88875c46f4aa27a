// Effects that are next to nothing: where each is tried, and what the responses change by.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// What makes a coordinate of an effect change nothing.
enum class Nothing {
  zero,            ///< a difference or a factor: x = 0, both ways from there
  minus_infinity,  ///< the logarithm of a strength: a mass, a stiffness
  plus_infinity,  ///< of what is weak where it is large: the corner of a low-pass, a support's mass
};

/// A difference, or a factor that is usually 1: it changes nothing at x = 0.
[[nodiscard]] bool is_about_zero(const Parameter& parameter);

/// An effect in one place, of one channel, at one frequency, at a size that is next to nothing.
struct Probe {
  Eigen::Index option = 0;
  Eigen::VectorXd x;      ///< coordinates of the parameters
  Eigen::Index size = 0;  ///< which of them is its size
  Nothing nothing = Nothing::zero;

  /// Which way its coordinate goes from nothing: −1 where it is nothing at plus infinity.
  [[nodiscard]] double sign() const { return nothing == Nothing::plus_infinity ? -1.0 : 1.0; }
};

/// Places at which the score test tries a cause,
inline constexpr Eigen::Index kPlacesOfScore = 144;
/// and what of ln evidence may be lost from one to the next.
inline constexpr double kLostBetweenPlaces = 6.0;

/// Where probes of one problem are taken: a state of its structure, solved once.
class Probing {
 public:
  /// The simulation as it is. Cost: one solve of all lines.
  explicit Probing(const Problem& problem);
  /// @pre  a state of problem.structure
  Probing(const Problem& problem, State state);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const Solved& now() const { return now_; }

  /// Those of an effect: each choice; each coordinate that is a size by itself; at some `places`
  /// spread evenly over the surface; of an effect with a frequency twice as many, each at another
  /// frequency of the band. What else it has is at the centre of its prior. Empty for an effect
  /// that cannot be here, or has no numbers.
  [[nodiscard]] std::vector<Probe> probes(const Effect& effect, Eigen::Index places) const;

  /// d value / dx of every coordinate of every probe in turn, about the state, weighted: N ×
  /// (probes × parameters). Of a probe's size, and of what the size multiplies, at the size that it
  /// has. Cost: one solve with all that the probes attach, a slope per column.
  [[nodiscard]] Eigen::MatrixXd columns(const Effect& effect, std::span<const Probe> probes) const;

  /// The same of the probes' sizes alone: N × probes. What only hangs on the body is cheaper: K p q
  /// per column.
  [[nodiscard]] Eigen::MatrixXd size_columns(const Effect& effect,
                                             std::span<const Probe> probes) const;

  /// What each choice of an effect without numbers changes, weighted: N × options.
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
