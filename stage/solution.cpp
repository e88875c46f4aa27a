#include "stage/solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/error_estimate.h"
#include "stage/estimates/blind_spots.h"
#include "stage/faces.h"
#include "stage/forecast.h"
#include "study/problems.h"

namespace chladni::stage {
namespace {

/// Number of flexible modes, so that the highest expected one is included.
int wanted_count(const study::Study& study) {
  int count = study.modes.count;
  for (const auto& expectation : study.expectations) {
    if (!expectation.key.starts_with("frequency_")) continue;
    count = std::max(count, std::stoi(expectation.key.substr(expectation.key.find('_') + 1)));
  }
  return count;
}

/// Reports modes that the study names but that will not be computed.
void require_modes(const study::Study& study) {
  if (study.modes.up_to_hz > 0.0) return;
  const int there = wanted_count(study);
  study::Problems problems(study.file.string());
  const auto look = [&](const char* key, int highest, int line, int column) {
    if (highest <= there) return;
    problems.add(line, column,
                 fmt::format("{} asks for flexible mode {}, but {} will be computed; raise "
                             "modes.count",
                             key, highest, there));
  };
  if (const auto& plan = study.placement; plan && !plan->modes.empty()) {
    look("placement.modes", *std::max_element(plan->modes.begin(), plan->modes.end()),
         plan->modes_line, plan->modes_column);
  }
  if (const auto& plan = study.priors) {
    look("priors.modes", plan->modes, plan->modes_line, plan->modes_column);
  }
  problems.throw_if_any();
}

fem::ModesOptions modes_options(const study::Study& study, const Work& work) {
  fem::ModesOptions options;
  options.count = wanted_count(study);
  options.certificate = work.choices().certificate;
  options.seed = work.seed();
  return options;
}

bool reaches(const modal::Modes& modes, double up_to_hz) {
  return modes.frequency_hz.size() > 0 && modes.frequency_hz.tail<1>()(0) >= up_to_hz;
}

/// Modes up to a frequency: asks for more until one lies above it, then removes those above.
fem::ModesResult modes_up_to(const fem::System& system, double up_to_hz, fem::ModesOptions options,
                             const Progress& progress) {
  auto result = fem::modes(system, options, progress);
  const auto most = static_cast<int>(system.dofs.free_count / 4);
  while (!reaches(result.modes, up_to_hz) && options.count < most) {
    const double ratio = up_to_hz / result.modes.frequency_hz.tail<1>()(0);
    options.count =
        std::min(most, static_cast<int>(options.count * std::clamp(1.2 * ratio, 1.3, 4.0)) + 2);
    result = fem::modes(system, options, progress);
  }
  Eigen::Index below = 0;
  while (below < result.modes.mode_count() && result.modes.frequency_hz(below) <= up_to_hz) ++below;
  result.modes.frequency_hz.conservativeResize(below);
  result.modes.damping_ratio.conservativeResize(below);
  result.modes.shapes.conservativeResize(Eigen::NoChange, below);
  result.summary.residual.conservativeResize(below);
  std::erase_if(result.summary.clusters,
                [&](const fem::Cluster& cluster) { return cluster.first + cluster.size > below; });
  return result;
}

fem::ModesResult modes_of(const study::Study& study, const fem::System& system, Work& work) {
  const auto options = modes_options(study, work);
  const auto progress = work.progress();
  auto result = study.modes.up_to_hz > 0.0
                    ? modes_up_to(system, study.modes.up_to_hz, options, progress)
                    : fem::modes(system, options, progress);
  const Eigen::Index flexible = result.modes.mode_count() - result.modes.rigid_count;
  result.modes.damping_ratio.tail(flexible).setConstant(study.modes.damping_ratio);
  return result;
}

void warn(const std::vector<std::string>& lines, Solution& solution, Work& work) {
  for (const auto& line : lines) {
    solution.introduction.warnings.push_back(line);
    work.warn(line);
  }
}

// With the mesh the cost is known. A solution that is too expensive is refused before it starts.
void forecast_again(const study::Study& study, const mesh::TetMesh& body, Solution& solution,
                    Work& work) {
  auto& introduction = solution.introduction;
  if (introduction.cost.exact) return;
  introduction.cost = forecast(study, body, introduction.body);
  work.note("with the mesh: " + introduction.cost.line());
  refuse_what_cannot_fit(study, introduction.body, introduction.cost);
}

}  // namespace

Introduction introduced(const study::Study& study, Work& work) {
  require_modes(study);
  Introduction introduction;
  introduction.warnings = study.warnings;
  for (const auto& warning : study.warnings) work.warn(warning);
  introduction.outline = outline_of(study, work.progress());
  require_faces(study, introduction.outline.shell);
  introduction.body = understood(study, introduction.outline);
  introduction.cost = forecast(study, introduction.outline);
  work.show(introduction.body.line() + "\n");
  for (const auto& note : introduction.outline.notes) work.note(note);
  for (const auto& warning : implausible(introduction.body)) {
    introduction.warnings.push_back(study.file.string() + ": " + warning);
    work.warn(introduction.warnings.back());
  }
  return introduction;
}

Solution solved(const study::Study& study, Work& work) {
  auto introduction = work.timed("geometry", [&] { return introduced(study, work); });
  work.note(introduction.cost.line());
  return solved(study, std::move(introduction), work);
}

Solution solved(const study::Study& study, Introduction introduction, Work& work) {
  const auto progress = work.progress();
  throw_if_interrupted();
  refuse_what_cannot_fit(study, introduction.body, introduction.cost);
  Solution solution;
  solution.introduction = std::move(introduction);
  const auto& outline = solution.introduction.outline;
  auto body = work.timed("mesh", [&] { return body_of(study, outline, progress); });
  forecast_again(study, body, solution, work);
  solution.model = work.timed("places", [&] { return model_of(study, std::move(body)); });
  for (const auto& note : solution.model.notes) work.note(note);
  warn(solution.model.warnings, solution, work);
  warn(channels_kept_out(study, solution.model), solution, work);
  throw_if_interrupted();

  const auto& model = solution.model;
  tell(progress, "assembling");
  const auto system = work.timed("assembly", [&] {
    return fem::assemble(model.body, model.materials, study.supports, model.attachments);
  });
  auto result = work.timed("modes", [&] { return modes_of(study, system, work); });
  solution.degrees_of_freedom = system.dofs.free_count;
  tell(progress, "estimating the error of the mesh");
  solution.frequency_error = work.timed("error_estimate", [&] {
    return fem::frequency_error(model.body, model.materials, system, result.modes);
  });
  solution.summary = result.summary;
  warn(solution.summary.warnings, solution, work);
  solution.modes = std::move(result.modes);
  solution.extra_shapes =
      solution.modes.shapes(system.dofs.free_dof.tail(system.dofs.extra_count()), Eigen::all);
  solution.modes.shapes = fem::on_nodes(system.dofs, solution.modes.shapes);
  warn(coarse_mesh(solution), solution, work);
  warn(blind_spots(study, solution), solution, work);
  return solution;
}

Eigen::MatrixXd shapes_at(const std::vector<mesh::Site>& sites, const Points& directions,
                          const modal::Modes& modes) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(sites.size()), modes.mode_count());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const auto row = mesh::row_at(sites[static_cast<std::size_t>(i)], directions.row(i).transpose(),
                                  modes.dof_count() / 3);
    values.row(i) = row.transpose() * modes.shapes;
  }
  return values;
}

Eigen::MatrixXd shapes_at(const std::vector<study::Channel>& channels,
                          const std::vector<mesh::Site>& sites, const modal::Modes& modes) {
  Points directions(static_cast<Eigen::Index>(channels.size()), 3);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    directions.row(static_cast<Eigen::Index>(i)) = channels[i].direction.transpose();
  }
  return shapes_at(sites, directions, modes);
}

}  // namespace chladni::stage
