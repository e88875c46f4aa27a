#include "diagnosis/compare.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "diagnosis/constants.h"
#include "modal/frf.h"

namespace chladni::diagnosis {
namespace {

using Indices = std::vector<Eigen::Index>;

struct Collocated {
  Eigen::Index output = 0, input = 0;
  double sign = 1.0;
};

std::vector<Collocated> collocated(const modal::ReducedModel& model) {
  std::vector<Collocated> pairs;
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    const Eigen::RowVectorXd sensor = model.output_shapes.row(i);
    for (Eigen::Index j = 0; j < model.input_count(); ++j) {
      const Eigen::RowVectorXd actuator = model.input_shapes.col(j).transpose();
      const double sign = sensor.dot(actuator) < 0.0 ? -1.0 : 1.0;
      if ((sensor - sign * actuator).norm() > kConstants.one_place * sensor.norm()) continue;
      pairs.push_back({i, j, sign});
      break;
    }
  }
  return pairs;
}

// Sums over lines where both are measured.
struct Sums {
  std::complex<double> between = 0.0;
  double one = 0.0, other = 0.0, different = 0.0, variance = 0.0;
  bool stated = false;
  Eigen::Index lines = 0;
};

Sums sums(const modal::FrfSet& set, const Collocated& a, const Collocated& b,
          const ComparisonOptions& options) {
  Sums result;
  result.stated = !set.variance.empty();
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const double f = set.frequency_hz(static_cast<Eigen::Index>(k));
    if (f < options.low_hz || f > options.high_hz) continue;
    const auto ab = a.sign * b.sign * set.value[k](a.output, b.input);
    const auto ba = set.value[k](b.output, a.input);
    if (!std::isfinite(std::abs(ab)) || !std::isfinite(std::abs(ba))) continue;
    ++result.lines;
    result.between += std::conj(ba) * ab;
    result.one += std::norm(ab);
    result.other += std::norm(ba);
    result.different += std::norm(ab - ba);
    if (!result.stated) continue;
    result.variance += set.variance[k](a.output, b.input) + set.variance[k](b.output, a.input);
  }
  return result;
}

Reciprocity of(const Collocated& a, const Collocated& b, const Sums& sum) {
  Reciprocity result{a.output, a.input, b.output, b.input};
  const double size = 0.5 * (sum.one + sum.other);
  result.difference = std::sqrt(sum.different / size);
  result.noise = sum.stated ? std::sqrt(sum.variance / size) : NAN;
  result.ratio = sum.between.real() / sum.other;
  const double left = sum.one - std::pow(sum.between.real(), 2) / sum.other;
  result.left = std::sqrt(std::max(left, 0.0) / sum.one);
  return result;
}

// Indices of the names of `wanted` among those of the structure; −1: not there.
Indices places(const std::vector<modal::MeasuredChannel>& wanted,
               const std::vector<std::string>& names) {
  Indices result;
  for (const auto& one : wanted) {
    const auto found = std::find(names.begin(), names.end(), one.name);
    result.push_back(found == names.end() ? -1 : found - names.begin());
  }
  return result;
}

// Rows of the measurement that the structure also has.
Indices shared(const Indices& places) {
  Indices rows;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] >= 0) rows.push_back(static_cast<Eigen::Index>(i));
  }
  return rows;
}

Indices picked(const Indices& of, const Indices& rows) {
  Indices result;
  for (const auto row : rows) result.push_back(of[static_cast<std::size_t>(row)]);
  return result;
}

modal::ReducedModel part(const modal::ReducedModel& model, const Indices& outputs,
                         const Indices& inputs) {
  auto result = model;
  result.output_shapes = model.output_shapes(outputs, Eigen::all);
  result.input_shapes = model.input_shapes(Eigen::all, inputs);
  result.residual = model.residual(outputs, inputs);
  result.dampers.to_outputs = model.dampers.to_outputs(outputs, Eigen::all);
  result.dampers.from_inputs = model.dampers.from_inputs(Eigen::all, inputs);
  return result;
}

