#include "diagnosis/specimens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "dense/blas.h"
#include "diagnosis/modes/specimens/hypotheses.h"
#include "diagnosis/modes/specimens/linearised.h"
#include "diagnosis/modes/specimens/specimen_constants.h"
#include "diagnosis/modes/specimens/specimens_told.h"

namespace chladni::diagnosis {

void check(const std::vector<Specimen>& specimens) {
  require(specimens.size() >= 2, "one specimen has no others to be compared with; expected two");
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    const auto& one = specimens[i];
    const auto known = [&](const std::string& name) {
      return std::any_of(specimens.begin(), specimens.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Specimen& other) { return other.name == name; });
    };
    require(!known(one.name), "specimen " + one.name + " stands twice");
    require(
        one.same_as.empty() || known(one.same_as),
        fmt::format("{} is the same as {}, which does not stand before it", one.name, one.same_as));
    require(one.measured.count() > 0, one.name + " has no measured modes");
    require(!one.constants.empty(),
            one.name +
                ": no constant states how well it is known; expected some, such as "
                "{ value = \"70 GPa\", within = \"10 %\" }");
    for (const auto& constant : one.constants) {
      require(constant.kind == CalibratedConstant::Kind::unknown || constant.deviation > 0.0,
              fmt::format("{} of {}: its deviation must be above 0", constant.name, one.name));
    }
  }
}

SpecimensDiagnosis diagnosed(const std::vector<Specimen>& specimens,
                             const DiagnosisOptions& options) {
  const dense::OneBlasThread one_thread;
  check(specimens);
  const bool learned = options.levels == Levels::learned;
  SpecimenModels models(specimens, options);
  for (int round = 1;; ++round) {
    tell(options.progress, fmt::format("all specimens, round {}", round));
    Series series = models.series();
    const auto strays = set_strays_aside(series, learned);
    const JointModel model(series, learned);
    const auto weighed = weighed_hypotheses(model, series, options.most_causes);
    if (round == kSpecimens.rounds) {
      return told(specimens, models, series, model, weighed, strays, options);
    }
    models.move_to(series, model, weighed.fits.front());
  }
}

}  // namespace chladni::diagnosis
