// Values for what was not measured, where equations need every response. Used in this room only.
#pragma once

#include <Eigen/Core>

#include "identification/fit_data.h"

namespace chladni::identification {

/// K×pq: the data, with the values of a vector fit where nothing was measured: its residues there
/// are those of matrices of rank one, its constant is 0. All modes are known to it that the other
/// responses show. Data that were measured in full stay as they are. Cost: one vector fit.
/// @throws InvalidInput  as vector_fit
[[nodiscard]] Eigen::MatrixXcd filled(const FitData& data);

}  // namespace chladni::identification
