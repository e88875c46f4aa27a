#include "steps/priors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "priors/dynamic_residual.h"
#include "priors/simulated_lengths.h"
#include "stage/faces.h"
#include "steps/interpolation.h"
#include "study/problems.h"

namespace chladni::steps {
namespace {

constexpr double kStill = 1e-3;  // relative motion of a rigid-body mode
constexpr double kRidge = 0.05;  // change in ln
constexpr double kAlike = 10.0;  // [degrees] between the mean normals of patches
constexpr int kOrdinaryModes = 12;
constexpr Eigen::Index kMatchedOn = 400;  // points of the surface

// The mean normal of each named patch on the surface.
Points patch_normals(const placement::Sites& sites, const std::vector<int>& patches) {
  Points normals = Points::Zero(std::ssize(patches), 3);
  for (Eigen::Index i = 0; i < sites.count(); ++i) {
    const auto found = std::ranges::find(patches, sites.patch(i));
    if (found != patches.end()) {
      normals.row(found - patches.begin()) += sites.area(i) * sites.normal.row(i);
    }
  }
  normals.rowwise().normalize();
  return normals;
}

// Motions along different normals jump where two patches meet, which no smooth prior has: of them
// a length would be learned that is none.
void require_one_direction(const study::Study& study, const study::PriorsPlan& plan,
                           const mesh::TetMesh& body, const placement::Sites& sites) {
  if (plan.direction || plan.along_normal || plan.on.patches.size() < 2) return;
  std::vector<int> patches;
  for (const auto& name : plan.on.patches) {
    const auto place = std::ranges::find(body.patch_names, name) - body.patch_names.begin();
    patches.push_back(static_cast<int>(place));
  }
  const Points normals = patch_normals(sites, patches);
  study::Problems problems(study.file.string());
  for (std::size_t k = 1; k < patches.size() && problems.empty(); ++k) {
    const double cosine = normals.row(0).dot(normals.row(static_cast<Eigen::Index>(k)));
    const double apart = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
    if (apart <= kAlike) continue;
    problems.add(plan.on.line, plan.on.column,
                 fmt::format("priors.on: \"{}\" and \"{}\" look {:.0f} degrees apart, and motions "
                             "along different normals have no common length; name one of them, or "
                             "say direction = \"z\" for the motion along one axis (direction = "
                             "\"normal\" where they meet without an edge)",
                             plan.on.patches.front(), plan.on.patches[k], apart));
  }
  problems.throw_if_any();
}

priors::Learning learning_of(const study::PriorsPlan& plan, const Points& sample, unsigned seed) {
  priors::Learning how;
  how.merit = plan.by == "leave_one_out" ? priors::Merit::leave_one_out
                                         : priors::Merit::marginal_likelihood;
  how.noise_ratio = plan.noise_ratio;
  how.learn_noise = plan.learn_noise;
  how.length_range = priors::length_range(sample);
  how.seed = seed;
  return how;
}

void choose_modes(const study::Study& study, const stage::Solution& solution,
                  LearnedPriors& result) {
  const auto& modes = solution.modes;
  const auto& sites = result.surface.sites;
  const Eigen::Index flexible = modes.mode_count() - modes.rigid_count;
  require(result.plan.modes <= flexible,
          fmt::format("{}: priors.modes asks for {} flexible modes, but {} were computed; raise "
                      "modes.count",
                      study.file.string(), result.plan.modes, flexible));
  const auto wanted = result.plan.modes > 0
                          ? result.plan.modes
                          : static_cast<int>(std::min<Eigen::Index>(kOrdinaryModes, flexible));
  std::vector<double> rms;
  for (Eigen::Index j = modes.rigid_count; j < modes.rigid_count + wanted; ++j) {
    const double one =
        std::sqrt(sites.shapes.col(j).cwiseAbs2().dot(sites.area) / sites.area.sum());
    if (one * std::sqrt(solution.model.mass.mass_kg) > kStill) {
      result.columns.push_back(j);
      rms.push_back(one);
    } else {
      result.notes.push_back(
          fmt::format("mode {} ({:.2f} Hz) does not move the surface along its "
                      "direction; nothing is learned from it",
                      j + 1, modes.frequency_hz(j)));
    }
  }
  require(!result.columns.empty(),
          study.file.string() +
              ": no flexible mode moves the surface along its direction; choose "
              "other patches (priors.on) or another direction");
  result.rms = Eigen::Map<const Eigen::VectorXd>(rms.data(), std::ssize(rms));
}

LearnedAt learned_at(const LearnedPriors& result, Eigen::Index samples, unsigned seed) {
  const auto& sites = result.surface.sites;
  const auto rows = priors::spread_points(sites.position, samples);
  const Points sample = sites.position(rows, Eigen::all);
  const Eigen::MatrixXd values = sites.shapes(rows, result.columns);
  auto how = learning_of(result.plan, sample, seed);
  const auto modes = static_cast<Eigen::Index>(result.columns.size());
  LearnedAt at;
  at.samples = sample.rows();
  at.noise_dependence = Eigen::VectorXd::Zero(modes + 1);
  at.per_mode = priors::learned(result.kernel, sample, values, how);
  if (!how.learn_noise) {
    at.noise_dependence.head(modes) =
        priors::noise_dependence(at.per_mode, result.kernel, sample, values, how);
  }
  how.shared = true;
  const Eigen::MatrixXd alike = values * result.rms.cwiseInverse().asDiagonal();
  const auto shared = priors::learned(result.kernel, sample, alike, how);
  if (!how.learn_noise) {
    at.noise_dependence.tail<1>() =
        priors::noise_dependence(shared, result.kernel, sample, alike, how);
  }
  at.shared = shared.front();
  return at;
}

// Adds matched lengths, if channels look along the surface's own direction.
void add_matched(const stage::Solution& solution, const priors::Places& places,
                 LearnedPriors& result) {
  if (places.count() < 2 || result.kernel.parameter_count() != 1) return;
  const auto& surface = result.surface.sites;
  const auto rows = priors::spread_points(surface.position, kMatchedOn);
  priors::Task task;
  task.places = places.position;
  if (priors::spread_points(task.places, 2).size() < 2) return;  // all in one place
  task.surface = surface.position(rows, Eigen::all);
  task.area = Eigen::VectorXd::Ones(std::ssize(rows));
  const auto count = static_cast<Eigen::Index>(result.columns.size());
  result.matched_length.resize(count);
  result.expected_error.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double hz = solution.modes.frequency_hz(result.columns[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd spread =
        priors::coefficient_variances(solution.modes.frequency_hz, hz).cwiseSqrt();
    task.at_places = places.shapes * spread.asDiagonal();
    task.on_surface = surface.shapes(rows, Eigen::all) * spread.asDiagonal();
    const auto best = priors::expected_length(result.kernel, task);
    result.matched_length(i) = best.length;
    result.expected_error(i) = best.error;
    result.matched_at_bound.push_back(best.at_bound);
  }
}

// The frequency of a mode as text, or "all together".
std::string name_of(const stage::Solution& solution, const LearnedPriors& result,
                    Eigen::Index mode) {
  if (mode == std::ssize(result.columns)) return "all together";
  const auto column = result.columns[static_cast<std::size_t>(mode)];
  return fmt::format("{} ({:.2f} Hz)", column + 1, solution.modes.frequency_hz(column));
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Where no length fits the channels, that at the end of the range is none that was found.
void warn_of_matched(const stage::Solution& solution, LearnedPriors& result) {
  std::vector<std::string> none;
  for (std::size_t i = 0; i < result.matched_at_bound.size(); ++i) {
    if (!result.matched_at_bound[i]) continue;
    none.push_back(name_of(solution, result, static_cast<Eigen::Index>(i)));
  }
  if (none.empty()) return;
  result.warnings.push_back("matched lengths at the end of their range: " + joined(none) +
                            "; at the shortest one the channels do not resolve the mode");
}

void add_warnings(const stage::Solution& solution, LearnedPriors& result) {
  const auto& last = result.last();
  std::vector<std::string> bound;
  std::vector<std::string> ridge;
  for (Eigen::Index i = 0; i < last.noise_dependence.size(); ++i) {
    const bool is_mode = i < std::ssize(last.per_mode);
    const auto& one = is_mode ? last.per_mode[static_cast<std::size_t>(i)] : last.shared;
    if (!one.at_bound.empty()) {
      bound.push_back(name_of(solution, result, i) + ": " + joined(one.at_bound));
    }
    if (last.noise_dependence(i) > kRidge) ridge.push_back(name_of(solution, result, i));
  }
  if (!bound.empty()) {
    result.warnings.push_back("hyper-parameters at the end of their range: " + joined(bound));
  }
  warn_of_matched(solution, result);
  if (!ridge.empty()) {
    result.warnings.push_back(fmt::format(
        "on the ridge of sigma and length: {} of {} change by more than {:.0f} % when the noise "
        "ratio of {:.1g} becomes a hundred times as large; noise-free samples fix a combination of "
        "both, and more samples do not help. The matched length does not suffer from it",
        ridge.size(), last.noise_dependence.size(), 100.0 * kRidge, result.plan.noise_ratio));
  }
}

// The mode of the shortest length among those that the channels see; among all if they see none.
int most_complex_of(const LearnedPriors& result) {
  constexpr double kSeen = 0.5;  // largest part of a shape's square that may stay unknown
  const auto& modes = result.last().per_mode;
  const auto sees = [&](std::size_t i) {
    return result.expected_error.size() == 0 ||
           result.expected_error(static_cast<Eigen::Index>(i)) < kSeen;
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < modes.size(); ++i) {
    const bool shorter = modes[i].parameters(0) < modes[best].parameters(0);
    if (sees(i) != sees(best) ? sees(i) : shorter) best = i;
  }
  return static_cast<int>(best);
}

}  // namespace

LearnedPriors learned_priors(const study::Study& study, const stage::Solution& solution,
                             stage::Work& work) {
  study::PriorsPlan plan = study.priors.value_or(study::PriorsPlan{});
  const auto faces = stage::faces_of(study, solution.model.body, plan.on, "priors.on");
  const auto asked = plan;
  plan.direction = stage::direction_on(faces, plan);
  const auto scales = plan.per_axis ? priors::Scales::per_axis : priors::Scales::isotropic;
  LearnedPriors result(plan, priors::Kernel(priors::kernel_family(plan.kernel), scales));
  const auto progress = work.progress();
  tell(progress, "looking at the surface");
  const placement::Sampler sampler(solution.model.body, solution.modes, {plan.direction, 0.0});
  result.surface = stage::surface_on(sampler, faces);
  require_one_direction(study, asked, solution.model.body, result.surface.sites);
  result.notes = faces.notes;
  choose_modes(study, solution, result);
  work.timed("learning", [&] {
    for (const int samples : plan.samples) {
      tell(progress, fmt::format("learning from {} samples", samples));
      const auto count = std::min<Eigen::Index>(samples, result.surface.sites.count());
      const bool again = !result.by_samples.empty() && count <= result.last().samples;
      if (!again) result.by_samples.push_back(learned_at(result, count, work.seed()));
      if (result.last().samples >= samples) continue;
      result.notes.push_back(
          fmt::format("the surface has {} points that differ; {} samples cannot be had",
                      result.last().samples, samples));
    }
    const auto places = channels_on_surface(study, solution, result);
    add_matched(solution, places, result);
    add_channel_errors(solution, places, result);
    return 0;
  });
  result.most_complex = most_complex_of(result);
  add_warnings(solution, result);
  return result;
}

}  // namespace chladni::steps
