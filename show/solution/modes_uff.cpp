#include "show/modes_uff.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include "dense/algebra.h"
#include "host/atomic_file.h"
#include "show/version.h"

namespace chladni::show {
namespace {

using Eigen::Index;

constexpr double kOnePlace = 1e-9;  // [m]

io::UffModes untitled(const study::Study& study) {
  return {.title = study.title,
          .program = "chladni " + version(),
          .node = {},
          .place = {},
          .triangles = {},
          .lines = {},
          .frequency_hz = {},
          .damping_ratio = {},
          .shapes = {},
          .imaginary = {},
          .has_scale = {},
          .known = {}};
}

/// Channels at one place.
struct Node {
  long long number = 0;  // 0: not stated
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  std::vector<Index> rows;     // of the matched shapes
  Eigen::MatrixXd directions;  // of these, one in each row
};

/// The channel of a row of the matched shapes, with the node that the study or the file states.
modal::MeasuredChannel channel_of(const study::Study& study, const steps::IdentifiedModel& model,
                                  Index row) {
  const auto& matched = model.match.rows[static_cast<std::size_t>(row)];
  const auto& side = matched.actuator ? model.seen.inputs : model.seen.outputs;
  auto channel = side[static_cast<std::size_t>(matched.channel)];
  const auto& stated = matched.actuator ? study.actuators : study.sensors;
  const Index at = steps::index_of(stated, channel.name);
  if (at >= 0 && stated[static_cast<std::size_t>(at)].node) {
    channel.node = stated[static_cast<std::size_t>(at)].node;
  }
  return channel;
}

void number_rest(std::vector<Node>& nodes) {
  std::set<long long> taken;
  for (const auto& node : nodes) taken.insert(node.number);
  long long next = 1;
  for (auto& node : nodes) {
    if (node.number > 0) continue;
    while (taken.contains(next)) ++next;
    node.number = next++;
  }
}

// The node of the channel's number, else one at its place that has no other number.
std::vector<Node>::iterator known_node(std::vector<Node>& nodes,
                                       const modal::MeasuredChannel& channel) {
  const auto numbered = std::ranges::find_if(
      nodes, [&](const Node& node) { return channel.node && node.number == *channel.node; });
  if (numbered != nodes.end() || !channel.position) return numbered;
  return std::ranges::find_if(nodes, [&](const Node& node) {
    const bool is_free = !channel.node || node.number == 0;
    return is_free && (node.place - *channel.position).norm() < kOnePlace;
  });
}

void join(Node& node, Index row, const Eigen::Vector3d& direction) {
  node.rows.push_back(row);
  node.directions.conservativeResize(std::ssize(node.rows), 3);
  node.directions.bottomRows(1) = direction.transpose();
}

using Known = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

// Whether the value of a row in a mode is known: it has a deviation, where these are stated. A mode
// without a scale, or with one of unknown deviation, has none at any row; it is known at the
// sensors that the fit knows it at.
bool is_known(const steps::IdentifiedModel& model, Index row, Index mode) {
  const auto& match = model.match;
  if (!match.shapes.row(row).allFinite()) return false;
  if (match.deviation.size() == 0 || std::isfinite(match.deviation(row, mode))) return true;
  const auto& matched = match.rows[static_cast<std::size_t>(row)];
  const bool has_scale =
      match.modes[static_cast<std::size_t>(mode)].by != identification::MatchedBy::nothing &&
      match.deviation.col(mode).array().isFinite().any();
  const auto& fitted = model.found.fit.output_std;
  return !has_scale && !matched.actuator && fitted.rows() > matched.channel &&
         fitted.cols() > mode && std::isfinite(fitted(matched.channel, mode));
}

// Rows of the match × modes of the file.
Known known_values(const steps::IdentifiedModel& model, const std::vector<Index>& modes) {
  Known known(std::ssize(model.match.rows), std::ssize(modes));
  for (Index row = 0; row < known.rows(); ++row) {
    for (Index k = 0; k < known.cols(); ++k) {
      known(row, k) = is_known(model, row, modes[static_cast<std::size_t>(k)]);
    }
  }
  return known;
}

// The nodes of the rows that some mode knows.
std::vector<Node> nodes_of(const study::Study& study, const steps::IdentifiedModel& model,
                           const Known& known) {
  std::vector<Node> nodes;
  for (Index row = 0; row < std::ssize(model.match.rows); ++row) {
    if (!known.row(row).any()) continue;
    const auto channel = channel_of(study, model, row);
    auto node = known_node(nodes, channel);
    if (node == nodes.end()) {
      nodes.push_back({.number = 0,
                       .place = channel.position.value_or(Eigen::Vector3d::Zero()),
                       .rows = {},
                       .directions = {}});
      node = nodes.end() - 1;
    }
    if (channel.node) node->number = *channel.node;
    join(*node, row, channel.direction);
  }
  number_rest(nodes);
  return nodes;
}

// The channels of the node that know a mode; none where these do not tell the motion along the
// direction of one of its sensors, at which a reader would find a 0.
std::vector<Index> telling_channels(const Node& node, const identification::GainMatch& match,
                                    const Known& known, Index mode) {
  constexpr double kAcross = 1e-6;
  std::vector<Index> telling;
  std::vector<Index> sensors;
  for (Index c = 0; c < std::ssize(node.rows); ++c) {
    const auto row = node.rows[static_cast<std::size_t>(c)];
    if (known(row, mode)) telling.push_back(c);
    if (!match.rows[static_cast<std::size_t>(row)].actuator) sensors.push_back(c);
  }
  if (telling.empty() || sensors.empty()) return telling;
  const Eigen::MatrixXd told = node.directions(telling, Eigen::all).transpose();
  const Eigen::MatrixXd all = node.directions(sensors, Eigen::all).transpose();
  const Eigen::MatrixXd part = told * Eigen::MatrixXd(dense::pseudo_inverse(told) * all);
  return (all - part).norm() > kAcross ? std::vector<Index>{} : telling;
}

// Writes the motion of a node in each mode, from the channels that know it, into the file's modes.
void put_motion(const Node& node, Index at, const identification::GainMatch& match,
                const std::vector<Index>& modes, const Known& known, io::UffModes& result) {
  for (Index k = 0; k < std::ssize(modes); ++k) {
    const auto telling = telling_channels(node, match, known, k);
    result.known(at, k) = !telling.empty();
    if (telling.empty()) continue;
    std::vector<Index> rows;
    for (const auto c : telling) rows.push_back(node.rows[static_cast<std::size_t>(c)]);
    const Eigen::MatrixXd along = node.directions(telling, Eigen::all);
    const Eigen::MatrixXd directions = dense::pseudo_inverse(along);
    const auto mode = modes[static_cast<std::size_t>(k)];
    result.shapes.col(k).segment<3>(3 * at) =
        directions * Eigen::VectorXd(match.shapes.col(mode)(rows));
    if (match.imaginary.size() == 0) continue;
    result.imaginary.col(k).segment<3>(3 * at) =
        directions * Eigen::VectorXd(match.imaginary.col(mode)(rows));
  }
}

std::vector<bool> scales_of(const identification::GainMatch& match,
                            const std::vector<Index>& modes) {
  std::vector<bool> has_scale;
  for (const Index mode : modes) {
    has_scale.push_back(match.modes.at(static_cast<std::size_t>(mode)).by !=
                        identification::MatchedBy::nothing);
  }
  return has_scale;
}

// Whether the interpolated shapes are mass-normalised: those of a table have any scale.
std::vector<bool> scales_of(const study::Study& study, const steps::Interpolated& result) {
  const auto& measured = result.measured;
  const auto count = static_cast<std::size_t>(measured.shapes.frequency_hz.size());
  if (!measured.identified) {
    const bool of_a_study = study.measurement && !study.measurement->truth.empty();
    return std::vector<bool>(count, of_a_study);
  }
  return scales_of(measured.identified->match, measured.fitted_mode);
}

void leave(const std::string& name, const std::string& dataset,
           const std::function<io::UffModes()>& modes, const Run& run) {
  const auto file = run / name;
  if (dataset == "none") {
    std::filesystem::remove(file);  // of a run that was to leave it
    return;
  }
  write_atomically(file, io::modes_uff(modes(), dataset == "55" ? io::ShapeDataset::nodes_55
                                                                : io::ShapeDataset::analysis_2414));
}

}  // namespace

io::UffModes body_modes_uff(const study::Study& study, const stage::Solution& solution) {
  const auto& body = solution.model.body;
  auto result = untitled(study);
  result.triangles = body.faces.leftCols(3);
  std::vector<std::int32_t> row(static_cast<std::size_t>(body.node_count()), -1);
  for (const auto corner : result.triangles.reshaped()) row[static_cast<std::size_t>(corner)] = 0;
  std::vector<Index> corners;
  for (std::size_t node = 0; node < row.size(); ++node) {
    if (row[node] < 0) continue;
    row[node] = static_cast<std::int32_t>(corners.size());
    corners.push_back(static_cast<Index>(node));
    result.node.push_back(std::ssize(corners));
  }
  for (auto& corner : result.triangles.reshaped()) corner = row[static_cast<std::size_t>(corner)];
  const auto& modes = solution.modes;
  result.place = body.points(corners, Eigen::all);
  result.frequency_hz = modes.frequency_hz;
  result.damping_ratio = modes.damping_ratio;
  result.shapes.resize(3 * std::ssize(corners), modes.mode_count());
  for (Index i = 0; i < std::ssize(corners); ++i) {
    result.shapes.middleRows(3 * i, 3) =
        modes.shapes.middleRows(3 * corners[static_cast<std::size_t>(i)], 3);
  }
  result.has_scale.assign(static_cast<std::size_t>(modes.mode_count()), true);
  return result;
}

io::UffModes channel_modes_uff(const study::Study& study, const steps::IdentifiedModel& model) {
  const auto& match = model.match;
  const auto modes = steps::modes_within(model);
  const auto known = known_values(model, modes);
  const auto nodes = nodes_of(study, model, known);
  const Index n = std::ssize(nodes), m = std::ssize(modes);
  auto result = untitled(study);
  result.place.resize(n, 3);
  result.shapes.setZero(3 * n, m);
  result.known.resize(n, m);
  if (match.imaginary.size() > 0) result.imaginary.setZero(3 * n, m);
  for (Index i = 0; i < n; ++i) {
    const auto& node = nodes[static_cast<std::size_t>(i)];
    result.node.push_back(node.number);
    result.place.row(i) = node.place.transpose();
    put_motion(node, i, match, modes, known, result);
  }
  result.lines = io::wire_frame(result.place);
  result.frequency_hz = model.found.fit.model.frequency_hz(modes);
  result.damping_ratio = model.found.fit.model.damping_ratio(modes);
  result.has_scale = scales_of(match, modes);
  return result;
}

io::UffModes surface_modes_uff(const study::Study& study, const steps::Interpolated& result) {
  const auto& sites = result.surface.sites;
  const auto& mean = result.methods.front().surface.mean;
  auto modes = untitled(study);
  modes.place = sites.position;
  modes.triangles = result.surface.triangles;
  modes.shapes.resize(3 * sites.count(), mean.cols());
  for (Index i = 0; i < sites.count(); ++i) {
    modes.node.push_back(i + 1);
    const Eigen::Vector3d along = result.direction.value_or(sites.normal.row(i).transpose());
    modes.shapes.middleRows(3 * i, 3) = along * mean.row(i);
  }
  modes.frequency_hz = result.measured.shapes.frequency_hz;
  modes.damping_ratio = result.measured.damping_ratio;
  if (modes.damping_ratio.size() == 0) modes.damping_ratio.setZero(modes.frequency_hz.size());
  modes.has_scale = scales_of(study, result);
  return modes;
}

void leave_modes_uff(const study::Study& study, const stage::Solution& solution, const Run& run) {
  leave(
      "modes.unv", study.modes.uff, [&] { return body_modes_uff(study, solution); }, run);
}

void leave_modes_uff(const study::Study& study, const steps::IdentifiedModel& model, Run& run) {
  const auto plan = study.identification.value_or(study::IdentificationPlan{});
  const auto modes = [&] {
    auto result = channel_modes_uff(study, model);
    for (Index k = 0; k < result.known.cols(); ++k) {
      if (result.known.col(k).any()) continue;
      run.warn(
          fmt::format("identified.unv: the mode at {:.6g} Hz is left out, its shape is known "
                      "at no channel",
                      result.frequency_hz(k)));
    }
    return result;
  };
  leave("identified.unv", plan.uff, modes, run);
}

void leave_modes_uff(const study::Study& study, const steps::Interpolated& result, const Run& run) {
  const auto plan = study.interpolation.value_or(study::InterpolationPlan{});
  leave(
      "mode_field.unv", plan.uff, [&] { return surface_modes_uff(study, result); }, run);
}

}  // namespace chladni::show
