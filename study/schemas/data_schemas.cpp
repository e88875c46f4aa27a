// The keys of what is measured, and of what is made of it.
#include <fmt/ranges.h>

#include <algorithm>

#include "diagnosis/effect.h"
#include "priors/interpolator.h"
#include "priors/kernel.h"
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

/// A file of the measurement; study.json has its name without the folder.
Key<MeasurementPlan> data_file(const std::string& name,
                               std::filesystem::path MeasurementPlan::*value,
                               const std::string& meaning) {
  return special<MeasurementPlan>(
      {name, "a path", "none", meaning}, name,
      [=](const MeasurementPlan& plan) { return io::Json((plan.*value).filename().string()); });
}

/// A key of the recordings as one of the measurement.
Key<MeasurementPlan> of_recording(const Key<RecordingPlan>& key) {
  return {
      .text = key.text,
      .json_name = key.json_name,
      .read = [key](TableReader& table, MeasurementPlan& plan) { key.read(table, plan.recording); },
      .json = [key](const MeasurementPlan& plan) { return key.json(plan.recording); }};
}

void read_points(TableReader& table, InterpolationPlan& plan) {
  Names names("point");
  for (auto& point : table.tables("point")) {
    plan.points.push_back({point.required_text("name"), read_place(point, "at")});
    names.add(point, plan.points.back().name);
    point.refuse_unknown();
  }
}

io::Json points_json(const InterpolationPlan& plan) {
  io::JsonArray points;
  for (const auto& point : plan.points) {
    points.push_back(io::JsonObject{{"name", point.name}, {"at_m", place_json(point.at)}});
  }
  return points;
}

void read_predicted(TableReader& table, InterpolationPlan& plan) {
  plan.predicted = table.text("predicted").value_or(plan.predicted);
  if (plan.predicted.ends_with(".csv") && plan.predicted.find('/') == plan.predicted.npos) return;
  table.wrong(*table.find("predicted"),
              table.name("predicted") + ": found \"" + plan.predicted +
                  "\", expected the name of a file such as \"predicted.csv\"");
}

void read_learned_modes(TableReader& table, PriorsPlan& plan) {
  plan.modes = static_cast<int>(table.integer("modes", 1, kMostModes).value_or(0));
  if (const TomlNode* node = table.find("modes")) {
    plan.modes_line = node->line;
    plan.modes_column = node->column;
  }
}

constexpr int kFewestSamples = 4;
constexpr int kMostSamples = 4000;  // N³: a minute and 400 MB

void read_samples(TableReader& table, PriorsPlan& plan) {
  const TomlNode* node = table.find("samples");
  if (node == nullptr) return;
  plan.samples.clear();
  const auto add = [&](const TomlNode& one) {
    if (one.kind == TomlNode::Kind::integer && one.number >= kFewestSamples &&
        one.number <= kMostSamples) {
      plan.samples.push_back(static_cast<int>(one.number));
    } else {
      table.wrong(
          one, fmt::format("{} holds {}; expected numbers of samples from {} to {}",
                           table.name("samples"), description(one), kFewestSamples, kMostSamples));
    }
  };
  if (node->kind == TomlNode::Kind::array && !node->elements.empty()) {
    for (const auto& element : node->elements) add(element);
  } else {
    add(*node);
  }
  std::sort(plan.samples.begin(), plan.samples.end());
}

void read_noise_ratio(TableReader& table, PriorsPlan& plan) {
  const TomlNode* ratio = table.find("noise_ratio");
  if (ratio != nullptr && ratio->text == "learned") {
    plan.learn_noise = true;
    return;
  }
  plan.noise_ratio = table.quantity("noise_ratio", "1", Sign::positive).value_or(plan.noise_ratio);
  if (plan.noise_ratio < 1e-8 || plan.noise_ratio > 1.0) {
    table.wrong(*ratio, table.name("noise_ratio") +
                            " is outside 1e-8 to 1; below, rounding would choose the length");
  }
}

io::Json whole_numbers(const std::vector<int>& numbers) {
  io::JsonArray array;
  for (const int number : numbers) array.emplace_back(number);
  return array;
}

}  // namespace

