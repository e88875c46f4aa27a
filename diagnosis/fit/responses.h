// Responses of a state, and their derivatives.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// Parts of the responses at K lines. Response (i, j) is column i + p j.
struct Solved {
  Eigen::VectorXd omega;           ///< K [rad/s], above 0
  Eigen::MatrixXcd left_columns;   ///< r×pK, line by line: (C Z⁻¹)ᵀ, attachments included
  Eigen::MatrixXcd right_columns;  ///< r×qK: Z⁻¹ B
  /// Between the channels and the attachments' D displacements: p×DK, q×DK.
  Eigen::MatrixXcd to_outputs, to_inputs;
  Eigen::MatrixXcd output_factors, input_factors;  ///< p×K, q×K: of the channels' paths
  Eigen::MatrixXcd structure;                      ///< K×pq, before the channels' paths
  Eigen::MatrixXcd value;                          ///< K×pq, as recorded
  /// Only if the body differs between the experiments, else empty: q entries, each of one column
  /// (experiment()). `structure` and `value` then come from these; the other members belong to the
  /// mean body.
  std::vector<Solved> experiments;

  [[nodiscard]] Eigen::Index line_count() const { return omega.size(); }
  /// The columns of line k: p×r and r×q.
  [[nodiscard]] auto left(Eigen::Index k) const {
    const Eigen::Index p = left_columns.cols() / omega.size();
    return left_columns.middleCols(p * k, p).transpose();
  }
  [[nodiscard]] auto right(Eigen::Index k) const {
    const Eigen::Index q = right_columns.cols() / omega.size();
    return right_columns.middleCols(q * k, q);
  }
};

/// Z = K + jH + sD + s²M without attachments, prepared for solves on K lines. K and M are made
/// diagonal (real eigenvectors). The off-diagonal part of D and H is then added by iteration, on
/// all lines at once. Lines where the iteration does not converge are solved directly. One Body
/// serves all states with the same matrices.
class Body {
 public:
  /// Cost: 10 r³ (nothing where all matrices are diagonal), and one `solve` of the channels.
  /// @param coupled  false: off-diagonal damping is left out, for a first look
  /// @throws NumericalFailure  Z is singular at a line, M is not positive definite
  Body(const State& state, const Eigen::VectorXd& omega, bool coupled = true);

  [[nodiscard]] bool same(const State& state) const;  ///< True if the state has the same matrices.
  [[nodiscard]] const Eigen::VectorXd& omega() const { return omega_; }
  [[nodiscard]] bool coupled() const { return coupled_; }
  /// Z⁻¹ V of real V, r×c: r×cK, line by line. Cost: some 4 r² c per line.
  [[nodiscard]] Eigen::MatrixXcd solve(const Eigen::MatrixXd& v) const;
  /// (C Z⁻¹)ᵀ, r×pK, and Z⁻¹ B, r×qK, of a state's channels. Those of the constructor's state are
  /// stored.
  [[nodiscard]] Eigen::MatrixXcd left(const State& state) const;
  [[nodiscard]] Eigen::MatrixXcd right(const State& state) const;

 private:
  [[nodiscard]] Eigen::MatrixXcd channels(const Eigen::MatrixXd& now, const Eigen::MatrixXd& before,
                                          const Eigen::MatrixXcd& kept) const;
  [[nodiscard]] Eigen::MatrixXcd iterated(const Eigen::MatrixXd& v) const;
  void finish(Eigen::Index line, const Eigen::MatrixXd& v, Eigen::MatrixXcd& x) const;

  Eigen::VectorXd omega_;
  Eigen::MatrixXd stiffness_, loss_, damping_, mass_;
  Eigen::MatrixXd turn_;    ///< r×r: the eigenvectors; empty: not needed
  Eigen::VectorXd lambda_;  ///< r
  Eigen::MatrixXd turned_loss_, turned_damping_;
  bool coupled_ = false;               ///< off-diagonal entries are used
  Eigen::MatrixXcd diagonal_inverse_;  ///< r×K
  Eigen::MatrixXd outputs_, inputs_;
  Eigen::MatrixXcd left_, right_;
};

/// Responses of a state. Attachments enter by Woodbury's identity, exact at any strength.
/// @pre  body.same(state)
/// Cost: per line r p q, and d³ for d displacements of the attachments.
[[nodiscard]] Solved solved(const State& state, const Body& body);

/// Only the responses, K×pq.
[[nodiscard]] Eigen::MatrixXcd responses(const State& state, const Eigen::VectorXd& omega,
                                         bool coupled = true);

/// d value / d x, K×pq, to first order about `at`, whose responses are `solved`. The states move
/// from `minus` to `plus` while x changes by `step`. Only the difference of the two states is an
/// approximation. Both states have the same attachments and frames as `at`, in the same order.
/// Cost: per line p q times the number of entries that differ, or r (p + q) r for full matrices.
[[nodiscard]] Eigen::MatrixXcd slope(const State& at, const Solved& solved, const State& minus,
                                     const State& plus, double step);

/// A X for real A and complex X, at the speed of BLAS.
[[nodiscard]] Eigen::MatrixXcd product(const Eigen::MatrixXd& a, const Eigen::MatrixXcd& x);
/// Contribution of one moving support, p×q, and of all of them.
[[nodiscard]] Eigen::MatrixXcd frame_response(const Frame& frame, std::complex<double> s);
[[nodiscard]] Eigen::MatrixXcd frame_responses(const State& state, std::complex<double> s);
/// The structure's responses, p×q, in the form in which the channels record them.
[[nodiscard]] Eigen::MatrixXcd recorded(const State& state, const Eigen::MatrixXcd& structure,
                                        std::complex<double> s);
/// Factor of a path on the responses, and of the paths of one side, one per channel.
[[nodiscard]] std::complex<double> factor(const Path& path, std::complex<double> s);
[[nodiscard]] Eigen::VectorXcd factors(const std::vector<Path>& paths, std::complex<double> s);

}  // namespace chladni::diagnosis
