// Modes by the ranks of MPI: a body whose factor is too large for one machine.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "fem/modes.h"
#include "fem/system.h"

namespace chladni::cluster {

struct RanksOptions {
  std::string launcher = {};  ///< what starts the ranks: "mpiexec -n 4", "srun -N 8"
  int count = 20;             ///< flexible modes; a cluster is never cut
  double up_to_hz = 0.0;  ///< all modes below this, and at least one flexible one; 0: use `count`
  double guess_hz = 0.0;  ///< about `count` modes lie below this; 0: from the system
  /// It exists and all ranks see it; empty: that of temporary files.
  std::filesystem::path folder = {};
};

/// What the ranks tell of themselves.
struct RanksSummary {
  std::string launcher;
  std::vector<double> peak_bytes;  ///< resident, one per rank
  int shifts = 0;                  ///< about which the spectrum was sliced
  double seconds = 0.0;            ///< wall time of the ranks
  /// "4 ranks: 3 shifts, 12.3 s, up to 410 MB each"
  [[nodiscard]] std::string line() const;
};

struct RanksResult {
  fem::ModesResult modes;
  RanksSummary ranks;
};

/// The modes of `system` as fem::modes returns them, found by `launcher chladni-slepc ...`: SLEPc's
/// Krylov-Schur slices the spectrum below a bound, and MUMPS counts the eigenvalues there. K and M
/// go over in PETSc's binary files, and the modes come back in files (cluster/reply.h). They lie in
/// a folder of their own, which is removed. Of the reply only the count is believed
/// (fem::checked_modes).
///
/// @throws InvalidInput    an empty launcher
/// @throws WorkerDied      there is no such launcher, or this build has no chladni-slepc; a rank
///                         died; the launcher gave up (its reason, and what helps where that is
///                         known); the reply cannot be used (UnusableReply)
/// @throws OutOfResources  PETSc or MUMPS had no memory; the disk is full
/// @throws NumericalFailure  as fem::checked_modes
/// @throws Interrupted     Ctrl-C; the ranks are ended
/// Cost of this process: K, M and four times the shapes in memory; K, M and twice the shapes on
/// disk.
[[nodiscard]] RanksResult modes_by_ranks(const fem::System& system, const RanksOptions& options,
                                         const Progress& progress = {});

}  // namespace chladni::cluster
