// Parts of the data that are held out in turn.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/cross_validation.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

/// A part as indices: responses of some outputs on some lines.
struct DataPart {
  HeldOutPart told;
  std::vector<Eigen::Index> outputs;  ///< ascending
  double low = 0.0, high = 0.0;       ///< [rad/s], both in the part

  [[nodiscard]] bool holds(Eigen::Index output, double omega) const;
};

/// Each output in turn (where there are two; of many, a few at a time, as many as
/// Constants::sensor_parts), blocks of lines with whole resonances (their borders are where the
/// measured responses are least), and the upper part of the band. Parts of fewer than
/// Constants::least_lines are left out.
[[nodiscard]] std::vector<DataPart> held_out_parts(const std::vector<std::string>& outputs,
                                                   const Observed& observed);

/// The data without a part, and that part alone.
[[nodiscard]] Observed without(const Observed& observed, const DataPart& part);
[[nodiscard]] Observed only(const Observed& observed, const DataPart& part);

}  // namespace chladni::diagnosis
