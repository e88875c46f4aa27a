// [[variation]] of a study: deviations of its body from the stated material and geometry.
#include "study/tables/tables.h"

namespace chladni::study {

void read_variations(TableReader& root, Study& study) {
  for (auto& table : root.tables("variation")) {
    VariationPlan plan;
    if (!table.has("of")) table.missing("of", "\"stiffness\" or \"thickness\"");
    plan.of = table.choice("of", {"stiffness", "thickness"}).value_or("stiffness");
    const bool patch = table.has("at") || table.has("radius") || table.has("relative");
    if (patch) {
      plan.at = read_place(table, "at");
      plan.radius = table.required_quantity("radius", "m", Sign::positive);
      plan.relative = table.required_quantity("relative", "1");
      if (plan.relative <= -1.0) {
        table.wrong(*table.find("relative"), table.name("relative") +
                                                 " leaves nothing; expected "
                                                 "more than -1");
      }
    }
    bool waves = false;
    for (std::size_t k = 0; k < kVariationWaves.size(); ++k) {
      waves = waves || table.has(kVariationWaves[k]);
      plan.waves[k] = table.quantity(kVariationWaves[k], "1").value_or(0.0);
    }
    if (!patch && !waves) {
      table.missing("at", "a patch (at, radius, relative) or waves (u1, v1, u2, u1v1, v2)");
    }
    for (const auto* key : {"at", "radius", "relative"}) table.find(key);
    table.refuse_unknown();
    study.variations.push_back(plan);
  }
}

}  // namespace chladni::study
