#include "stage/estimates/blind_spots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chladni::stage {
namespace {

constexpr double kBlind = 0.01;      // part of the largest motion of a mode
constexpr double kMeshError = 0.01;  // relative, of a frequency
constexpr double kDashpot = 0.1;     // of the stated damping ratio: less is not worth a word
constexpr double kNoDashpot = 1e-6;  // damping ratio
constexpr std::size_t kMostListed = 8;

/// A flexible mode, or a repeated one with all its members.
struct Group {
  Eigen::Index first, size;
  std::string number;  ///< "mode 9", "modes 10-11"
  double hz;
};

std::vector<Group> groups_of(const Solution& solution) {
  std::vector<Group> groups;
  const auto& modes = solution.modes;
  for (Eigen::Index i = modes.rigid_count; i < modes.mode_count();) {
    Eigen::Index size = 1;
    for (const auto& cluster : solution.summary.clusters) {
      if (cluster.first == i) size = cluster.size;
    }
    const auto number =
        size == 1 ? fmt::format("mode {}", i + 1) : fmt::format("modes {}-{}", i + 1, i + size);
    groups.push_back({i, size, number, modes.frequency_hz(i)});
    i += size;
  }
  return groups;
}

/// Largest motion of each group on the body, in any direction.
Eigen::VectorXd largest_motion(const modal::Modes& modes, const std::vector<Group>& groups) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto shapes = modes.shapes.middleCols(groups[g].first, groups[g].size);
    for (Eigen::Index node = 0; node < modes.dof_count() / 3; ++node) {
      auto& value = largest(static_cast<Eigen::Index>(g));
      value = std::max(value, shapes.middleRows<3>(3 * node).norm());
    }
  }
  return largest;
}

/// channels×groups: motion at each channel over the largest motion, 0 to 1.
Eigen::MatrixXd gains(const std::vector<study::Channel>& channels,
                      const std::vector<mesh::Site>& sites, const modal::Modes& modes,
                      const std::vector<Group>& groups) {
  const Eigen::MatrixXd values = shapes_at(channels, sites, modes);
  const Eigen::VectorXd largest = largest_motion(modes, groups);
  Eigen::MatrixXd result(values.rows(), largest.size());
  for (Eigen::Index g = 0; g < largest.size(); ++g) {
    const auto& group = groups[static_cast<std::size_t>(g)];
    result.col(g) = values.middleCols(group.first, group.size).rowwise().norm() / largest(g);
  }
  return result;
}

/// "a, b, c and 4 more".
std::string first_of(const std::vector<std::string>& all) {
  const std::size_t shown = std::min(all.size(), kMostListed);
  const auto text = fmt::format(
      "{}", fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return shown == all.size() ? text : fmt::format("{} and {} more", text, all.size() - shown);
}

void add_blindness(const std::string& kind, const std::vector<study::Channel>& channels,
                   const Eigen::MatrixXd& gain, const std::vector<Group>& groups,
                   std::vector<std::string>& lines) {
  if (channels.empty()) return;
  std::vector<std::string> unseen;
  std::vector<std::string> nodal;
  for (Eigen::Index g = 0; g < gain.cols(); ++g) {
    const auto& group = groups[static_cast<std::size_t>(g)];
    if (gain.col(g).maxCoeff() < kBlind) {
      unseen.push_back(fmt::format("{} ({:.2f} Hz)", group.number, group.hz));
      continue;
    }
    for (Eigen::Index c = 0; c < gain.rows(); ++c) {
      if (gain(c, g) >= kBlind) continue;
      const auto& name = channels[static_cast<std::size_t>(c)].name;
      nodal.push_back(fmt::format("\"{}\" of {} (gain {:.3f})", name, group.number, gain(c, g)));
    }
  }
  if (!unseen.empty()) {
    lines.push_back(fmt::format("no {} {} {}: put one off their nodal lines, or turn it", kind,
                                kind == "sensor" ? "sees" : "moves", first_of(unseen)));
  }
  if (!nodal.empty()) {
    lines.push_back(fmt::format("{}s on nodal lines: {}", kind, first_of(nodal)));
  }
}

std::size_t modes_to_place(const study::PlacementPlan& plan, const modal::Modes& modes) {
  if (!(plan.up_to_hz > 0.0)) return plan.modes.size();
  const auto flexible = modes.frequency_hz.tail(modes.mode_count() - modes.rigid_count);
  return static_cast<std::size_t>((flexible.array() <= plan.up_to_hz).count());
}

bool is_in(const study::KeepOut& zone, const mesh::Site& site, const mesh::TetMesh& body) {
  const Eigen::Vector2d at = site.position.head<2>();
  if (zone.shape == "disc") return (at - zone.from).norm() < 0.5 * zone.diameter;
  if (zone.shape == "box") {
    return (at.array() > zone.from.array().min(zone.to.array())).all() &&
           (at.array() < zone.from.array().max(zone.to.array())).all();
  }
  const auto patch = static_cast<std::size_t>(body.face_patch(site.face));
  return patch < body.patch_names.size() && body.patch_names[patch] == zone.patch;
}

}  // namespace

