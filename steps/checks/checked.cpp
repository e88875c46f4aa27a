#include "steps/checked.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/error.h"
#include "host/shell_word.h"
#include "stage/faces.h"
#include "stage/forecast.h"
#include "stage/points_on_body.h"
#include "stage/solution.h"
#include "steps/interpolation.h"
#include "steps/simulated.h"
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

bool names_specimen(const study::DataFile& file) { return file.key.starts_with("specimen"); }
bool names_study(const study::DataFile& file) {
  return names_specimen(file) || file.key.ends_with(".truth");
}

// What is wrong with the place of a file; empty if it is there.
std::string fault_at(const study::Study& study, const study::DataFile& file) {
  std::error_code fault;
  const auto name = file.path.filename().string();
  if (std::filesystem::is_directory(file.path, fault)) {
    return fmt::format("{} \"{}\" is a folder; expected a file", file.key, name);
  }
  if (std::filesystem::exists(file.path, fault)) return "";
  const bool measured = study.measurement && file.key.starts_with("measurement.");
  return fmt::format("{} \"{}\" does not exist (looked for {}){}", file.key, name,
                     file.path.string(), measured ? study::source_text(*study.measurement) : "");
}

// Flexible modes of the truth that are asked for and that it will not compute; empty: none.
std::string modes_beyond(const study::Study& study, const study::Study& truth) {
  const int wanted = study.measurement ? study.measurement->modes : 0;
  const int there = stage::wanted_count(truth);
  if (truth.modes.up_to_hz > 0.0 || wanted <= there) return "";
  return fmt::format(
      "measurement.modes asks for {} modes, but {} will be computed of {}; raise "
      "modes.count there",
      wanted, there, truth.file.filename().string());
}

// A truth stands by its modes alone, a specimen by its measurement too.
// @throws InvalidInput  the study that `file` names cannot be meant, names patches that its body
//                       lacks, or files that are not there
void require_named_study(const study::Study& study, const study::DataFile& file,
                         const stage::Work& work) {
  auto allowed = work.choices().allowed;
  if (names_specimen(file)) {
    allowed.push_back(std::filesystem::absolute(study.file).parent_path());
  }
  const auto named = study::read_study(file.path, allowed);
  stage::require_faces(named, stage::outline_of(named).shell);
  study::Problems problems(named.file.string());
  for (const auto& one : named.files) {
    const bool is_used = one.key.starts_with("geometry.") || names_specimen(file);
    const auto fault = is_used ? fault_at(named, one) : "";
    if (!fault.empty()) problems.add(one.line, one.column, fault);
  }
  problems.throw_if_any();
  if (file.key.ends_with("measurement.truth")) {
    const auto beyond = modes_beyond(study, named);
    require(beyond.empty(), beyond);
  }
}

// The command that writes a measured file of this study; empty where another one does.
std::string command_that_writes(const study::Study& study, const study::DataFile& file) {
  const bool recordings = study.experiment->leaves_time;
  const auto command = "chladni simulate " + shell_word(study.file.string());
  if (file.key == "measurement.frf") return recordings ? "" : command;
  const bool is_left = recordings && file.path.filename() == kRecordingsFile;
  if (file.key != "measurement.time" || !is_left) return "";
  return command + " -o " + shell_word(file.path.parent_path().string());
}

// Reports named files that do not exist, and studies that cannot be meant. For a file that
// `simulate` will write there is only a note.
void look_for_files(const study::Study& study, stage::Work& work) {
  study::Problems problems(study.file.string());
  for (const auto& file : study.files) {
    const auto fault = fault_at(study, file);
    const bool to_come = study.experiment && !std::filesystem::exists(file.path) &&
                         (file.key == "measurement.frf" || file.key == "measurement.time");
    if (to_come) {
      const auto command = command_that_writes(study, file);
      work.note(fmt::format("{} \"{}\" is not there yet{}", file.key, file.path.filename().string(),
                            command.empty() ? "" : ": " + command + " writes it"));
    } else if (!fault.empty()) {
      problems.add(file.line, file.column, fault);
    } else if (names_study(file)) {
      try {
        require_named_study(study, file, work);
      } catch (const InvalidInput& e) {
        problems.add(file.line, file.column, fmt::format("{}: {}", file.key, e.what()));
      }
    }
  }
  problems.throw_if_any();
}

// What is wrong with the body does not hide what is wrong with the files: both are told.
stage::Introduction introduced_beside_files(const study::Study& study, bool data,
                                            stage::Work& work) {
  try {
    return stage::introduced(study, work);
  } catch (const InvalidInput& of_body) {
    if (!data) throw;
    try {
      look_for_files(study, work);
    } catch (const InvalidInput& of_files) {
      throw InvalidInput(fmt::format("{}\n{}", of_body.what(), of_files.what()));
    }
    throw;
  }
}

// Points at which motions are asked for must be on the body.
void require_points(const study::Study& study, const mesh::TetMesh& body) {
  std::optional<mesh::SiteFinder> finder;
  const double reach = stage::reach_of(body);
  study::Problems problems(study.file.string());
  const auto look = [&](const study::Place& at, const std::string& what) {
    if (!finder) finder.emplace(body);
    const auto site = stage::site_at(*finder, at);
    if (site.distance <= reach) return;
    problems.add(
        at.line, 1,
        fmt::format("{} is not on the body, which is {:.3g} mm away", what, 1e3 * site.distance));
  };
  if (study.placement) {
    for (const auto& at : study.placement->interest) look(at, "a point of interest");
  }
  if (study.interpolation) {
    for (const auto& point : study.interpolation->points) {
      look(point.at, "interpolation.point \"" + point.name + "\"");
    }
  }
  if (study.observer) {
    for (const auto& point : study.observer->points) {
      look(point.at, "observer.point \"" + point.name + "\"");
    }
  }
  problems.throw_if_any();
}

}  // namespace

stage::Introduction checked(const study::Study& study, bool data, stage::Work& work) {
  auto introduction = introduced_beside_files(study, data, work);
  const auto& shell = introduction.outline.shell;
  const auto round = stage::rounded_outline(study, introduction.outline);
  const auto& body = round ? *round : shell;
  const auto places = stage::places_of(study, body);
  for (const auto& note : places.notes) work.note(note);
  for (const auto& warning : places.warnings) {
    introduction.warnings.push_back(warning);
    work.warn(warning);
  }
  static_cast<void>(stage::materials_of(study, shell.region_names));
  require_points(study, body);
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
