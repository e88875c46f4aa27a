// Placement as a table, JSON, fields and a picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/heat_map_picture.h"
#include "show/placement.h"
#include "steps/placement.h"

namespace chladni::show {
namespace {

io::Json place_json(const Eigen::Vector3d& at) {
  return io::JsonObject{{"x_m", at.x()}, {"y_m", at.y()}, {"z_m", at.z()}};
}

io::Json places_json(const Points& places) {
  io::JsonArray array;
  for (const auto at : places.rowwise()) array.push_back(place_json(at.transpose()));
  return array;
}

Eigen::Index column_of(const steps::Placed& placed, int group) {
  return placed.wanted.columns[static_cast<std::size_t>(
      placed.wanted.groups[static_cast<std::size_t>(group)].first)];
}

io::Json pair_json(const stage::Solution& solution, const steps::Placed& placed,
                   const steps::BestPair& pair) {
  const auto& modes = solution.modes;
  const Eigen::Index column = column_of(placed, pair.limiting);
  return io::JsonObject{{"x_m", pair.position.x()},
                        {"y_m", pair.position.y()},
                        {"z_m", pair.position.z()},
                        {"score", pair.score},
                        {"value", placed.criterion->for_people(pair.score)},
                        {"limiting_mode", static_cast<long long>(column - modes.rigid_count + 1)},
                        {"limiting_frequency_hz", modes.frequency_hz(column)}};
}

io::Json pairs_json(const stage::Solution& solution, const steps::Placed& placed,
                    const std::vector<steps::BestPair>& pairs) {
  io::JsonArray array;
  for (const auto& pair : pairs) array.push_back(pair_json(solution, placed, pair));
  return array;
}

io::Json worst_place_json(const steps::Placed& placed, const steps::ScoredLayout& layout) {
  if (layout.deviation.size() == 0) return {};
  Eigen::Index worst = 0;
  layout.deviation.maxCoeff(&worst);
  return place_json(placed.surface.sites.position.row(worst).transpose());
}

io::Json layout_json(const steps::Placed& placed, const steps::ScoredLayout& layout) {
  io::JsonObject scores;
  const auto criteria = placement::layout_criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    scores.emplace_back(std::string(criteria[c]->name),
                        layout.scores(static_cast<Eigen::Index>(c)));
  }
  io::JsonArray blind;
  for (const int mode : layout.blind) blind.emplace_back(mode);
  return io::JsonObject{{"name", layout.name},
                        {"sensors", io::Json::texts(layout.sensors)},
                        {"actuators", io::Json::texts(layout.actuators)},
                        {"collocated_pairs", layout.pairs},
                        {"blind_modes", blind},
                        {"worst_place", worst_place_json(placed, layout)},
                        {"scores", scores}};
}

io::Json optimum_json(const steps::Optimum& optimum) {
  const bool has_bound = optimum.certificate > 0.0;
  const auto& choice = optimum.choice;
  io::JsonArray equivalent;
  for (const auto& sites : optimum.equivalent) equivalent.push_back(places_json(sites));
  return io::JsonObject{{"criterion", optimum.by},
                        {"sites", places_json(optimum.sites)},
                        {"score", choice.score},
                        {"bound", has_bound ? io::Json(choice.bound) : io::Json()},
                        {"gap", has_bound ? io::Json(choice.bound - choice.score) : io::Json()},
                        {"efficiency", has_bound ? io::Json(optimum.certificate) : io::Json()},
                        {"proven", choice.proven},
                        {"remark", optimum.remark},
                        {"equivalent", equivalent}};
}

io::Json wanted_json(const stage::Solution& solution, const steps::WantedModes& wanted) {
  io::JsonArray modes;
  for (std::size_t g = 0; g < wanted.groups.size(); ++g) {
    const auto [first, size] = wanted.groups[g];
    const auto column = wanted.columns[static_cast<std::size_t>(first)];
    modes.push_back(
        io::JsonObject{{"mode", static_cast<long long>(column - solution.modes.rigid_count + 1)},
                       {"size", static_cast<long long>(size)},
                       {"frequency_hz", solution.modes.frequency_hz(column)},
                       {"rms_kg_m05", wanted.rms(first)},
                       {"sensor_noise_kg_m05", wanted.sensor_noise(first)},
                       {"actuator_noise_kg_m05", wanted.actuator_noise(first)}});
  }
  return modes;
}

std::string value_text(const placement::Criterion& criterion, double score) {
  const double value = criterion.for_people(score);
  return criterion.unit == "1" ? fmt::format("{:.3f}", value)
                               : fmt::format("{:.3g} {}", value, criterion.unit);
}

std::string pairs_table(const stage::Solution& solution, const steps::Placed& placed,
                        const std::vector<steps::BestPair>& pairs) {
  std::string text;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d mm = 1e3 * pairs[i].position;
    text += fmt::format("{:4}  {:9.2f} {:9.2f} {:9.2f}  {:>10}  {}\n", i + 1, mm.x(), mm.y(),
                        mm.z(), value_text(*placed.criterion, pairs[i].score),
                        steps::group_name(solution, placed.wanted, pairs[i].limiting));
  }
  return text;
}

