// What helps where a solution does not fit the memory, with figures that are computed for the
// study.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "stage/solution.h"

namespace chladni::stage {

/// One change with which the study fits.
struct Remedy {
  std::string kind;            ///< "coarser mesh", "cubic cells", "mirror symmetry" or "ranks"
  double edge_length_m = 0.0;  ///< for mesh.edge_length; 0: stays
  int order = 0;               ///< for mesh.order; 0: stays
  std::vector<std::string> mirrors = {};  ///< for modes.mirrors; empty: stay
  std::string engine = {};                ///< for --engine; empty: none
  double degrees_of_freedom = 0.0;        ///< with the change
  double memory_bytes = 0.0;              ///< of this process at the peak, with the change
  /// No wanted frequency is further above the converged one than this part of it; where nothing
  /// small enough to be solved tells, it is not known.
  std::optional<double> frequency_error = {};
  double highest_hz = 0.0;  ///< the highest wanted frequency, where the error is known
  int ranks = 0;            ///< that share the factor
  double rank_bytes = 0.0;  ///< of each rank at the peak

  /// What to write, and what it gives: a line.
  [[nodiscard]] std::string line() const;
};

/// "12.3 mm", as a study has it.
[[nodiscard]] std::string millimetres(double metres);

/// A solution that does not fit.
struct Shortage {
  double need_bytes = 0.0, have_bytes = 0.0;
  /// Size of the factor; known where the system was analysed.
  std::optional<double> factor_bytes = {};
};

/// What fits, the best of each kind: a coarser mesh of the same elements, cubic elements on a
/// coarser mesh, mirrored parts where the body with all that is attached to it has mirror planes
/// (of the study's own mesh, or of the finest that fits so), ranks of MPI that share the factor.
///
/// The memory of a mesh is that of its own matrices by the analysis of their pattern; above 300 000
/// degrees of freedom it is that of a coarser mesh times the 1.4th power of the ratio, more than
/// plates and compact bodies need (docs/reference/cluster.md). The error is the estimate of
/// fem/error_estimate.h on the mesh itself; above 25 000 degrees of freedom that of two coarser
/// meshes, of which no more is taken to fall further than the rate of the elements (2·order)
/// explains. A tenth of the memory is kept free.
/// Cost: some seconds; half a minute where millions of degrees of freedom fit.
/// @throws Interrupted
[[nodiscard]] std::vector<Remedy> remedies(const study::Study& study,
                                           const Introduction& introduction,
                                           const Shortage& shortage, Work& work);

/// A study whose solution does not fit, and what helps.
class DoesNotFit : public OutOfResources {
 public:
  DoesNotFit(const std::string& what, std::vector<Remedy> ways)
      : OutOfResources(what), remedies(std::move(ways)) {}
  std::vector<Remedy> remedies;
};

/// @throws DoesNotFit
[[noreturn]] void refuse(const study::Study& study, const Introduction& introduction,
                         const Shortage& shortage, Work& work);

}  // namespace chladni::stage
