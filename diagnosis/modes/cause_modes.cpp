#include "diagnosis/modes/cause_modes.h"

#include "base/error.h"

namespace chladni::diagnosis {

using Eigen::Index;

State CauseModes::after(const Changes& changes) const {
  State state = state_of(problem_.structure());
  for (const auto& change : changes) change(state);
  return state;
}

std::optional<RecordedModes> CauseModes::of(const std::vector<Supposed>& causes) const {
  try {
    Changes changes;
    for (const auto& cause : causes) changes.push_back(change_of(cause, problem_.structure()));
    return problem_.modes(after(changes), false);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

void CauseModes::begin_at(const std::vector<Supposed>& causes) {
  changes_.clear();
  for (const auto& cause : causes) changes_.push_back(change_of(cause, problem_.structure()));
  kept_ = after(changes_);
  modes_of_kept_.reset();
}

std::optional<RecordedModes> CauseModes::with_coordinate(const std::vector<Supposed>& causes,
                                                         Index c) {
  std::size_t which = 0;
  for (Index first = causes[0].x.size(); first <= c; first += causes[++which].x.size()) {
  }
  try {
    auto changes = changes_;
    changes[which] = change_of(causes[which], problem_.structure());
    const State state = after(changes);
    if (!have_same_body(state, kept_)) return problem_.modes(state, false);
    if (!modes_of_kept_) modes_of_kept_ = problem_.body_modes(kept_, false);
    return modes_of_kept_ ? ModesProblem::modes(state, *modes_of_kept_) : std::nullopt;
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace chladni::diagnosis
