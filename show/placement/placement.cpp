// Placement as a table and JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "show/placement.h"
#include "show/placement/placement_words.h"
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

io::Json worst_place_json(const steps::BestPlaces& places, const steps::ScoredLayout& layout) {
  if (layout.deviation.size() == 0) return {};
  Eigen::Index worst = 0;
  layout.deviation.maxCoeff(&worst);
  return place_json(places.surface.sites.position.row(worst).transpose());
}

io::Json layout_json(const steps::BestPlaces& places, const steps::ScoredLayout& layout) {
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
                        {"worst_place", worst_place_json(places, layout)},
                        {"scores", scores}};
}

std::string_view name_of(placement::DeviceKind kind) {
  switch (kind) {
    case placement::DeviceKind::sensor:
      return "sensor";
    case placement::DeviceKind::actuator:
      return "actuator";
    case placement::DeviceKind::pair:
      return "pair";
  }
  return "";
}

// Per site; sensors where the criterion chooses nothing else.
io::Json devices_json(const placement::Optimum& optimum) {
  std::vector<std::string> names(static_cast<std::size_t>(optimum.sites.rows()), "sensor");
  for (std::size_t i = 0; i < optimum.kinds.size(); ++i) names[i] = name_of(optimum.kinds[i]);
  return io::Json::texts(names);
}

// Root mean squares over the region.
io::Json observer_json(const std::optional<placement::ObserverValue>& value) {
  if (!value) return {};
  return io::JsonObject{{"estimate_m", std::sqrt(value->estimate)},
                        {"prediction_m", std::sqrt(value->prediction)},
                        {"without_m", std::sqrt(value->without)},
                        {"loop_m", std::sqrt(value->loop)},
                        {"loop_motion_m", std::sqrt(value->loop_motion)},
                        {"loop_force_n", std::sqrt(value->loop_force_n2)}};
}

io::Json optimum_json(const placement::Optimum& optimum) {
  const bool has_bound = optimum.certificate > 0.0;
  const auto& choice = optimum.choice;
  io::JsonArray equivalent;
  for (const auto& sites : optimum.equivalent) equivalent.push_back(places_json(sites));
  return io::JsonObject{{"criterion", optimum.by},
                        {"sites", places_json(optimum.sites)},
                        {"devices", devices_json(optimum)},
                        {"observer", observer_json(optimum.observer)},
                        {"score", choice.score},
                        {"bound", has_bound ? io::Json(choice.bound) : io::Json()},
                        {"gap", has_bound ? io::Json(choice.bound - choice.score) : io::Json()},
                        {"efficiency", has_bound ? io::Json(optimum.certificate) : io::Json()},
                        {"proven", choice.proven},
                        {"remark", optimum.remark},
                        {"equivalent", equivalent}};
}

io::Json wanted_json(const stage::Solution& solution, const placement::WantedModes& wanted) {
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

// True if a layout was chosen by this criterion; also where none was chosen.
bool was_chosen_by(const placement::LayoutCriterion& criterion, const steps::BestPlaces& places) {
  const auto& optima = places.optima;
  return optima.empty() || std::ranges::any_of(optima, [&](const placement::Optimum& optimum) {
           return optimum.by == criterion.name;
         });
}

std::string layouts_table(const steps::BestPlaces& places, bool all) {
  const auto width = [](const steps::ScoredLayout& layout) {
    return std::clamp<std::size_t>(layout.name.size(), 10, 30);
  };
  std::string text = fmt::format("\n{:<29}", "layout");
  for (const auto& layout : places.layouts) {
    text += fmt::format("  {:>{}.30}", layout.name, width(layout));
  }
  text += "\n";
  const auto criteria = placement::layout_criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    if (!all && !was_chosen_by(*criteria[c], places)) continue;
    const std::string unit =
        criteria[c]->unit == "1" ? "" : fmt::format(" [{}]", criteria[c]->unit);
    text += fmt::format("{:<29}", std::string(criteria[c]->name) + unit);
    for (const auto& layout : places.layouts) {
      const double value = layout.scores(static_cast<Eigen::Index>(c));
      text += fmt::format("  {:>{}}", std::isfinite(value) ? fmt::format("{:.4g}", value) : "-",
                          width(layout));
    }
    text += criteria[c]->larger_is_better ? "  more is better\n" : "  less is better\n";
  }
  return text;
}

// "2 pairs, 1 sensor"
std::string counted(const std::vector<placement::DeviceKind>& kinds) {
  using enum placement::DeviceKind;
  std::string text;
  for (const auto kind : {pair, actuator, sensor}) {
    const auto count = std::ranges::count(kinds, kind);
    if (count == 0) continue;
    text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, name_of(kind),
                        count == 1 ? "" : "s");
  }
  return text;
}

std::string observer_text(const placement::Optimum& optimum) {
  const auto& value = *optimum.observer;
  const auto nm = [](double square) { return fmt::format("{:.4g} nm", 1e9 * std::sqrt(square)); };
  std::string text = fmt::format("best {} by {}: ", counted(optimum.kinds), optimum.by);
  if (optimum.by == "loop_cost") {
    text += fmt::format("in the loop the region moves {} rms with {:.3g} N rms of force; ",
                        nm(value.loop_motion), std::sqrt(value.loop_force_n2));
  }
  return text + fmt::format("its motion is known to {} rms, of {} without sensors and loop",
                            nm(value.estimate), nm(value.without));
}

}  // namespace

