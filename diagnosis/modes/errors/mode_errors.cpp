#include "diagnosis/modes/errors/mode_errors.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/errors/mixing_modes.h"
#include "diagnosis/modes/errors/mode_change.h"
#include "diagnosis/modes/errors/mode_rows.h"
#include "diagnosis/modes/partner.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int kNone = -1;

int of(ErrorClass which) { return static_cast<int>(which); }

// Columns of the shared errors: gains of sensors and actuators, their places along u and v, then
// the body's.
struct SharedColumns {
  Index outputs = 0, inputs = 0, body = 0;
  bool gains = false;  // channels have errors of their own where shapes were measured

  [[nodiscard]] Index channels() const { return gains ? outputs + inputs : 0; }
  [[nodiscard]] Index gain(bool sensor, Index i) const { return sensor ? i : outputs + i; }
  [[nodiscard]] Index place(bool sensor, Index i, Index axis) const {
    return channels() * (1 + axis) + gain(sensor, i);
  }
  // What the gains of a side share.
  [[nodiscard]] Index common_gain(bool sensor) const { return 3 * channels() + (sensor ? 0 : 1); }
  [[nodiscard]] Index of_body(Index i) const { return 3 * channels() + (gains ? 2 : 0) + i; }
  [[nodiscard]] Index count() const { return of_body(body); }
};

std::vector<int> classes_of(const SharedColumns& columns, const std::vector<BodyError>& body) {
  std::vector<int> all(at(columns.count()), kNone);
  for (Index c = 0; c < columns.channels(); ++c) {
    all[at(c)] = of(ErrorClass::gain);
    all[at(columns.channels() + c)] = of(ErrorClass::place);
    all[at(2 * columns.channels() + c)] = of(ErrorClass::place);
  }
  for (const bool sensor : {true, false}) {
    if (columns.gains) all[at(columns.common_gain(sensor))] = of(ErrorClass::gain);
  }
  for (std::size_t i = 0; i < body.size(); ++i) {
    all[at(columns.of_body(static_cast<Index>(i)))] = body[i].of;
  }
  return all;
}

// All that the blocks of one hypothesis share.
struct Scene {
  const Structure& structure;
  const MeasuredModes& measured;
  const RecordedModes& model;
  const ShapeUnits& units;
  const MatrixXd& smooth;
  const Matching& matching;
  const std::vector<Partner>& partners;  // per measured mode; without parts: none
  SharedColumns columns;
  MatrixXd outputs, inputs;         // p×m, q×m: shapes of the partners
  std::vector<ModeChange> changes;  // per error of the body

  // All hypotheses have the same data: where the study states no damping there is none to compare
  // with, also for a hypothesis with a dashpot.
  [[nodiscard]] bool has_damping(Index i) const {
    return measured.damping_ratio(i) > 0.0 && structure.damping_ratio.maxCoeff() > 0.0;
  }
  // The channel whose motion a record shows: exchanged channels take their places with them.
  [[nodiscard]] Index channel_of(bool sensor, Index record) const {
    return (sensor ? model.output_of : model.input_of)[at(record)];
  }
};

// Motion of channel i along an axis of the chart, behind record i.
double slope_of(const ChannelSide& side, Index i, Index axis, const VectorXd& motion) {
  const auto& slopes = axis == 0 ? side.slope_u : side.slope_v;
  if (slopes.rows() <= i) return 0.0;
  return slopes.row(i).head(motion.size()).dot(motion);
}

// One side of a block: its first row (-1: no shape), the row of the residue (-1: none).
struct Place {
  const PartnerSide& side;
  bool is_sensor;
  Index first, residue;
};

double square_of(const PartnerSide& side) { return std::max(side.model.squaredNorm(), 0.1); }

// A change of the model's record at one channel: in the shape and in the residue.
void put_change(Rows& rows, const Place& place, Index a, double change, Index column) {
  if (place.first >= 0) rows.shared(place.first + 2 * a, column) += change;
  if (place.residue < 0) return;
  rows.shared(place.residue, column) += place.side.model(a) * change / square_of(place.side);
}

