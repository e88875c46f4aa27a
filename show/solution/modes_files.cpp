#include <fmt/format.h>

#include "base/error.h"
#include "io/csv.h"
#include "io/picture.h"
#include "io/vtu.h"
#include "show/control_models.h"
#include "show/modes_uff.h"
#include "show/solution.h"

namespace chladni::show {

void leave_modes(const study::Study& study, const stage::Solution& solution, Run& run) {
  const auto& model = solution.model;
  const auto& modes = solution.modes;
  const auto markers = stage::markers_of(study, model);
  run.leave("modes.json", modes_json(study, solution), true);
  io::write_csv(run / "modes.csv", modes_columns(solution));
  io::write_modes_vtu(run / "modes.vtu", model.body, modes, study.title);
  leave_modes_uff(study, solution, run);
  if (!markers.empty()) io::write_markers_vtu(run / "channels.vtu", markers);
  if (const int mode = run.options().animate; mode > 0) {
    require(mode <= modes.mode_count(), "--animate " + fmt::to_string(mode) + ": there are " +
                                            fmt::to_string(modes.mode_count()) + " modes");
    io::write_animation(run / "modes.pvd", model.body, modes, mode - 1);
  }
  leave_control_models(study, solution, run);
  if (modes.mode_count() == modes.rigid_count) {
    if (run.options().pictures) run.note("modes.png is not painted: no flexible mode was found");
    return;
  }
  if (run.options().pictures) tell(run.progress(), "painting the modes");
  run.paint("modes.png", [&](const auto& png) {
    io::draw_modes(png, model.body, modes, study.title, markers, 9, solution.summary.clusters);
  });
}

}  // namespace chladni::show