const Schema<MeasurementPlan>& measurement_schema() {
  using P = MeasurementPlan;
  using R = RecordingPlan;
  static const Schema<P> schema = {
      "measurement",
      {data_file("frf", &P::frf, "responses"),
       data_file("time", &P::time, "recordings that responses are estimated from"),
       data_file("validation", &P::validation,
                 "a second record, of the form of `frf` or `time`: no fit sees it, and what a fit "
                 "predicts there is scored"),
       of_recording(whole("period", 4, kLongestPeriod, &R::period,
                          "samples of the periodic excitation in `time`",
                          "as in the file; none: "
                          "blows of a hammer")),
       of_recording(quantity("sample_rate", "Hz", Sign::positive, &R::sample_rate_hz,
                             "of `time` where the file has none", "as in the file")),
       of_recording(choice("inputs", {"commands", "forces"}, &R::inputs,
                           "what the inputs of `time` are: commands that are held from sample to "
                           "sample, or measured forces")),
       of_recording(choice("transient", {"remove", "drop"}, &R::transient,
                           "what is done about the start of a periodic excitation: taken off all "
                           "periods, or the first periods dropped")),
       of_recording(quantity("force_window", "s", Sign::positive, &R::force_window,
                             "time after a blow in which the force counts", "all of the record")),
       of_recording(quantity("exponential_window", "s", Sign::positive, &R::exponential_window,
                             "time constant of the window that ends records of blows; its damping "
                             "is taken off the modes again",
                             "none")),
       of_recording(choice("hammer", {"h1", "h2"}, &R::hammer,
                           "estimate from blows: h1 bears noise of the sensors, h2 that of the "
                           "force")),
       data_file("shapes", &P::shapes, "a table of measured mode shapes"),
       data_file("truth", &P::truth,
                 "a study whose modes stand for measured ones, instead of shapes"),
       quantity("noise", "1", Sign::positive, &P::noise,
                "of a shape's value over its root mean square, where none is stated"),
       special<P>({"modes", fmt::format("a path, or 1 to {}", kMostModes),
                   "of truth: those in view, at most 12",
                   "measured modes for a diagnosis; a number: flexible modes of truth"},
                  "modes",
                  [](const P& plan) {
                    return plan.modes_file.empty() ? io::Json(plan.modes)
                                                   : io::Json(plan.modes_file.filename().string());
                  }),
       data_file("reference", &P::reference,
                 "modes measured before something changed; a cause is what only `modes` need"),
       special<P>({"hold_out", "channels of the study", "none",
                   "channels that no fit may see; what is predicted there is scored"},
                  "hold_out", [](const P& plan) { return io::Json::texts(plan.hold_out); }),
       quantity("mass", "kg", Sign::positive, &P::mass,
                "of the body on scales; compared between specimens", "not weighed"),
       text("source", &P::source, "where files are to be had that do not come with the study",
            "none")}};
  return schema;
}

const Schema<InterpolationPlan>& interpolation_schema() {
  using P = InterpolationPlan;
  static const Schema<P> schema = {
      "interpolation",
      {names<P>(
           {"methods", "names of `chladni list interpolations`",
            "the default and two of the thesis", "the first is the one that is shown"},
           "method", [] { return names_in(priors::interpolators()); }, &P::methods),
       faces<P>("whose motion is wanted"),
       motion<P>("of that motion"),
       {.text = {"point", "tables with name, at", "none", "where shapes are printed"},
        .json_name = "points",
        .read = read_points,
        .json = points_json},
       {.text = {"predicted", "the name of a file that ends in .csv", quoted({P{}.predicted}),
                 "responses where nothing was measured"},
        .json_name = "predicted",
        .read = read_predicted,
        .json = [](const P& plan) { return io::Json(plan.predicted); }},
       quantity("table_pitch", "m", Sign::positive, &P::table_pitch,
                "of a lookup table seen from above, mode_field.csv", "no table"),
       whole("polynomial_degree", 1, 30, &P::polynomial_degree,
             "in x and y, of mode_field_polynomial.json", "no polynomial"),
       shape_dataset<P>("mode_field.unv, a universal file of the surface")}};
  return schema;
}

const Schema<StateSpacePlan>& state_space_schema() {
  using P = StateSpacePlan;
  static const Schema<P> schema = {
      "state_space",
      {quantity("sample_rate", "Hz", Sign::positive, &P::sample_rate_hz,
                "of the discrete model and the C header",
                "that of the experiment, else neither is made"),
       whole("states", 1, 2 * kMostModes, &P::states,
             "that a balanced reduction leaves, rigid-body motion included", "all"),
       whole("pade_order", 1, 10, &P::pade_order,
             "of the delays of the continuous model; the discrete one has them exactly",
             "they stay delays")}};
  return schema;
}

