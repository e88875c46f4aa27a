// [placement] of a study: allowed places of devices, and the aim.
#include <algorithm>

#include "placement/criteria.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

/// modes = 3, modes = [1, 4], or up_to = "500 Hz" (also written modes = { up_to = ... }).
void read_wanted_modes(TableReader& table, PlacementPlan& plan) {
  const TomlNode* node = table.find("modes");
  plan.up_to_hz = table.quantity("up_to", "Hz", Sign::positive).value_or(0.0);
  if (node == nullptr) return;
  plan.modes_line = node->line;
  plan.modes_column = node->column;
  if (table.has("up_to")) {
    table.wrong(*node, table.path() + " has modes and up_to; expected one of them");
  } else if (node->kind == TomlNode::Kind::table) {
    auto inner = table.table("modes");
    plan.up_to_hz = inner->required_quantity("up_to", "Hz", Sign::positive);
    inner->refuse_unknown();
  } else if (node->kind == TomlNode::Kind::array) {
    for (const auto& element : node->elements) {
      const bool good = element.kind == TomlNode::Kind::integer && element.number >= 1.0 &&
                        element.number <= kMostModes;
      if (good) {
        plan.modes.push_back(static_cast<int>(element.number));
      } else {
        table.wrong(element, table.name("modes") + " holds " + description(element) +
                                 "; expected numbers of flexible modes, counted from 1");
      }
    }
  } else if (const auto count = table.integer("modes", 1, kMostModes)) {
    for (int i = 1; i <= *count; ++i) plan.modes.push_back(i);
  }
}

Eigen::Vector2d corner(TableReader& table, std::string_view key) {
  if (!table.has(key)) table.missing(key, "two lengths such as [\"10 mm\", \"20 mm\"]");
  return table.quantities(key, "m", 2).value_or(Eigen::Vector2d::Zero());
}

KeepOut keep_out_of(TableReader& table) {
  KeepOut zone;
  if (auto box = table.table("box")) {
    zone.shape = "box";
    zone.from = corner(*box, "from");
    zone.to = corner(*box, "to");
    box->refuse_unknown();
  } else if (auto disc = table.table("disc")) {
    zone.shape = "disc";
    zone.from = corner(*disc, "at");
    zone.diameter = disc->required_quantity("diameter", "m", Sign::positive);
    disc->refuse_unknown();
  } else if (const auto patch = table.text("patch")) {
    zone.shape = "patch";
    zone.patch = *patch;
    zone.line = table.find("patch")->line;
    zone.column = table.find("patch")->column;
  } else {
    table.missing("box", "box = { from, to }, disc = { at, diameter } or patch = \"name\"");
  }
  table.refuse_unknown();
  return zone;
}

void read_keep_out(TableReader& placement, PlacementPlan& plan) {
  const TomlNode* node = placement.find("keep_out");
  if (node == nullptr) return;
  if (node->kind != TomlNode::Kind::array) {
    placement.wrong(*node, "placement.keep_out is " + description(*node) +
                               "; expected an array of boxes, discs and names of patches");
    return;
  }
  const bool names_only =
      std::all_of(node->elements.begin(), node->elements.end(),
                  [](const TomlNode& element) { return element.kind == TomlNode::Kind::text; });
  if (names_only) {
    for (const auto& element : node->elements) {
      plan.keep_out.push_back({.shape = "patch",
                               .patch = element.text,
                               .line = element.line,
                               .column = element.column});
    }
    return;
  }
  for (auto& table : placement.tables("keep_out")) plan.keep_out.push_back(keep_out_of(table));
}

void read_grid(TableReader& placement, PlacementPlan& plan) {
  auto table = placement.table("grid");
  if (!table) return;
  GridPlan grid;
  const auto one = table->find("pitch");
  if (one != nullptr && one->kind == TomlNode::Kind::text) {
    grid.pitch.setConstant(table->required_quantity("pitch", "m", Sign::positive));
  } else if (one == nullptr) {
    table->missing("pitch", "a length such as \"60 mm\", or two");
  } else {
    grid.pitch = table->quantities("pitch", "m", 2, Sign::positive).value_or(Eigen::Vector2d(1, 1));
  }
  grid.columns = static_cast<int>(table->integer("columns", 1, 1000).value_or(0));
  grid.rows = static_cast<int>(table->integer("rows", 1, 1000).value_or(0));
  if (!table->has("columns")) table->missing("columns", "places along x, such as 9");
  if (!table->has("rows")) table->missing("rows", "places along y, such as 9");
  grid.centre = table->quantities("centre", "m", 2).value_or(Eigen::Vector2d::Zero());
  table->refuse_unknown();
  plan.grid = grid;
}

