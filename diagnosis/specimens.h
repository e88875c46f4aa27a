// Several specimens of one design, diagnosed together: which one differs from what is written of
// it, beside constants that scatter and errors that all models of the design share.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/calibrated.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/measured_modes.h"

namespace chladni::diagnosis {

/// One specimen, or one measurement of it.
struct Specimen {
  std::string name;
  std::string
      group;  ///< specimens of one group are more alike, such as halves of a board; or empty
  /// The specimen that was measured before, with another known modification: constants, entries and
  /// model-form errors are the same. Empty: a specimen of its own.
  std::string same_as;
  Structure structure;
  MeasuredModes measured;  ///< its frequencies are compared; shapes help to pair the modes
  /// What is written of it. A `measured` number is an entry that may be a blunder, any other one a
  /// constant that each specimen has from one population. Beside the effects of CalibratedConstant:
  /// "mass" [kg], and "length_along_u", "length_along_v" [m] of a rectangular plate.
  std::vector<CalibratedConstant> constants;
};

/// An entry of a specimen that may be wrong.
struct OddEntry {
  std::string specimen, key, effect, unit;
  double of_study = 0.0;          ///< as written, in `unit`
  double value = 0.0, std = 0.0;  ///< what the data have instead, supposed that it is wrong
  double probability = 0.0;       ///< that it is wrong
  double log_evidence = 0.0;      ///< of this one entry against none

  /// Relative change from what is written.
  [[nodiscard]] double change() const { return value / of_study - 1.0; }
};

/// One answer: some wrong entries, or a specimen that is not of this design.
struct SpecimensExplanation {
  std::vector<OddEntry> entries;
  std::string unlike;         ///< a specimen whose constants or modes no entry explains; or empty
  bool by_modes = false;      ///< the frequencies of `unlike` scatter; else its constants differ
  double log_evidence = 0.0;  ///< against "none"
  double probability = 0.0;
};

/// The population of a constant.
struct PopulationConstant {
  std::string name, unit, effect;
  double mean = 0.0, std = 0.0;  ///< in `unit`
  double spread = 0.0;  ///< relative deviation of a specimen; of a group, where there are some
  double within_group = 0.0;  ///< relative deviation inside a group; 0: there are no groups
  bool determined = true;     ///< false: these data tell nothing of the mean
};

struct SpecimenTold {
  std::string name, group, same_as;
  std::vector<CalibratedNumber> constants;  ///< entries among them, under the best explanation
  std::vector<ModeTold> modes;  ///< `after_hz` with these constants and the shared error
  double scatter = 0.0;         ///< root mean square of ln(measured over simulated), after both
};

struct SpecimensDiagnosis {
  Verdict verdict = Verdict::unexplained;
  SpecimensExplanation best;                 ///< no entries where none is needed
  std::vector<SpecimensExplanation> rivals;  ///< descending, without the best
  double none = 0.0;                         ///< probability that every entry is right
  std::vector<OddEntry> entries;             ///< all that may be wrong, the most probable first
  std::vector<SpecimenTold> specimens;
  std::vector<PopulationConstant> population;
  double shared_error = 0.0;  ///< of ln f, level of what all specimens share in a mode
  double own_error = 0.0;     ///< of ln f, level of what each mode of a specimen has by itself
  std::string measure_next;
  std::vector<Proposal> proposals;  ///< best first
  std::vector<std::string> notes;
};

/// @throws InvalidInput  fewer than two specimens; a name that stands twice or is not known; a
///                       specimen without modes or constants; a deviation that is not above 0
void check(const std::vector<Specimen>& specimens);

/// Which entries of which specimens contradict the frequencies of all. The model is linear in the
/// logarithms near the most probable constants, and is linearised again there:
///
///   ln f = ln f(model) + slopes · constants + e(mode) + d(specimen, mode) + noise,
///   constants = mean + group + specimen, entries = written + deviation or blunder.
///
/// e, d, groups and specimens are normal with levels that are learned under each hypothesis; a
/// hypothesis says which entries are blunders, and its evidence is Laplace's in the logarithms of
/// the levels. Source: Behmanesh, Moaveni, Lombaert and Papadimitriou, Mech. Syst. Signal Process.
/// 64 (2015) for the population; MacKay, Neural Computation 4 (1992) for the levels; Mitchell and
/// Beauchamp, J. Am. Stat. Assoc. 83 (1988) for deviation or blunder.
/// Cost: 1 s for each specimen, 10 s for ten specimens of ten modes and four entries.
/// @throws InvalidInput  as check; a specimen with fewer than two modes in common with its model
[[nodiscard]] SpecimensDiagnosis diagnosed(const std::vector<Specimen>& specimens,
                                           const DiagnosisOptions& options = {});

}  // namespace chladni::diagnosis
