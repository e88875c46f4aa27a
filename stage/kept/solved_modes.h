// Modes that are solved, or taken from an earlier run that solved the same.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluster/ranks.h"
#include "fem/modes.h"
#include "stage/model.h"
#include "stage/work.h"

namespace chladni::stage {

/// Which modes of a model are wanted.
struct ModesRequest {
  fem::ModesOptions options;         ///< its count: of flexible modes, at least
  double up_to_hz = 0.0;             ///< at least one flexible mode beyond this; 0: use the count
  std::string launcher;              ///< what starts the ranks that find them; empty: this process
  std::vector<std::string> mirrors;  ///< axes across which the body is mirrored
  double guess_hz = 0.0;             ///< for the ranks: about so many modes lie below
};

struct SolvedModes {
  fem::ModesResult result;          ///< shapes on the free degrees of freedom
  Eigen::VectorXd frequency_error;  ///< per mode (fem/error_estimate.h)
  std::optional<cluster::RanksSummary> ranks;
};

/// Solves, and keeps the result in the cache of `work`, where it has one; or takes it from there
/// where the same bodies, materials, supports and attachments were solved by the same code on as
/// many threads. Modes that are taken have the same bits as those that were solved. Where times are
/// kept (`work.choices().keep_times`), a longer list of modes serves too, and its first ones are
/// taken: they agree with those of a shorter list to the solver's tolerance, not to the last bit.
/// @throws as fem::modes and cluster::modes_by_ranks; never because of what is kept
[[nodiscard]] SolvedModes solved_modes(const Model& model, const fem::System& system,
                                       const std::vector<fem::Support>& supports,
                                       const ModesRequest& request, Work& work);

/// Number of the `flexible` lowest modes with the rigid-body ones; a repeated mode is not cut.
[[nodiscard]] Eigen::Index count_with(int flexible, const modal::Modes& modes,
                                      const std::vector<fem::Cluster>& clusters);

/// Leaves the first `count` modes.
void keep_first(Eigen::Index count, modal::Modes& modes, fem::ModesSummary& summary);

}  // namespace chladni::stage
