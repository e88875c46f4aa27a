// Shapes of modes whose damping is not modal: each point has its own phase.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/reduced_model.h"
#include "modal/state_space.h"

namespace chladni::identification {

/// The kind of damping, which also decides the kind of modes.
enum class Damping {
  modal,    ///< each mode alone: real shapes, G = Σ L R / (s² + 2ζωs + ω²)
  general,  ///< modes coupled: complex shapes, G = Σ L R / (2jω_d (s − p)) and its conjugate
};

/// G(s) = Σ_m [ L_m R_m / (2jω_m √(1−ζ_m²) (s − p_m)) + its conjugate ] beside rigid-body
/// modes. With real L and R this is a mode of modal damping, in the same unit. The data do not
/// determine a complex factor between L and R: |L_m| = |R_m| fixes its size, a real and
/// positive Σ L² + conj(Σ R²) its phase, a positive largest Re L the sign. Columns of
/// rigid-body modes are real.
struct ComplexShapes {
  Eigen::MatrixXcd outputs;                               ///< p×m: L [kg^-1/2]
  Eigen::MatrixXcd inputs;                                ///< m×q: R [kg^-1/2]
  Eigen::MatrixXd output_real_std, output_imaginary_std;  ///< p×m
  Eigen::MatrixXd input_real_std, input_imaginary_std;    ///< m×q
  /// [m], of (ω [rad/s], ζ, Re L, Re R, Im L, Im R), (2 + 2p + 2q) squared; 0 for Im
  /// of rigid-body modes
  std::vector<Eigen::MatrixXd> covariance;
};

/// Modal phase collinearity (|Σ v²| / Σ |v|²)² (Pappa, Elliott and Schenk 1993): 1 if all entries
/// have one phase or its opposite, 0 if they go around the circle. A vector of zeros has 1.
[[nodiscard]] double phase_collinearity(const Eigen::VectorXcd& shape);

/// The phase factor e^{jφ} for which L e^{jφ} and R e^{−jφ} have the phase of ComplexShapes, up to
/// the sign. 1 if the phase is not determined.
[[nodiscard]] std::complex<double> common_phase(const Eigen::VectorXcd& outputs,
                                                const Eigen::RowVectorXcd& inputs);

/// Receptances on the lines, K×pq, without a delay. @param model  frequencies, damping, residual
[[nodiscard]] Eigen::MatrixXcd responses(const modal::ReducedModel& model,
                                         const ComplexShapes& shapes,
                                         const Eigen::VectorXd& frequency_hz);

/// State space from the inputs to displacements of the outputs. States: first position and
/// velocity of each rigid-body mode, then two per flexible mode with the matrix [σ ω_d; −ω_d σ].
/// The residual is in D.
[[nodiscard]] modal::StateSpace state_space(const modal::ReducedModel& model,
                                            const ComplexShapes& shapes);

}  // namespace chladni::identification
