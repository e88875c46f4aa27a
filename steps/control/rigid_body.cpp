#include "steps/rigid_body.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>

#include "base/error.h"
#include "identification/suspension.h"

namespace chladni::steps {
namespace {

using identification::ChannelFrame;

// Motions that either side sees, as columns of combinations of the six.
Eigen::MatrixXd seen_motions(const ChannelFrame& outputs, const ChannelFrame& inputs) {
  const Eigen::Vector3d about = outputs.places.colwise().mean();
  Eigen::MatrixXd all(outputs.places.rows() + inputs.places.rows(), 6);
  all << identification::rigid_motions(outputs, about),
      identification::rigid_motions(inputs, about);
  const double distance = all.rightCols(3).norm() / std::max(1e-300, all.leftCols(3).norm());
  if (distance > 0.0) all.rightCols(3) /= distance;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeThinV);
  const auto& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > identification::kNoMotion * values(0)).count();
  Eigen::MatrixXd motions = svd.matrixV().leftCols(rank);
  if (distance > 0.0) motions.bottomRows(3) /= distance;
  return motions;
}

// Modes above 0 Hz in which the body moves as a whole.
identification::Suspension suspension_of(const study::Study& study, const IdentifiedModel& model,
                                         const ChannelFrame& outputs, const ChannelFrame& inputs) {
  const auto& fit = model.found.fit;
  const int stated = study.identification ? study.identification->suspended_modes : -1;
  if (fit.model.rigid_count > 0 || stated == 0) return {};
  if (stated < 0 && !study.supports.empty()) return {};
  const auto motions = seen_motions(outputs, inputs);
  const Eigen::Vector3d about = outputs.places.colwise().mean();
  const Eigen::MatrixXd left = identification::rigid_motions(outputs, about) * motions;
  const Eigen::MatrixXd right = identification::rigid_motions(inputs, about) * motions;
  return stated > 0 ? identification::stated_suspension(fit, left, right, stated)
                    : identification::suspension(fit, left, right);
}

// A sentence where the response at low frequencies is not that of the whole body.
std::string missing_modes(const study::Study& study, const RigidBodyOfChannels& found,
                          const IdentifiedModel& model) {
  const auto seen = std::min(found.sensors.rank, found.actuators.rank);
  if (found.modes >= seen || is_held(study)) return "";
  return fmt::format(
      "the channels see {} motions of the body as a whole and the fit has {} of them: below {:.4g} "
      "Hz, where its lines begin, the model lacks that part of the response",
      seen, found.modes, model.data.frequency_hz(0));
}

void add_properties(const ChannelFrame& outputs, const ChannelFrame& inputs,
                    const IdentifiedModel& model, double bending, RigidBodyOfChannels& found) {
  auto product = identification::rigid_product(model.found.fit, model.match, found.suspended);
  // Either side of a product may be off by this part of the rms.
  const double bent = 2.0 * bending * bending * product.value.cwiseAbs2().mean();
  product.covariance.diagonal().array() += bent;
  try {
    found.properties = identification::rigid_properties(product, outputs, inputs);
  } catch (const NumericalFailure& fault) {
    found.notes.emplace_back(fault.what());
    return;
  }
  found.about = found.properties->about;
  const auto has_no_unit = [](const auto& channel) { return channel.unit.empty(); };
  found.up_to_a_factor =
      std::any_of(model.seen.outputs.begin(), model.seen.outputs.end(), has_no_unit);
}

bool are_of_one_kind(const std::vector<modal::MeasuredChannel>& channels) {
  return std::ranges::all_of(
      channels, [&](const auto& channel) { return channel.kind == channels.front().kind; });
}

}  // namespace

std::optional<RigidBodyOfChannels> rigid_body_of_channels(const study::Study& study,
                                                          const IdentifiedModel& model) {
  const auto outputs = identification::channel_frame(model.seen.outputs);
  const auto inputs = identification::channel_frame(model.seen.inputs);
  if (!outputs || !inputs) return std::nullopt;
  RigidBodyOfChannels found;
  found.sensor_names = modal::names_of(model.seen.outputs);
  found.actuator_names = modal::names_of(model.seen.inputs);
  found.about = (outputs->places.colwise().sum() + inputs->places.colwise().sum()).transpose() /
                static_cast<double>(outputs->places.rows() + inputs->places.rows());
  const auto suspension = suspension_of(study, model, *outputs, *inputs);
  found.suspended = suspension.modes;
  found.modes =
      model.found.fit.model.rigid_count + static_cast<Eigen::Index>(found.suspended.size());
  found.sensors = identification::sensor_decoupling(*outputs, found.about);
  found.actuators = identification::actuator_decoupling(*inputs, found.about);
  const auto missing = missing_modes(study, found, model);
  if (!missing.empty()) found.notes.push_back(missing);
  if (!are_of_one_kind(model.seen.outputs)) {
    found.notes.emplace_back(
        "the sensors measure different quantities: their decoupling matrix is for displacements");
  }
  if (model.match.side < 0) {
    found.notes.emplace_back(
        "the decoupling matrices are for the directions that the study states, against which the "
        "actuators as a whole count in the responses: a loop through both matrices needs the other "
        "sign");
  }
  // Fewer modes than motions, as on springs to the ground, are not those of the whole body.
  if (found.modes == 0 || found.modes < std::min(found.sensors.rank, found.actuators.rank)) {
    return found;
  }
  add_properties(*outputs, *inputs, model, suspension.bending, found);
  found.sensors = identification::sensor_decoupling(*outputs, found.about);
  found.actuators = identification::actuator_decoupling(*inputs, found.about);
  return found;
}

}  // namespace chladni::steps
