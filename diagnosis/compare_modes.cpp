// Simulated modes beside identified ones.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "diagnosis/compare.h"
#include "modal/groups.h"
#include "modal/mac.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {
namespace {

using Indices = std::vector<Eigen::Index>;

constexpr double kInView = 1e-4;      // of the largest shape at the channels of one side
constexpr double kBeyondLast = 1.05;  // of the last measured mode

/// Flexible modes at the channels that were measured, on one side and the other.
struct Seen {
  Indices column;  // in the model
  Eigen::VectorXd frequency_hz;
  Eigen::MatrixXd outputs, inputs;  // rows that were measured × modes
};

Indices finite_rows(const Eigen::MatrixXd& deviation) {
  Indices rows;
  for (Eigen::Index i = 0; i < deviation.rows(); ++i) {
    if (deviation.row(i).allFinite()) rows.push_back(i);
  }
  return rows;
}

Seen seen(const modal::ReducedModel& model, const Indices& outputs, const Indices& inputs,
          double high_hz) {
  const Eigen::MatrixXd at_outputs = model.output_shapes(outputs, Eigen::all);
  const Eigen::MatrixXd at_inputs = model.input_shapes.transpose()(inputs, Eigen::all);
  const auto flexible = model.mode_count() - model.rigid_count;
  Seen result;
  if (flexible == 0) return result;
  const double most_out = at_outputs.rightCols(flexible).colwise().norm().maxCoeff();
  const double most_in = at_inputs.rightCols(flexible).colwise().norm().maxCoeff();
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    if (model.frequency_hz(m) > high_hz) continue;
    if (!(at_outputs.col(m).norm() > kInView * most_out)) continue;
    if (!(at_inputs.col(m).norm() > kInView * most_in)) continue;
    result.column.push_back(m);
  }
  result.frequency_hz = model.frequency_hz(result.column);
  result.outputs = at_outputs(Eigen::all, result.column);
  result.inputs = at_inputs(Eigen::all, result.column);
  return result;
}

modal::Modes as_modes(const Seen& of, const Eigen::MatrixXd& shapes) {
  return {of.frequency_hz, Eigen::VectorXd::Zero(of.frequency_hz.size()), shapes, 0};
}

ModeDifference difference(const modal::ReducedModel& simulated, const identification::ModalFit& fit,
                          Eigen::Index a, Eigen::Index b, double mac) {
  ModeDifference one;
  one.simulated = a;
  one.measured = b;
  one.simulated_hz = simulated.frequency_hz(a);
  one.measured_hz = fit.model.frequency_hz(b);
  one.measured_std_hz = fit.frequency_std_hz(b);
  one.change = one.measured_hz / one.simulated_hz - 1.0;
  one.change_std = one.measured_std_hz / one.simulated_hz;
  one.simulated_damping = simulated.damping_ratio(a);
  one.measured_damping = fit.model.damping_ratio(b);
  one.measured_damping_std = fit.damping_std(b);
  one.mac = mac;
  return one;
}

// Of each measured shape and what of the simulated mode's group is nearest to it, with unit norm.
Eigen::VectorXd comac(const modal::Pairing& pairing, const Eigen::VectorXd& frequency_hz,
                      const Eigen::MatrixXd& simulated, const Eigen::MatrixXd& measured,
                      double gap) {
  const auto n = static_cast<Eigen::Index>(pairing.pairs.size());
  if (n == 0) return Eigen::VectorXd::Constant(simulated.rows(), NAN);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(simulated.rows(), n);
  Eigen::MatrixXd b = a;
  const auto groups = modal::groups(frequency_hz, gap);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& pair = pairing.pairs[static_cast<std::size_t>(k)];
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& one) { return pair.a < one.first + one.size; });
    const Eigen::MatrixXd span = simulated.middleCols(group->first, group->size);
    b.col(k) = measured.col(pair.b).normalized();
    a.col(k) = (span * span.colPivHouseholderQr().solve(b.col(k))).normalized();
  }
  return modal::comac(a, b);
}

