// Comparison of simulated modes with identified modes.
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "diagnosis/compare.h"
#include "diagnosis/constants.h"
#include "modal/dashpot_ratio.h"
#include "modal/groups.h"
#include "modal/mac.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Flexible modes at the channels that were measured, ascending in frequency.
struct ModesAtChannels {
  Indices column;  // in the model
  Eigen::VectorXd frequency_hz;
  Eigen::MatrixXd outputs, inputs;  // rows that were measured × modes
};

struct Channels {
  Indices outputs, inputs;
};

Indices finite_rows(const Eigen::MatrixXd& deviation) {
  Indices rows;
  for (Eigen::Index i = 0; i < deviation.rows(); ++i) {
    if ((deviation.row(i).array() < HUGE_VAL).any()) rows.push_back(i);
  }
  return rows;
}

Indices flexible(const modal::ReducedModel& model) {
  Indices columns(static_cast<std::size_t>(model.mode_count() - model.rigid_count));
  std::iota(columns.begin(), columns.end(), model.rigid_count);
  std::ranges::stable_sort(columns, {}, [&](Eigen::Index m) { return model.frequency_hz(m); });
  return columns;
}

// True for each mode that both sides see, relative to the largest of all flexible modes.
std::vector<bool> in_view(const modal::ReducedModel& model, const Channels& channels,
                          const Indices& columns) {
  const Eigen::VectorXd out = model.output_shapes(channels.outputs, columns).colwise().norm();
  const Eigen::VectorXd in = model.input_shapes(columns, channels.inputs).rowwise().norm();
  std::vector<bool> seen;
  for (Eigen::Index k = 0; k < out.size(); ++k) {
    seen.push_back(out(k) > kConstants.in_view * out.maxCoeff() &&
                   in(k) > kConstants.in_view * in.maxCoeff());
  }
  return seen;
}

ModesAtChannels at_channels(const modal::ReducedModel& model, const Channels& channels,
                            const Indices& columns) {
  return {columns, model.frequency_hz(columns), model.output_shapes(channels.outputs, columns),
          model.input_shapes(columns, channels.inputs).transpose()};
}

// The largest ratio of a value to its deviation; NaN is skipped.
double sureness(const Eigen::VectorXd& values, const Eigen::VectorXd& deviations) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double sure = std::abs(values(i)) / deviations(i);
    if (sure > most) most = sure;
  }
  return most;
}

// The reason why a pole of the fit is not a mode; empty if it is a mode.
std::string why_no_mode(const identification::ModalFit& fit, Eigen::Index m,
                        const Channels& channels, const ComparisonOptions& options) {
  const double f = fit.model.frequency_hz(m);
  const double damping = fit.model.damping_ratio(m);
  const double deviation = fit.frequency_std_hz(m);
  if (f < options.low_hz || f > options.high_hz) return "beside the band";
  if (!(damping < kConstants.no_resonance)) {
    return fmt::format("damping ratio {:.2g}: no resonance", damping);
  }
  if (!(deviation <= std::max(damping, kConstants.frequency_known) * f)) {
    return fmt::format("its frequency is known to {:.2g} Hz only", deviation);
  }
  const Eigen::VectorXd out = fit.model.output_shapes.col(m)(channels.outputs);
  const Eigen::VectorXd in = fit.model.input_shapes.row(m).transpose()(channels.inputs);
  const Eigen::VectorXd out_std = fit.output_std.col(m)(channels.outputs);
  const Eigen::VectorXd in_std = fit.input_std.row(m).transpose()(channels.inputs);
  const bool supported = sureness(out, out_std) > kConstants.significant &&
                         sureness(in, in_std) > kConstants.significant;
  return supported ? "" : "its shape is within three deviations of zero";
}

ModesAtChannels measured_modes(const identification::ModalFit& fit, const Channels& channels,
                               const ComparisonOptions& options, ModeComparison& result) {
  const auto columns = flexible(fit.model);
  const auto view = in_view(fit.model, channels, columns);
  Indices kept;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    auto why = why_no_mode(fit, columns[k], channels, options);
    if (why.empty() && !view[k]) why = "no channel sees it";
    if (why.empty()) {
      kept.push_back(columns[k]);
    } else {
      result.no_modes.push_back({columns[k], fit.model.frequency_hz(columns[k]), std::move(why)});
    }
  }
  return at_channels(fit.model, channels, kept);
}

