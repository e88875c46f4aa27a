// Scores of the study's layouts, and of the best possible layouts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stage/points_on_body.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

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

ScoredLayout scored_channels(const study::LayoutPlan& channels,
                             const placement::LayoutScorer& scorer, const study::Study& study,
                             const stage::Model& model) {
  const auto sensors = numbers_of(study.sensors, channels.sensors);
  const auto actuators = numbers_of(study.actuators, channels.actuators);
  ScoredLayout layout{scorer.of_channels(sensors, actuators),
                      channels.name,
                      channels.sensors,
                      channels.actuators,
                      {}};
  const auto markers = stage::markers_of(study, model);
  for (const auto s : sensors) layout.markers.push_back(markers[s]);
  for (const auto a : actuators) layout.markers.push_back(markers[study.sensors.size() + a]);
  return layout;
}

study::LayoutPlan layout_of_all_channels(const study::Study& study) {
  return {"study", study::names_of(study.sensors), study::names_of(study.actuators)};
}

// Adds the channels that stay, with their markers.
void add_those_that_stay(const study::Study& study, const placement::Structure& structure,
                         const stage::Model& model, ScoredLayout& layout) {
  const auto markers = stage::markers_of(study, model);
  for (std::size_t i = 0; i < study.sensors.size(); ++i) {
    if (!structure.sensors.keeps(static_cast<Eigen::Index>(i))) continue;
    layout.sensors.push_back(study.sensors[i].name);
    layout.markers.push_back(markers[i]);
  }
  for (std::size_t i = 0; i < study.actuators.size(); ++i) {
    if (!structure.actuators.keeps(static_cast<Eigen::Index>(i))) continue;
    layout.actuators.push_back(study.actuators[i].name);
    layout.markers.push_back(markers[study.sensors.size() + i]);
  }
}

// An optimum beside the channels that stay, scored like the other layouts.
ScoredLayout scored_optimum(const placement::Optimum& optimum,
                            const placement::LayoutScorer& scorer, const study::Study& study,
                            const placement::Structure& structure, const stage::Model& model) {
  auto score =
      optimum.kinds.empty() ? scorer.of_sensors(optimum.shapes) : scorer.of_devices(optimum);
  ScoredLayout layout{std::move(score), "best by " + optimum.by, {}, {}, {}};
  add_those_that_stay(study, structure, model, layout);
  for (Eigen::Index i = 0; i < optimum.sites.rows(); ++i) {
    const auto kind = optimum.kinds.empty() ? placement::DeviceKind::sensor
                                            : optimum.kinds[static_cast<std::size_t>(i)];
    const Eigen::Vector3d at = optimum.sites.row(i).transpose();
    for (const auto* marker : {"sensor", "actuator"}) {
      using enum placement::DeviceKind;
      if (kind == (marker == std::string_view("sensor") ? actuator : sensor)) continue;
      layout.markers.push_back({"", marker, at, Eigen::Vector3d::UnitZ()});
    }
  }
  return layout;
}

// Two of one kind in one place are only one point with less noise.
// @param near  [m]: the largest distance
void note_coincident(const ScoredLayout& layout, double near, std::vector<std::string>& notes) {
  for (std::size_t i = 0; i < layout.markers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& a = layout.markers[j];
      const auto& b = layout.markers[i];
      const bool same = a.kind == b.kind && (a.position - b.position).norm() < near &&
                        std::abs(a.direction.dot(b.direction)) > 0.999;
      if (!same || b.name.empty()) continue;
      notes.push_back(fmt::format("layout \"{}\": {}s {} and {} are in one place and see the same",
                                  layout.name, a.kind, a.name, b.name));
    }
  }
}

}  // namespace

void add_layouts(const study::Study& study, const stage::Solution& solution,
                 const placement::Structure& structure, const placement::Plan& plan,
                 BestPlaces& places) {
  const placement::LayoutScorer scorer(structure, places.surface.sites, places.wanted, plan);
  std::vector<study::LayoutPlan> layouts = study.layouts;
  const double near = stage::reach_of(solution.model.body);
  const bool has_channels = !study.sensors.empty() || !study.actuators.empty();
  if (layouts.empty() && has_channels) layouts.push_back(layout_of_all_channels(study));
  for (const auto& layout : layouts) {
    places.layouts.push_back(scored_channels(layout, scorer, study, solution.model));
    note_coincident(places.layouts.back(), near, places.notes);
  }
  for (const auto& optimum : places.optima) {
    places.layouts.push_back(scored_optimum(optimum, scorer, study, structure, solution.model));
  }
}

}  // namespace chladni::steps