std::string layouts_table(const steps::Placed& placed) {
  const auto width = [](const steps::ScoredLayout& layout) {
    return std::clamp<std::size_t>(layout.name.size(), 10, 30);
  };
  std::string text = fmt::format("\n{:<29}", "layout");
  for (const auto& layout : placed.layouts) {
    text += fmt::format("  {:>{}}", layout.name.substr(0, 30), width(layout));
  }
  text += "\n";
  const auto criteria = placement::layout_criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    const std::string unit =
        criteria[c]->unit == "1" ? "" : fmt::format(" [{}]", criteria[c]->unit);
    text += fmt::format("{:<29}", std::string(criteria[c]->name) + unit);
    for (const auto& layout : placed.layouts) {
      const double value = layout.scores(static_cast<Eigen::Index>(c));
      text += fmt::format("  {:>{}}", std::isfinite(value) ? fmt::format("{:.4g}", value) : "-",
                          width(layout));
    }
    text += criteria[c]->larger_is_better ? "  more is better\n" : "  less is better\n";
  }
  return text;
}

io::HeatMapPicture picture_of(const study::Study& study, const stage::Solution& solution,
                              const steps::Placed& placed) {
  const auto& sites = placed.surface.sites;
  const auto& map = placed.maps[placed.chosen];
  io::HeatMapPicture picture;
  picture.title = study.title;
  picture.scale = std::string(placed.criterion->name) + ", lighter is better";
  picture.points = sites.position;
  picture.triangles = placed.surface.triangles;
  const double highest = map.score.maxCoeff();
  picture.value = highest > 0.0 ? Eigen::VectorXd(map.score / highest) : map.score;
  picture.lowest = "0";
  picture.highest = value_text(*placed.criterion, highest);
  if (placed.criterion->unit != "1") picture.lowest = "unknown";
  for (Eigen::Index i = 0; i < placed.forbidden.size(); ++i) {
    picture.forbidden.push_back(placed.forbidden(i) >= 0 ? 1 : 0);
  }
  for (const auto& [first, size] : placed.wanted.groups) {
    if (size > 1) continue;  // a repeated mode has no fixed nodal lines
    const auto column = placed.wanted.columns[static_cast<std::size_t>(first)];
    picture.nodal_lines.push_back(
        {fmt::format("mode {} ({:.2f} Hz)", column + 1, solution.modes.frequency_hz(column)),
         sites.shapes.col(column)});
  }
  const auto& shown = placed.pairs.empty() ? placed.best : placed.pairs;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // The best one, and those equally good by symmetry.
    if (placed.pairs.empty() && shown[i].score < 0.99 * shown[0].score) break;
    picture.best.push_back(
        {shown[i].position, value_text(*placed.criterion, shown[i].score) + ", mode " +
                                std::to_string(column_of(placed, shown[i].limiting) + 1)});
  }
  picture.markers = stage::markers_of(study, solution.model);
  picture.markers.resize(study.sensors.size() + study.actuators.size());
  return picture;
}

io::LayoutsPicture layouts_picture(const study::Study& study, const steps::Placed& placed) {
  io::LayoutsPicture picture;
  picture.title = study.title + ": layouts";
  picture.scale = "expected error of an interpolated shape, of its root mean square";
  picture.points = placed.surface.sites.position;
  picture.triangles = placed.surface.triangles;
  double largest = 0.0;
  for (const auto& layout : placed.layouts) {
    if (layout.deviation.size() > 0) largest = std::max(largest, layout.deviation.maxCoeff());
  }
  picture.lightest = "0";
  picture.darkest = fmt::format("{:.2g} %", 100.0 * largest);
  for (const auto& layout : placed.layouts) {
    if (layout.deviation.size() == 0) continue;
    const Eigen::VectorXd& off = layout.deviation;
    const double mean =
        std::sqrt(off.cwiseAbs2().dot(placed.surface.sites.area) / placed.surface.sites.area.sum());
    picture.panels.push_back(
        {layout.name,
         fmt::format("mean {:.2g} %, worst {:.2g} %", 100.0 * mean, 100.0 * off.maxCoeff()),
         (1.0 - (off / largest).array().sqrt()).matrix(), layout.markers});
  }
  return picture;
}

void leave_fields(const stage::Solution& solution, const steps::Placed& placed,
                  const std::string& title, const Run& run) {
  std::vector<io::NodeField> fields;
  const auto criteria = placement::criteria();
  io::Units units{title, {"length: m"}};
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    fields.push_back({std::string(criteria[c]->name), placed.maps[c].score});
    units.lines.push_back(std::string(criteria[c]->name) +
                          (criteria[c]->unit == "1" ? ": 1" : ": 1/standard deviation"));
  }
  Eigen::VectorXd limiting(placed.surface.sites.count());
  for (Eigen::Index i = 0; i < limiting.size(); ++i) {
    const auto column = column_of(placed, placed.maps[placed.chosen].limiting(i));
    limiting(i) = static_cast<double>(column - solution.modes.rigid_count + 1);
  }
  fields.push_back({"limiting_mode", limiting});
  fields.push_back({"admissible", (placed.forbidden.array() < 0).cast<double>()});
  io::write_surface_vtu(run / "heat_map.vtu", placed.surface.sites.position,
                        placed.surface.triangles, fields, units);
}

}  // namespace