// Modes that may be partners of those measured in the band.
ModesAtChannels simulated_modes(const modal::ReducedModel& model, const Channels& channels,
                                ModeComparison& result) {
  const auto columns = flexible(model);
  const auto view = in_view(model, channels, columns);
  Indices kept;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double f = model.frequency_hz(columns[k]);
    const double reach = kConstants.reach;
    if (f < result.low_hz / reach || f > result.high_hz * reach) continue;
    if (view[k]) {
      kept.push_back(columns[k]);
    } else if (f >= result.low_hz && f <= result.high_hz) {
      result.simulated_unseen.push_back({columns[k], f, {}});
    }
  }
  return at_channels(model, channels, kept);
}

modal::Modes as_modes(const ModesAtChannels& of, const Eigen::MatrixXd& shapes) {
  return {of.frequency_hz, Eigen::VectorXd::Zero(of.frequency_hz.size()), shapes, 0};
}

// MAC at the sensors times MAC at the actuators; repeated modes use their subspace.
Eigen::MatrixXd likeness(const ModesAtChannels& a, const ModesAtChannels& b, double gap) {
  return modal::alike(as_modes(a, a.outputs), as_modes(b, b.outputs), gap)
      .cwiseProduct(modal::alike(as_modes(a, a.inputs), as_modes(b, b.inputs), gap));
}

// The number of its group of repeated modes, for each mode.
Indices group_of(const Eigen::VectorXd& frequency_hz, double gap) {
  Indices number;
  for (const auto& group : modal::groups(frequency_hz, gap)) {
    number.insert(number.end(), static_cast<std::size_t>(group.size), group.first);
  }
  return number;
}

double confusion(const ModesAtChannels& a, double gap) {
  const auto groups = group_of(a.frequency_hz, gap);
  const Eigen::MatrixXd alike = likeness(a, a, gap);
  double sum = 0.0;
  double count = 0.0;
  for (Eigen::Index i = 0; i < alike.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)]) continue;
      sum += alike(i, j);
      count += 1.0;
    }
  }
  // For a single mode: the expected MAC of unrelated shapes with this number of responses.
  const auto responses = static_cast<double>(a.outputs.rows() * a.inputs.rows());
  return count > 0.0 ? sum / count : 1.0 / responses;
}

/// Distances for the pairing of modes of a and b, both ascending.
struct Likeness {
  Eigen::MatrixXd mac, apart;  // apart: |ln of the frequencies' ratio|
};

Likeness likeness_of(const ModesAtChannels& a, const ModesAtChannels& b, double gap) {
  Likeness result{likeness(a, b, gap), {}};
  result.apart = (b.frequency_hz.array().log().transpose().replicate(a.frequency_hz.size(), 1) -
                  a.frequency_hz.array().log().replicate(1, b.frequency_hz.size()))
                     .abs();
  return result;
}

modal::Pairing paired(const Likeness& like, bool shapes_tell, const ComparisonOptions& options) {
  const double apart = shapes_tell ? options.apart : options.apart_alone;
  Eigen::MatrixXd cost = (like.apart.array() / apart).square();
  if (shapes_tell) cost.array() += 1.0 - like.mac.array();
  // Among equals (repeated modes) the order is kept: the term is convex in i − j.
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      cost(i, j) += 1e-9 * std::pow(static_cast<double>(i - j), 2);
    }
  }
  modal::Pairing pairing;
  for (const auto& [i, j] : modal::assigned(cost, shapes_tell ? 1.0 - options.least_mac : 1.0)) {
    pairing.pairs.push_back({.a = i, .b = j, .mac = like.mac(i, j)});
  }
  return pairing;
}

// True if no other simulated mode near enough in frequency has nearly the same MAC.
bool by_shape(const Likeness& like, const Indices& group, const modal::ModePair& pair,
              double apart) {
  for (Eigen::Index i = 0; i < like.mac.rows(); ++i) {
    const bool repeated =
        group[static_cast<std::size_t>(i)] == group[static_cast<std::size_t>(pair.a)];
    if (repeated || like.apart(i, pair.b) >= apart) continue;
    if (like.mac(i, pair.b) > pair.mac - kConstants.clear_mac) return false;
  }
  return true;
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
  if (one.simulated_hz > 0.0) one.simulated_damping += modal::dashpot_ratio(simulated, a);
  one.measured_damping = fit.model.damping_ratio(b);
  one.measured_damping_std = fit.damping_std(b);
  one.mac = mac;
  return one;
}

// COMAC between each measured shape and its projection on the simulated mode's group, of unit norm.
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
    a.col(k) = (span * span.colPivHouseholderQr().solve(Eigen::VectorXd(b.col(k)))).normalized();
  }
  return modal::comac(a, b);
}

