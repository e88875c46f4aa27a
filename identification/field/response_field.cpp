#include "identification/response_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/diagonal.h"
#include "base/error.h"
#include "identification/damping_coupling.h"
#include "identification/field/rigid_band.h"
#include "identification/gains/pair_evidence.h"

namespace chladni::identification {
namespace {

constexpr double kOpenScale = 0.7;  // deviation of ln α where the pairs alone do not tell it
constexpr double kExplained = 0.3;  // part of the fitted residual that the simulation must explain
constexpr double kBeyond = 1.05;    // simulated modes above this multiple of the band are residual

// Whether a mode is known at both channels of a pair; it is not where one was not measured.
bool knows_both(const GainMatch& match, const CollocatedPair& pair, Eigen::Index mode) {
  return std::isfinite(match.deviation(pair.output, mode)) &&
         std::isfinite(match.input_deviation(mode, pair.input));
}

// Remaining difference between the two sides of the pairs, for each mode. If the places of a pair
// differ, it is the part that remains along the simulated shape at both places, because near a node
// the ratio of the sides has no meaning.
Eigen::VectorXd pair_disagreement(const modal::ReducedModel& fit, const ChannelGains& gains) {
  const auto& match = gains.match;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(fit.mode_count());
  if (gains.pairs.size() < 2) return result;
  for (auto m = fit.rigid_count; m < fit.mode_count(); ++m) {
    const auto& mode = match.modes[static_cast<std::size_t>(m)];
    if (mode.by != MatchedBy::pairs) continue;
    double square = 0.0;
    double known = 0.0;
    for (std::size_t c = 0; c < gains.pairs.size(); ++c) {
      const auto& pair = gains.pairs[c];
      if (!knows_both(match, pair, m)) continue;
      known += 1.0;
      const bool apart = !pair.is_one_place();
      const double at_input = apart ? pair.at_input(m) : 1.0;
      const double at_output = apart ? pair.at_output(m) : pair.sign;
      // The part that the gains explain is corrected, on either side.
      const double gain = gains.corrects_gains ? match.pairs[c].ratio : 1.0;
      const double output = fit.output_shapes(pair.output, m) / mode.alpha / gain;
      const double input = mode.sign * mode.alpha * fit.input_shapes(m, pair.input);
      const double size = std::hypot(at_input, at_output);
      if (size > 0.0) square += std::pow((output * at_input - input * at_output) / size, 2);
    }
    result(m) = std::sqrt(square / std::max(known, 1.0));
  }
  return result;
}

// Rows of a match as sides of a modal model. Rows of pairs that lie apart say themselves what the
// scale between both sides is; rows of pairs at one place are one, and the pairs have said it.
priors::BothSides both_sides(const ChannelGains& gains, const std::vector<Eigen::Index>& rows,
                             const std::vector<Eigen::Index>& modes) {
  const auto& match = gains.match;
  priors::BothSides sides{{}, Eigen::VectorXd(std::ssize(modes)), match.deviation(rows, modes)};
  for (const auto row : rows) {
    sides.actuator.push_back(match.rows[static_cast<std::size_t>(row)].actuator);
  }
  const bool apart = std::ranges::none_of(
      gains.pairs, [](const CollocatedPair& pair) { return pair.is_one_place(); });
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto& mode = match.modes[static_cast<std::size_t>(modes[k])];
    double deviation = mode.alpha_std / mode.alpha;
    const bool by_rows = mode.by == MatchedBy::pairs && (apart || contradicted(mode));
    if (by_rows) deviation = std::max(deviation, kOpenScale);
    sides.log_deviation(static_cast<Eigen::Index>(k)) = deviation;
  }
  return sides;
}

// Static flexibility of the simulation's modes above the band, places × actuators.
Eigen::MatrixXd flexibility_above(const FieldSimulation& simulation,
                                  const Eigen::MatrixXd& places) {
  const auto& frequency = simulation.channels.frequency_hz;
  const auto& inputs = simulation.channels.inputs;
  const double above = kBeyond * simulation.highest_hz;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(places.rows(), inputs.rows());
  for (Eigen::Index r = 0; r < frequency.size(); ++r) {
    if (frequency(r) < above) continue;
    const double omega = 2.0 * std::numbers::pi * frequency(r);
    sum += places.col(r) * inputs.col(r).transpose() / (omega * omega);
  }
  return sum;
}

// p×q: whether the fit tells the residual.
Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> is_residual_known(const GainMatch& match) {
  auto result = match.residual_known;
  if (result.size() == 0) result.setConstant(match.residual.rows(), match.residual.cols(), true);
  return result;
}

// The simulation's residual at the sensors, and the fitted one: 0 where a response was not
// measured.
struct Residuals {
  Eigen::MatrixXd simulated, fitted;  // p×q
};

Residuals measured_residuals(const GainMatch& match, const FieldSimulation& simulation) {
  const auto measured = is_residual_known(match);
  return {measured.select(flexibility_above(simulation, simulation.channels.outputs), 0.0),
          measured.select(match.residual, 0.0)};
}

// Root mean square over the sensors, per actuator, of what the simulation's modes above the band
// leave of the fitted residual. Without a measured response it is that of all.
Eigen::RowVectorXd unexplained_residual(const GainMatch& match, const FieldSimulation& simulation) {
  const auto both = measured_residuals(match, simulation);
  const Eigen::MatrixXd left = both.fitted - residual_factor(match, simulation) * both.simulated;
  const Eigen::MatrixXd told = is_residual_known(match).cast<double>();
  const double all = left.norm() / std::sqrt(std::max(1.0, told.sum()));
  const Eigen::ArrayXXd count = told.colwise().sum();
  return (count > 0.0)
      .select(left.colwise().norm().cwiseQuotient(count.max(1.0).sqrt().matrix()), all);
}

// Root mean square of each mode's shape at the channels that were measured.
Eigen::VectorXd sizes_at_channels(const ModalFit& fit, const GainMatch& match) {
  const auto rows = measured_rows(fit, match);
  const Eigen::MatrixXd shapes =
      rows.empty() ? match.shapes : Eigen::MatrixXd(match.shapes(rows, Eigen::all));
  return shapes.colwise().norm().transpose() / std::sqrt(static_cast<double>(shapes.rows()));
}

// Rigid-body rows at places that move along z: the body's motion in its plane is not known. There,
// and without a body, they stay 0 with their size at the channels as deviation.
void add_rigid_rows(const ModalFit& fit, const GainMatch& match, const priors::Places& places,
                    PlacesOfInterest& result) {
  const auto rigid = fit.model.rigid_count;
  if (rigid == 0 || !match.rigid) return;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < places.count(); ++i) {
    if (moves_along_z(places.direction.row(i))) rows.push_back(i);
  }
  const auto directions =
      rigid_directions(Eigen::MatrixX3d(places.position(rows, Eigen::all)), rigid_motion(rigid));
  const Eigen::MatrixXd own = places.direction.col(2)(rows).asDiagonal() * directions;
  const auto own_modes = Eigen::seqN(0, rigid);
  result.shapes(rows, own_modes) = own * match.rigid->modes;
  result.deviation(rows, own_modes) = rigid_deviation(*match.rigid, own);
}