identification::ModalFit part(const identification::ModalFit& fit, const Indices& outputs,
                              const Indices& inputs) {
  auto result = fit;
  result.model.output_shapes = fit.model.output_shapes(outputs, Eigen::all);
  result.model.input_shapes = fit.model.input_shapes(Eigen::all, inputs);
  result.output_std = fit.output_std(outputs, Eigen::all);
  result.input_std = fit.input_std(Eigen::all, inputs);
  return result;
}

}  // namespace

modal::ReducedModel reduced_model(const Structure& structure) {
  const auto r = structure.mode_count();
  const auto p = structure.output_count();
  const auto q = structure.input_count();
  modal::ReducedModel model{structure.frequency_hz,
                            structure.damping_ratio,
                            structure.rigid_count,
                            structure.outputs.shapes,
                            structure.inputs.shapes.transpose(),
                            structure.residual,
                            {}};
  Eigen::MatrixXd dampers(0, r);
  if (structure.dashpots.size() > 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(structure.dashpots);
    const Eigen::VectorXd& values = solver.eigenvalues();
    const auto count = (values.array() > 1e-12 * values.maxCoeff()).count();
    dampers = values.tail(count).cwiseSqrt().asDiagonal() *
              solver.eigenvectors().rightCols(count).transpose();
  }
  const auto d = dampers.rows();
  model.dampers = {dampers, Eigen::MatrixXd::Zero(p, d), Eigen::MatrixXd::Zero(d, q),
                   Eigen::MatrixXd::Zero(d, d)};
  return model;
}

std::vector<Reciprocity> reciprocity(const modal::FrfSet& measured,
                                     const modal::ReducedModel& simulated,
                                     const ComparisonOptions& options) {
  const auto pairs = collocated(simulated);
  std::vector<Reciprocity> result;
  for (std::size_t a = 0; a < pairs.size(); ++a) {
    for (std::size_t b = a + 1; b < pairs.size(); ++b) {
      const auto sum = sums(measured, pairs[a], pairs[b], options);
      if (sum.lines == 0 || !(sum.one > 0.0) || !(sum.other > 0.0)) continue;
      result.push_back(of(pairs[a], pairs[b], sum));
    }
  }
  return result;
}

Comparison compared(const Structure& structure, const modal::FrfSet& measured,
                    const identification::ModalFit* fit, const ComparisonOptions& options) {
  const auto outputs = places(measured.outputs, structure.outputs.names);
  const auto inputs = places(measured.inputs, structure.inputs.names);
  const auto rows = shared(outputs);
  const auto columns = shared(inputs);
  require(!rows.empty() && !columns.empty(),
          "comparison: simulation and measurement have no sensor or no actuator in common");
  const auto lowest = std::max(options.low_hz, 1e-12);  // a response at 0 Hz may be infinite
  const auto seen =
      modal::converted(modal::band(modal::part(measured, rows, columns), lowest, options.high_hz),
                       modal::FrfKind::receptance);
  require(seen.line_count() > 0, "comparison: nothing was measured in the band");
  const auto model = part(reduced_model(structure), picked(outputs, rows), picked(inputs, columns));
  const auto simulated = modal::frf(model, seen.frequency_hz);
  Comparison result;
  result.responses = compared(seen, simulated.value, options);
  if (fit != nullptr) {
    auto measured_band = options;
    measured_band.low_hz = seen.frequency_hz(0);
    measured_band.high_hz = seen.frequency_hz(seen.line_count() - 1);
    result.modes = compared(model, part(*fit, rows, columns), measured_band);
  }
  result.reciprocity = reciprocity(seen, model, options);
  result.swaps = swaps(seen, simulated.value, options);
  return result;
}

}  // namespace chladni::diagnosis
