// The keys of [placement] and of its tables.
#include "placement/criteria.h"
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

io::Json modes_json(const PlacementPlan& plan) {
  io::JsonArray modes;
  for (const int mode : plan.modes) modes.emplace_back(mode);
  return modes;
}

io::Json zones_json(const std::vector<KeepOut>& all) {
  io::JsonArray zones;
  for (const auto& zone : all) {
    zones.push_back(io::JsonObject{{"shape", zone.shape},
                                   {"from_m", io::Json(zone.from)},
                                   {"to_m", io::Json(zone.to)},
                                   {"diameter_m", zone.diameter},
                                   {"patch", zone.patch}});
  }
  return zones;
}

io::Json interest_json(const PlacementPlan& plan) {
  io::JsonArray places;
  for (const auto& place : plan.interest) places.push_back(place_json(place));
  return places;
}

/// A table of its own that may be missing; study.json then has nothing of it.
template <typename Part>
Key<PlacementPlan> part(const std::string& name, std::optional<Part> PlacementPlan::*value,
                        const Schema<Part>& schema, const std::string& meaning,
                        const std::string& otherwise) {
  return special<PlacementPlan>(
      {name, "a table", otherwise, meaning}, name,
      [value, &schema](const PlacementPlan& plan) -> std::optional<io::Json> {
        if (!(plan.*value)) return std::nullopt;
        return schema.json(*(plan.*value));
      });
}

void read_pitch(TableReader& table, GridPlan& grid) {
  const auto* one = table.find("pitch");
  if (one != nullptr && one->kind == TomlNode::Kind::text) {
    grid.pitch.setConstant(table.required_quantity("pitch", "m", Sign::positive));
  } else if (one == nullptr) {
    table.missing("pitch", "a length such as \"60 mm\", or two");
  } else {
    grid.pitch = table.quantities("pitch", "m", 2, Sign::positive).value_or(Eigen::Vector2d(1, 1));
  }
}

}  // namespace

const Schema<GridPlan>& grid_schema() {
  using P = GridPlan;
  static const Schema<P> schema = {
      "placement.grid",
      {{.text = {"pitch", "one or two quantities in m, positive", "needed",
                 "between places, along x and y"},
        .json_name = "pitch_m",
        .read = read_pitch,
        .json = [](const P& plan) { return io::Json(plan.pitch); }},
       {.text = {"centre", "two quantities in m", "[0, 0]", "of the grid, seen from above"},
        .json_name = "centre_m",
        .read =
            [](TableReader& table, P& plan) {
              if (const auto centre = table.quantities("centre", "m", 2)) plan.centre = *centre;
            },
        .json = [](const P& plan) { return io::Json(plan.centre); }},
       whole("columns", 1, 1000, &P::columns, "places along x", "needed"),
       whole("rows", 1, 1000, &P::rows, "places along y", "needed")}};
  return schema;
}

const Schema<UncertaintyPlan>& uncertainty_schema() {
  using P = UncertaintyPlan;
  static const Schema<P> schema = {
      "placement.uncertainty",
      {quantity("modulus", "1", Sign::not_negative, &P::modulus,
                "relative, smooth over the body, below 0.5"),
       quantity("density", "1", Sign::not_negative, &P::density, "the same of the density"),
       quantity("thickness", "1", Sign::not_negative, &P::thickness, "the same of the thickness"),
       quantity("attached_mass", "kg", Sign::not_negative, &P::attached_mass,
                "of each of four masses anywhere"),
       whole("members", 2, 1000, &P::members, "bodies of the ensemble"),
       either("take", {"worst", "mean"}, "worst", &P::worst, "what of the ensemble counts")}};
  return schema;
}

const Schema<PlacementPlan>& choose_schema() {
  using P = PlacementPlan;
  static const Schema<P> schema = {
      "placement.choose",
      {whole("sites", 1, 10000, &P::sites, "to choose", "as many as the study's channels have"),
       choice("by", {"determinant", "interpolation_error", "observer"}, &P::choose_by,
              "what makes one best")}};
  return schema;
}

