// Values for what was not measured, where equations need every response. Used in this room only.
#pragma once

#include <Eigen/Core>

#include "base/progress.h"
#include "identification/fit_data.h"

namespace chladni::identification {

/// K×pq: the data, with the values of a vector fit where nothing was measured: its residues there
/// are those of matrices of rank one, its constant is 0. All modes are known to it that the other
/// responses show. Data that were measured in full stay as they are, at no cost.
/// Cost: the vector fits of rising order of start_poles.
/// @throws as start_poles
[[nodiscard]] Eigen::MatrixXcd filled(const FitData& data, const Progress& progress = {});

}  // namespace chladni::identification
