// [observer] of a study: points, disturbances, recordings and the loop.
#include "study/observer_plan.h"

#include <algorithm>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

const std::vector<std::string> kDisturbanceKinds{"actuators", "force", "floor"};

std::string unit_of(const DisturbancePlan& plan) { return plan.kind == "floor" ? "m/s^2" : "N"; }

io::Json motion_or_none(const std::optional<Eigen::Vector3d>& direction) {
  return direction ? io::Json(*direction) : io::Json();
}

// The strength of a disturbance, whose unit depends on its kind.
void read_strength(TableReader& table, DisturbancePlan& plan) {
  const bool floor = plan.kind == "floor";
  if (table.has("rms") == table.has("density")) {
    table.missing("rms", floor ? "either rms = \"1 mm/s^2\" or density = \"1e-8 m^2 s^-4/Hz\""
                               : "either rms = \"0.1 N\" or density = \"1e-6 N^2/Hz\"");
  }
  plan.rms = table.quantity("rms", unit_of(plan), Sign::positive).value_or(0.0);
  plan.density =
      table.quantity("density", floor ? "m^2 s^-4/Hz" : "N^2/Hz", Sign::positive).value_or(0.0);
  if (table.has("drift_time") && (table.has("band") || table.has("density"))) {
    table.wrong(*table.find("drift_time"),
                table.name("drift_time") +
                    ": a drift has an rms, that of its change in this time, and neither a density "
                    "nor a band");
  }
}

// Keys that say nothing of this kind of disturbance.
void refuse_idle(TableReader& table, const DisturbancePlan& plan) {
  const auto refuse = [&](const char* key, const char* kind) {
    if (plan.kind.empty() || plan.kind == kind || !table.has(key)) return;
    table.wrong(*table.find(key), table.name(key) + " changes nothing of kind \"" + plan.kind +
                                      "\"; expected kind = \"" + kind + "\" beside it");
  };
  refuse("actuators", "actuators");
  refuse("at", "force");
  refuse("direction", "force");
}

void read_disturbances(TableReader& root, const Study& study, ObserverPlan& plan) {
  Names names("disturbance");
  for (auto& table : root.tables("disturbance")) {
    DisturbancePlan one;
    disturbance_schema().read(table, one);
    names.add(table, one.name);
    if (!table.has("kind")) table.missing("kind", quoted(kDisturbanceKinds));
    one.actuators = table.texts("actuators");
    refuse_strangers(table, "actuators", "actuator of the study", one.actuators,
                     names_of(study.actuators));
    if (one.kind == "force" || table.find("at") != nullptr) one.at = read_place(table, "at");
    one.direction = table.direction("direction");
    read_strength(table, one);
    refuse_idle(table, one);
    table.refuse_unknown();
    plan.disturbances.push_back(one);
  }
}

void read_points(TableReader& root, ObserverPlan& plan) {
  Names names("point");
  for (auto& table : root.tables("point")) {
    ObservedPoint point{table.required_text("name"), read_place(table, "at"),
                        table.direction("direction")};
    names.add(table, point.name);
    table.refuse_unknown();
    plan.points.push_back(point);
  }
}

void read_loop(TableReader& root, const Study& study, ObserverPlan& plan) {
  auto table = root.table("loop");
  if (!table) return;
  auto& loop = plan.loop.emplace();
  observer_loop_schema().read(*table, loop);
  loop.actuators = table->texts("actuators");
  refuse_strangers(*table, "actuators", "actuator of the study", loop.actuators,
                   names_of(study.actuators));
  if (loop.actuators.empty()) table->missing("actuators", "[\"a1\", \"a2\"]: those that it drives");
  table->refuse_unknown();
}

io::Json points_json(const ObserverPlan& plan) {
  io::JsonArray points;
  for (const auto& point : plan.points) {
    points.push_back(io::JsonObject{{"name", point.name},
                                    {"at_m", place_json(point.at)},
                                    {"direction", motion_or_none(point.direction)}});
  }
  return points;
}

io::Json disturbances_json(const ObserverPlan& plan) {
  io::JsonArray disturbances;
  for (const auto& one : plan.disturbances) {
    disturbances.push_back(disturbance_schema().json(one));
  }
  return disturbances;
}

io::Json file_json(const std::filesystem::path& path) {
  return path.empty() ? io::Json() : io::Json(path.filename().string());
}

}  // namespace

