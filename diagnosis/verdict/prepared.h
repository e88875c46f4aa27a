// What a diagnosis has before it looks for causes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

struct Prepared {
  std::shared_ptr<const Structure> structure;  ///< its channels those that are measured
  Observed observed;                           ///< on all lines
  std::vector<std::string> notes;
  std::vector<Deviation> tolerable;  ///< of *structure
  /// Errors of its mode shapes: noise to the search, parameters to its last word.
  std::vector<Deviation> shapes;
  double response = 0.0;      ///< Tolerances::response, which they follow from
  double solver_error = 0.0;  ///< Problem::solver_error, likewise

  /// At most `lines` lines as the search sees them.
  [[nodiscard]] Observed for_search(int lines) const;
  /// As the last word does.
  [[nodiscard]] std::vector<Deviation> all_deviations() const;
};

/// @throws as diagnosed
[[nodiscard]] Prepared prepared(const Structure& structure, const modal::FrfSet& measured,
                                const Tolerances& tolerances);

}  // namespace chladni::diagnosis
