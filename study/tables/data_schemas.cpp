// The keys of what is measured, and of what is made of it.
#include "diagnosis/effect.h"
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {

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
       whole("most_causes", 1, 10, &P::most_causes, "at most so many at once"),
       quantity("least_evidence", "1", Sign::positive, &P::least_evidence,
                "of a cause: ln of the Bayes factor"),
       quantity("rival_within", "1", Sign::positive, &P::rival_within,
                "rivals that are nearer in ln of the evidence make a cause ambiguous"),
       whole("lines", 20, 100000, &P::lines, "of the search, at most"),
       band("hold_out_band", &P::hold_out_low_hz, &P::hold_out_high_hz, example,
            "lines that no fit may see; the gain is measured there", "none")}};
  return schema;
}

}  // namespace chladni::study