void put_channel_errors(Rows& rows, const Place& place, const VectorXd& motion,
                        const Scene& scene) {
  if (!scene.columns.gains) return;
  const auto& channels = place.is_sensor ? scene.structure.outputs : scene.structure.inputs;
  for (Index a = 0; a < place.side.count(); ++a) {
    const Index i = scene.channel_of(place.is_sensor, place.side.rows[at(a)]);
    put_change(rows, place, a, place.side.model(a), scene.columns.gain(place.is_sensor, i));
    put_change(rows, place, a, place.side.model(a), scene.columns.common_gain(place.is_sensor));
    for (const Index axis : {0, 1}) {
      put_change(rows, place, a, slope_of(channels, i, axis, motion) * place.side.recorded(a),
                 scene.columns.place(place.is_sensor, i, axis));
    }
  }
}

void put_body_errors(Rows& rows, const Place& place, const VectorXd& parts, const Scene& scene) {
  for (std::size_t b = 0; b < scene.changes.size(); ++b) {
    const auto& change = scene.changes[b];
    const VectorXd shape = (place.is_sensor ? change.outputs : change.inputs) * parts;
    for (Index a = 0; a < place.side.count(); ++a) {
      put_change(rows, place, a, shape(place.side.rows[at(a)]) * place.side.recorded(a),
                 scene.columns.of_body(static_cast<Index>(b)));
    }
  }
}

// What modes that mix with this one add: to the real parts, or to the imaginary parts.
enum class Mixed { by_stiffness, by_damping };
/// @param shapes  p×c: of the modes, at the channels of the side, for an error of 1
void put_mixed(Rows& rows, const Place& place, Mixed by, const MatrixXd& shapes) {
  const double square = square_of(place.side);
  const auto number = [&](Index row, Index column) -> double& {
    return by == Mixed::by_stiffness ? rows.mixed(row, column) : rows.damped(row + 1, column);
  };
  for (Index column = 0; column < shapes.cols(); ++column) {
    for (Index a = 0; a < place.side.count(); ++a) {
      const double change = shapes(place.side.rows[at(a)], column) * place.side.recorded(a);
      if (place.first >= 0) number(place.first + 2 * a, column) += change;
      if (place.residue >= 0) {
        number(place.residue, column) += place.side.model(a) * change / square;
      }
    }
  }
}

// Smooth errors of the shape: the same field at sensors and actuators.
void put_smooth(Rows& rows, const Place& place, const Scene& scene) {
  const Index before = place.is_sensor ? 0 : scene.structure.outputs.count();
  const double square = square_of(place.side);
  const Index count = scene.smooth.cols();
  for (Index a = 0; a < place.side.count(); ++a) {
    const Index channel = before + scene.channel_of(place.is_sensor, place.side.rows[at(a)]);
    const double size = std::copysign(place.side.weight(a), place.side.recorded(a));
    for (Index c = 0; c < count; ++c) {
      const double change = size * scene.smooth(channel, c);
      if (place.first >= 0) {
        rows.smooth(place.first + 2 * a, c) = change;
        rows.smooth(place.first + 2 * a + 1, count + c) = kConstants.smooth_phase * change;
      }
      if (place.residue >= 0)
        rows.smooth(place.residue, c) += place.side.model(a) * change / square;
    }
  }
}

// The rows of one side's shape: pairs of a real and an imaginary part. Returns the first; -1 for
// none.
Index put_shape(Rows& rows, const PartnerSide& side, bool is_sensor) {
  if (!side.is_shape()) return -1;
  Index first = -1;
  for (Index a = 0; a < side.count(); ++a) {
    const double real = side.measured(a).real() - side.model(a);
    const Index row = rows.add(real, side.noise(a), of(ErrorClass::shape), side.weight(a));
    const Index imaginary = rows.add(side.measured(a).imag(), side.noise(a), of(ErrorClass::phase),
                                     kConstants.own_phase * side.weight(a));
    if (a == 0) first = row;
    rows.free(row, is_sensor ? 0 : 2) = side.model(a);
    rows.free(imaginary, is_sensor ? 1 : 3) = side.model(a);
  }
  return first;
}

// The deviation of ln of the least-squares factor, from the values' deviations.
double factor_noise(const PartnerSide& side) {
  const double squares = side.model.cwiseAbs2().dot(side.noise.cwiseAbs2());
  return std::sqrt(squares) / square_of(side);
}

// Part of a side's shape that is in phase: |Σ v²| over Σ |v|².
double part_in_phase(const PartnerSide& side) {
  const VectorXcd& v = side.measured;
  return std::max(std::abs(v.cwiseProduct(v).sum()) / std::max(v.squaredNorm(), 1e-300),
                  kConstants.least_in_phase);
}

