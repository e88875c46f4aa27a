// Scores of the study's layouts, and the best possible layouts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "mesh/surface.h"
#include "placement/constants.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

constexpr double kCollocated = 1e-3;  // [m], largest distance

Eigen::MatrixXd wanted_part(const Eigen::MatrixXd& shapes, const WantedModes& wanted) {
  return shapes(Eigen::all, wanted.columns);
}

// The data that all layouts of a study share; the channels are added later.
placement::LayoutView bare_view(const study::Study& study, const stage::Solution& solution,
                                const study::PlacementPlan& plan, const Placed& placed) {
  const auto& modes = solution.modes;
  const auto& wanted = placed.wanted;
  const auto& sites = placed.surface.sites;
  placement::LayoutView view;
  view.groups = wanted.groups;
  view.frequency_hz = modes.frequency_hz(wanted.columns);
  view.damping_ratio = modes.damping_ratio(wanted.columns);
  view.rms = wanted.rms;
  view.sensor_noise = wanted.sensor_noise;
  view.actuator_noise = wanted.actuator_noise;
  view.prior = placement::shape_prior(sites.shapes, sites.area, modes.frequency_hz, wanted.columns);
  view.surface_all = sites.shapes;
  const placement::Sampler sampler(solution.model.body, modes, {plan.direction, 0.0});
  const auto& finder = sampler.finder();
  std::vector<mesh::Site> points;
  for (const auto& place : plan.interest) {
    auto site = place.from_above ? finder.from_above(place.point.x(), place.point.y())
                                 : std::optional(finder.nearest(place.point));
    require(site && site->distance < 1e-3, study.file.string() + ":" + std::to_string(place.line) +
                                               ": a point of interest is not on the body");
    points.push_back(*site);
  }
  view.interest_all = sampler.at(points).shapes;
  view.interest = wanted_part(view.interest_all, wanted);
  return view;
}

placement::Lines lines_of(const std::vector<study::Channel>& channels,
                          const std::vector<mesh::Site>& sites,
                          const std::vector<std::size_t>& chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  placement::Lines lines{Points(count, 3), Points(count, 3)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = chosen[static_cast<std::size_t>(i)];
    lines.position.row(i) = sites[k].position.transpose();
    lines.direction.row(i) = channels[k].direction.transpose();
  }
  return lines;
}

std::vector<std::size_t> numbers_of(const std::vector<study::Channel>& channels,
                                    const std::vector<std::string>& names) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (std::find(names.begin(), names.end(), channels[i].name) != names.end()) {
      numbers.push_back(i);
    }
  }
  return numbers;
}

// Modes of the whole study, counted from 1, that the points cannot see.
std::vector<int> blind_modes(const stage::Solution& solution, const study::PlacementPlan& plan,
                             placement::LayoutView view, const Placed& placed) {
  const auto& modes = solution.modes;
  const Eigen::Index rigid = modes.rigid_count;
  const Eigen::Index flexible = modes.mode_count() - rigid;
  view.groups = modal::groups(modes.frequency_hz.tail(flexible), plan.frequency_tolerance);
  const auto& sites = placed.surface.sites;
  const auto norms =
      placement::group_norms(sites.shapes.rightCols(flexible), sites.area, view.groups);
  view.rms.resize(flexible);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    view.rms.segment(view.groups[g].first, view.groups[g].size)
        .setConstant(norms.rms(static_cast<Eigen::Index>(g)));
  }
  view.sensors = view.sensors_all.rightCols(flexible).eval();
  view.actuators = view.actuators_all.rightCols(flexible).eval();
  const Eigen::VectorXd sight = placement::sight(view);
  std::vector<int> blind;
  const double still = 1e-3 / std::sqrt(solution.model.mass.mass_kg);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    const auto [first, size] = view.groups[g];
    // A mode that hardly moves the surface in this direction is not counted.
    if (sight(static_cast<Eigen::Index>(g)) >= placement::Constants::blind ||
        view.rms(first) < still) {
      continue;
    }
    for (Eigen::Index i = 0; i < size; ++i)
      blind.push_back(static_cast<int>(rigid + first + i + 1));
  }
  return blind;
}

ScoredLayout scored(const std::string& name, const placement::LayoutView& view,
                    const stage::Solution& solution, const study::PlacementPlan& plan,
                    const Placed& placed) {
  ScoredLayout layout;
  layout.name = name;
  layout.pairs = static_cast<int>(view.pairs.size());
  const auto criteria = placement::layout_criteria();
  layout.scores.resize(static_cast<Eigen::Index>(criteria.size()));
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    layout.scores(static_cast<Eigen::Index>(c)) = criteria[c]->value(view);
  }
  layout.blind = blind_modes(solution, plan, view, placed);
  const auto points = placement::samples(view);
  if (points.rows.rows() > 0) {
    layout.deviation =
        placement::expected_deviation(view.prior, points.rows, points.noise, view.surface_all)
            .cwiseAbs2()
            .rowwise()
            .mean()
            .cwiseSqrt();
  }
  return layout;
}