// The places of the match's rows.
priors::Places rows_of(const GainMatch& match, const priors::Places& outputs,
                       const priors::Places& inputs) {
  const auto count = std::ssize(match.rows);
  priors::Places places{Points(count, 3), Points(count, 3),
                        Eigen::MatrixXd(count, outputs.shapes.cols()),
                        Eigen::MatrixXd(count, outputs.harmonics.cols())};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& row = match.rows[static_cast<std::size_t>(i)];
    const auto& side = row.actuator ? inputs : outputs;
    places.position.row(i) = side.position.row(row.channel);
    places.direction.row(i) = side.direction.row(row.channel);
    places.shapes.row(i) = side.shapes.row(row.channel);
    if (side.harmonics.cols() > 0) places.harmonics.row(i) = side.harmonics.row(row.channel);
  }
  return places;
}

bool has_scale(const GainMatch& match, Eigen::Index m) {
  const auto& mode = match.modes[static_cast<std::size_t>(m)];
  return mode.by != MatchedBy::nothing && std::isfinite(mode.alpha_std);
}

void require_places(const modal::FrfSet& responses, const priors::Simulation& simulation,
                    const priors::Places& outputs, const priors::Places& inputs) {
  const auto modes = simulation.mode_count();
  const auto fits = [&](const priors::Places& places, Eigen::Index count) {
    return places.count() == count && places.direction.rows() == count &&
           places.shapes.rows() == count && places.shapes.cols() == modes;
  };
  require(fits(outputs, responses.output_count()) && fits(inputs, responses.input_count()),
          "a field of responses needs the place, direction and simulated shapes of each of its "
          "channels");
}

}  // namespace

