// The numbers of all specimens in one linear model.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnosis/specimens.h"

namespace chladni::diagnosis {

/// n numbers: ln f of each paired mode of each measurement, measured less model, and ln of each
/// weighed mass likewise. b bodies: the specimens without those that are measured again.
struct Series {
  struct Row {
    Eigen::Index measurement = 0, body = 0;
    Eigen::Index mode = -1;      ///< of the design, the same in all specimens; −1: a mass
    Eigen::Index measured = -1;  ///< place in MeasuredModes
  };
  /// A constant of the population.
  struct Constant {
    CalibratedConstant stated;  ///< of the first body; `value`: the mean of what is stated
    double width = 0.0;         ///< of the prior of the mean, in ln
    Eigen::MatrixXd slope;      ///< n×b: rows by ln of the constant of each body
    Eigen::VectorXd of_body;    ///< b: ln of what is stated, less ln of `stated.value`
  };
  /// A number of one body with its own small deviation.
  struct Entry {
    CalibratedConstant stated;
    Eigen::Index body = 0;
    bool may_be_wrong = false;
    Eigen::VectorXd slope;  ///< n: rows by ln(true over stated)
  };

  std::vector<Row> rows;
  Eigen::VectorXd error, noise;  ///< n: with all constants as stated.value and all entries right
  std::vector<Constant> constants;
  std::vector<Entry> entries;
  std::vector<Eigen::Index> group;  ///< b: number of its group
  bool has_groups = false;
  std::vector<std::string> bodies;  ///< b names
  Eigen::Index modes = 0;           ///< of the design

  [[nodiscard]] Eigen::Index count() const { return error.size(); }
  [[nodiscard]] Eigen::Index body_count() const { return static_cast<Eigen::Index>(bodies.size()); }
};

/// Place in `series.entries` of an entry of a body, −1: it has none of that key.
[[nodiscard]] Eigen::Index entry_of(const Series& series, Eigen::Index body,
                                    const std::string& key);
/// Place in `series.constants`, −1: none of that key.
[[nodiscard]] Eigen::Index constant_of(const Series& series, const std::string& key);

}  // namespace chladni::diagnosis
