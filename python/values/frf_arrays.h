// Matrices of each line as one array, and back.
#pragma once

#include <pybind11/complex.h>
#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "base/error.h"
#include "modal/frf_set.h"
#include "python/values/given.h"

namespace chladni::python {

using Complexes =
    pybind11::array_t<std::complex<double>, pybind11::array::c_style | pybind11::array::forcecast>;
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Lines × rows × columns as one matrix for each line.
/// @throws InvalidInput  another shape; `what` names the array
template <typename Matrix, typename Array>
std::vector<Matrix> matrices_of(const Array& array, const std::string& what, Eigen::Index rows,
                                Eigen::Index columns) {
  require(array.ndim() == 3 && array.shape(1) == rows && array.shape(2) == columns,
          what + " needs the shape lines x outputs x inputs");
  const auto values = array.template unchecked<3>();
  std::vector<Matrix> matrices;
  for (pybind11::ssize_t k = 0; k < array.shape(0); ++k) {
    Matrix matrix(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < columns; ++j) matrix(i, j) = values(k, i, j);
    }
    matrices.push_back(std::move(matrix));
  }
  return matrices;
}

/// @throws InvalidInput  real numbers: magnitudes or decibels have no phase; `what` names the array
inline void require_phase(pybind11::handle responses, const std::string& what) {
  require(is_complex(responses),
          what + " is real, without a phase; expected complex numbers (where the imaginary parts " +
              "are 0: " + what + ".astype(complex))");
}

template <typename Array, typename Matrix>
Array array_of(const std::vector<Matrix>& matrices, Eigen::Index rows, Eigen::Index columns) {
  Array array({std::ssize(matrices), rows, columns});
  auto values = array.template mutable_unchecked<3>();
  for (std::size_t k = 0; k < matrices.size(); ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < columns; ++j) {
        values(static_cast<pybind11::ssize_t>(k), i, j) = matrices[k](i, j);
      }
    }
  }
  return array;
}

/// Lines of a set, or None where it has none of the kind.
template <typename Array, typename Matrix>
pybind11::object array_or_none(const std::vector<Matrix>& lines, const modal::FrfSet& set) {
  if (lines.empty()) return pybind11::none();
  return array_of<Array>(lines, set.output_count(), set.input_count());
}

}  // namespace chladni::python
