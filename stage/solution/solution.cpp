#include "stage/solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/interrupt.h"
#include "host/memory.h"
#include "stage/estimates/blind_spots.h"
#include "stage/faces.h"
#include "stage/forecast.h"
#include "stage/kept/solved_modes.h"
#include "stage/remedies.h"
#include "study/problems.h"

namespace chladni::stage {
namespace {

/// Reports modes that the study names but that will not be computed.
void require_modes(const study::Study& study) {
  study::Problems problems(study.file.string());
  const double up_to = study.modes.up_to_hz;
  if (const auto& plan = study.placement; up_to > 0.0 && plan && plan->up_to_hz > up_to) {
    problems.add(plan->modes_line, plan->modes_column,
                 fmt::format("placement asks for modes up to {:.6g} Hz, but those up to {:.6g} Hz "
                             "will be computed; raise modes.up_to",
                             plan->up_to_hz, up_to));
  }
  problems.throw_if_any();
  if (up_to > 0.0) return;
  const int there = wanted_count(study);
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

/// Modes as the study asks for, but at least `flexible`.
SolvedModes modes_of(const study::Study& study, const Solution& solution, int flexible,
                     Work& work) {
  constexpr double kMore = 1.3;  // a forecast of their number is right within a factor of 1.5
  ModesRequest request;
  request.options.count = std::max(wanted_count(study), flexible);
  request.options.certificate = work.choices().certificate;
  request.options.seed = work.seed();
  request.options.memory_limit_bytes = work.choices().memory_limit_bytes;
  request.up_to_hz = study.modes.up_to_hz;
  request.mirrors = study.modes.mirrors;
  request.launcher = engine_of(study, work);
  if (!request.launcher.empty()) {
    request.guess_hz = frequency_of(kMore * request.options.count, solution.introduction.body);
  }
  auto solved = [&] {
    try {
      return solved_modes(solution.model, *solution.system, study.supports, request, work);
    } catch (const fem::FactorTooLarge& e) {
      refuse(study, solution.introduction,
             {e.forecast.total_bytes, e.have_bytes, e.forecast.factor_bytes}, work);
    }
  }();
  auto& modes = solved.result.modes;
  modes.damping_ratio.tail(modes.mode_count() - modes.rigid_count)
      .setConstant(study.modes.damping_ratio);
  return solved;
}

/// Number of modes that the study asks for among those that were computed. A repeated mode is not
/// cut, also where the frequency up to which they are wanted lies within it.
Eigen::Index own_count(const study::Study& study, const modal::Modes& modes,
                       const std::vector<fem::Cluster>& clusters) {
  if (study.modes.up_to_hz <= 0.0) return count_with(wanted_count(study), modes, clusters);
  Eigen::Index below = 0;
  while (below < modes.mode_count() && modes.frequency_hz(below) <= study.modes.up_to_hz) ++below;
  return count_with(static_cast<int>(below - modes.rigid_count), modes, clusters);
}

/// The solution with its first modes alone.
Solution with_first(Eigen::Index count, Solution solution) {
  keep_first(count, solution.modes, solution.summary);
  solution.extra_shapes.conservativeResize(Eigen::NoChange, count);
  solution.frequency_error.conservativeResize(count);
  return solution;
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
  refuse_what_cannot_fit(study, introduction, work);
}

/// Everything before the modes.
/// @param judged  what is too expensive to solve is refused
Solution placed_and_assembled(const study::Study& study, Introduction introduction, Work& work,
                              bool judged) {
  const auto progress = work.progress();
  throw_if_interrupted();
  if (judged) refuse_what_cannot_fit(study, introduction, work);
  Solution solution;
  solution.introduction = std::move(introduction);
  const auto& outline = solution.introduction.outline;
  auto body = work.timed("mesh", [&] { return body_of(study, outline, work); });
  if (judged) forecast_again(study, body, solution, work);
  solution.model = work.timed("places", [&] { return model_of(study, std::move(body)); });
  for (const auto& note : solution.model.notes) work.note(note);
  warn(solution.model.warnings, solution, work);
  warn(channels_kept_out(study, solution.model), solution, work);
  throw_if_interrupted();

  const auto& model = solution.model;
  tell(progress, "assembling");
  solution.system = work.timed("assembly", [&] {
    return std::make_shared<const fem::System>(
        fem::assemble(model.body, model.materials, study.supports, model.attachments));
  });
  solution.degrees_of_freedom = solution.system->dofs.free_count;
  return solution;
}

/// Stores the modes on all nodes, with the error that the mesh leaves in them.
void take(SolvedModes solved, Solution& solution) {
  const auto& dofs = solution.system->dofs;
  solution.summary = std::move(solved.result.summary);
  solution.modes = std::move(solved.result.modes);
  solution.frequency_error = std::move(solved.frequency_error);
  solution.ranks = std::move(solved.ranks);
  solution.extra_shapes = solution.modes.shapes(dofs.free_dof.tail(dofs.extra_count()), Eigen::all);
  solution.modes.shapes = fem::on_nodes(dofs, solution.modes.shapes);
}

void warn_of_modes(const study::Study& study, Solution& solution, Work& work) {
  warn(solution.summary.warnings, solution, work);
  warn(coarse_mesh(solution), solution, work);
  warn(left_out_dashpots(solution), solution, work);
  // A part of the work has the channels of the study, which is told of them itself.
  if (work.part().empty()) warn(blind_spots(study, solution), solution, work);
}

}  // namespace

std::string engine_of(const study::Study& study, const Work& work) {
  return work.choices().engine.empty() ? study.modes.engine : work.choices().engine;
}

void refuse_what_cannot_fit(const study::Study& study, const Introduction& introduction,
                            Work& work) {
  refuse_too_many_modes(study, introduction.body, introduction.cost);
  auto cost = introduction.cost;
  if (!engine_of(study, work).empty()) cost.memory_bytes = cost.memory_beside_ranks_bytes;
  const auto limit = work.choices().memory_limit_bytes;
  const auto have = static_cast<double>(limit > 0 ? limit : available_memory());
  if (fits(cost, have)) return;
  refuse(study, introduction, {.need_bytes = cost.memory_bytes, .have_bytes = have}, work);
}

Introduction introduced(const study::Study& study, Work& work) {
  require_modes(study);
  require(study.modes.mirrors.empty() || engine_of(study, work).empty(),
          study.file.string() +
              ": the ranks of --engine take the whole body; leave out modes.mirrors or the engine");
  Introduction introduction;
  introduction.warnings = study.warnings;
  for (const auto& warning : study.warnings) work.warn(warning);
  introduction.outline = outline_of(study, work.progress());
  require_faces(study, introduction.outline.shell);
  introduction.body = understood(study, introduction.outline);
  introduction.cost = forecast(study, introduction.outline);
  work.show(introduction.body.line() + "\n");
  for (const auto& note : introduction.outline.notes) work.note(note);
  const auto warn = [&](const std::string& warning) {
    introduction.warnings.push_back(warning);
    work.warn(warning);
  };
  for (const auto& warning : implausible(introduction.body)) {
    warn(study.file.string() + ": " + warning);
  }
  for (const auto& warning : unlikely_modes(study, introduction.body)) warn(warning);
  return introduction;
}

Solution assembled(const study::Study& study, Work& work) {
  auto introduction = work.timed("geometry", [&] { return introduced(study, work); });
  return placed_and_assembled(study, std::move(introduction), work, false);
}

Solution solved(const study::Study& study, Work& work) {
  auto introduction = work.timed("geometry", [&] { return introduced(study, work); });
  work.note(introduction.cost.line());
  return solved(study, std::move(introduction), work);
}

Solution solved(const study::Study& study, Introduction introduction, Work& work) {
  Solution solution = placed_and_assembled(study, std::move(introduction), work, true);
  auto solved = modes_of(study, solution, 0, work);
  if (study.modes.up_to_hz > 0.0) {
    auto& [modes, summary] = solved.result;
    keep_first(own_count(study, modes, summary.clusters), modes, summary);
    solved.frequency_error.conservativeResize(modes.mode_count());
  }
  take(std::move(solved), solution);
  warn_of_modes(study, solution, work);
  return solution;
}

TwoSolutions solved_with_more(const study::Study& study, int flexible, Work& work) {
  auto introduction = work.timed("geometry", [&] { return introduced(study, work); });
  study::Study larger = study;  // what is solved, for the forecasts
  larger.modes.count = std::max(study.modes.count, flexible);
  introduction.cost = forecast(larger, introduction.outline);
  work.note(introduction.cost.line());
  TwoSolutions both;
  both.with_more = placed_and_assembled(larger, std::move(introduction), work, true);
  take(modes_of(study, both.with_more, flexible, work), both.with_more);
  const auto& modes = both.with_more.modes;
  const auto& clusters = both.with_more.summary.clusters;
  both.own = with_first(own_count(study, modes, clusters), both.with_more);
  const auto enough = count_with(larger.modes.count, modes, clusters);
  if (enough < modes.mode_count()) both.with_more = with_first(enough, std::move(both.with_more));
  warn_of_modes(study, both.own, work);
  return both;
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
