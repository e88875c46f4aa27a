// What the tests of identify read from the program's JSON.
#pragma once

#include <Eigen/Core>

#include "io/json.h"

namespace chladni::app {

/// Places of the thesis beam's five sensors and coils along it [m].
inline const Eigen::VectorXd kPlaces{{0.05, 0.15, 0.25, 0.35, 0.45}};

/// A matrix as the JSON carries it: a list of rows of equal length, at least one.
inline Eigen::MatrixXd matrix(const io::Json& rows) {
  Eigen::MatrixXd result(std::ssize(rows.array()), std::ssize(rows.array().front().array()));
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    for (Eigen::Index j = 0; j < result.cols(); ++j) {
      result(i, j) =
          rows.array()[static_cast<std::size_t>(i)].array()[static_cast<std::size_t>(j)].number();
    }
  }
  return result;
}

}  // namespace chladni::app