std::vector<std::string> channels_kept_out(const study::Study& study, const Model& model) {
  std::vector<std::string> found;
  if (!study.placement) return found;
  const auto look = [&](const std::string& kind, const std::vector<study::Channel>& channels,
                        const std::vector<mesh::Site>& sites) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const auto& zones = study.placement->keep_out;
      const bool kept_out = std::any_of(
          zones.begin(), zones.end(),
          [&](const study::KeepOut& zone) { return is_in(zone, sites[i], model.body); });
      if (!kept_out) continue;
      found.push_back(
          fmt::format("{} \"{}\" (line {})", kind, channels[i].name, channels[i].at.line));
    }
  };
  look("sensor", study.sensors, model.sensors);
  look("actuator", study.actuators, model.actuators);
  if (found.empty()) return found;
  return {fmt::format("{}: placement.keep_out keeps the places of these free: {}",
                      study.file.string(), first_of(found))};
}

std::vector<std::string> blind_spots(const study::Study& study, const Solution& solution) {
  std::vector<std::string> lines;
  const auto groups = groups_of(solution);
  if (groups.empty()) return lines;
  const auto& modes = solution.modes;
  add_blindness("sensor", study.sensors,
                gains(study.sensors, solution.model.sensors, modes, groups), groups, lines);
  add_blindness("actuator", study.actuators,
                gains(study.actuators, solution.model.actuators, modes, groups), groups, lines);
  const auto wanted = study.placement ? modes_to_place(*study.placement, modes) : 0;
  if (!study.sensors.empty() && study.sensors.size() < wanted) {
    lines.push_back(
        fmt::format("{} sensors for the {} modes of [placement]: they cannot tell all "
                    "of them apart at one moment",
                    study.sensors.size(), wanted));
  }
  return lines;
}

std::vector<std::string> coarse_mesh(const Solution& solution) {
  Eigen::Index worst = 0;
  if (solution.frequency_error.size() == 0) return {};
  const double error = solution.frequency_error.maxCoeff(&worst);
  if (error <= kMeshError) return {};
  const int order = solution.model.body.order();
  const double shorter = std::pow(kMeshError / error, 0.5 / order);
  const auto remedy =
      solution.introduction.outline.file_has_cells
          ? fmt::format("mesh it finer where it was made, with edges {:.2f} as long", shorter)
          : fmt::format("shorten mesh.edge_length to {:.2f} of it", shorter);
  return {fmt::format("the mesh may leave mode {} ({:.2f} Hz) {:.1f} % too high; for 1 % {}{}",
                      worst + 1, solution.modes.frequency_hz(worst), 100.0 * error, remedy,
                      order < 3 ? ", or raise mesh.order" : "")};
}

std::vector<std::string> left_out_dashpots(const Solution& solution) {
  const auto& damping = solution.system->damping;
  if (damping.nonZeros() == 0) return {};
  const auto& modes = solution.modes;
  const auto& free_dof = solution.system->dofs.free_dof;
  std::vector<std::string> damped;
  Eigen::VectorXd shape(damping.rows());
  for (auto i = modes.rigid_count; i < modes.mode_count(); ++i) {
    for (Eigen::Index dof = 0; dof < free_dof.size(); ++dof) {
      if (free_dof(dof) < 0) continue;
      const auto extra = dof - modes.shapes.rows();
      shape(free_dof(dof)) = extra < 0 ? modes.shapes(dof, i) : solution.extra_shapes(extra, i);
    }
    const double omega = 2.0 * std::numbers::pi * modes.frequency_hz(i);
    const Eigen::VectorXd force = damping.selfadjointView<Eigen::Lower>() * shape;
    const double ratio = shape.dot(force) / (2.0 * omega);
    if (ratio <= std::max(kDashpot * modes.damping_ratio(i), kNoDashpot)) continue;
    damped.push_back(
        fmt::format("mode {} ({:.2f} Hz) {:.2g}", i + 1, modes.frequency_hz(i), ratio));
  }
  if (damped.empty()) return {};
  return {
      "dashpots are left out of the modes and of their damping ratios; by themselves they would "
      "give a damping ratio to " +
      first_of(damped)};
}

}  // namespace chladni::stage
