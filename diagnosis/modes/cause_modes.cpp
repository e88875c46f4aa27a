#include "diagnosis/modes/cause_modes.h"

#include "base/error.h"

namespace chladni::diagnosis {

using Eigen::Index;

std::optional<RecordedModes> CauseModes::after(const Changes& changes) const {
  State state = state_of(problem_.structure());
  for (const auto& change : changes) change(state);
  return problem_.modes(state, false);
}

std::optional<RecordedModes> CauseModes::of(const std::vector<Supposed>& causes) const {
  try {
    Changes changes;
    for (const auto& cause : causes) changes.push_back(change_of(cause, problem_.structure()));
    return after(changes);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

void CauseModes::begin_at(const std::vector<Supposed>& causes) {
  changes_.clear();
  for (const auto& cause : causes) changes_.push_back(change_of(cause, problem_.structure()));
}

std::optional<RecordedModes> CauseModes::with_coordinate(const std::vector<Supposed>& causes,
                                                         Index c) const {
  std::size_t which = 0;
  for (Index first = causes[0].x.size(); first <= c; first += causes[++which].x.size()) {
  }
  try {
    auto changes = changes_;
    changes[which] = change_of(causes[which], problem_.structure());
    return after(changes);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace chladni::diagnosis
