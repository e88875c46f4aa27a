#include "diagnosis/modes/partner.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/decompositions.h"
#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr auto kTiny = std::numeric_limits<double>::min();

// The channels of one side that have a value in a measured mode.
struct PartnerValues {
  std::vector<Index> rows;
  VectorXcd value;  // without the phases of the paths
  VectorXd noise;
  MatrixXd shapes;  // of all modes of the model, times the sizes of the paths
  VectorXd path;    // sizes of the paths
};

PartnerValues partner_values(const MatrixXcd& measured, const MatrixXd& deviation, Index i,
                             const MatrixXd& shapes, const MatrixXcd& path, Index k) {
  PartnerValues values;
  values.rows = rows_with_values(measured, i);
  const auto n = static_cast<Index>(values.rows.size());
  values.value.resize(n);
  values.noise.resize(n);
  values.path.resize(n);
  values.shapes.resize(n, shapes.cols());
  for (Index a = 0; a < n; ++a) {
    const Index row = values.rows[at(a)];
    const Complex way = path(row, k);
    const double size = std::abs(way);
    values.value(a) = measured(row, i) * std::conj(way) / std::max(size, kTiny);
    values.noise(a) = deviation(row, i);
    values.path(a) = size;
    values.shapes.row(a) = size * shapes.row(row);
  }
  return values;
}

PartnerValues sensor_values(const MeasuredModes& measured, const RecordedModes& model, Index i,
                            Index k) {
  return partner_values(measured.output_shapes, measured.output_std, i, model.outputs,
                        model.output_path, k);
}
PartnerValues actuator_values(const MeasuredModes& measured, const RecordedModes& model, Index i,
                              Index k) {
  return partner_values(measured.input_shapes, measured.input_std, i, model.inputs,
                        model.input_path, k);
}

// Parts of the modes of a span that fit the shape best, beside errors of kConstants.shape_error.
VectorXd parts_of(const RecordedModes& model, const std::vector<Index>& span,
                  const PartnerValues& values) {
  VectorXd parts = VectorXd::Unit(model.count(), span.front());
  if (span.size() == 1) return parts;
  const VectorXd real = (values.value * std::conj(phase_of(values.value))).real();
  const MatrixXd basis = values.shapes(Eigen::all, span);
  MatrixXd normal = basis.transpose() * basis;
  const double scale = normal(0, 0);
  for (std::size_t l = 1; l < span.size(); ++l) {
    const double apart =
        std::abs(std::log(model.frequency_hz(span[l]) / model.frequency_hz(span[0])));
    const auto i = static_cast<Index>(l);
    normal(i, i) +=
        scale * std::pow(kConstants.shape_error / std::max(part_deviation(apart), 1e-9), 2);
  }
  const VectorXd found = normal.ldlt().solve(VectorXd(basis.transpose() * real));
  if (!found.allFinite() || !(found.norm() > 0.0)) return parts;
  parts.setZero();
  parts(span) = found.normalized();
  return parts;
}

double root_mean_square(const auto& vector) {
  return vector.norm() / std::sqrt(static_cast<double>(std::max<Index>(vector.size(), 1)));
}

PartnerSide side_of(const PartnerValues& values, const VectorXd& parts, double unit) {
  PartnerSide side;
  side.rows = values.rows;
  const VectorXd shape = values.shapes * parts;
  const double least = unit * root_mean_square(values.path) / kConstants.blindest;
  const double size = std::max({root_mean_square(shape), least, kTiny});
  side.model = shape / size;
  side.recorded = values.path / size;
  side.weight = unit * side.recorded;
  if (side.count() == 0) return side;
  const double measured = std::max(root_mean_square(values.value), kTiny);
  const Complex product = shape.cast<Complex>().dot(values.value);
  side.factor = std::polar(measured / size, std::arg(product));
  // The measured shape has its own phase, and the model its sign: the factor of a side that hardly
  // sees the mode has no phase, and the sign of a simulated shape is arbitrary.
  const Complex turn = std::conj(phase_of(values.value));
  side.measured = values.value * turn / measured;
  if ((side.factor * turn).real() < 0.0) {
    side.model = -side.model;
    side.recorded = -side.recorded;
  }
  side.noise = values.noise / measured;
  return side;
}

// True where the values lie across the shape as much as errors of the body's shapes let them.
bool has_open_sign(const PartnerSide& side) {
  const double along = std::abs(side.model.cast<Complex>().dot(side.measured));
  return along < kConstants.blind_error * side.blindness() * side.model.norm();
}

