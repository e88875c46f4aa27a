// Natural modes of an undamped structure, with a proof that none is missing.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "fem/system.h"
#include "modal/modes.h"

namespace chladni::fem {

struct ModesOptions {
  int count = 20;           ///< flexible modes; a cluster is never cut, so there may be more
  double shift_hz = 0.0;    ///< K + (2π shift)² M is factorised; 0: chosen from the system
  double tolerance = 1e-9;  ///< relative residual (fem/eigen/residual.h) asked of the iteration
  int block = 4;            ///< vectors per Lanczos step
  bool certificate = true;  ///< count the eigenvalues by inertia
  std::size_t memory_limit_bytes = 0;  ///< 0: what the machine has free
  unsigned seed = 1;                   ///< for the random start block
};

/// Neighbouring modes that are equal to within the solver's or the mesh's error.
struct Cluster {
  Eigen::Index first = 0, size = 1;  ///< columns of the modes
};

/// Accuracy, completeness and cost of a computation of modes.
struct ModesSummary {
  Eigen::VectorXd residual;    ///< per mode, relative (fem/eigen/residual.h)
  double orthogonality = 0.0;  ///< max |ΦᵀMΦ − I|
  bool complete = false;  ///< an inertia count proves that none below counted_below_hz is missing
  double counted_below_hz = 0.0;
  int counted = 0, found = 0;         ///< eigenvalues below counted_below_hz, with the rigid ones
  std::vector<Cluster> clusters;      ///< of two and more
  std::vector<std::string> warnings;  ///< residuals that are above 1e-9 and not refused
  int block_steps = 0, solves = 0;
  int restarts = 0;             ///< new start blocks after a count said that modes were missing
  int count_attempts = 0;       ///< shifts that were tried, in all counts together
  double forecast_bytes = 0.0;  ///< memory beside K and M, from the pattern alone
  double factor_bytes = 0.0, factor_seconds = 0.0, iterate_seconds = 0.0, certify_seconds = 0.0;
  std::string text;  ///< one line: "modes below 2000 Hz: 34 found, 34 counted"
};

struct ModesResult {
  modal::Modes modes;  ///< shapes on the free degrees of freedom, n×m
  ModesSummary summary;
};

/// Memory that `modes` needs beside K and M [bytes].
struct MemoryForecast {
  double total_bytes = 0.0;   ///< at the peak
  double factor_bytes = 0.0;  ///< of LLᵀ alone
};

/// From the pattern of K and M. The analysis is kept in the system for `modes`.
/// @throws Interrupted
[[nodiscard]] MemoryForecast memory_forecast(const System& system, const ModesOptions& options);

/// The factor does not fit: the forecast, and what there is.
class FactorTooLarge : public OutOfResources {
 public:
  FactorTooLarge(const std::string& what, MemoryForecast need, double have)
      : OutOfResources(what), forecast(need), have_bytes(have) {}
  MemoryForecast forecast;
  double have_bytes;
};

/// The rigid-body modes and the `count` lowest flexible ones of K φ = ω² M φ.
///
/// The method is block shift-invert Lanczos with full reorthogonalisation (Grimes, Lewis and Simon
/// 1994) on a sparse factorisation of K + s M. The rigid-body modes are known from the geometry:
/// they are deflated and returned as they are. An inertia count of K − σM proves that no mode is
/// missing. Where a mode is missing, the iteration goes on with a new start block. Repeated modes
/// have a canonical orientation (docs/reference/modes.md); each flexible shape has its largest
/// entry positive.
///
/// @throws InvalidInput      K and M differ in shape, or there are fewer than `count` modes
/// @throws FactorTooLarge    what it needs does not fit (forecast from the symbolic analysis)
/// @throws NumericalFailure  M is not positive definite, K not semidefinite; a motion costs no
///                           energy and is not among system.rigid (a mechanism); a residual is 1e-4
///                           or more; the eigenvalues cannot be counted; modes are still missing
///                           after the restarts
/// @throws Interrupted       within about a second; later while CHOLMOD factorises a part of a
///                           large system (a subtree per core, then what is above), and where METIS
///                           finds the order and the program chladni-order is not installed
[[nodiscard]] ModesResult modes(const System& system, const ModesOptions& options = {},
                                const Progress& progress = {});

}  // namespace chladni::fem
