#include "diagnosis/readings/bands.h"

#include <algorithm>
#include <cmath>

namespace chladni::diagnosis {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

// Width of frequency that each line stands for: half of the way to its neighbours.
VectorXd widths(const VectorXd& omega) {
  VectorXd width = VectorXd::Ones(omega.size());
  const Index last = omega.size() - 1;
  for (Index k = 0; last > 0 && k <= last; ++k) {
    width(k) = 0.5 * (omega(std::min(k + 1, last)) - omega(std::max<Index>(k - 1, 0)));
  }
  return width;
}

// Mean over each band and its neighbours.
ArrayXd with_neighbours(const ArrayXd& value) {
  ArrayXd mean(value.size());
  for (Index b = 0; b < value.size(); ++b) {
    const Index first = std::max<Index>(b - 1, 0);
    mean(b) = value.segment(first, std::min(b + 2, value.size()) - first).mean();
  }
  return mean;
}

}  // namespace

Bands bands_of(const VectorXd& omega, const BandNumbers& numbers) {
  const double low = omega(0);
  const double span = std::log(omega(omega.size() - 1) / low);
  const auto count = static_cast<Index>(std::floor(span / std::log1p(numbers.apart))) + 1;
  Bands bands{VectorXd(count), Eigen::MatrixXd(count, omega.size())};
  const VectorXd width = widths(omega);
  for (Index b = 0; b < count; ++b) {
    bands.omega(b) = low * std::pow(1.0 + numbers.apart, static_cast<double>(b));
    const double half = numbers.half_width * bands.omega(b);
    const ArrayXd off = (omega.array() - bands.omega(b)) / half;
    const ArrayXd weight = width.array() / (1.0 + off.square());
    bands.average.row(b) = (weight / weight.sum()).matrix().transpose();
  }
  return bands;
}

BandPair::BandPair(const Eigen::VectorXcd& measured, const Eigen::VectorXcd& model)
    : measured2_(measured.cwiseAbs2().array()),
      model2_(model.cwiseAbs2().array()),
      along_((measured.array() * model.array().conjugate()).real()),
      measured_level_(with_neighbours(measured2_)),
      model_level_(with_neighbours(model2_)) {}

double BandPair::distance(double factor) const {
  const double factor2 = factor * factor;
  const ArrayXd apart = measured2_ - 2.0 * factor * along_ + factor2 * model2_;
  const ArrayXd level = 0.5 * (measured_level_ + factor2 * model_level_);
  return (apart / level.max(1e-300)).mean();
}

double misfit_of(double distance, Index bands, const BandNumbers& numbers) {
  const double least = numbers.least_error * numbers.least_error;
  return static_cast<double>(bands) * std::log(distance + least);
}

}  // namespace chladni::diagnosis
