// Shapes of modes whose damping is not modal: every point has a phase of its own.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/reduced_model.h"
#include "modal/state_space.h"

namespace chladni::identification {

/// How a structure loses energy, and with it what its modes are.
enum class Damping {
  modal,    ///< each mode by itself: real shapes, G = Σ L R / (s² + 2ζωs + ω²)
  general,  ///< modes coupled: complex shapes, G = Σ L R / (2jω_d (s − p)) and its conjugate
};

/// G(s) = Σ_m [ L_m R_m / (2jω_m √(1−ζ_m²) (s − p_m)) + its conjugate ] beside rigid-body modes:
/// with real L and R that is a mode of modal damping, in the same unit. Of the complex factor
/// between L and R that no data know the size is fixed by |L_m| = |R_m|, the phase by Σ L² + conj(Σ
/// R²) being real and positive, the sign by the largest Re L being positive. Columns of rigid-body
/// modes are real.
struct ComplexShapes {
  Eigen::MatrixXcd outputs;                               ///< p×m: L [kg^-1/2]
  Eigen::MatrixXcd inputs;                                ///< m×q: R [kg^-1/2]
  Eigen::MatrixXd output_real_std, output_imaginary_std;  ///< p×m
  Eigen::MatrixXd input_real_std, input_imaginary_std;    ///< m×q
  /// [m], of (ω [rad/s], ζ, Re L, Re R, Im L, Im R), (2 + 2p + 2q) squared; Im of rigid-body modes
  /// 0
  std::vector<Eigen::MatrixXd> covariance;
};

/// Modal phase collinearity (|Σ v²| / Σ |v|²)² (Pappa, Elliott and Schenk 1993): 1 where all
/// entries have one phase or its opposite, 0 where they go around the circle. 1 of a vector of
/// zeros.
[[nodiscard]] double phase_collinearity(const Eigen::VectorXcd& shape);

/// The phase factor e^{jφ} with which L e^{jφ} and R e^{−jφ} are as ComplexShapes says, sign apart.
/// 1 where the phase is not determined.
[[nodiscard]] std::complex<double> common_phase(const Eigen::VectorXcd& outputs,
                                                const Eigen::RowVectorXcd& inputs);

/// Receptances on the lines, K×pq, without a delay. @param model  frequencies, damping, residual
[[nodiscard]] Eigen::MatrixXcd responses(const modal::ReducedModel& model,
                                         const ComplexShapes& shapes,
                                         const Eigen::VectorXd& frequency_hz);

/// From the inputs to displacements of the outputs. States: two per flexible mode, that turn with
/// [σ ω_d; −ω_d σ], after position and speed of each rigid-body mode. The residual is in D.
[[nodiscard]] modal::StateSpace state_space(const modal::ReducedModel& model,
                                            const ComplexShapes& shapes);

}  // namespace chladni::identification
