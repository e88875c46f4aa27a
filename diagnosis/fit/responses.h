// Responses of a state, and how they change with it.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// At K lines: what a response is made of. Response (i, j) is column i + p j.
struct Solved {
  Eigen::VectorXd omega;           ///< K [rad/s], above 0
  Eigen::MatrixXcd left_columns;   ///< r×pK, line by line: (C Z⁻¹)ᵀ, attachments included
  Eigen::MatrixXcd right_columns;  ///< r×qK: Z⁻¹ B
  /// Between the channels and the attachments' D displacements: p×DK, q×DK.
  Eigen::MatrixXcd to_outputs, to_inputs;
  Eigen::MatrixXcd structure;  ///< K×pq, before the channels' paths
  Eigen::MatrixXcd value;      ///< K×pq, as recorded
  /// Where the body was not the same all the time: q, each of one column (experiment()), and
  /// left_columns, right_columns and what follows them of the body in the mean. Else empty.
  std::vector<Solved> experiments;

  [[nodiscard]] Eigen::Index line_count() const { return omega.size(); }
  /// Of line k: p×r and r×q.
  [[nodiscard]] auto left(Eigen::Index k) const {
    const Eigen::Index p = left_columns.cols() / omega.size();
    return left_columns.middleCols(p * k, p).transpose();
  }
  [[nodiscard]] auto right(Eigen::Index k) const {
    const Eigen::Index q = right_columns.cols() / omega.size();
    return right_columns.middleCols(q * k, q);
  }
};

/// Z = K + jH + sD + s²M without attachments, ready to be solved on K lines: K and M are brought to
/// diagonal form (real eigenvectors), what of D and H is then beside the diagonal comes in by
/// iteration, all lines at once; lines that it does not serve are solved by themselves. Kept for
/// the states that share these matrices.
class Body {
 public:
  /// Cost: 10 r³ (nothing where all matrices are diagonal), and one `solve` of the channels.
  /// @param coupled  false: what damping is beside the diagonal is left out, for a first look
  /// @throws NumericalFailure  Z is singular at a line, M is not positive definite
  Body(const State& state, const Eigen::VectorXd& omega, bool coupled = true);

  [[nodiscard]] bool same(const State& state) const;  ///< has these matrices
  [[nodiscard]] const Eigen::VectorXd& omega() const { return omega_; }
  [[nodiscard]] bool coupled() const { return coupled_; }
  /// Z⁻¹ V of real V, r×c: r×cK, line by line. Cost: some 4 r² c per line.
  [[nodiscard]] Eigen::MatrixXcd solve(const Eigen::MatrixXd& v) const;
  /// (C Z⁻¹)ᵀ, r×pK, and Z⁻¹ B, r×qK, of a state's channels; those of the state it was made of are
  /// kept.
  [[nodiscard]] Eigen::MatrixXcd left(const State& state) const;
  [[nodiscard]] Eigen::MatrixXcd right(const State& state) const;

 private:
  [[nodiscard]] Eigen::MatrixXcd channels(const Eigen::MatrixXd& now, const Eigen::MatrixXd& before,
                                          const Eigen::MatrixXcd& kept) const;
  [[nodiscard]] Eigen::MatrixXcd iterated(const Eigen::MatrixXd& v) const;
  void finish(Eigen::Index line, const Eigen::MatrixXd& v, Eigen::MatrixXcd& x) const;

  Eigen::VectorXd omega_;
  Eigen::MatrixXd stiffness_, loss_, damping_, mass_;
  Eigen::MatrixXd turn_;    ///< r×r: the eigenvectors; empty: none needed
  Eigen::VectorXd lambda_;  ///< r
  Eigen::MatrixXd turned_loss_, turned_damping_;
  bool coupled_ = false;               ///< they have entries beside the diagonal
  Eigen::MatrixXcd diagonal_inverse_;  ///< r×K
  Eigen::MatrixXd outputs_, inputs_;
  Eigen::MatrixXcd left_, right_;
};

/// Attachments come in by Woodbury's identity, exact at any strength.
/// @pre  body.same(state)
/// Cost: per line r p q, and d³ of the attachments.
[[nodiscard]] Solved solved(const State& state, const Body& body);

/// Only the responses, K×pq.
[[nodiscard]] Eigen::MatrixXcd responses(const State& state, const Eigen::VectorXd& omega,
                                         bool coupled = true);

/// d value / d x of states that move from `minus` to `plus` while x changes by `step`, K×pq, to
/// first order about `at`, whose responses are `solved`; exact but for the difference of the two
/// states. Both have the attachments and frames of `at`, one by one.
/// Cost: per line p q times the number of entries that differ, or r (p + q) r for full matrices.
[[nodiscard]] Eigen::MatrixXcd slope(const State& at, const Solved& solved, const State& minus,
                                     const State& plus, double step);

/// A X of real A and complex X, at the speed of BLAS.
[[nodiscard]] Eigen::MatrixXcd product(const Eigen::MatrixXd& a, const Eigen::MatrixXcd& x);
/// What one support that moves adds, p×q, and all of them.
[[nodiscard]] Eigen::MatrixXcd frame_response(const Frame& frame, std::complex<double> s);
[[nodiscard]] Eigen::MatrixXcd frame_responses(const State& state, std::complex<double> s);
/// The structure's responses, p×q, as the record's channels show them.
[[nodiscard]] Eigen::MatrixXcd recorded(const State& state, const Eigen::MatrixXcd& structure,
                                        std::complex<double> s);
/// What the paths of one side make of the responses, one factor per channel.
[[nodiscard]] Eigen::VectorXcd factors(const std::vector<Path>& paths, std::complex<double> s);

}  // namespace chladni::diagnosis