const Schema<DisturbancePlan>& disturbance_schema() {
  using P = DisturbancePlan;
  const std::string strength = "a quantity in N, of the floor in m/s^2, positive";
  static const Schema<P> schema = {
      "[observer.disturbance]",
      {{.text = {"name", "a text", "needed", "differs from all other disturbances'"},
        .json_name = "name",
        .read = [](TableReader& table, P& plan) { plan.name = table.required_text("name"); },
        .json = [](const P& plan) { return io::Json(plan.name); }},
       choice("kind", kDisturbanceKinds, &P::kind,
              "a force at each actuator, a force at a place, or the acceleration of the floor "
              "along z",
              "needed"),
       special<P>({"actuators", "actuators of the study", "all", "of kind `actuators`"},
                  "actuators", [](const P& plan) { return io::Json::texts(plan.actuators); }),
       special<P>({"at", "two lengths (onto the top along z) or three (the nearest point)",
                   "needed for a force", "of kind `force`: where it acts"},
                  "at_m",
                  [](const P& plan) -> std::optional<io::Json> {
                    if (plan.kind != "force") return std::nullopt;
                    return place_json(plan.at);
                  }),
       special<P>({"direction", R"("x", "-z", ... or three numbers)", "that of the interpolation",
                   "of kind `force`"},
                  "direction",
                  [](const P& plan) -> std::optional<io::Json> {
                    if (plan.kind != "force") return std::nullopt;
                    return motion_or_none(plan.direction);
                  }),
       special<P>({"rms", strength, "needed without density",
                   "of the disturbance; of a drift that of its change"},
                  "rms", [](const P& plan) { return io::Json(plan.rms); }),
       special<P>({"density", "a quantity in N^2/Hz, of the floor in m^2 s^-4/Hz, positive",
                   "needed without rms", "one-sided power spectral density"},
                  "density", [](const P& plan) { return io::Json(plan.density); }),
       {.text = {"band", "two quantities in Hz, ascending", "up to half of the sample rate",
                 "with slopes of first order below and above; white without it"},
        .json_name = "band_hz",
        .read =
            [](TableReader& table, P& plan) {
              read_band(table, "band", "[\"0 Hz\", \"50 Hz\"]", plan.low_hz, plan.high_hz);
            },
        .json =
            [](const P& plan) {
              return io::JsonArray{plan.low_hz, plan.high_hz};
            }},
       quantity("drift_time", "s", Sign::positive, &P::drift_time,
                "in which a disturbance without a mean changes by rms", "no drift")}};
  return schema;
}

const Schema<ObserverLoopPlan>& observer_loop_schema() {
  using P = ObserverLoopPlan;
  static const Schema<P> schema = {
      "observer.loop",
      {special<P>({"actuators", "actuators of the study", "needed", "that it drives"}, "actuators",
                  [](const P& plan) { return io::Json::texts(plan.actuators); }),
       needed("bandwidth", "Hz", &P::bandwidth_hz, "where it crosses"),
       quantity("delay", "s", Sign::not_negative, &P::delay,
                "of the computer, at least one sample")}};
  return schema;
}

const Schema<ObserverPlan>& observer_schema() {
  using P = ObserverPlan;
  static const Schema<P> schema = {
      "observer",
      {quantity("sample_rate", "Hz", Sign::positive, &P::sample_rate_hz, "of the filter",
                "that of the recordings, of the state space or of the experiment"),
       special<P>({"noise", "a quantity in the sensors' unit, positive",
                   "from the periods of the recordings", "rms of each sensor, in each sample"},
                  "noise", [](const P& plan) { return io::Json(plan.noise); }),
       special<P>({"replay", "a path", "the recordings of the measurement",
                   "recordings over which the filter runs"},
                  "replay", [](const P& plan) { return file_json(plan.replay); }),
       special<P>({"truth", "a path", "none",
                   "the study of a virtual rig: the best filter knows its modes"},
                  "truth", [](const P& plan) { return file_json(plan.truth); }),
       truth("learn_noise", &P::learn_noise,
             "the recordings say how much noise and disturbance the filter counts on"),
       quantity("settle", "s", Sign::positive, &P::settle,
                "of each recording, which no score counts", "until the filter has settled"),
       special<P>({"point", "tables with name, at, direction", "none", "where motion is wanted"},
                  "points", points_json),
       special<P>({"disturbance", "tables", "needed", "what moves the body and is not measured"},
                  "disturbances", disturbances_json),
       special<P>({"loop", "a table", "none", "a loop on the estimate, compared with the sensors'"},
                  "loop", [](const P& plan) -> std::optional<io::Json> {
                    if (!plan.loop) return std::nullopt;
                    return observer_loop_schema().json(*plan.loop);
                  })}};
  return schema;
}

void read_observer(TableReader& root, const StudyFolder& folder, Study& study) {
  auto table = root.table("observer");
  if (!table) return;
  auto& plan = study.observer.emplace();
  observer_schema().read(*table, plan);
  plan.replay = read_path(*table, folder, "replay", study);
  plan.truth = read_path(*table, folder, "truth", study);
  const auto unit = sensor_unit(study);
  if (unit.empty() && table->has("noise")) {
    table->wrong(*table->find("noise"),
                 "observer.noise: the sensors measure different quantities; expected recordings "
                 "with periods, from which it is found");
  } else {
    plan.noise = table->quantity("noise", unit, Sign::positive).value_or(0.0);
  }
  read_points(*table, plan);
  read_disturbances(*table, study, plan);
  read_loop(*table, study, plan);
  if (plan.disturbances.empty()) {
    table->missing("disturbance",
                   "[[observer.disturbance]] with name, kind = \"actuators\" and rms = \"0.1 N\"");
  }
  table->refuse_unknown();
}

}  // namespace chladni::study
