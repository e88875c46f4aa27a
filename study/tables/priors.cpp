// [priors] of a study: the hyper-parameters to learn from its modes.
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {

void read_priors(TableReader& root, Study& study) {
  auto table = root.table("priors");
  if (!table) return;
  priors_schema().read(*table, study.priors.emplace());
  table->refuse_unknown();
}

}  // namespace chladni::study
