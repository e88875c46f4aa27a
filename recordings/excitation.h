// Periodic excitation: random-phase multisines (thesis (4.1); Pintelon and Schoukens 2012, ch. 5).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/draw.h"

namespace chladni::recordings {

/// The lines of the band that are excited.
enum class ExcitedLines {
  all,
  odd,
  /// Odd lines without one of every four at random. A response there and on the even
  /// lines is nonlinear.
  odd_with_detection,
};

/// From one excited line to the next, in lines of the period; silent odd lines count as excited.
[[nodiscard]] constexpr Eigen::Index step_of(ExcitedLines lines) {
  return lines == ExcitedLines::all ? 1 : 2;
}

struct MultisinePlan {
  Eigen::Index period = 0;             ///< samples N
  double sample_time_s = 0.0;          ///< the lines are k / (N T)
  double low_hz = 0.0, high_hz = 0.0;  ///< the band with both ends; never 0 Hz nor N/2
  ExcitedLines lines = ExcitedLines::all;
  /// Seed of the choice of silent odd lines. All realisations have the same ones, so that each
  /// excited line is excited in all of them.
  unsigned detection_seed = 1;
  double rms = 1.0;  ///< rms value of the signal
  /// Shape of the amplitude spectrum: amplitudes at these frequencies [Hz, ascending]. In between
  /// the logarithm of the amplitude is linear in frequency. Empty: flat.
  Eigen::VectorXd shape_hz, shape;
  /// Number of clip-and-rephase steps that lower the crest factor (van der Ouderaa, Schoukens,
  /// Renneboog 1988). The phases are then not random: use 0 with several realisations.
  int crest_iterations = 0;
};

struct Multisine {
  Eigen::VectorXd signal;               ///< N, one period
  std::vector<Eigen::Index> lines;      ///< excited, ascending
  std::vector<Eigen::Index> detection;  ///< lines of the band that are not excited
  Eigen::VectorXcd coefficient;         ///< at `lines`, in the convention of fourier()
  double crest_factor = 0.0;            ///< largest magnitude over rms
};

/// Draws new phases, uniform in [0, 2π), in each call.
/// @throws InvalidInput  no line in the band, the band beyond half the sampling frequency, a shape
///                       that is not positive or not ascending
[[nodiscard]] Multisine multisine(const MultisinePlan& plan, Draw& draw);

/// The method that separates several inputs.
enum class InputScheme {
  one_at_a_time,
  /// q experiments with all inputs, U_je(k) = A_j(k) e^{jφ_j(k)} W_je. W is a Hadamard matrix (q a
  /// power of 2) or the Fourier matrix. At the same rms the noise variance is q times less
  /// (Dobrowiecki, Schoukens, Guillaume 2006).
  orthogonal,
};

/// One realisation: q experiments.
struct ExperimentSet {
  std::vector<Eigen::MatrixXd> inputs;  ///< [experiment] N×q, one period
  std::vector<Eigen::Index> lines, detection;
  double crest_factor = 0.0;  ///< the largest of all inputs
};

/// True if the columns of the orthogonal scheme differ in sign only: q is a power of 2.
[[nodiscard]] bool differ_in_sign_only(Eigen::Index inputs);

/// One plan for each input: they may differ in rms and shape, and in nothing else.
/// @throws InvalidInput  as multisine(); no inputs; plans of different lines; crest_iterations with
///                       `orthogonal` where the experiments differ in more than signs
[[nodiscard]] ExperimentSet experiments(const std::vector<MultisinePlan>& plans, InputScheme scheme,
                                        Draw& draw);

/// The same plan for all inputs.
[[nodiscard]] ExperimentSet experiments(const MultisinePlan& plan, Eigen::Index inputs,
                                        InputScheme scheme, Draw& draw);

/// Largest magnitude over root mean square; 0 for a signal that is 0.
[[nodiscard]] double crest_factor(const Eigen::Ref<const Eigen::VectorXd>& signal);

}  // namespace chladni::recordings