const Schema<ObserverLayoutPlan>& observer_layout_schema() {
  using P = ObserverLayoutPlan;
  constexpr int kMost = 1000;
  static const Schema<P> schema = {
      "placement.observer",
      {special<P>({"region", "names of patches, or tables with box, disc or patch",
                   "the points of observer, else all faces of placement.on",
                   "where the motion is to be known"},
                  "region", [](const P& plan) { return zones_json(plan.region); }),
       whole("sensors", 0, kMost, &P::sensors, "to choose",
             "placement.choose.sites without actuators and pairs, else 0"),
       whole("actuators", 0, kMost, &P::actuators, "to choose"),
       whole("pairs", 0, kMost, &P::pairs, "collocated, to choose"),
       quantity("effort", "m/N", Sign::positive, &P::effort,
                "motion that a force of 1 N of one actuator is worth in the loop",
                "no loop; needed for actuators and pairs"),
       quantity("suspension", "Hz", Sign::positive, &P::suspension_hz,
                "frequency at which rigid-body modes without stiffness are held")}};
  return schema;
}

const Schema<PlacementPlan>& placement_schema() {
  using P = PlacementPlan;
  static const Schema<P> schema = {
      "placement",
      {special<P>({"modes", "a number, numbers counted from 1, or { up_to }", "3",
                   "flexible modes that are to be seen and moved"},
                  "modes", modes_json),
       quantity("up_to", "Hz", Sign::positive, &P::up_to_hz,
                "all flexible modes below this, instead of modes", "none"),
       choice("criterion", names_in(placement::criteria()), &P::criterion, "of the heat map"),
       motion<P>("of the pair"),
       faces<P>("where devices may be"),
       special<P>({"keep_out", "names of patches, or tables with box, disc or patch", "none",
                   "where no device may be"},
                  "keep_out", [](const P& plan) { return zones_json(plan.keep_out); }),
       quantity("edge_distance", "m", Sign::not_negative, &P::edge_distance,
                "from the edges of those faces"),
       quantity("footprint", "m", Sign::not_negative, &P::footprint,
                "diameter over which a device averages"),
       quantity("spacing", "m", Sign::not_negative, &P::spacing, "between two devices"),
       special<P>({"there", "channels of the study", "none", "channels that keep their places"},
                  "there", [](const P& plan) { return io::Json::texts(plan.there); }),
       whole("pairs", 1, 100, &P::pairs, "to choose together"),
       quantity("noise", "1", Sign::positive, &P::noise,
                "of an identified shape's entry, over the shape's root mean square"),
       quantity("frf_noise", "m/N", Sign::positive, &P::frf_noise,
                "of each line of an FRF, instead of noise; beside frequency_resolution", "none"),
       quantity("frequency_resolution", "Hz", Sign::positive, &P::resolution_hz,
                "between lines; beside frf_noise", "none"),
       quantity("position_error", "m", Sign::not_negative, &P::position_error,
                "standard deviation of a device's place along each axis"),
       quantity("frequency_tolerance", "1", Sign::not_negative, &P::frequency_tolerance,
                "relative: nearer neighbours are one group"),
       special<P>({"interest", "tables with at", "none", "points whose FRFs are to be predicted"},
                  "interest_m", interest_json),
       special<P>({"choose", "a table", "as an empty one", "sites that are chosen by themselves"},
                  "choose", [](const P& plan) { return choose_schema().json(plan); }),
       part("grid", &P::grid, grid_schema(), "the only places of devices", "anywhere"),
       part("observer", &P::observer, observer_layout_schema(),
            "a layout for the observer of [observer]", "none"),
       part("uncertainty", &P::uncertainty, uncertainty_schema(),
            "standard deviations of what is not known of the body", "none")}};
  return schema;
}

}  // namespace chladni::study