ScoredLayout scored_channels(const study::LayoutPlan& channels, placement::LayoutView view,
                             const study::Study& study, const stage::Solution& solution,
                             const study::PlacementPlan& plan, const Placed& placed) {
  const auto sensors = numbers_of(study.sensors, channels.sensors);
  const auto actuators = numbers_of(study.actuators, channels.actuators);
  const auto& model = solution.model;
  view.sensors_all =
      stage::shapes_at(study.sensors, model.sensors, solution.modes)(sensors, Eigen::all);
  view.actuators_all =
      stage::shapes_at(study.actuators, model.actuators, solution.modes)(actuators, Eigen::all);
  view.sensors = wanted_part(view.sensors_all, placed.wanted);
  view.actuators = wanted_part(view.actuators_all, placed.wanted);
  view.pairs = pairs_of(study, solution, sensors, actuators);
  auto layout = scored(channels.name, view, solution, plan, placed);
  layout.sensors = channels.sensors;
  layout.actuators = channels.actuators;
  const auto markers = stage::markers_of(study, model);
  for (const auto s : sensors) layout.markers.push_back(markers[s]);
  for (const auto a : actuators) layout.markers.push_back(markers[study.sensors.size() + a]);
  return layout;
}

study::LayoutPlan all_channels(const study::Study& study) {
  study::LayoutPlan layout;
  layout.name = "study";
  for (const auto& sensor : study.sensors) layout.sensors.push_back(sensor.name);
  for (const auto& actuator : study.actuators) layout.actuators.push_back(actuator.name);
  return layout;
}

// An optimum as sensors, scored like the other layouts.
ScoredLayout scored_optimum(const Optimum& optimum, placement::LayoutView view,
                            const stage::Solution& solution, const study::PlacementPlan& plan,
                            const Placed& placed) {
  view.sensors_all = optimum.shapes;
  view.actuators_all.resize(0, view.sensors_all.cols());
  view.sensors = wanted_part(view.sensors_all, placed.wanted);
  view.actuators = wanted_part(view.actuators_all, placed.wanted);
  auto layout = scored("best by " + optimum.by, view, solution, plan, placed);
  for (const auto at : optimum.sites.rowwise()) {
    layout.markers.push_back({"", "sensor", at.transpose(), Eigen::Vector3d::UnitZ()});
  }
  return layout;
}

// Two of one kind in one place are only one point with less noise.
void note_coincident(const ScoredLayout& layout, std::vector<std::string>& notes) {
  for (std::size_t i = 0; i < layout.markers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& a = layout.markers[j];
      const auto& b = layout.markers[i];
      const bool same = a.kind == b.kind && (a.position - b.position).norm() < kCollocated &&
                        std::abs(a.direction.dot(b.direction)) > 0.999;
      if (!same || b.name.empty()) continue;
      notes.push_back(fmt::format("layout \"{}\": {}s {} and {} are in one place and see the same",
                                  layout.name, a.kind, a.name, b.name));
    }
  }
}

}  // namespace

std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_of(
    const study::Study& study, const stage::Solution& solution,
    const std::vector<std::size_t>& sensors, const std::vector<std::size_t>& actuators) {
  const auto& model = solution.model;
  const auto box = mesh::bounding_box(model.body.points);
  return placement::collocated(lines_of(study.sensors, model.sensors, sensors),
                               lines_of(study.actuators, model.actuators, actuators), kCollocated,
                               0.05 * (box.row(1) - box.row(0)).norm());
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_of(const study::Study& study,
                                                            const stage::Solution& solution) {
  std::vector<std::size_t> sensors(study.sensors.size()), actuators(study.actuators.size());
  std::iota(sensors.begin(), sensors.end(), 0U);
  std::iota(actuators.begin(), actuators.end(), 0U);
  return pairs_of(study, solution, sensors, actuators);
}

void add_layouts(const study::Study& study, const stage::Solution& solution,
                 const study::PlacementPlan& plan, Placed& placed) {
  const auto view = bare_view(study, solution, plan, placed);
  std::vector<study::LayoutPlan> layouts = study.layouts;
  const bool has_channels = !study.sensors.empty() || !study.actuators.empty();
  if (layouts.empty() && has_channels) layouts.push_back(all_channels(study));
  for (const auto& layout : layouts) {
    placed.layouts.push_back(scored_channels(layout, view, study, solution, plan, placed));
    note_coincident(placed.layouts.back(), placed.notes);
  }
  for (const auto& optimum : placed.optima) {
    placed.layouts.push_back(scored_optimum(optimum, view, solution, plan, placed));
  }
}

}  // namespace chladni::steps