std::string optimum_text(const steps::Optimum& optimum) {
  std::string text = fmt::format("best {} sites by {}: score {:.6g}", optimum.sites.rows(),
                                 optimum.by, optimum.choice.score);
  if (optimum.choice.proven) {
    text += ", proven to be the best";
  } else if (optimum.certificate > 0.0) {
    text +=
        fmt::format(", at least {:.2f} % of the best there can be", 100.0 * optimum.certificate);
  }
  if (!optimum.remark.empty()) text += " (" + optimum.remark + ")";
  if (!optimum.equivalent.empty()) {
    text += fmt::format("; {} mirrored or turned layouts are as good", optimum.equivalent.size());
  }
  return text;
}

std::string blind_text(const stage::Solution& solution, const steps::ScoredLayout& layout) {
  std::string modes;
  for (const int mode : layout.blind) {
    modes += fmt::format("{}{} ({:.2f} Hz)", modes.empty() ? "" : ", ", mode,
                         solution.modes.frequency_hz(mode - 1));
  }
  return fmt::format("layout \"{}\" cannot see mode{} {}", layout.name,
                     layout.blind.size() == 1 ? "" : "s", modes);
}

io::JsonObject placement_json(const study::Study&, const stage::Solution& solution,
                              const steps::Placed& placed) {
  io::JsonArray layouts;
  for (const auto& layout : placed.layouts) layouts.push_back(layout_json(placed, layout));
  io::JsonArray optima;
  for (const auto& optimum : placed.optima) optima.push_back(optimum_json(optimum));
  io::JsonArray rules;
  for (std::size_t r = 0; r < placed.rules.size(); ++r) {
    const auto took = (placed.forbidden.array() == static_cast<int>(r)).count();
    rules.push_back(
        io::JsonObject{{"rule", placed.rules[r].name}, {"took", static_cast<long long>(took)}});
  }
  return {{"criterion", std::string(placed.criterion->name)},
          {"unit", std::string(placed.criterion->unit)},
          {"modes", wanted_json(solution, placed.wanted)},
          {"best", pairs_json(solution, placed, placed.best)},
          {"pairs", pairs_json(solution, placed, placed.pairs)},
          {"layouts", layouts},
          {"optimum", optimum_json(placed.optima.front())},
          {"optima", optima},
          {"rules", rules},
          {"points", static_cast<long long>(placed.surface.sites.count())},
          {"notes", io::Json::texts(placed.notes)}};
}

std::string placement_table(const stage::Solution& solution, const steps::Placed& placed) {
  std::string text =
      fmt::format(
          "best places of one collocated pair by {}\n{:>4}  {:>9} {:>9} {:>9}  {:>10}  {}\n",
          placed.criterion->name, "", "x [mm]", "y [mm]", "z [mm]", "value", "limited by mode") +
      pairs_table(solution, placed, placed.best);
  if (!placed.pairs.empty()) {
    text += "pairs chosen together\n" + pairs_table(solution, placed, placed.pairs);
  }
  if (!placed.layouts.empty()) text += layouts_table(placed);
  text += "\n";
  for (const auto& optimum : placed.optima) text += optimum_text(optimum) + "\n";
  for (const auto& layout : placed.layouts) {
    if (!layout.blind.empty()) text += "note: " + blind_text(solution, layout) + "\n";
  }
  return text;
}

void leave_placement(const study::Study& study, const stage::Solution& solution,
                     const steps::Placed& placed, Run& run, bool main_result) {
  for (const auto& note : placed.notes) run.note(note);
  for (const auto& layout : placed.layouts) {
    for (const int mode : layout.blind) {
      const auto& columns = placed.wanted.columns;
      if (std::find(columns.begin(), columns.end(), mode - 1) == columns.end()) continue;
      run.warn(blind_text(solution, layout) + "; placement.modes asks for it");
      break;
    }
  }
  run.leave("placement.json", placement_json(study, solution, placed), main_result);
  leave_fields(solution, placed, study.title, run);
  if (!run.options().pictures) return;
  tell(run.progress(), "painting the heat map");
  run.paint("heat_map.png",
            [&](const auto& png) { io::draw_heat_map(png, picture_of(study, solution, placed)); });
  const auto layouts = layouts_picture(study, placed);
  if (layouts.panels.empty()) return;
  run.paint("layouts.png", [&](const auto& png) { io::draw_layouts(png, layouts); });
}

}  // namespace chladni::show