// Pairs that are alike for modes so far apart: with few channels, shapes resemble each other.
modal::Pairing paired(const Seen& a, const Seen& b, const ComparisonOptions& options) {
  const double gap = options.repeated_gap;
  const auto out_a = as_modes(a, a.outputs);
  const auto out_b = as_modes(b, b.outputs);
  const Eigen::MatrixXd at_inputs = modal::alike(as_modes(a, a.inputs), as_modes(b, b.inputs), gap);
  auto pairing = modal::pairing_by(modal::alike(out_a, out_b, gap).cwiseProduct(at_inputs), out_a,
                                   out_b, {.repeated_gap = gap, .least_mac = options.least_mac});
  std::erase_if(pairing.pairs, [&](const modal::ModePair& pair) {
    const double apart = std::log1p(pair.frequency_change);
    if (pair.mac - apart * apart >= options.least_mac) return false;
    pairing.alone_a.push_back(pair.a);
    pairing.alone_b.push_back(pair.b);
    return true;
  });
  std::sort(pairing.alone_a.begin(), pairing.alone_a.end());
  std::sort(pairing.alone_b.begin(), pairing.alone_b.end());
  return pairing;
}

void set_pairs(const modal::Pairing& pairing, const modal::ReducedModel& simulated,
               const identification::ModalFit& fit, ModeComparison& result) {
  const auto of_a = [&](Eigen::Index k) {
    return result.simulated_modes[static_cast<std::size_t>(k)];
  };
  const auto of_b = [&](Eigen::Index k) {
    return result.measured_modes[static_cast<std::size_t>(k)];
  };
  for (const auto& pair : pairing.pairs) {
    result.pairs.push_back(difference(simulated, fit, of_a(pair.a), of_b(pair.b), pair.mac));
  }
  for (const auto k : pairing.alone_a) result.simulated_alone.push_back(of_a(k));
  result.measured_alone.clear();
  for (const auto k : pairing.alone_b) result.measured_alone.push_back(of_b(k));
}

void spread(const Eigen::VectorXd& values, const Indices& rows, Eigen::VectorXd& all) {
  for (std::size_t i = 0; i < rows.size(); ++i) all(rows[i]) = values(static_cast<Eigen::Index>(i));
}

}  // namespace

ModeComparison compared(const modal::ReducedModel& simulated, const identification::ModalFit& fit,
                        const ComparisonOptions& options) {
  const auto p = simulated.output_count();
  const auto q = simulated.input_count();
  require(fit.model.output_count() == p && fit.model.input_count() == q,
          "comparison: the identified model has other channels than the simulation");
  const Indices outputs = finite_rows(fit.output_std);
  const Indices inputs = finite_rows(fit.input_std.transpose());
  ModeComparison result;
  result.output_comac = Eigen::VectorXd::Constant(p, NAN);
  result.input_comac = Eigen::VectorXd::Constant(q, NAN);
  const Seen b = seen(fit.model, outputs, inputs, HUGE_VAL);
  if (b.column.empty()) return result;
  const double last = kBeyondLast * b.frequency_hz.maxCoeff();
  const Seen a = seen(simulated, outputs, inputs, 2.0 * last);
  result.simulated_modes = a.column;
  result.measured_modes = b.column;
  result.simulated_hz = {a.frequency_hz.begin(), a.frequency_hz.end()};
  result.measured_hz = {b.frequency_hz.begin(), b.frequency_hz.end()};
  result.measured_alone = b.column;
  if (a.column.empty()) return result;
  const auto pairing = paired(a, b, options);
  set_pairs(pairing, simulated, fit, result);
  std::erase_if(result.simulated_alone, [&](Eigen::Index k) {
    const double f = simulated.frequency_hz(k);
    return f < options.low_hz || f > std::min(options.high_hz, last);
  });
  result.mac = modal::mac(a.outputs, b.outputs).cwiseProduct(modal::mac(a.inputs, b.inputs));
  const double gap = options.repeated_gap;
  spread(comac(pairing, a.frequency_hz, a.outputs, b.outputs, gap), outputs, result.output_comac);
  spread(comac(pairing, a.frequency_hz, a.inputs, b.inputs, gap), inputs, result.input_comac);
  return result;
}

}  // namespace chladni::diagnosis
