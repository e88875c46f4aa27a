// The amplitude spectrum of an excitation that tells frequencies and damping of given modes best.
#pragma once

#include <Eigen/Core>

namespace chladni::identification {

/// K lines, m modes, q inputs. The response of mode i to input j on line k is sight·drive·h(k) in
/// units of the noise of one experiment with a force coefficient of 1.
struct ShapeProblem {
  Eigen::VectorXd line_hz;        ///< K, ascending
  Eigen::VectorXd frequency_hz;   ///< m, above 0
  Eigen::VectorXd damping_ratio;  ///< m, above 0
  Eigen::MatrixXd sight;          ///< K×m: Σ_i l_i² |s|^{2 kind} / σ_i²(k) [rad⁴/s⁴ / N²]
  Eigen::MatrixXd drive;          ///< m×q: r²
  double frequency_std_hz = 0.0;  ///< wanted; infinite: not asked for
  double damping_std = 0.0;       ///< wanted, relative
  double simulation_error = 0.0;  ///< relative deviation of `frequency_hz` from those of the rig
};

/// m: the expected variance of frequency and damping of each mode in units of the wanted one, as if
/// the mode were alone, the worse of both. It is the mean over what the simulation may be wrong.
/// @param power  K×q: |U|², summed over all experiments
[[nodiscard]] Eigen::VectorXd expected_variance(const ShapeProblem& problem,
                                                const Eigen::MatrixXd& power);

/// K×q: |U|² on each line, Σ_k cost·power = 1 for each input. It makes the worst mode as good as it
/// can (the eighth norm of the deviations, by multiplicative steps: Torsney 1983, Yu 2010). A tenth
/// is spread evenly, so that nothing in the band goes unseen. Lines closer than simulation_error
/// have the same power: nobody knows which of them the mode will meet.
/// @param cost   K×q, above 0
/// Cost: 120 iterations of lines in reach of each mode.
[[nodiscard]] Eigen::MatrixXd best_power(const ShapeProblem& problem, const Eigen::MatrixXd& cost);

}  // namespace chladni::identification
