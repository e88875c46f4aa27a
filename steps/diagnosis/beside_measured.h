// The simulation on the channels and lines that were measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/modal_fit.h"
#include "steps/compared.h"

namespace chladni::steps {

/// Rows of the channels in a list of names.
[[nodiscard]] std::vector<Eigen::Index> places(const std::vector<modal::MeasuredChannel>& channels,
                                               const std::vector<std::string>& names);

/// Prediction of a study on the measured channels and lines, in the form that `recorder` records
/// them. If a sensor's quantity differs, its row is multiplied by a power of s.
[[nodiscard]] std::vector<Eigen::MatrixXcd> predicted(const study::Study& study,
                                                      const diagnosis::Structure& structure,
                                                      const study::Study& recorder,
                                                      const modal::FrfSet& measured);

struct ComparedResponses {
  std::optional<identification::ModalFit> fit;  ///< modes of what was measured
  bool scaled = true;    ///< false: no units are stated, and the scale is that of the simulation
  double band_hz = 0.0;  ///< the last line
};
/// Fills all of `one` but `before`, which it has, and `modes`. @throws as its steps
[[nodiscard]] ComparedResponses compare_responses(const study::Study& study, MeasuredFrfs measured,
                                                  Compared& one, stage::Work& work);

/// Fills `modes` and `structure`. Returns the highest frequency. @throws as its steps
[[nodiscard]] double compare_modes(const study::Study& study, const diagnosis::MeasuredModes& all,
                                   Compared& one, stage::Work& work);

}  // namespace chladni::steps
