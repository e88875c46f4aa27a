// Every key of these tables stands here once.
#include "study/schemas.h"

#include <fmt/ranges.h>

#include "study/device_arrays.h"
#include "study/schemas/known.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

io::Json pairs_json(const IdentificationPlan& plan) {
  io::JsonArray pairs;
  for (const auto& [sensor, actuator] : plan.pairs) {
    pairs.push_back(io::JsonObject{{"sensor", sensor}, {"actuator", actuator}});
  }
  return pairs;
}

Key<diagnosis::Tolerances> tolerance(const std::string& name, const std::string& unit,
                                     double diagnosis::Tolerances::*value,
                                     const std::string& meaning) {
  return quantity(name, unit, Sign::not_negative, value, meaning);
}

/// @param of  which tables of that name: "of kind `mass`"; or empty
template <typename Plan>
TableText text_of(const Schema<Plan>& schema, const std::string& of = "") {
  TableText text{fmt::format("`[{}]`{}{}", schema.table, of.empty() ? "" : " ", of), {}};
  if (schema.table.empty()) text.heading = "Above all tables";
  for (const auto& key : schema.keys) text.keys.push_back(key.text);
  return text;
}

}  // namespace

const Schema<Study>& top_schema() {
  using P = Study;
  static const Schema<P> schema = {
      "",
      {{.text = {"title", "a text", "the study's name", "for reports"},
        .json_name = "title",
        .read = [](TableReader& table,
                   P& study) { study.title = table.text("title").value_or(study.name); },
        .json = not_shown<P>},
       special<P>({"extends", "the file of a study", "none",
                   "a study whose tables this one takes over and changes"},
                  "extends", not_shown<P>),
       {.text = {"seed", "0 to 4294967295", "1", "of everything random; `--seed` overrules it"},
        .json_name = "seed",
        .read =
            [](TableReader& table, P& study) {
              const auto seed = table.integer("seed", 0, 4294967295);
              if (seed) study.seed = static_cast<unsigned>(*seed);
            },
        .json = not_shown<P>}}};
  return schema;
}

const Schema<MeshPlan>& mesh_schema() {
  using P = MeshPlan;
  static const Schema<P> schema = {
      "mesh",
      {quantity("edge_length", "m", Sign::positive, &P::edge_length, "of the tetrahedra",
                "from the geometry"),
       whole("order", 1, 3, &P::order, "of the elements",
             "3, or 2 where cubic elements would be too many; that of a file of tetrahedra"),
       whole("layers", 1, 100, &P::layers, "cells through the thickness of a layered mesh",
             "chosen"),
       whole("across_ribs", 1, 20, &P::across_ribs, "cells through a rib of a layered table",
             "chosen"),
       choice("mesher", {"layered", "tetgen"}, &P::mesher, "how the body is filled", "chosen"),
       truth("remesh", &P::remesh, "even triangles on a file's surface before TetGen"),
       either("repair", {"safe", "fill"}, "fill", &P::fill_holes,
              "of a file's surface; \"fill\" closes holes")}};
  return schema;
}

const Schema<ModesPlan>& modes_schema() {
  using P = ModesPlan;
  static const Schema<P> schema = {
      "modes",
      {whole("count", 1, kMostModes, &P::count, "flexible modes"),
       quantity("up_to", "Hz", Sign::positive, &P::up_to_hz,
                "all modes below this, instead of count", "none"),
       quantity("damping_ratio", "1", Sign::not_negative, &P::damping_ratio,
                "of every flexible mode, below 1"),
       text("engine", &P::engine,
            "\"mpiexec -n 4\": ranks of MPI find the modes; `--engine` overrules it",
            "this process"),
       names<P>(
           {"mirrors", "a list of \"x\", \"y\", \"z\"", "none",
            "axes across which the body is its own mirror image: its modes are found in two "
            "parts for each, in less memory"},
           "axis",
           [] {
             return std::vector<std::string>{"x", "y", "z"};
           },
           &P::mirrors),
       shape_dataset<P>("modes.unv, a universal file of the surface")}};
  return schema;
}