Eigen::Index column_of(const steps::BestPlaces& places, int group) {
  return places.wanted.columns[static_cast<std::size_t>(
      places.wanted.groups[static_cast<std::size_t>(group)].first)];
}

std::string value_text(const placement::Criterion& criterion, double score) {
  const double value = criterion.for_people(score);
  return criterion.unit == "1" ? fmt::format("{:.3f}", value)
                               : fmt::format("{:.3g} {}", value, criterion.unit);
}

io::ResultTable pairs_table(const stage::Solution& solution, const steps::BestPlaces& places,
                            const std::vector<placement::BestPair>& pairs) {
  const auto& modes = solution.modes;
  const auto count = std::ssize(pairs);
  Points at(count, 3);
  Eigen::VectorXd score(count), value(count), frequency_hz(count);
  std::vector<std::string> rank, shown, limit;
  std::vector<io::Json> mode;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& pair = pairs[static_cast<std::size_t>(i)];
    const auto column = column_of(places, pair.limiting);
    at.row(i) = pair.position.transpose();
    score(i) = pair.score;
    value(i) = places.criterion->for_people(pair.score);
    frequency_hz(i) = modes.frequency_hz(column);
    rank.push_back(fmt::to_string(i + 1));
    shown.push_back(value_text(*places.criterion, pair.score));
    limit.push_back(
        placement::group_name(modes.frequency_hz, modes.rigid_count, places.wanted, pair.limiting));
    mode.emplace_back(static_cast<long long>(column - modes.rigid_count + 1));
  }
  io::ResultTable table{"Best places of one collocated pair", {}};
  auto& columns = table.columns;
  columns.push_back(io::word_column("", rank, 4));
  columns.back().gap = 0;
  columns.back().is_number = true;
  for (const int axis : {0, 1, 2}) {
    const std::string name(1, "xyz"[axis]);
    columns.push_back(io::number_column(name, "mm", at.col(axis), {"{:.2f}", 1e3}, 9, name + "_m"));
    columns.back().gap = axis == 0 ? 2 : 1;
  }
  columns.push_back(io::json_column("score", score));
  columns.push_back(io::word_column("value", shown, 10));
  columns.back().is_number = true;
  columns.push_back(io::json_column("value", value));
  columns.push_back(io::word_column("limited by mode", limit));
  columns.push_back(io::json_column("limiting_mode", mode));
  columns.push_back(io::json_column("limiting_frequency_hz", frequency_hz));
  return table;
}

std::string optimum_text(const placement::Optimum& optimum) {
  std::string text = optimum.observer
                         ? observer_text(optimum)
                         : fmt::format("best {} sites by {}: score {:.6g}", optimum.sites.rows(),
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
                              const steps::BestPlaces& places) {
  io::JsonArray layouts;
  for (const auto& layout : places.layouts) layouts.push_back(layout_json(places, layout));
  io::JsonArray optima;
  for (const auto& optimum : places.optima) optima.push_back(optimum_json(optimum));
  io::JsonArray rules;
  for (std::size_t r = 0; r < places.rules.size(); ++r) {
    const auto took = (places.forbidden.array() == static_cast<int>(r)).count();
    rules.push_back(
        io::JsonObject{{"rule", places.rules[r].name}, {"took", static_cast<long long>(took)}});
  }
  return {{"criterion", std::string(places.criterion->name)},
          {"unit", std::string(places.criterion->unit)},
          {"modes", wanted_json(solution, places.wanted)},
          {"best", io::json_rows(pairs_table(solution, places, places.best))},
          {"pairs", io::json_rows(pairs_table(solution, places, places.pairs))},
          {"layouts", layouts},
          {"optimum", optimum_json(places.optima.front())},
          {"optima", optima},
          {"rules", rules},
          {"points", static_cast<long long>(places.surface.sites.count())},
          {"notes", io::Json::texts(places.notes)}};
}

std::string placement_table(const stage::Solution& solution, const steps::BestPlaces& places,
                            bool all) {
  std::string text =
      fmt::format("best places of one collocated pair by {}\n{}", places.criterion->name,
                  io::text(pairs_table(solution, places, places.best)));
  if (!places.pairs.empty()) {
    text += "pairs chosen together\n" + io::rows_text(pairs_table(solution, places, places.pairs));
  }
  if (!places.layouts.empty()) text += layouts_table(places, all);
  text += "\n";
  for (const auto& optimum : places.optima) text += optimum_text(optimum) + "\n";
  for (const auto& layout : places.layouts) {
    if (!layout.blind.empty()) text += "note: " + blind_text(solution, layout) + "\n";
  }
  if (!all && !places.layouts.empty() && !places.optima.empty()) {
    text += fmt::format("more with --all and in placement.json: layouts by {} criteria\n",
                        placement::layout_criteria().size());
  }
  return text;
}

}  // namespace chladni::show
