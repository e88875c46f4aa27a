// A series of plates of one design, as a workshop measures them: every plate is of another board,
// none is uniform, and one sheet may be wrong.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/specimens.h"

namespace chladni::simulators {

struct PlateSeriesOptions {
  int specimens = 10, modes = 10;
  double stiffness_scatter = 0.10;  ///< of each elastic constant between plates, in ln
  double density_scatter = 0.04;
  /// Factors of what all plates share and the model lacks (thickness and modulus that vary over
  /// the plate, a glued label), and of what each plate has by itself. At 1 the frequencies are off
  /// by 1 to 2 % and by 0.3 to 0.5 %.
  double shared = 1.0, own = 1.0;
  bool shapes = true;  ///< with errors of 5 %, at nine sensors; else frequencies alone
  double least = 0.10, most = 0.20;  ///< |ln| of the wrong entry
};

struct PlateSeries {
  std::vector<diagnosis::Specimen> specimens;
  int odd = -1;             ///< the plate whose sheet is wrong; −1: none
  std::string odd_effect;   ///< "thickness" or "mass"
  double odd_change = 0.0;  ///< ln(true over written)
};

/// @param hidden  "none", "thickness", "mass"
/// Cost: 0.2 s for each specimen.
/// @throws InvalidInput  another word
[[nodiscard]] PlateSeries plate_series(unsigned seed, const std::string& hidden,
                                       const PlateSeriesOptions& options = {});

/// ln(measured over simulated) of each mode and plate, less the plates' own constants: what the
/// model is off by in all plates alike, and by itself, root mean square.
struct SeriesErrors {
  double shared = 0.0, own = 0.0;
};
[[nodiscard]] SeriesErrors errors_of_series(unsigned seed, const PlateSeriesOptions& options = {});

}  // namespace chladni::simulators