// ln by which a residue is larger than that of a real mode. Complex modes are normalised by vᵀ M v,
// which is less than |v|² by the part in phase: modes that damping couples, two of nearly the same
// frequency above all, have large residues that cancel.
double complex_excess(const PartnerSide& out, const PartnerSide& in) {
  double sum = 0.0;
  Index count = 0;
  for (const auto* side : {&out, &in}) {
    if (!side->is_shape()) continue;
    sum -= static_cast<double>(side->count()) * std::log(part_in_phase(*side));
    count += side->count();
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

// ln of a residue over its model. A mode that the channels hardly see has a less certain one.
Index put_residue(Rows& rows, const PartnerSide& out, const PartnerSide& in) {
  const auto ratio = std::log(out.factor * in.factor);
  const double excess = complex_excess(out, in);
  const double blindness = std::max(out.blindness(), in.blindness());
  const double unseen = std::pow(blindness / kConstants.blindest, 2);
  const double noise = std::hypot(factor_noise(out), factor_noise(in));
  const double unsure =
      std::hypot(kConstants.unseen_size * unseen, kConstants.excess_error * excess);
  const Index row =
      rows.add(ratio.real() - excess, std::hypot(noise, unsure), of(ErrorClass::residue));
  rows.add(ratio.imag(), std::hypot(noise, kConstants.unknown_scale * unseen),
           of(ErrorClass::residue));
  return row;
}

Index most_rows(const MeasuredModes& measured) {
  return 4 + 2 * (measured.output_shapes.rows() + measured.input_shapes.rows());
}

// Numbers of a channel that is not believed.
void doubt(Rows& rows, const Place& place, const Disturbed& disturbed) {
  const auto what = place.is_sensor ? Disturbed::What::sensor : Disturbed::What::actuator;
  const auto found = std::ranges::find(place.side.rows, disturbed.index);
  if (disturbed.what != what || found == place.side.rows.end() || place.first < 0) return;
  const Index row = place.first + 2 * (found - place.side.rows.begin());
  rows.doubt(row, 1.0);
  rows.doubt(row + 1, 1.0);
}

// The numbers of a mode that has a partner.
ModeBlock paired(const Scene& scene, Index i, const Disturbed& disturbed) {
  const auto& measured = scene.measured;
  const auto& model = scene.model;
  const auto& columns = scene.columns;
  const auto& changes = scene.changes;
  const Index k = scene.matching.model[at(i)];
  const Partner& other = scene.partners[at(i)];
  const auto stiffness = mixed_by_stiffness(model, k, other.parts);
  const auto damping = mixed_by_damping(measured, model, scene.matching, i);
  const VectorXd motion = model.motion * other.parts;
  Rows rows(most_rows(measured), columns.count(), std::ssize(stiffness), std::ssize(damping),
            scene.smooth.cols());
  const Index frequency = rows.add(std::log(measured.frequency_hz(i) / model.frequency_hz(k)),
                                   measured.frequency_std(i), of(ErrorClass::frequency));
  for (std::size_t b = 0; b < changes.size(); ++b) {
    rows.shared(frequency, columns.of_body(static_cast<Index>(b))) =
        changes[b].frequency.dot(other.parts.cwiseAbs2());
  }
  if (scene.has_damping(i)) {
    const double simulated = std::max(model.damping_ratio(k), kConstants.least_damping);
    rows.add(std::log(measured.damping_ratio(i) / simulated), measured.damping_std(i),
             of(ErrorClass::damping));
  }
  const Index first_out = put_shape(rows, other.sensors, true);
  const Index first_in = put_shape(rows, other.actuators, false);
  const bool has_residue =
      measured.scaled && other.sensors.count() > 0 && other.actuators.count() > 0;
  const Index residue = has_residue ? put_residue(rows, other.sensors, other.actuators) : -1;
  for (const bool is_sensor : {true, false}) {
    const Place place{is_sensor ? other.sensors : other.actuators, is_sensor,
                      is_sensor ? first_out : first_in, residue};
    const MatrixXd& partners = is_sensor ? scene.outputs : scene.inputs;
    put_mixed(rows, place, Mixed::by_stiffness,
              shapes_across(stiffness, is_sensor ? model.outputs : model.inputs, partners.col(i),
                            other.parts));
    put_mixed(rows, place, Mixed::by_damping, shapes_mixed(damping, partners));
    put_smooth(rows, place, scene);
    put_channel_errors(rows, place, motion, scene);
    put_body_errors(rows, place, other.parts, scene);
    doubt(rows, place, disturbed);
  }
  return rows.taken();
}

// The numbers of a mode without a partner: they are as wide as such numbers can be.
ModeBlock alone(const Scene& scene, Index i) {
  const auto& measured = scene.measured;
  Rows rows(most_rows(measured), scene.columns.count(), 0, 0, 0);
  rows.add(kConstants.alone_frequency, kConstants.alone_frequency, kNone);
  if (scene.has_damping(i)) rows.add(1.0, 1.0, kNone);
  const auto put = [&](const Eigen::MatrixXcd& shapes) {
    const auto values = rows_with_values(shapes, i);
    if (values.size() < 2) return values.size();
    const VectorXcd shape = shapes(values, i);
    const double size = shape.norm() / std::sqrt(static_cast<double>(shape.size()));
    const VectorXcd turned = shape * std::conj(phase_of(shape)) / std::max(size, 1e-300);
    for (Index a = 0; a < turned.size(); ++a) {
      rows.add(turned(a).real(), 1.0, kNone);
      rows.add(turned(a).imag(), 1.0, kNone);
    }
    return values.size();
  };
  const bool out = put(measured.output_shapes) > 0;
  const bool in = put(measured.input_shapes) > 0;
  if (measured.scaled && out && in) {
    rows.add(kConstants.unknown_scale, kConstants.unknown_scale, kNone);
    rows.add(kConstants.unknown_scale, kConstants.unknown_scale, kNone);
  }
  return rows.taken();
}

// Modes of the model between the lowest and the highest measured one that no measured mode has. One
// that the channels do not see is missed by nobody; a side without measured shapes sees all.
double unseen(const Scene& scene, const Matching& matching) {
  const auto& hz = scene.measured.frequency_hz;
  double count = 0.0;
  for (Index k = 0; k < scene.model.count(); ++k) {
    const double own = scene.model.frequency_hz(k);
    if (own <= hz(0) || own >= hz(hz.size() - 1)) continue;
    if (std::ranges::find(matching.model, k) != matching.model.end()) continue;
    const auto seen = [k](const Eigen::MatrixXcd& by, const MatrixXd& shapes, double unit) {
      return by.rows() == 0 ? 1.0 : visibility(shapes.col(k), unit);
    };
    count += seen(scene.measured.output_shapes, scene.model.outputs, scene.units.outputs) *
             seen(scene.measured.input_shapes, scene.model.inputs, scene.units.inputs);
  }
  return count;
}

// The modes of the model in the spans of these blocks.
std::vector<Index> modes_of(const Matching& matching, const std::vector<bool>& blocks) {
  std::vector<Index> all;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!blocks[i]) continue;
    for (const Index k : matching.span[i]) {
      if (std::ranges::find(all, k) == all.end()) all.push_back(k);
    }
  }
  return all;
}

}  // namespace

