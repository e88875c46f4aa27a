// The modes of a structure with causes of which one is changed at a time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

class CauseModes {
 public:
  /// @param problem  must outlive it
  explicit CauseModes(const ModesProblem& problem) : problem_(problem) {}

  /// Modes with these causes; none if no body is like this. Cost: one eigenproblem.
  [[nodiscard]] std::optional<RecordedModes> of(const std::vector<Supposed>& causes) const;

  /// Keeps what each of these causes changes. @throws NumericalFailure  it is impossible
  void begin_at(const std::vector<Supposed>& causes);
  /// Modes with causes of which only the one that has coordinate c differs from those kept.
  /// Cost: one eigenproblem, but one for all coordinates that change channels alone.
  [[nodiscard]] std::optional<RecordedModes> with_coordinate(const std::vector<Supposed>& causes,
                                                             Eigen::Index c);

 private:
  using Changes = std::vector<std::function<void(State&)>>;
  [[nodiscard]] State after(const Changes& changes) const;

  const ModesProblem& problem_;
  Changes changes_;
  State kept_;  // after all of them
  std::optional<BodyModes> modes_of_kept_;
};

}  // namespace chladni::diagnosis
