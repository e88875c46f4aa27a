#include "stage/kept/solved_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "base/error.h"
#include "base/packed.h"
#include "base/sha256.h"
#include "fem/error_estimate.h"
#include "stage/kept/kept_content.h"
#include "stage/kept/modes_bytes.h"
#include "stage/mirrors.h"

namespace chladni::stage {
namespace {

bool reaches(const modal::Modes& modes, double up_to_hz) {
  return modes.frequency_hz.size() > 0 && modes.frequency_hz.tail<1>()(0) >= up_to_hz;
}

using Solve = std::function<fem::ModesResult(const fem::ModesOptions&)>;

/// Modes up to a frequency and some beyond: asks for more until one lies above it.
fem::ModesResult modes_beyond(const fem::System& system, double up_to_hz, fem::ModesOptions options,
                              const Solve& solve) {
  auto result = solve(options);
  const auto most = static_cast<int>(system.dofs.free_count / 4);
  while (!reaches(result.modes, up_to_hz) && options.count < most) {
    const double ratio = up_to_hz / result.modes.frequency_hz.tail<1>()(0);
    options.count =
        std::min(most, static_cast<int>(options.count * std::clamp(1.2 * ratio, 1.3, 4.0)) + 2);
    result = solve(options);
  }
  return result;
}

/// By this process, or by the ranks of MPI.
SolvedModes found(const Model& model, const fem::System& system, const ModesRequest& request,
                  Work& work) {
  const auto& options = request.options;
  if (!request.launcher.empty()) {
    auto result = cluster::modes_by_ranks(system,
                                          {.launcher = request.launcher,
                                           .count = options.count,
                                           .up_to_hz = request.up_to_hz,
                                           .guess_hz = request.guess_hz,
                                           .folder = work.choices().folder},
                                          work.progress());
    work.note(result.ranks.line());
    return {std::move(result.modes), {}, std::move(result.ranks)};
  }
  const auto mirrors = mirrors_of(model, system, request.mirrors);
  const Solve solve = [&](const fem::ModesOptions& asked) {
    return mirrors.empty() ? fem::modes(system, asked, work.progress())
                           : fem::modes_by_mirrors(system, mirrors, asked, work.progress());
  };
  const bool by_frequency = request.up_to_hz > 0.0;
  return {by_frequency ? modes_beyond(system, request.up_to_hz, options, solve) : solve(options),
          {},
          {}};
}

SolvedModes computed(const Model& model, const fem::System& system, const ModesRequest& request,
                     Work& work) {
  auto solved = work.timed("modes", [&] { return found(model, system, request, work); });
  tell(work.progress(), "estimating the error of the mesh");
  solved.frequency_error = work.timed("error_estimate", [&] {
    return fem::frequency_error(model.body, model.materials, system, solved.result.modes);
  });
  return solved;
}

/// The entries of one model: modes-MODEL-REQUEST-COUNT, where COUNT modes were found.
struct Entries {
  std::string model, request;

  Entries(const Model& body, const std::vector<fem::Support>& supports, const ModesRequest& wanted)
      : model("modes-" + fingerprint_of(body, supports, wanted).substr(0, 40) + "-"),
        request(sha256(Packed()
                           .add(wanted.options.count)
                           .add(wanted.up_to_hz)
                           .add(wanted.guess_hz)
                           .bytes())
                    .substr(0, 8) +
                "-") {}

  [[nodiscard]] std::string name(const modal::Modes& modes) const {
    return fmt::format("{}{}{:06}", model, request, modes.mode_count());
  }
};

std::optional<SolvedModes> read(const Cache& cache, const std::string& name, Eigen::Index dofs) {
  return kept_content(cache, name,
                      [&](const std::string& bytes) { return modes_of_bytes(bytes, dofs); });
}

bool suffice(const modal::Modes& modes, const ModesRequest& request) {
  return modes.mode_count() >= modes.rigid_count + request.options.count &&
         (request.up_to_hz <= 0.0 || reaches(modes, request.up_to_hz));
}

/// Modes of the same model for another request, with more modes than are wanted here.
std::optional<SolvedModes> first_of_more(const Cache& cache, const Entries& entries,
                                         Eigen::Index dofs, const ModesRequest& request,
                                         Work& work) {
  for (const auto& name : cache.names(entries.model)) {
    const auto count = std::atoi(name.substr(name.rfind('-') + 1).c_str());
    if (count < request.options.count) continue;
    auto more = read(cache, name, dofs);
    if (!more || !suffice(more->result.modes, request)) continue;
    auto& [modes, summary] = more->result;
    const auto all = modes.mode_count();
    if (request.up_to_hz <= 0.0) {
      keep_first(count_with(request.options.count, modes, summary.clusters), modes, summary);
      more->frequency_error.conservativeResize(modes.mode_count());
    }
    work.note(modes.mode_count() == all
                  ? "modes of an earlier run"
                  : fmt::format("modes of an earlier run, the first {} of its {}",
                                modes.mode_count(), all));
    return more;
  }
  return {};
}

std::optional<SolvedModes> kept(const Cache& cache, const Entries& entries, Eigen::Index dofs,
                                const ModesRequest& request, Work& work) {
  for (const auto& name : cache.names(entries.model + entries.request)) {
    auto same = read(cache, name, dofs);
    if (!same) continue;
    work.note("modes of an earlier run");
    return same;
  }
  if (!work.choices().keep_times) return {};  // --reproducible: the same bits, whatever is kept
  return first_of_more(cache, entries, dofs, request, work);
}

}  // namespace

SolvedModes solved_modes(const Model& model, const fem::System& system,
                         const std::vector<fem::Support>& supports, const ModesRequest& request,
                         Work& work) {
  const auto cache = work.choices().cache;
  if (!cache) return computed(model, system, request, work);
  const Entries entries(model, supports, request);
  const auto known = [&] { return kept(*cache, entries, system.dofs.free_count, request, work); };
  if (auto modes = work.timed("kept_modes", known)) return std::move(*modes);
  const Cache::Hold hold(*cache, entries.model, work.progress());
  if (auto modes = known()) return std::move(*modes);  // of a run that solved meanwhile
  auto solved = computed(model, system, request, work);
  const auto refused = cache->keep(entries.name(solved.result.modes), bytes_of(solved));
  if (!refused.empty()) work.note_once("the modes are not kept for later runs: " + refused);
  return solved;
}

Eigen::Index count_with(int flexible, const modal::Modes& modes,
                        const std::vector<fem::Cluster>& clusters) {
  Eigen::Index count = std::min(modes.mode_count(), modes.rigid_count + flexible);
  for (const auto& cluster : clusters) {
    if (cluster.first < count) count = std::max(count, cluster.first + cluster.size);
  }
  return count;
}

void keep_first(Eigen::Index count, modal::Modes& modes, fem::ModesSummary& summary) {
  modes.frequency_hz.conservativeResize(count);
  modes.damping_ratio.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
  modes.rigid_count = std::min(modes.rigid_count, count);
  summary.residual.conservativeResize(count);
  std::erase_if(summary.clusters,
                [&](const fem::Cluster& cluster) { return cluster.first + cluster.size > count; });
}

}  // namespace chladni::stage