const Schema<ExperimentPlan>& experiment_schema() {
  using P = ExperimentPlan;
  const std::string sensors_unit = "a quantity in the sensors' unit, not negative";
  static const Schema<P> schema = {
      "experiment",
      {choice("structure", {"study", "rigid_chain", "rigid_chain_with_carried_body"}, &P::structure,
              "what is tested: the study's model, or the thesis' chain of rigid bodies"),
       quantity("sample_rate", "Hz", Sign::positive, &P::sample_rate_hz, "of the loop"),
       whole("samples", 8, kLongestPeriod, &P::samples, "of a period"),
       whole("periods", 1, 10000, &P::periods, "recorded in each experiment"),
       whole("realisations", 1, 10000, &P::realisations, "of the random phases"),
       whole("warm_up", 0, 10000, &P::warm_up, "periods before those recorded"),
       quantity("amplitude", "N", Sign::positive, &P::amplitude, "rms of each force"),
       special<P>({"band", "two quantities in Hz, ascending",
                   "the first line to an eighth of the rate", "excited lines"},
                  "band_hz",
                  [](const P& plan) {
                    return io::JsonArray{plan.low_hz, plan.high_hz};
                  }),
       choice("lines", {"all", "odd", "odd_with_detection"}, &P::lines,
              "that are excited; with detection one odd line of four is silent"),
       choice("inputs", {"one_at_a_time", "orthogonal"}, &P::inputs,
              "how the actuators take turns"),
       special<P>({"noise", sensors_unit, "0", "rms of each sensor"}, "noise",
                  [](const P& plan) { return io::Json(plan.noise); }),
       quantity("noise_ratio", "1", Sign::not_negative, &P::noise_ratio,
                "rms of each sensor over that of its response, instead of noise"),
       quantity("process_noise", "N", Sign::not_negative, &P::process_noise,
                "rms of a force on each actuator that nobody records"),
       special<P>({"quantisation", sensors_unit, "0", "step of each sensor"}, "quantisation",
                  [](const P& plan) { return io::Json(plan.quantisation); }),
       quantity("delay", "s", Sign::not_negative, &P::delay, "from command to force"),
       choice("compensate", {"all", "hold", "none"}, &P::compensate,
              "what the estimate is freed from: delay and hold, the hold, nothing"),
       special<P>({"cubic_spring", "a table with stiffness, sensor, actuator", "none",
                   "a cubic spring to the ground at a collocated pair"},
                  "cubic_stiffness_n_per_m3",
                  [](const P& plan) { return io::Json(plan.cubic_stiffness); }),
       special<P>({"cubic_spring.sensor", "a sensor of the study", "none", "its place"},
                  "cubic_sensor", [](const P& plan) { return io::Json(plan.cubic_sensor); }),
       special<P>({"cubic_spring.actuator", "an actuator of the study", "none", "its place"},
                  "cubic_actuator", [](const P& plan) { return io::Json(plan.cubic_actuator); }),
       special<P>({"controlled", "actuators of the study", "open loop",
                   "actuators in a stabilising loop; a free body needs one"},
                  "controlled", [](const P& plan) { return io::Json::texts(plan.controlled); }),
       quantity("bandwidth", "Hz", Sign::positive, &P::bandwidth_hz,
                "of the loop; beside controlled", "none"),
       either("leaves", {"frf", "time"}, "time", &P::leaves_time,
              "responses, or recordings as time_data.csv"),
       special<P>({"excitation", "a path", "drawn anew",
                   "recordings whose inputs are played, one period each: the excitation.csv of "
                   "`chladni experiment`"},
                  "excitation",
                  [](const P& plan) { return io::Json(plan.excitation.filename().string()); })}};
  return schema;
}