ModeErrors mode_errors(const Structure& structure, const MeasuredModes& measured,
                       const RecordedModes& model, const ShapeUnits& units,
                       const Matching& matching, const std::vector<BodyError>& body,
                       const Eigen::MatrixXd& smooth, const Disturbed& disturbed,
                       const std::vector<bool>& shares) {
  const SharedColumns none{measured.output_shapes.rows(), measured.input_shapes.rows()};
  const auto partners = partners_of(matching, measured, model, units);
  const MatrixXd parts = parts_of(partners, model.count());
  const Scene bare{structure,
                   measured,
                   model,
                   units,
                   smooth,
                   matching,
                   partners,
                   none,
                   model.outputs * parts,
                   model.inputs * parts,
                   {}};
  Scene whole = bare;
  whole.columns.gains = none.outputs + none.inputs > 1;
  whole.columns.body = static_cast<Index>(body.size());
  const bool some = std::ranges::find(shares, true) != shares.end();
  if (some) {
    const auto modes = modes_of(matching, shares);
    for (const auto& error : body) whole.changes.push_back(change_by(error, model, modes));
  }
  ModeErrors errors;
  if (some) errors.shared_of = classes_of(whole.columns, body);
  for (Index i = 0; i < measured.count(); ++i) {
    const auto& scene = shares[at(i)] ? whole : bare;
    const Index k = matching.model[at(i)];
    const bool doubted = disturbed.what == Disturbed::What::mode && disturbed.index == i;
    if (k < 0 && !doubted) errors.penalty += kConstants.alone;
    errors.blocks.push_back(k < 0 || doubted ? alone(scene, i) : paired(scene, i, disturbed));
  }
  errors.penalty += kConstants.unmeasured * unseen(bare, matching);
  return errors;
}

}  // namespace chladni::diagnosis
