#include "steps/observed.h"

#include <filesystem>
#include <memory>
#include <utility>

#include "base/error.h"

namespace chladni::steps {
namespace {

// One method of interpolation is enough: that of the study, else the default.
study::Study with_one_method(study::Study study) {
  if (!study.interpolation) study.interpolation.emplace();
  auto& methods = study.interpolation->methods;
  if (methods.empty()) methods.emplace_back("dynamic_residual");
  methods.resize(1);
  return study;
}

// Over the recordings: with the noise of the observer, and where that is learned, as it was stated.
void add_replays(const study::Study& study, const Observer& stated, const Recordings& recorded,
                 Observed& found, stage::Work& work) {
  const auto truth = true_filter(study, stated, work);
  const auto replayed = [&](const Observer& one) { return replay(study, one, recorded, truth); };
  found.replay = work.timed("replay", [&] { return replayed(found.observer); });
  if (found.observer.noise.is_learned()) {
    found.stated = work.timed("replay as stated", [&] { return replayed(stated); });
  }
}

void warn_of_limits(const Observed& found, stage::Work& work) {
  for (const auto& note : found.observer.notes) work.warn(note);
  if (found.replay) {
    for (const auto& note : found.replay->notes) work.warn(note);
  }
  if (found.loop) {
    for (const auto& note : found.loop->notes) work.warn(note);
  }
}

}  // namespace

void require_observer(const study::Study& study) {
  require(study.observer.has_value(),
          study.file.string() +
              ": there is no [observer]; expected one with [[observer.point]] and "
              "[[observer.disturbance]]");
  require(study.measurement && has_responses(*study.measurement),
          study.file.string() +
              ": an observer stands on an identified model; expected [measurement] with frf or "
              "time");
  const auto& plan = *study.measurement;
  for (const auto& path : {plan.frf, plan.time, study.observer->replay, study.observer->truth}) {
    require(path.empty() || std::filesystem::exists(path),
            path.string() + ": there is no such file" + study::source_text(plan));
  }
}

Observed observed(const study::Study& whole, const stage::Solution& solution, stage::Work& work) {
  require_observer(whole);
  const auto study = with_one_method(whole);
  const auto shapes = std::make_shared<const Interpolated>(interpolated(study, solution, work));
  std::optional<Recordings> recorded;
  if (has_recordings(study)) {
    recorded = recordings(study, *shapes->measured.identified, work);
  }
  const auto stated = observer(study, solution, shapes, recorded ? &*recorded : nullptr, work);
  Observed found{stated, {}, {}, {}};
  if (recorded && study.observer->learn_noise) {
    found.observer = work.timed("noise of the recordings",
                                [&] { return with_learned_noise(study, stated, *recorded); });
  }
  if (recorded && stated.judges > 0) add_replays(study, stated, *recorded, found, work);
  if (study.observer->loop) {
    found.loop = work.timed("loop", [&] { return loop_trial(study, found.observer, work); });
  }
  warn_of_limits(found, work);
  return found;
}

}  // namespace chladni::steps