void set_pairs(const modal::Pairing& pairing, const Likeness& like, const ModesAtChannels& a,
               const ModesAtChannels& b, const modal::ReducedModel& simulated,
               const identification::ModalFit& fit, const ComparisonOptions& options,
               ModeComparison& result) {
  const auto group = group_of(a.frequency_hz, options.repeated_gap);
  std::vector<bool> paired_a(a.column.size(), false);
  std::vector<bool> paired_b(b.column.size(), false);
  for (const auto& pair : pairing.pairs) {
    const auto i = static_cast<std::size_t>(pair.a);
    const auto j = static_cast<std::size_t>(pair.b);
    paired_a[i] = paired_b[j] = true;
    result.pairs.push_back(difference(simulated, fit, a.column[i], b.column[j], pair.mac));
    result.pairs.back().by_shape = result.shapes_tell && by_shape(like, group, pair, options.apart);
  }
  for (std::size_t i = 0; i < paired_a.size(); ++i) {
    const double f = simulated.frequency_hz(a.column[i]);
    const bool inside = f >= result.low_hz && f <= result.high_hz;
    if (!paired_a[i] && inside) result.simulated_alone.push_back({a.column[i], f, {}});
    if (paired_a[i] || inside) result.simulated_modes.push_back(static_cast<Eigen::Index>(i));
  }
  for (std::size_t j = 0; j < paired_b.size(); ++j) {
    if (paired_b[j]) continue;
    result.measured_alone.push_back({b.column[j], fit.model.frequency_hz(b.column[j]), {}});
  }
}

// On entry `simulated_modes` are rows of a; on return they are columns of the model.
void set_mac(const ModesAtChannels& a, const ModesAtChannels& b, ModeComparison& result) {
  const Indices rows = result.simulated_modes;
  result.simulated_hz.clear();
  for (auto& mode : result.simulated_modes) {
    result.simulated_hz.push_back(a.frequency_hz(mode));
    mode = a.column[static_cast<std::size_t>(mode)];
  }
  result.measured_modes = b.column;
  result.measured_hz = {b.frequency_hz.begin(), b.frequency_hz.end()};
  if (rows.empty() || b.column.empty()) return;
  const Eigen::MatrixXd outputs = a.outputs(Eigen::all, rows);
  const Eigen::MatrixXd inputs = a.inputs(Eigen::all, rows);
  result.mac = modal::mac(outputs, b.outputs).cwiseProduct(modal::mac(inputs, b.inputs));
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
  const Channels channels{finite_rows(fit.output_std), finite_rows(fit.input_std.transpose())};
  ModeComparison result;
  result.output_comac = Eigen::VectorXd::Constant(p, NAN);
  result.input_comac = Eigen::VectorXd::Constant(q, NAN);
  if (channels.outputs.empty() || channels.inputs.empty()) return result;
  const ModesAtChannels b = measured_modes(fit, channels, options, result);
  const double last = b.column.empty() ? 0.0 : kConstants.beyond_last * b.frequency_hz.maxCoeff();
  result.low_hz = options.low_hz;
  result.high_hz = std::isfinite(options.high_hz) ? options.high_hz : last;
  const ModesAtChannels a = simulated_modes(simulated, channels, result);
  if (a.column.empty()) {
    for (const auto m : b.column) {
      result.measured_alone.push_back({m, fit.model.frequency_hz(m), {}});
    }
    return result;
  }
  const double gap = options.repeated_gap;
  result.confusion = confusion(a, gap);
  result.shapes_tell = result.confusion <= kConstants.confused;
  const Likeness like = likeness_of(a, b, gap);
  const auto pairing = paired(like, result.shapes_tell, options);
  set_pairs(pairing, like, a, b, simulated, fit, options, result);
  set_mac(a, b, result);
  spread(comac(pairing, a.frequency_hz, a.outputs, b.outputs, gap), channels.outputs,
         result.output_comac);
  spread(comac(pairing, a.frequency_hz, a.inputs, b.inputs, gap), channels.inputs,
         result.input_comac);
  return result;
}

std::string why_no_mode(const identification::ModalFit& fit, Eigen::Index m,
                        const ComparisonOptions& options) {
  Channels all;
  for (Eigen::Index i = 0; i < fit.model.output_shapes.rows(); ++i) all.outputs.push_back(i);
  for (Eigen::Index j = 0; j < fit.model.input_shapes.cols(); ++j) all.inputs.push_back(j);
  return why_no_mode(fit, m, all, options);
}

}  // namespace chladni::diagnosis