bool moves_along_z(const Eigen::RowVector3d& direction) {
  constexpr double kAlong = 0.999;
  return std::abs(direction.z()) > kAlong;
}

std::vector<Eigen::Index> measured_rows(const ModalFit& fit, const GainMatch& match) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < match.deviation.rows(); ++i) {
    const auto flexible = match.deviation.row(i).tail(fit.flexible_count());
    if (flexible.array().isFinite().any()) rows.push_back(i);
  }
  return rows;
}

std::vector<Eigen::Index> modes_with_scale(const ModalFit& fit, const GainMatch& match) {
  const auto rows = measured_rows(fit, match);
  std::vector<Eigen::Index> modes;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count() && !rows.empty(); ++m) {
    if (has_scale(match, m) && match.deviation.col(m)(rows).allFinite()) modes.push_back(m);
  }
  return modes;
}

std::vector<Eigen::Index> rows_without(const ModalFit& fit, const GainMatch& match,
                                       Eigen::Index mode) {
  std::vector<Eigen::Index> rows;
  if (!has_scale(match, mode)) return rows;
  for (const auto row : measured_rows(fit, match)) {
    if (!std::isfinite(match.deviation(row, mode))) rows.push_back(row);
  }
  return rows;
}

std::string why_none_has_scale(const ModalFit& fit, const GainMatch& match) {
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    if (rows_without(fit, match, m).empty()) continue;
    return "no identified mode is known at all channels; where these are in parts without a "
           "response between them, each mode is known in one part: measure one response between "
           "the parts, or predict from one of them alone";
  }
  return "no identified mode has a known scale: name a pair of a sensor and an actuator at one "
         "place (identification.pair of a study)";
}

priors::MeasuredShapes measured_shapes(const ModalFit& fit, const ChannelGains& gains,
                                       const priors::Places& rows) {
  const auto modes = modes_with_scale(fit, gains.match);
  const auto measured = measured_rows(fit, gains.match);
  const Eigen::VectorXd doubt = pair_disagreement(fit.model, gains)(modes);
  const Eigen::MatrixXd deviation = gains.match.deviation(measured, modes);
  return {priors::part(rows, measured), fit.model.frequency_hz(modes),
          gains.match.shapes(measured, modes),
          (deviation.cwiseAbs2().rowwise() + doubt.cwiseAbs2().transpose()).cwiseSqrt(),
          both_sides(gains, measured, modes)};
}

std::optional<priors::MeasuredShapes> with_scale_off(const GainMatch& match,
                                                     const std::vector<Eigen::Index>& modes,
                                                     priors::MeasuredShapes shapes) {
  constexpr double kLeast = 1e-3;
  Eigen::RowVectorXd factor = Eigen::RowVectorXd::Ones(std::ssize(modes));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto& mode = match.modes[static_cast<std::size_t>(modes[k])];
    const double relative = 2.0 * mode.alpha_std / mode.alpha;
    require(std::isfinite(relative),
            "the scale of mode " + fmt::to_string(modes[k] + 1) + ": its deviation is not known");
    factor(static_cast<Eigen::Index>(k)) += relative;
  }
  if (factor.maxCoeff() < 1.0 + kLeast || !shapes.sides) return std::nullopt;
  const auto& actuator = shapes.sides->actuator;
  for (std::size_t row = 0; row < actuator.size(); ++row) {
    if (actuator[row]) shapes.values.row(static_cast<Eigen::Index>(row)).array() *= factor.array();
  }
  return shapes;
}

double gain_deviation(const ChannelGains& gains) {
  constexpr double kLevel = 0.1;
  constexpr double kWorth = 2.0;  // pairs
  constexpr double kBeyond = 5.0;
  const auto& pairs = gains.match.pairs;
  double square = 0.0;
  double excess = 0.0;
  double telling = 0.0;
  for (const auto& pair : pairs) {
    if (pair.modes == 0) continue;  // it says nothing
    telling += 1.0;
    const double ratio = std::log(pair.ratio);
    const double deviation = std::isfinite(pair.ratio_std) ? pair.ratio_std : pair.part_std;
    square += ratio * ratio;
    excess = std::max(excess, std::abs(ratio) - kBeyond * deviation);
  }
  const double known = telling - static_cast<double>(gain_parts(pairs));  // a mean of 0 in each
  if (known < 1.0) return gains.corrects_gains ? kLevel : 0.0;
  if (gains.corrects_gains) square += kWorth * kLevel * kLevel;
  if (!gains.corrects_gains && excess <= 0.0) return 0.0;
  return std::sqrt(square / known * (1.0 + 1.0 / telling));
}

