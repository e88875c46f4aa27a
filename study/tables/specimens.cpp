// [[specimen]] of a study: other studies of one design, each with its own measurement.
#include "study/schemas.h"
#include "study/tables/rows.h"
#include "study/tables/tables.h"

namespace chladni::study {

const Schema<SpecimenPlan>& specimen_schema() {
  using P = SpecimenPlan;
  static const Schema<P> schema = {
      "[specimen]",
      {special<P>({"name", "a text", "needed", "differs from all others"}, "name",
                  [](const P& plan) { return io::Json(plan.name); }),
       special<P>({"study", "a path", "needed",
                   "a study with one measurement, which extends this one or another of the series"},
                  "study", [](const P& plan) { return io::Json(plan.file.filename().string()); }),
       text("group", &P::group,
            "specimens of one group scatter less among themselves, such as halves of a board",
            "none"),
       text("same_as", &P::same_as,
            "a specimen above that was measured again, with a known modification in its study",
            "none")}};
  return schema;
}

void read_specimens(TableReader& root, const StudyFolder& folder, Study& study) {
  Names names("specimen");
  for (auto& table : root.tables("specimen")) {
    SpecimenPlan plan;
    specimen_schema().read(table, plan);
    plan.name = table.required_text("name");
    if (!table.has("study")) table.missing("study", "\"plate_2.toml\"");
    plan.file = read_path(table, folder, "study", study);
    names.add(table, plan.name);
    if (table.has("same_as")) {
      std::vector<std::string> known;
      for (const auto& other : study.specimens) known.push_back(other.name);
      refuse_strangers(table, "same_as", "specimen above", {plan.same_as}, known);
    }
    table.refuse_unknown();
    study.specimens.push_back(std::move(plan));
  }
}

}  // namespace chladni::study