const Schema<PriorsPlan>& priors_schema() {
  using P = PriorsPlan;
  static const Schema<P> schema = {
      "priors",
      {choice("kernel", names_in(priors::kernels()), &P::kernel, "of the Gaussian process"),
       either("axes", {"isotropic", "per_axis"}, "per_axis", &P::per_axis,
              "one length scale, or one for each of x, y, z"),
       choice("by", {"marginal_likelihood", "leave_one_out"}, &P::by, "what is made largest"),
       {.text = {"modes", fmt::format("1 to {}", kMostModes), "12, or all there are",
                 "flexible modes to learn from"},
        .json_name = "modes",
        .read = read_learned_modes,
        .json = [](const P& plan) { return io::Json(plan.modes); }},
       {.text = {"samples",
                 fmt::format("whole numbers from {} to {}", kFewestSamples, kMostSamples),
                 fmt::format("[{}]", fmt::join(P{}.samples, ", ")),
                 "of each mode; the largest counts"},
        .json_name = "samples",
        .read = read_samples,
        .json = [](const P& plan) { return whole_numbers(plan.samples); }},
       {.text = {"noise_ratio", "1e-8 to 1, or \"learned\"", default_text(P{}.noise_ratio, "1"),
                 "variance of the noise over that of the prior"},
        .json_name = "noise_ratio",
        .read = read_noise_ratio,
        .json =
            [](const P& plan) {
              return plan.learn_noise ? io::Json("learned") : io::Json(plan.noise_ratio);
            }},
       faces<P>("whose motion is learned from"),
       motion<P>("of that motion")}};
  return schema;
}

const Schema<diagnosis::MeasurementCosts>& costs_schema() {
  using P = diagnosis::MeasurementCosts;
  static const Schema<P> schema = {
      "diagnosis.costs",
      {quantity("repetition", "1", Sign::not_negative, &P::repetition, "a mode measured again"),
       quantity("exchange", "1", Sign::not_negative, &P::exchange,
                "another sensor or actuator in the place of one"),
       quantity("mass", "1", Sign::not_negative, &P::mass, "a known mass on the body"),
       quantity("dimension", "1", Sign::not_negative, &P::dimension, "callipers"),
       quantity("sensor", "1", Sign::not_negative, &P::sensor, "one more sensor"),
       quantity("weighing", "1", Sign::not_negative, &P::weighing, "the body alone on scales")}};
  return schema;
}

const Schema<DiagnosisPlan>& diagnosis_schema() {
  using P = DiagnosisPlan;
  const std::string example = R"(["20 Hz", "900 Hz"])";
  static const Schema<P> schema = {
      "diagnosis",
      {band("band", &P::low_hz, &P::high_hz, example, "lines that are looked at", "all lines"),
       special<P>({"tolerances", "a file in the study's folder, or a table", "the usual ones",
                   "what a real structure may deviate"},
                  "tolerances",
                  [](const P& plan) { return tolerances_schema().json(plan.tolerances); }),
       faces<P>("where causes are sought"),
       names<P>(
           {"effects", "names of `chladni list effects`", "all", "causes to consider"},
           "effect (chladni list effects)", [] { return names_in(diagnosis::effects()); },
           &P::effects),
       whole("most_causes", 1, 10, &P::most_causes,
             "at most so many at once; wrong readings of channels do not count"),
       quantity("least_evidence", "1", Sign::positive, &P::least_evidence,
                "of a cause: ln of the Bayes factor"),
       quantity("rival_within", "1", Sign::positive, &P::rival_within,
                "rivals that are nearer in ln of the evidence make a cause ambiguous"),
       whole("lines", 20, 100000, &P::lines, "of the search, at most"),
       choice("levels", {"learned", "known"}, &P::levels,
              "of the errors of a sound model: inferred from measured modes, or the tolerances"),
       special<P>({"costs", "a table", "the usual ones",
                   "what further measurements cost, as ln of the Bayes factor that pays for them"},
                  "costs", [](const P& plan) { return costs_schema().json(plan.costs); }),
       band("hold_out_band", &P::hold_out_low_hz, &P::hold_out_high_hz, example,
            "lines that no fit may see; the gain is measured there", "none")}};
  return schema;
}

}  // namespace chladni::study
