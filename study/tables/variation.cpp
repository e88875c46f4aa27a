// [[variation]] of a study: deviations of its body from the stated material and geometry.
#include <algorithm>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {

void read_variations(TableReader& root, Study& study) {
  for (auto& table : root.tables("variation")) {
    const auto plan = read_part(table, variation_schema());
    const bool has_waves =
        std::ranges::any_of(kVariationWaves, [&](auto wave) { return table.has(wave); });
    if (!plan.at && !has_waves) {
      table.missing("at", "a patch (at, radius, relative) or waves (u1, v1, u2, u1v1, v2)");
    }
    table.refuse_unknown();
    study.variations.push_back(plan);
  }
}

}  // namespace chladni::study