// A side on the nodes of a mode has no sign of its own. A residue has one, which the other side
// passes on.
void agree_on_sign(PartnerSide& sensors, PartnerSide& actuators) {
  if (!((sensors.factor * actuators.factor).real() < 0.0)) return;
  auto& blinder = sensors.blindness() > actuators.blindness() ? sensors : actuators;
  if (!has_open_sign(blinder)) return;
  blinder.factor = -blinder.factor;
  blinder.model = -blinder.model;
  blinder.recorded = -blinder.recorded;
}

double mac_of(const PartnerSide& side) {
  if (!side.is_shape()) return 1.0;
  const Complex product = side.model.cast<Complex>().dot(side.measured);
  return std::norm(product) /
         std::max(side.model.squaredNorm() * side.measured.squaredNorm(), kTiny);
}

// What the channels do not see is less alike than a partner and more alike than a stranger.
double likeness_of(const PartnerSide& side) {
  if (!side.is_shape()) return 1.0;
  const double trust = 1.0 / (1.0 + std::pow(kConstants.blind_error * side.blindness(), 4));
  return trust * mac_of(side) + (1.0 - trust) * kConstants.unseen_likeness;
}

}  // namespace

double part_deviation(double apart) {
  return 0.1 * std::max(0.0, kConstants.neighbours - apart) / std::max(apart, 1e-9);
}

std::vector<Index> rows_with_values(const MatrixXcd& shapes, Index i) {
  std::vector<Index> rows;
  for (Index row = 0; row < shapes.rows(); ++row) {
    if (std::isfinite(std::abs(shapes(row, i)))) rows.push_back(row);
  }
  return rows;
}

Complex phase_of(const VectorXcd& shape) {
  const Complex square = shape.cwiseProduct(shape).sum();
  return std::polar(1.0, 0.5 * std::arg(square));
}

ShapeUnits shape_units(const Structure& structure) {
  const auto unit = [&](const MatrixXd& shapes) {
    const MatrixXd flexible = shapes.rightCols(structure.mode_count() - structure.rigid_count);
    return flexible.size() == 0 ? 1.0 : root_mean_square(flexible);
  };
  return {unit(structure.outputs.shapes), unit(structure.inputs.shapes)};
}

double visibility(const VectorXd& shape, double unit) {
  if (shape.size() == 0) return 1.0;
  const double seen = kConstants.blindest * root_mean_square(shape) / unit;
  return seen * seen / (1.0 + seen * seen);
}

double PartnerSide::blindness() const { return root_mean_square(weight); }

double Partner::mac() const { return mac_of(sensors) * mac_of(actuators); }

double Partner::likeness() const { return likeness_of(sensors) * likeness_of(actuators); }

std::vector<Index> span_of(const MeasuredModes& measured, const RecordedModes& model, Index i,
                           Index k) {
  const Index outputs = std::ssize(rows_with_values(measured.output_shapes, i));
  const Index inputs = std::ssize(rows_with_values(measured.input_shapes, i));
  const auto apart = [&](Index l) {
    return std::abs(std::log(model.frequency_hz(l) / model.frequency_hz(k)));
  };
  std::vector<Index> span{k};
  for (Index l = 0; l < model.count(); ++l) {
    if (l != k && apart(l) < kConstants.neighbours) span.push_back(l);
  }
  std::stable_sort(span.begin() + 1, span.end(),
                   [&](Index a, Index b) { return apart(a) < apart(b); });
  const auto most = static_cast<std::size_t>(std::max<Index>(1, std::max(outputs, inputs) - 2));
  if (span.size() > most) span.resize(most);
  return span;
}

Partner partner(const MeasuredModes& measured, const RecordedModes& model, const ShapeUnits& units,
                Index i, const std::vector<Index>& span) {
  const PartnerValues out = sensor_values(measured, model, i, span.front());
  const PartnerValues in = actuator_values(measured, model, i, span.front());
  Partner result;
  result.parts = parts_of(model, span, out.value.size() >= in.value.size() ? out : in);
  result.sensors = side_of(out, result.parts, units.outputs);
  result.actuators = side_of(in, result.parts, units.inputs);
  const bool has_residue = result.sensors.count() > 0 && result.actuators.count() > 0;
  if (measured.scaled && has_residue) agree_on_sign(result.sensors, result.actuators);
  return result;
}

}  // namespace chladni::diagnosis