double residual_factor(const GainMatch& match, const FieldSimulation& simulation) {
  const auto [simulated, fitted] = measured_residuals(match, simulation);
  const double square = simulated.squaredNorm();
  const double factor = square > 0.0 ? simulated.cwiseProduct(fitted).sum() / square : 0.0;
  const double left = (fitted - factor * simulated).squaredNorm();
  const bool explains = factor > 0.0 && left < (1.0 - kExplained) * fitted.squaredNorm();
  return explains ? factor : 0.0;
}

PlacesOfInterest places_of_interest(const ModalFit& fit, const ChannelGains& gains,
                                    const std::vector<Eigen::Index>& modes,
                                    const FieldSimulation& simulation, const priors::Places& places,
                                    const priors::Field& field) {
  const auto& match = gains.match;
  const auto m = fit.model.mode_count();
  PlacesOfInterest interest{Eigen::MatrixXd::Zero(places.count(), m),
                            sizes_at_channels(fit, match).transpose().replicate(places.count(), 1),
                            match.side * residual_factor(match, simulation) *
                                flexibility_above(simulation, places.shapes)};
  interest.shapes(Eigen::all, modes) = field.mean;
  interest.deviation(Eigen::all, modes) = field.deviation;
  interest.residual_deviation =
      unexplained_residual(match, simulation).replicate(places.count(), 1);
  interest.gain_deviation = gain_deviation(gains);
  add_rigid_rows(fit, match, places, interest);
  if (fit.complex) {
    const auto parts = imaginary_parts(
        fit, match, {simulation.channels.frequency_hz, simulation.rows, places.shapes});
    interest.imaginary = parts.mean;
    interest.imaginary_deviation = parts.deviation;
  }
  return interest;
}

PredictedResponses ResponseField::at(const priors::Places& places,
                                     const Eigen::VectorXd& frequency_hz) const {
  auto field = field_->at(places);
  if (field_with_scale_off_ != nullptr) {
    const Eigen::ArrayXXd moved = field_with_scale_off_->at(places).mean - field.mean;
    field.deviation = (field.deviation.array().square() + moved.square()).sqrt();
  }
  const auto interest = places_of_interest(fit_, gains_, modes_, simulation_, places, field);
  return predicted(fit_, gains_.match, interest, frequency_hz);
}

ResponseField response_field(const modal::FrfSet& responses, const priors::Simulation& simulation,
                             const priors::Places& outputs, const priors::Places& inputs,
                             const ResponseFieldPlan& plan) {
  require_places(responses, simulation, outputs, inputs);
  const auto data = fit_data(responses, {.low_hz = plan.low_hz, .high_hz = plan.high_hz});
  ResponseField result;
  result.fit_ = identified(data, plan.fit).fit;
  const SimulatedChannels channels{simulation.frequency_hz, outputs.shapes, inputs.shapes};
  result.gains_ =
      channel_gains(result.fit_, responses, plan.gains,
                    {[&] { return channels; },
                     [&] { return simulated_gain_prior(result.fit_, simulation, outputs, inputs); },
                     [&] { return diagonal_of(simulation.surface.position); }});
  const auto rows = rows_of(result.gains_.match, outputs, inputs);
  result.simulation_ = {channels, rows.shapes, data.frequency_hz(data.line_count() - 1)};
  result.modes_ = modes_with_scale(result.fit_, result.gains_.match);
  require(!result.modes_.empty(), why_none_has_scale(result.fit_, result.gains_.match));
  result.shapes_ = measured_shapes(result.fit_, result.gains_, rows);
  const auto& method = priors::interpolator(plan.method);
  result.field_ = priors::mode_field(method, result.shapes_, simulation);
  const auto off = with_scale_off(result.gains_.match, result.modes_, result.shapes_);
  if (off && !result.field_->summary().includes_scale) {
    result.field_with_scale_off_ = priors::mode_field(method, *off, simulation);
  }
  return result;
}

}  // namespace chladni::identification
