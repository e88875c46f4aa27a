// Placement as fields, pictures and files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/heat_map_picture.h"
#include "show/placement.h"
#include "show/placement/placement_words.h"
#include "show/readable.h"

namespace chladni::show {
namespace {

io::HeatMapPicture picture_of(const study::Study& study, const stage::Solution& solution,
                              const steps::BestPlaces& places) {
  const auto& sites = places.surface.sites;
  const auto& map = places.maps[places.chosen];
  io::HeatMapPicture picture;
  picture.title = study.title;
  picture.scale = std::string(places.criterion->name) + ", lighter is better";
  picture.points = sites.position;
  picture.triangles = places.surface.triangles;
  const double highest = map.score.maxCoeff();
  picture.value = highest > 0.0 ? Eigen::VectorXd(map.score / highest) : map.score;
  picture.lowest = "0";
  picture.highest = value_text(*places.criterion, highest);
  if (places.criterion->unit != "1") picture.lowest = "unknown";
  for (Eigen::Index i = 0; i < places.forbidden.size(); ++i) {
    picture.forbidden.push_back(places.forbidden(i) >= 0 ? 1 : 0);
  }
  for (const auto& [first, size] : places.wanted.groups) {
    if (size > 1) continue;  // a repeated mode has no fixed nodal lines
    const auto column = places.wanted.columns[static_cast<std::size_t>(first)];
    picture.nodal_lines.push_back(
        {fmt::format("mode {} ({:.2f} Hz)", column + 1, solution.modes.frequency_hz(column)),
         sites.shapes.col(column)});
  }
  const auto& shown = places.pairs.empty() ? places.best : places.pairs;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // The best one, and those equally good by symmetry.
    if (places.pairs.empty() && shown[i].score < 0.99 * shown[0].score) break;
    picture.best.push_back(
        {shown[i].position, value_text(*places.criterion, shown[i].score) + ", mode " +
                                fmt::to_string(column_of(places, shown[i].limiting) + 1)});
  }
  picture.markers = stage::markers_of(study, solution.model);
  picture.markers.resize(study.sensors.size() + study.actuators.size());
  return picture;
}

/// A deviation over the surface, of each layout.
struct LayoutField {
  std::string scale;
  Eigen::VectorXd steps::ScoredLayout::*deviation;
  double factor;  ///< to `unit`
  std::string unit;
};

LayoutField shape_error() {
  return {"expected error of an interpolated shape, of its root mean square",
          &steps::ScoredLayout::deviation, 100.0, "%"};
}

LayoutField motion_error() {
  return {"what the observer of a layout does not know of the motion",
          &steps::ScoredLayout::motion_deviation, 1e9, "nm"};
}

io::LayoutsPicture layouts_picture(const study::Study& study, const steps::BestPlaces& places,
                                   const LayoutField& field) {
  io::LayoutsPicture picture;
  picture.title = study.title + ": layouts";
  picture.scale = field.scale;
  picture.points = places.surface.sites.position;
  picture.triangles = places.surface.triangles;
  double largest = 0.0;
  for (const auto& layout : places.layouts) {
    const Eigen::VectorXd& off = layout.*field.deviation;
    if (off.size() > 0) largest = std::max(largest, off.maxCoeff());
  }
  picture.lightest = "0";
  picture.darkest = two_digits(field.factor * largest) + " " + field.unit;
  if (!(largest > 0.0)) largest = 1.0;  // all is known: light
  for (const auto& layout : places.layouts) {
    const Eigen::VectorXd& off = layout.*field.deviation;
    if (off.size() == 0) continue;
    const double mean =
        std::sqrt(off.cwiseAbs2().dot(places.surface.sites.area) / places.surface.sites.area.sum());
    picture.panels.push_back(
        {layout.name,
         fmt::format("mean {} {}, worst {} {}", two_digits(field.factor * mean), field.unit,
                     two_digits(field.factor * off.maxCoeff()), field.unit),
         (1.0 - (off / largest).array().sqrt()).matrix(), layout.markers});
  }
  return picture;
}

void leave_fields(const stage::Solution& solution, const steps::BestPlaces& places,
                  const std::string& title, const Run& run) {
  std::vector<io::NodeField> fields;
  const auto criteria = placement::criteria();
  io::Units units{title, {"length: m"}};
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    fields.push_back({std::string(criteria[c]->name), places.maps[c].score});
    units.lines.push_back(std::string(criteria[c]->name) +
                          (criteria[c]->unit == "1" ? ": 1" : ": 1/standard deviation"));
  }
  Eigen::VectorXd limiting(places.surface.sites.count());
  for (Eigen::Index i = 0; i < limiting.size(); ++i) {
    const auto column = column_of(places, places.maps[places.chosen].limiting(i));
    limiting(i) = static_cast<double>(column - solution.modes.rigid_count + 1);
  }
  fields.push_back({"limiting_mode", limiting});
  fields.push_back({"admissible", (places.forbidden.array() < 0).cast<double>()});
  io::write_surface_vtu(run / "heat_map.vtu", places.surface.sites.position,
                        places.surface.triangles, fields, units);
}

}  // namespace

void leave_placement(const study::Study& study, const stage::Solution& solution,
                     const steps::BestPlaces& places, Run& run, bool main_result) {
  for (const auto& note : places.notes) run.note(note);
  for (const auto& layout : places.layouts) {
    for (const int mode : layout.blind) {
      const auto& columns = places.wanted.columns;
      if (std::find(columns.begin(), columns.end(), mode - 1) == columns.end()) continue;
      run.warn(blind_text(solution, layout) + "; placement.modes asks for it");
      break;
    }
  }
  run.leave("placement.json", placement_json(study, solution, places), main_result);
  leave_fields(solution, places, study.title, run);
  if (run.options().pictures) tell(run.progress(), "painting the heat map");
  run.paint("heat_map.png",
            [&](const auto& png) { io::draw_heat_map(png, picture_of(study, solution, places)); });
  for (const auto& [file, field] : {std::pair("layouts.png", shape_error()),
                                    std::pair("observer_layouts.png", motion_error())}) {
    run.paint(file, [&](const auto& png) {
      const auto layouts = layouts_picture(study, places, field);
      if (!layouts.panels.empty()) io::draw_layouts(png, layouts);
    });
  }
}

}  // namespace chladni::show
