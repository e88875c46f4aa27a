// [design] of a study: the experiment that is to be made.
#include <algorithm>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

const std::vector<std::string> kSignalFiles{"csv", "mat", "wav"};

// Keys that change nothing beside the kind.
void refuse_idle_keys(TableReader& table, const ExcitationPlan& plan) {
  const std::vector<std::string> of_multisine{"stroke",         "voltage",         "realisations",
                                              "phases",         "files",           "margin",
                                              "force_per_volt", "simulation_error"};
  const std::vector<std::string> of_hammer{"pulse", "on"};
  const bool hammer = plan.kind == "hammer";
  for (const auto& key : hammer ? of_multisine : of_hammer) {
    if (!table.has(key)) continue;
    table.wrong(*table.find(key), table.name(key) + " changes nothing here; expected kind = \"" +
                                      (hammer ? "multisine" : "hammer") + "\" beside it");
  }
}

void check_limits(TableReader& table, const ExcitationPlan& plan) {
  if (plan.kind == "hammer") {
    if (!plan.force) table.missing("force", "\"50 N\": the peak of a blow");
    return;
  }
  if (!plan.force && !plan.stroke && !plan.voltage) {
    table.missing("force",
                  "\"5 N\", or stroke = \"0.5 mm\", or voltage = \"10 V\" with "
                  "force_per_volt: what the rig bears");
  }
  if (plan.voltage && !plan.force_per_volt) {
    table.missing("force_per_volt", "\"2 N/V\": a limit of voltage needs it");
  }
}

}  // namespace

const Schema<ExcitationPlan>& design_schema() {
  using P = ExcitationPlan;
  static const Schema<P> schema = {
      "design",
      {choice("kind", {"multisine", "hammer"}, &P::kind, "what moves the structure"),
       quantity("force", "N", Sign::positive, &P::force, "largest force of each actuator or blow",
                "no limit; needed with a hammer"),
       quantity("stroke", "m", Sign::positive, &P::stroke,
                "largest displacement at every sensor and actuator", "no limit"),
       quantity("voltage", "V", Sign::positive, &P::voltage,
                "largest voltage at each amplifier; beside force_per_volt", "no limit"),
       quantity("force_per_volt", "N/V", Sign::positive, &P::force_per_volt,
                "of every actuator with its amplifier: the signals are written in V",
                "the signals are written in N"),
       quantity("margin", "1", Sign::positive, &P::margin,
                "part of each limit that is used, at most 1"),
       quantity("frequency_deviation", "Hz", Sign::positive, &P::frequency_deviation,
                "wanted standard deviation of every frequency in the band", "not asked for"),
       quantity("damping_deviation", "1", Sign::positive, &P::damping_deviation,
                "wanted standard deviation of every damping ratio in the band, relative"),
       whole("realisations", 1, 1000, &P::realisations,
             "of the random phases; 4 or more tell noise from distortion"),
       quantity("longest", "s", Sign::positive, &P::longest, "time of the whole experiment"),
       quantity("longest_period", "s", Sign::positive, &P::longest_period,
                "of the multisine, or of the record of a blow"),
       choice("phases", {"random", "low_crest"}, &P::phases,
              "of the lines; low_crest gives more force under the same limit, and realisations no "
              "longer average distortion"),
       quantity("simulation_error", "1", Sign::not_negative, &P::simulation_error,
                "relative deviation of the simulated frequencies from those of the rig"),
       quantity("pulse", "s", Sign::positive, &P::pulse, "length of a blow: half a sine",
                "the longest whose spectrum falls by 10 dB in the band"),
       faces<P>("faces that can be hit"),
       names<P>(
           {"files", "a list of " + quoted(kSignalFiles), quoted(kSignalFiles),
            "formats of the signals"},
           "format", [] { return kSignalFiles; }, &P::files)}};
  return schema;
}

void read_design(TableReader& root, Study& study) {
  auto table = root.table("design");
  if (!table) return;
  auto& plan = study.design.emplace();
  const auto files = plan.files;
  design_schema().read(*table, plan);
  if (!table->has("files")) plan.files = files;
  if (plan.margin > 1.0) {
    table->wrong(*table->find("margin"), table->name("margin") + " must be 1 at most");
  }
  refuse_idle_keys(*table, plan);
  check_limits(*table, plan);
  table->refuse_unknown();
}

}  // namespace chladni::study
