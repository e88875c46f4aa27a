// Responses of a state, and how they change with it.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "diagnosis/state.h"

namespace chladni::diagnosis {

/// At K lines: what a response is made of. Response (i, j) is column i + p j.
struct Solved {
  Eigen::VectorXd omega;                ///< K [rad/s], above 0
  std::vector<Eigen::MatrixXcd> left;   ///< [K], p×r: C Z⁻¹, attachments included
  std::vector<Eigen::MatrixXcd> right;  ///< [K], r×q: Z⁻¹ B
  Eigen::MatrixXcd structure;           ///< K×pq, before the channels' paths
  Eigen::MatrixXcd value;               ///< K×pq, as recorded

  [[nodiscard]] Eigen::Index line_count() const { return omega.size(); }
};

/// The inverses of Z = K + jH + sD + s²M without attachments at K lines, kept for the states that
/// share them.
class Body {
 public:
  /// Cost: r³ per line, r where all matrices are diagonal.
  /// @throws NumericalFailure  Z is singular at a line
  Body(const State& state, const Eigen::VectorXd& omega);

  [[nodiscard]] bool same(const State& state) const;  ///< has these matrices
  [[nodiscard]] const Eigen::VectorXd& omega() const { return omega_; }
  /// Z⁻¹ V at line k, for real V r×c.
  [[nodiscard]] Eigen::MatrixXcd solve(Eigen::Index k, const Eigen::MatrixXd& v) const;
  /// C Z⁻¹ and Z⁻¹ B of a state's channels; those of the state it was made of are kept.
  [[nodiscard]] Eigen::MatrixXcd left(Eigen::Index k, const State& state) const;
  [[nodiscard]] Eigen::MatrixXcd right(Eigen::Index k, const State& state) const;

 private:
  Eigen::VectorXd omega_;
  Eigen::MatrixXd stiffness_, loss_, damping_, mass_;
  bool diagonal_ = false;
  Eigen::MatrixXcd diagonal_inverse_;      ///< r×K
  std::vector<Eigen::MatrixXcd> inverse_;  ///< [K], r×r
  Eigen::MatrixXd outputs_, inputs_;
  std::vector<Eigen::MatrixXcd> left_, right_;  ///< [K]
};

/// Attachments come in by Woodbury's identity, exact at any strength.
/// @pre  body.same(state)
/// Cost: per line r (p + q)(r or 1), d³ of the attachments.
[[nodiscard]] Solved solved(const State& state, const Body& body);

/// Only the responses, K×pq.
[[nodiscard]] Eigen::MatrixXcd responses(const State& state, const Eigen::VectorXd& omega);

/// d value / d x of states that move from `minus` to `plus` while x changes by `step`, K×pq, to
/// first order about `at`, whose responses are `solved`; exact but for the difference of the two
/// states. Both have the attachments and frames of `at`, one by one.
/// Cost: per line p q times the number of entries that differ, or r (p + q) r for full matrices.
[[nodiscard]] Eigen::MatrixXcd slope(const State& at, const Solved& solved, const State& minus,
                                     const State& plus, double step);

/// What the supports that move add, p×q.
[[nodiscard]] Eigen::MatrixXcd frame_responses(const State& state, std::complex<double> s);
/// The structure's responses, p×q, as the record's channels show them.
[[nodiscard]] Eigen::MatrixXcd recorded(const State& state, const Eigen::MatrixXcd& structure,
                                        std::complex<double> s);
/// What the paths of one side make of the responses, one factor per channel.
[[nodiscard]] Eigen::VectorXcd factors(const std::vector<Path>& paths, std::complex<double> s);

/// k + c s + m s², or of a carried mass.
[[nodiscard]] std::complex<double> dynamic_stiffness(const Attached& attached,
                                                     std::complex<double> s);

}  // namespace chladni::diagnosis