const Schema<IdentificationPlan>& identification_schema() {
  using P = IdentificationPlan;
  static const Schema<P> schema = {
      "identification",
      {band("band", &P::low_hz, &P::high_hz, "[\"10 Hz\", \"800 Hz\"]", "lines of the fit",
            "all lines above 0 Hz"),
       choice("method", {"likelihood", "thesis"}, &P::method,
              "of the fit; the thesis' path needs modes"),
       choice("damping", {"modal", "general"}, &P::damping, "real shapes, or complex ones"),
       choice("weighting", {"variance", "inverse_magnitude"}, &P::weighting,
              "of the lines; inverse_magnitude is the thesis'",
              quoted({"variance"}) + "; of the thesis' path " + quoted({"inverse_magnitude"})),
       quantity(
           "cut_off_db", "1", Sign::positive, &P::cut_off_db,
           "of inverse_magnitude: lines lower than the largest by more decibels weigh the same"),
       quantity("clip_db", "1", Sign::positive, &P::clip_db,
                "of inverse_magnitude: lines nearer to the largest than these decibels weigh the "
                "same; below cut_off_db",
                "not clipped"),
       whole("fraction_degree", 1, 200, &P::fraction_degree, "of the thesis' matrix fraction",
             "the least with two poles for every mode"),
       whole("sanathanan_koerner", 1, 10000, &P::sanathanan_koerner,
             "iterations of that name in the thesis' path"),
       whole("levenberg_marquardt", 0, 10000, &P::levenberg_marquardt,
             "iterations on the fraction after them"),
       whole("modal_iterations", 1, 10000, &P::modal_iterations,
             "iterations on the modal model after that"),
       quantity("model_error", "1", Sign::not_negative, &P::model_error,
                "of |G|: error of the model; an upper limit where the file states variances",
                "0 where the file states variances, else 0.01"),
       whole("modes", 1, 1000, &P::modes, "flexible modes", "found by the fit"),
       whole("rigid_body_modes", 0, 6, &P::rigid_body_modes, "modes at 0 Hz",
             "found; 0 where a spring or a support holds the body"),
       whole("suspended_modes", 0, 3, &P::suspended_modes,
             "lowest modes above 0 Hz in which the body moves as a whole on soft springs", "found"),
       truth("delay", &P::delay, "whether a delay is fitted"),
       choice("delay_of", {"all", "sensors", "actuators"}, &P::delay_of,
              "one delay, or one for each sensor or actuator"),
       truth("residual", &P::residual, "whether the residual of the modes above is fitted"),
       truth("cross_validation", &P::cross_validation,
             "whether parts of periodic recordings are left out in turn and predicted"),
       text("unit", &P::unit,
            "of the sensors, where the file states none; SI: each in that of its quantity",
            "as the file has it"),
       special<P>({"pair", "tables with sensor, actuator", "those within pairs_within",
                   "collocated sensor and actuator"},
                  "pairs", pairs_json),
       quantity("pairs_within", "m", Sign::positive, &P::pairs_within,
                "the nearest sensor and actuator are a pair up to this distance"),
       choice("gain", {"tied", "thesis"}, &P::gain, "how the two sides of a mode get one scale"),
       choice("gain_errors", {"none", "sensors", "actuators"}, &P::gain_errors,
              "the side whose gains are corrected by the pairs"),
       whole("stabilisation", 2, 200, &P::stabilisation, "highest order of the diagram", "none"),
       shape_dataset<P>("identified.unv, a universal file of the channels")}};
  return schema;
}

const Schema<diagnosis::Tolerances>& tolerances_schema() {
  using P = diagnosis::Tolerances;
  static const Schema<P> schema = {
      "diagnosis.tolerances",
      {tolerance("gain", "1", &P::gain, "of each channel, relative"),
       tolerance("position", "m", &P::position, "of each channel along each axis"),
       tolerance("delay", "s", &P::delay, "common to all channels"),
       tolerance("modulus", "1", &P::modulus, "of the whole body, relative"),
       tolerance("density", "1", &P::density, "of the whole body, relative"),
       tolerance("thickness", "1", &P::thickness,
                 "relative, of the whole and of each smooth wave over the body"),
       tolerance("orthotropy", "1", &P::orthotropy, "of one direction's stiffness, relative"),
       tolerance("residual", "1", &P::residual,
                 "of the residual flexibility of the modes above, relative"),
       tolerance("frequency", "1", &P::frequency, "of each mode, beside the error of its mesh"),
       tolerance("damping", "1", &P::damping, "of each mode, in ln"),
       tolerance(
           "loaded_damping", "1", &P::loaded_damping,
           "0: the damping ratios are those of the body's modes; 1: perhaps those of the modes "
           "with all attachments"),
       tolerance("response", "1", &P::response,
                 "of each response by the mode shapes, relative to its channels' level"),
       tolerance("scale", "1", &P::scale, "of all responses together, in ln"),
       tolerance("mass", "kg", &P::mass,
                 "of each sensor or actuator beyond the model, the same for a side")}};
  return schema;
}

