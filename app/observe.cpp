// chladni observe STUDY: the motion where no sensor is, from the sensors there are.
#include <filesystem>
#include <memory>

#include "app/command.h"
#include "base/error.h"
#include "show/observer.h"
#include "steps/observer_replay.h"

namespace chladni::app {
namespace {

void require_tables(const study::Study& study) {
  require(study.observer.has_value(),
          study.file.string() +
              ": there is no [observer]; expected one with [[observer.point]] and "
              "[[observer.disturbance]]");
  require(study.measurement && steps::has_responses(*study.measurement),
          study.file.string() +
              ": an observer stands on an identified model; expected [measurement] with frf or "
              "time");
  const auto& plan = *study.measurement;
  for (const auto& path : {plan.frf, plan.time, study.observer->replay, study.observer->truth}) {
    require(path.empty() || std::filesystem::exists(path),
            path.string() + ": there is no such file" + study::source_text(plan));
  }
}

// One method of interpolation is enough: that of the study, else the default.
study::Study with_one_method(study::Study study) {
  if (!study.interpolation) study.interpolation.emplace();
  auto& methods = study.interpolation->methods;
  if (methods.empty()) methods.emplace_back("dynamic_residual");
  methods.resize(1);
  return study;
}

void run_observe(const study::Study& whole, show::Run& run) {
  require_tables(whole);
  const auto study = with_one_method(whole);
  const stage::Solution solution = stage::solved(study, run);
  const auto shapes =
      std::make_shared<const steps::Interpolated>(steps::interpolated(study, solution, run));
  std::optional<steps::Recordings> recorded;
  if (steps::has_recordings(study)) {
    recorded = steps::recordings(study, *shapes->measured.identified, run);
  }
  const auto stated =
      steps::observer(study, solution, shapes, recorded ? &*recorded : nullptr, run);
  auto observer = stated;
  if (recorded && study.observer->learn_noise) {
    observer = run.timed("noise of the recordings",
                         [&] { return steps::with_learned_noise(study, stated, *recorded); });
  }
  show::ShownObserver shown{observer, {}, {}, {}};
  if (recorded && observer.judges > 0) {
    const auto truth = steps::true_filter(study, stated, run);
    const auto replayed = [&](const steps::Observer& one) {
      return steps::replay(study, one, *recorded, truth);
    };
    shown.replay = run.timed("replay", [&] { return replayed(observer); });
    if (observer.noise.is_learned()) {
      shown.stated = run.timed("replay as stated", [&] { return replayed(stated); });
    }
  }
  if (study.observer->loop) {
    shown.loop = run.timed("loop", [&] { return steps::loop_trial(study, observer, run); });
  }
  run.show(show::observer_table(shown));
  show::leave_observer(study, shown, run);
  steps::require_trust(*shapes->measured.identified);
}

}  // namespace

constinit const Command observe_command{
    .name = "observe",
    .summary = "the motion where no sensor is, by a Kalman filter on the identified model",
    .run = run_observe,
};

}  // namespace chladni::app
