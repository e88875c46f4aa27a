// [placement] of a study: allowed places of devices, and the aim.
#include <algorithm>

#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

/// modes = 3, modes = [1, 4], or up_to = "500 Hz" (also written modes = { up_to = ... }).
void read_wanted_modes(TableReader& table, PlacementPlan& plan) {
  const TomlNode* node = table.find("modes");
  if (const auto* stated = node != nullptr ? node : table.find("up_to")) {
    plan.modes_line = stated->line;
    plan.modes_column = stated->column;
  }
  if (node == nullptr) return;
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

// An array of boxes, discs and patches, or of names of patches.
void read_zones(TableReader& owner, const std::string& key, std::vector<KeepOut>& zones) {
  const TomlNode* node = owner.find(key);
  if (node == nullptr) return;
  if (node->kind != TomlNode::Kind::array) {
    owner.wrong(*node, owner.name(key) + " is " + description(*node) +
                           "; expected an array of boxes, discs and names of patches");
    return;
  }
  const bool names_only =
      std::all_of(node->elements.begin(), node->elements.end(),
                  [](const TomlNode& element) { return element.kind == TomlNode::Kind::text; });
  if (names_only) {
    for (const auto& element : node->elements) {
      zones.push_back({.shape = "patch",
                       .patch = element.text,
                       .line = element.line,
                       .column = element.column});
    }
    return;
  }
  for (auto& table : owner.tables(key)) zones.push_back(keep_out_of(table));
}

void read_grid(TableReader& placement, PlacementPlan& plan) {
  auto table = placement.table("grid");
  if (!table) return;
  grid_schema().read(*table, plan.grid.emplace());
  if (!table->has("columns")) table->missing("columns", "places along x, such as 9");
  if (!table->has("rows")) table->missing("rows", "places along y, such as 9");
  table->refuse_unknown();
}

void read_uncertainty(TableReader& placement, PlacementPlan& plan) {
  auto table = placement.table("uncertainty");
  if (!table) return;
  auto& uncertainty = plan.uncertainty.emplace();
  uncertainty_schema().read(*table, uncertainty);
  for (const auto& [key, value] :
       {std::pair("modulus", uncertainty.modulus), std::pair("density", uncertainty.density),
        std::pair("thickness", uncertainty.thickness)}) {
    if (value < 0.5) continue;
    table->wrong(*table->find(key), table->name(key) +
                                        " is 50 % or more; expected a small relative deviation "
                                        "such as \"5 %\"");
  }
  table->refuse_unknown();
}

void read_observer_layout(TableReader& placement, PlacementPlan& plan) {
  auto table = placement.table("observer");
  if (!table) {
    if (plan.choose_by == "observer") plan.observer.emplace();
    return;
  }
  auto& layout = plan.observer.emplace();
  layout.line = placement.find("observer")->line;
  observer_layout_schema().read(*table, layout);
  read_zones(*table, "region", layout.region);
  if (table->has("region") && layout.region.empty()) {
    table->wrong(
        *table->find("region"),
        table->name("region") +
            " is empty; expected boxes, discs or names of patches where the motion is to be "
            "known");
  }
  if (layout.actuators + layout.pairs > 0 && !table->has("effort")) {
    table->missing("effort",
                   "\"10 nm/N\": the motion that a force of 1 N is worth; actuators and pairs are "
                   "chosen for a loop");
  }
  table->refuse_unknown();
}

void check_noise(TableReader& table) {
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

void read_there(TableReader& table, const Study& study, PlacementPlan& plan) {
  plan.there = table.texts("there");
  refuse_strangers(table, "there", "channel of the study", plan.there, channel_names(study));
}

void read_interest(TableReader& table, PlacementPlan& plan) {
  for (auto& point : table.tables("interest")) {
    plan.interest.push_back(read_place(point, "at"));
    point.refuse_unknown();
  }
}

void read_choice(TableReader& table, PlacementPlan& plan) {
  auto choose = table.table("choose");
  if (!choose) return;
  choose_schema().read(*choose, plan);
  choose->refuse_unknown();
}

}  // namespace

void read_placement(TableReader& root, Study& study) {
  auto table = root.table("placement");
  if (!table) return;
  auto& plan = study.placement.emplace();
  placement_schema().read(*table, plan);
  read_wanted_modes(*table, plan);
  read_zones(*table, "keep_out", plan.keep_out);
  read_grid(*table, plan);
  read_there(*table, study, plan);
  read_interest(*table, plan);
  read_choice(*table, plan);
  read_observer_layout(*table, plan);
  check_noise(*table);
  read_uncertainty(*table, plan);
  table->refuse_unknown();
}

}  // namespace chladni::study