std::vector<TableText> tables_of_a_study() {
  std::vector<TableText> tables;
  const auto add = [&](const auto& schema, const std::string& of = "") {
    tables.push_back(text_of(schema, of));
  };
  add(top_schema());
  add(file_schema());
  add(plate_schema(), "and of a `beam`");
  add(disc_schema());
  add(quadrilateral_schema());
  add(sphere_schema());
  add(wafer_table_schema());
  add(bore_schema());
  add(wafer_schema());
  add(material_schema());
  for (const auto* symmetry : {"isotropic", "cubic", "orthotropic"}) {
    add(constants_schema(symmetry), fmt::format("of symmetry `{}`", symmetry));
  }
  add(mesh_schema());
  add(modes_schema());
  add(support_schema());
  add(variation_schema());
  add(sensor_schema());
  add(actuator_schema());
  add(layout_schema());
  add(attachment_schema());
  add(mass_schema(), "of kind `mass`");
  add(spring_schema(), "of kind `spring`");
  add(damper_schema(), "of kind `damper`");
  add(torsion_spring_schema(), "of kind `torsion_spring`");
  add(link_schema(), "of kind `link`");
  add(resonator_schema(), "of kind `resonator`");
  add(mount_schema(), "of kind `kinematic_mount`");
  add(air_bearing_schema(), "of kind `air_bearing`");
  add(ring_schema(), "and of actuators and attachments");
  add(hexagon_schema(), "likewise; `sensor.at.grid` has the keys of `placement.grid`");
  add(placement_schema());
  add(grid_schema());
  add(uncertainty_schema());
  add(choose_schema());
  add(observer_layout_schema());
  add(measurement_schema());
  add(experiment_schema());
  add(design_schema());
  add(identification_schema());
  add(state_space_schema());
  add(observer_schema());
  add(disturbance_schema());
  add(observer_loop_schema());
  add(interpolation_schema());
  add(priors_schema());
  add(diagnosis_schema());
  add(tolerances_schema());
  add(costs_schema());
  add(specimen_schema());
  tables.push_back(expected_keys());
  return tables;
}

namespace {

// A bar ends a cell, if it is not told apart.
std::string as_cell(std::string words) {
  for (auto bar = words.find('|'); bar != words.npos; bar = words.find('|', bar + 2)) {
    words.insert(bar, 1, '\\');
  }
  return words;
}

}  // namespace

std::string page_of_keys() {
  std::string page =
      "# Keys of a study\n\n"
      "`chladni list keys` prints this page, and a test compares them. Text, units, defaults and "
      "bounds are\nthose that the reader uses. [study.md](study.md) explains the tables.\n"
      "A number may also say how well it is known, `{ value = \"70 GPa\", within = \"15 %\" }` "
      "(study.md#constants-that-are-not-known):\n";
  page += fmt::format("{}.\n", fmt::join(keys_with_deviations(), ", "));
  for (const auto& table : tables_of_a_study()) {
    page += fmt::format("\n## {}\n\n| key | what | may be | default |\n|---|---|---|---|\n",
                        table.heading);
    for (const auto& key : table.keys) {
      page += fmt::format("| `{}` | {} | {} | {} |\n", key.name, as_cell(key.meaning),
                          as_cell(key.expected), as_cell(key.otherwise));
    }
  }
  return page;
}

}  // namespace chladni::study
