#include "steps/checked.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"
#include "stage/forecast.h"
#include "steps/interpolation.h"
#include "study/problems.h"

namespace chladni::steps {
namespace {

constexpr double kMeshedAtOnce = 5e5;  // degrees of freedom, estimated: some seconds of meshing

// Walls thinner than an edge and slivers between a hole and a rib need several times the cells that
// volume and area suggest. Only the mesh shows this.
void forecast_from_mesh(const study::Study& study, stage::Introduction& introduction,
                        stage::Work& work) {
  auto& cost = introduction.cost;
  if (cost.exact || cost.degrees_of_freedom > kMeshedAtOnce) return;
  const auto body =
      work.timed("mesh", [&] { return stage::body_of(study, introduction.outline, work); });
  cost = stage::forecast(study, body, introduction.body);
}

// Reports named data files that do not exist. For a file that `simulate` will write there is only a
// note.
void look_for_files(const study::Study& study, stage::Work& work) {
  study::Problems problems(study.file.string());
  for (const auto& file : study.files) {
    if (std::filesystem::exists(file.path)) continue;
    const bool to_come =
        study.experiment && (file.key == "measurement.frf" || file.key == "measurement.time");
    if (to_come) {
      work.note(file.key + " \"" + file.path.filename().string() +
                "\" is not there yet: chladni simulate writes it");
      continue;
    }
    const bool measured = study.measurement && file.key.starts_with("measurement.");
    problems.add(file.line, file.column,
                 fmt::format("{} \"{}\" does not exist (looked for {}){}", file.key,
                             file.path.filename().string(), file.path.string(),
                             measured ? study::source_text(*study.measurement) : ""));
  }
  problems.throw_if_any();
}

}  // namespace

stage::Introduction checked(const study::Study& study, bool data, stage::Work& work) {
  auto introduction = stage::introduced(study, work);
  const auto& shell = introduction.outline.shell;
  const auto places = stage::places_of(study, shell);
  for (const auto& note : places.notes) work.note(note);
  for (const auto& warning : places.warnings) {
    introduction.warnings.push_back(warning);
    work.warn(warning);
  }
  static_cast<void>(stage::materials_of(study, shell.region_names));
  if (!data) return introduction;
  look_for_files(study, work);
  forecast_from_mesh(study, introduction, work);
  return introduction;
}

void require_measured(const study::Study& study) {
  require(study.measurement && has_shapes(*study.measurement),
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf, time, shapes "
              "or truth");
  const auto& plan = *study.measurement;
  for (const auto& path : {plan.shapes, plan.truth, plan.frf, plan.time}) {
    require(path.empty() || std::filesystem::exists(path),
            path.string() + ": there is no such file" + study::source_text(plan));
  }
}

}  // namespace chladni::steps
