// Periodic excitation: random-phase multisines (thesis (4.1); Pintelon and Schoukens 2012, ch. 5).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/draw.h"

namespace chladni::identification {

/// Which lines of the band are excited.
enum class ExcitedLines {
  all,
  odd,
  /// Odd ones, one at random of every four left out: what answers there, and on the even lines,
  /// is nonlinear.
  odd_with_detection,
};

struct MultisinePlan {
  Eigen::Index period = 0;             ///< samples N
  double sample_time_s = 0.0;          ///< the lines are k / (N T)
  double low_hz = 0.0, high_hz = 0.0;  ///< the band, both ends in it; never 0 Hz nor N/2
  ExcitedLines lines = ExcitedLines::all;
  double rms = 1.0;  ///< of the signal
  /// Shape of the amplitude spectrum: at these frequencies [Hz, ascending] these amplitudes, in
  /// between linear in the logarithms of the amplitude; empty: flat.
  Eigen::VectorXd shape_hz, shape;
  /// Clip-and-rephase steps that lower the crest factor (van der Ouderaa, Schoukens, Renneboog
  /// 1988). The phases are then not random: leave it 0 with several realisations.
  int crest_iterations = 0;
};

struct Multisine {
  Eigen::VectorXd signal;               ///< N, one period
  std::vector<Eigen::Index> lines;      ///< excited, ascending
  std::vector<Eigen::Index> detection;  ///< in the band and not excited
  Eigen::VectorXcd coefficient;         ///< of `lines`: as fourier() gives it
  double crest_factor = 0.0;            ///< largest magnitude over rms
};

/// Phases uniform in [0, 2π), drawn anew in each call.
/// @throws InvalidInput  no line in the band, the band beyond half the sampling frequency, a shape
///                       that is not positive or not ascending
[[nodiscard]] Multisine multisine(const MultisinePlan& plan, Draw& draw);

/// How several inputs are told apart.
enum class InputScheme {
  one_at_a_time,
  /// q experiments of all inputs, U_je(k) = A_j(k) e^{jφ_j(k)} W_je with W a Hadamard matrix (q a
  /// power of 2) or the Fourier matrix: at the same rms q times less noise variance (Dobrowiecki,
  /// Schoukens, Guillaume 2006).
  orthogonal,
};

/// One realisation: q experiments.
struct ExperimentSet {
  std::vector<Eigen::MatrixXd> inputs;  ///< [experiment] N×q, one period
  std::vector<Eigen::Index> lines, detection;
  double crest_factor = 0.0;  ///< the largest of all inputs
};

/// @throws InvalidInput  as multisine(); no inputs; crest_iterations with `orthogonal`
[[nodiscard]] ExperimentSet experiments(const MultisinePlan& plan, Eigen::Index inputs,
                                        InputScheme scheme, Draw& draw);

/// Largest magnitude over root mean square; 0 of a signal that is 0.
[[nodiscard]] double crest_factor(const Eigen::Ref<const Eigen::VectorXd>& signal);

}  // namespace chladni::identification
