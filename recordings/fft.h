// Discrete Fourier transforms of real signals, through FFTW.
#pragma once

#include <Eigen/Core>

namespace chladni::recordings {

/// X_k = Σ_n x_n e^{−j2πkn/N}, unscaled, k = 0 ... ⌊N/2⌋, of each column: N×c gives (⌊N/2⌋+1)×c.
/// Cost: N log N per column for any N.
/// @throws InvalidInput  no samples
[[nodiscard]] Eigen::MatrixXcd fourier(const Eigen::Ref<const Eigen::MatrixXd>& signals);

/// The real signals of N samples whose transforms these are. Imaginary parts of the lines 0 and (N
/// even) N/2 have no meaning and are ignored.
/// @throws InvalidInput  not ⌊N/2⌋+1 lines
[[nodiscard]] Eigen::MatrixXd inverse_fourier(const Eigen::MatrixXcd& lines, Eigen::Index samples);

}  // namespace chladni::recordings
