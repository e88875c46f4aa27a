// What a fit does not know, on its way through a match.
#pragma once

#include "identification/gains/matching.h"

namespace chladni::identification {

/// Replaces each variance that is not known by one that is finite and carries no information.
void bound_unknown(ModalFit& fit);

/// Values and variances that the fit does not know stay unknown after the match.
void mark_unknown(const ModalFit& fit, Matching& state);

}  // namespace chladni::identification
