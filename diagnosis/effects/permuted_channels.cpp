#include "diagnosis/effects/entries.h"
#include "diagnosis/in_study.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Three or more labels have too many permutations to try each. The labels of measured modes are
// put right before any other cause is sought (modes/labels.h); responses alone are not asked.
Index none_to_try(const Structure& /*structure*/) { return 0; }

void nothing(State& /*state*/, const Structure& /*structure*/, Index /*option*/,
             const Eigen::VectorXd& /*x*/) {}

std::vector<EffectStart> nowhere(const Scene& /*scene*/) { return {}; }

constexpr InStudy permuted_names(InStudy::Table table) {
  return {.table = table,
          .keys = {{.key = "name", .how = StudyKey::How::computed},
                   {.key = "node", .how = StudyKey::How::computed}}};
}

}  // namespace

constinit const Effect permuted_sensors{
    .name = "permuted_sensors",
    .summary = "three or more sensors carry each other's names",
    .source = "assignment of the records' shapes to the sensors",
    .confusable = "a symmetry of the body, under which the shapes are the same",
    .parameters = no_sizes,
    .options = none_to_try,
    .channels = no_channels,
    .apply = nothing,
    .starts = nowhere,
    .in_study = permuted_names(InStudy::Table::sensors),
};
constinit const Effect permuted_actuators{
    .name = "permuted_actuators",
    .summary = "three or more actuators carry each other's names",
    .source = "assignment of the records' shapes to the actuators",
    .confusable = "a symmetry of the body, under which the shapes are the same",
    .parameters = no_sizes,
    .options = none_to_try,
    .channels = no_channels,
    .apply = nothing,
    .starts = nowhere,
    .in_study = permuted_names(InStudy::Table::actuators),
};

}  // namespace chladni::diagnosis