double ratio(TableReader& table, std::string_view key, double otherwise) {
  return table.quantity(key, "1", Sign::not_negative).value_or(otherwise);
}

void read_uncertainty(TableReader& placement, PlacementPlan& plan) {
  auto table = placement.table("uncertainty");
  if (!table) return;
  UncertaintyPlan uncertainty;
  uncertainty.modulus = ratio(*table, "modulus", 0.0);
  uncertainty.density = ratio(*table, "density", 0.0);
  uncertainty.thickness = ratio(*table, "thickness", 0.0);
  uncertainty.attached_mass =
      table->quantity("attached_mass", "kg", Sign::not_negative).value_or(0.0);
  uncertainty.members = static_cast<int>(table->integer("members", 2, 1000).value_or(32));
  uncertainty.worst = table->choice("take", {"worst", "mean"}).value_or("worst") == "worst";
  for (const auto* key : {"modulus", "density", "thickness"}) {
    if (ratio(*table, key, 0.0) < 0.5) continue;
    table->wrong(*table->find(key), table->name(key) +
                                        " is 50 % or more; expected a small relative deviation "
                                        "such as \"5 %\"");
  }
  table->refuse_unknown();
  plan.uncertainty = uncertainty;
}

void read_noise(TableReader& table, PlacementPlan& plan) {
  plan.noise = table.quantity("noise", "1", Sign::positive).value_or(0.01);
  plan.frf_noise = table.quantity("frf_noise", "m/N", Sign::positive).value_or(0.0);
  plan.resolution_hz = table.quantity("frequency_resolution", "Hz", Sign::positive).value_or(0.0);
  plan.position_error = table.quantity("position_error", "m", Sign::not_negative).value_or(0.0);
  if (table.has("noise") && table.has("frf_noise")) {
    table.wrong(*table.find("frf_noise"),
                "placement has noise and frf_noise; expected one of them");
  }
  if (table.has("frf_noise") != table.has("frequency_resolution")) {
    table.missing(table.has("frf_noise") ? "frequency_resolution" : "frf_noise",
                  "frf_noise (\"1e-9 m/N\" per line) and frequency_resolution (\"0.5 Hz\") "
                  "together");
  }
}

void read_places(TableReader& table, const Study& study, PlacementPlan& plan) {
  read_motion(table, plan.direction, plan.along_normal);
  plan.on = read_faces(table, "on");
  read_keep_out(table, plan);
  plan.edge_distance = table.quantity("edge_distance", "m", Sign::not_negative).value_or(0.0);
  plan.footprint = table.quantity("footprint", "m", Sign::not_negative).value_or(0.0);
  plan.spacing = table.quantity("spacing", "m", Sign::not_negative).value_or(0.0);
  read_grid(table, plan);
  plan.there = table.texts("there");
  refuse_strangers(table, "there", "channel of the study", plan.there, channel_names(study));
  for (auto& point : table.tables("interest")) {
    plan.interest.push_back(read_place(point, "at"));
    point.refuse_unknown();
  }
}

void read_choice(TableReader& table, PlacementPlan& plan) {
  std::vector<std::string> names;
  for (const auto* criterion : placement::criteria()) names.emplace_back(criterion->name);
  plan.criterion = table.choice("criterion", names).value_or("weakest_mode");
  plan.pairs = static_cast<int>(table.integer("pairs", 1, 100).value_or(1));
  plan.frequency_tolerance = ratio(table, "frequency_tolerance", 0.01);
  auto choose = table.table("choose");
  if (!choose) return;
  plan.sites = static_cast<int>(choose->integer("sites", 1, 10000).value_or(0));
  plan.choose_by =
      choose->choice("by", {"determinant", "interpolation_error"}).value_or("determinant");
  choose->refuse_unknown();
}

}  // namespace

void read_placement(TableReader& root, Study& study) {
  auto table = root.table("placement");
  if (!table) return;
  auto& plan = study.placement.emplace();
  read_wanted_modes(*table, plan);
  read_places(*table, study, plan);
  read_choice(*table, plan);
  read_noise(*table, plan);
  read_uncertainty(*table, plan);
  table->refuse_unknown();
}

}  // namespace chladni::study
