// Modes and channels that two measurements have in common.
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/partner.h"
#include "diagnosis/modes/reference/reference.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

double mac_of(const MatrixXcd& a, Index i, const MatrixXcd& b, Index j) {
  const auto rows = rows_of_both(a, i, b, j);
  if (rows.size() < 2) return 1.0;
  const VectorXcd one = a(rows, i);
  const VectorXcd other = b(rows, j);
  const double squares = one.squaredNorm() * other.squaredNorm();
  return squares > 0.0 ? std::norm(one.dot(other)) / squares : 0.0;
}

// The channels of one side that the other measurement has, too.
std::vector<Index> shared_rows(const std::vector<std::string>& names,
                               const std::vector<std::string>& others, const char* lacks,
                               std::vector<std::string>& notes) {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::find(others, names[i]) != others.end()) {
      rows.push_back(static_cast<Index>(i));
    } else {
      notes.push_back(names[i] + lacks);
    }
  }
  return rows;
}

MeasuredModes with_rows(const MeasuredModes& all, const std::vector<Index>& outputs,
                        const std::vector<Index>& inputs) {
  MeasuredModes part = all;
  part.outputs.clear();
  part.inputs.clear();
  for (const Index i : outputs) part.outputs.push_back(all.outputs[at(i)]);
  for (const Index i : inputs) part.inputs.push_back(all.inputs[at(i)]);
  part.output_shapes = all.output_shapes(outputs, Eigen::all);
  part.output_std = all.output_std(outputs, Eigen::all);
  part.input_shapes = all.input_shapes(inputs, Eigen::all);
  part.input_std = all.input_std(inputs, Eigen::all);
  return part;
}

}  // namespace

std::vector<Index> rows_of_both(const MatrixXcd& a, Index i, const MatrixXcd& b, Index j) {
  auto rows = rows_with_values(a, i);
  std::erase_if(rows, [&](Index row) { return !std::isfinite(std::abs(b(row, j))); });
  return rows;
}

std::vector<Index> earlier_modes(const MeasuredModes& later, const MeasuredModes& reference) {
  MatrixXd cost(later.count(), reference.count());
  for (Index i = 0; i < cost.rows(); ++i) {
    for (Index j = 0; j < cost.cols(); ++j) {
      const double apart =
          std::log(later.frequency_hz(i) / reference.frequency_hz(j)) / kConstants.apart;
      const double mac = mac_of(later.output_shapes, i, reference.output_shapes, j) *
                         mac_of(later.input_shapes, i, reference.input_shapes, j);
      cost(i, j) = 1.0 - mac + apart * apart;
    }
  }
  std::vector<Index> earlier(at(later.count()), -1);
  for (const auto& [i, j] : modal::assigned(cost, 1.0 - kConstants.least_mac)) earlier[at(i)] = j;
  return earlier;
}

Common common(const MeasuredModes& later, const MeasuredModes& reference) {
  check(later);
  check(reference);
  Common both;
  const char* only_later = " was measured later only: left out";
  const char* only_before = " was measured in the reference only: left out";
  const auto out = shared_rows(later.outputs, reference.outputs, only_later, both.notes);
  const auto in = shared_rows(later.inputs, reference.inputs, only_later, both.notes);
  require(!out.empty() || later.outputs.empty() || reference.outputs.empty(),
          "no sensor in common: the modes before and after name other sensors");
  both.later = with_rows(later, out, in);
  both.reference =
      with_rows(reference, shared_rows(reference.outputs, later.outputs, only_before, both.notes),
                shared_rows(reference.inputs, later.inputs, only_before, both.notes));
  const auto earlier = earlier_modes(both.later, both.reference);
  require(std::ranges::any_of(earlier, [](Index j) { return j >= 0; }),
          "no mode in common: those before and after differ in frequency or shape");
  return both;
}

}  // namespace chladni::diagnosis
