// The joint likelihood of all specimens under a hypothesis, with its levels at their most probable.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/modes/specimens/series.h"

namespace chladni::diagnosis {

/// Which entries are blunders, or which body is not of this design.
struct Supposition {
  std::vector<Eigen::Index> entries;  ///< of Series::entries, ascending
  Eigen::Index unlike = -1;           ///< body; −1: none
  bool by_modes = false;              ///< the frequencies of `unlike` scatter; else its constants

  [[nodiscard]] bool is_none() const { return entries.empty() && unlike < 0; }
  bool operator==(const Supposition&) const = default;
};

/// A hypothesis at its most probable levels.
struct JointFit {
  Supposition supposed;
  Eigen::VectorXd ln_levels;  ///< JointModel::level_count
  double log_evidence = 0.0;
  Eigen::VectorXd weighted;  ///< n: K⁻¹ error
  Eigen::MatrixXd inverse;   ///< n×n: K⁻¹
};

/// A number with its deviation, after the data are seen.
struct Posterior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// The covariance K of all numbers is a sum of parts, each with a level; the numbers are normal.
class JointModel {
 public:
  /// The series must outlive it. @param learned  false: the levels are the usual ones
  JointModel(const Series& series, bool learned);

  /// Levels: the error that is shared, the own one, the scatter of each constant, and the ratio
  /// inside groups, if there are some.
  [[nodiscard]] Eigen::Index level_count() const { return usual_.size(); }
  /// Fisher scoring from `start`. @param start  ln of the levels; empty: the usual ones
  /// Cost: n³ times the levels for each of some ten steps; 50 ms for n = 100.
  [[nodiscard]] JointFit fitted(const Supposition& supposed, const Eigen::VectorXd& start) const;
  /// ln of the evidence that further columns with these deviations bring at the levels of `fit`.
  [[nodiscard]] double promise(const JointFit& fit, const Supposition& more) const;

  /// ln of a constant of each body over Series::Constant::stated.
  [[nodiscard]] Posterior constant(const JointFit& fit, std::size_t which) const;
  /// Mean and variance of the population's ln mean over Series::Constant::stated.
  [[nodiscard]] Eigen::Vector2d mean_of(const JointFit& fit, std::size_t which) const;
  /// Mean and variance of an entry's ln(true over stated).
  [[nodiscard]] Eigen::Vector2d entry(const JointFit& fit, std::size_t which) const;
  /// n: the error of each number that all specimens share.
  [[nodiscard]] Eigen::VectorXd shared_error(const JointFit& fit) const;
  /// Standard deviation of a body's constant, beside the mean: group and specimen.
  [[nodiscard]] double spread(const JointFit& fit, std::size_t which) const;
  [[nodiscard]] double within_group(const JointFit& fit, std::size_t which) const;

 private:
  struct Scored;
  [[nodiscard]] Scored scored(const Eigen::MatrixXd& more, const Eigen::VectorXd& x) const;
  void add_slopes(const Eigen::VectorXd& x, Scored& here) const;
  [[nodiscard]] Eigen::MatrixXd columns(const Supposition& supposed) const;
  [[nodiscard]] Eigen::MatrixXd covariance(const Eigen::VectorXd& ln_levels) const;
  [[nodiscard]] Eigen::MatrixXd slope(const Eigen::VectorXd& ln_levels, Eigen::Index level) const;
  [[nodiscard]] Eigen::MatrixXd between_bodies(const Eigen::VectorXd& ln_levels,
                                               std::size_t constant) const;
  [[nodiscard]] Eigen::Index ratio_level() const { return level_count() - 1; }

  const Series& series_;
  Eigen::VectorXd usual_, width_, at_most_;  // ln; ln; ln
  Eigen::MatrixXd known_;                    // noise, means, entries as they usually are
  Eigen::MatrixXd shared_, own_;             // parts of unit level
  std::vector<Eigen::MatrixXd> group_, body_;
  Eigen::MatrixXd same_group_;  // b×b
};

}  // namespace chladni::diagnosis
