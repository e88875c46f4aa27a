// The smallest effects that a table's measurement would find, as bench/README.md has them.
#pragma once

#include "diagnosis/detectable.h"
#include "simulators/hidden/hidden_effect.h"

namespace chladni {

/// A row per effect.
void print_detectable(const diagnosis::Structure& structure, const modal::FrfSet& measured,
                      const diagnosis::DiagnosisOptions& options);

/// The smallest mass anywhere with all tolerances, and without each of them in turn.
void print_bounds(const diagnosis::Structure& structure, const modal::FrfSet& measured,
                  const diagnosis::DiagnosisOptions& options);

/// Masses of some multiples of the smallest size hidden where seeds put them: how many a search
/// for masses finds.
void print_check(const diagnosis::Structure& structure, const diagnosis::DiagnosisOptions& options,
                 const simulators::HiddenOptions& hidden, unsigned first, unsigned seeds);

}  // namespace chladni
