// chladni check STUDY: prints the study in SI units and the expected cost; solves nothing.
#include <fmt/format.h>

#include <algorithm>

#include "app/command.h"
#include "show/solution.h"
#include "stage/forecast.h"
#include "stage/solution.h"
#include "steps/expectations.h"
#include "study/problems.h"

namespace chladni::app {
namespace {

constexpr double kMeshedAtOnce = 5e5;  // degrees of freedom, estimated: some seconds of meshing

// Walls thinner than an edge and slivers between a hole and a rib need several times the cells that
// volume and area suggest. Only the mesh shows this.
void forecast_from_mesh(const study::Study& study, stage::Introduction& introduction,
                        show::Run& run) {
  auto& cost = introduction.cost;
  if (cost.exact || cost.degrees_of_freedom > kMeshedAtOnce) return;
  const auto body = run.timed(
      "mesh", [&] { return stage::body_of(study, introduction.outline, run.progress()); });
  cost = stage::forecast(study, body, introduction.body);
}

// Reports named data files that do not exist. For a file that `simulate` will write there is only a
// note.
void look_for_files(const study::Study& study, show::Run& run) {
  study::Problems problems(study.file.string());
  for (const auto& file : study.files) {
    if (std::filesystem::exists(file.path)) continue;
    const bool to_come =
        study.experiment && (file.key == "measurement.frf" || file.key == "measurement.time");
    if (to_come) {
      run.note(file.key + " \"" + file.path.filename().string() +
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

void run_check(const study::Study& study, show::Run& run) {
  auto introduction = stage::introduced(study, run);
  const auto& shell = introduction.outline.shell;
  const auto places = stage::places_of(study, shell);
  for (const auto& note : places.notes) run.note(note);
  for (const auto& warning : places.warnings) {
    introduction.warnings.push_back(warning);
    run.warn(warning);
  }
  static_cast<void>(stage::materials_of(study, shell.region_names));
  if (!run.options().expect) look_for_files(study, run);
  if (!run.options().expect) forecast_from_mesh(study, introduction, run);
  run.show(introduction.cost.line() + "\n");
  run.leave("study.json", show::study_json(study, introduction), !run.options().expect);
  stage::refuse_what_cannot_fit(study, introduction, run);
  if (run.options().expect)
    steps::judge(study, stage::solved(study, std::move(introduction), run), run);
}

}  // namespace

constinit const Command check_command{
    .name = "check",
    .summary = "the study resolved in SI, and an estimate of size, memory and time",
    .run = run_check,
};

}  // namespace chladni::app
