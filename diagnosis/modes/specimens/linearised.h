// Each specimen's model near its most probable constants, and the numbers of all of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/modes/given.h"
#include "diagnosis/modes/modes_fit.h"
#include "diagnosis/modes/specimens/joint.h"
#include "diagnosis/modes/specimens/series.h"

namespace chladni::diagnosis {

/// A measurement of a specimen beside its model.
struct SpecimenModel {
  Given given;
  std::vector<HeldConstant> held;         ///< constants and entries that the model has
  std::vector<CalibratedConstant> sheet;  ///< mass and lengths
  std::unique_ptr<ModesProblem> problem;
  Eigen::Index body = 0;
  ModesFit fit;                       ///< its constants, modes and pairs
  std::vector<Eigen::Index> of_mode;  ///< of the model: the mode of the design
};

class SpecimenModels {
 public:
  /// Calibrates each specimen by itself, to pair its modes. @throws InvalidInput as diagnosed
  SpecimenModels(const std::vector<Specimen>& specimens, const DiagnosisOptions& options);

  /// The numbers of all, linear at the present constants.
  [[nodiscard]] Series series() const;
  /// Takes the constants that a joint fit has, and pairs the modes again.
  void move_to(const Series& series, const JointModel& model, const JointFit& fit);

  [[nodiscard]] const std::vector<std::unique_ptr<SpecimenModel>>& all() const { return models_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void start_from_the_others();
  void number_the_modes();

  const std::vector<Specimen>& specimens_;
  std::vector<std::unique_ptr<SpecimenModel>> models_;
  std::vector<std::string> notes_;
  Eigen::Index modes_ = 0;
};

}  // namespace chladni::diagnosis
