// chladni place STUDY: the best places of collocated pairs, and the quality of layouts.
#include "app/command.h"
#include "show/placement.h"
#include "steps/placement.h"

namespace chladni::app {
namespace {

void run_place(const study::Study& study, show::Run& run) {
  const stage::Solution solution = stage::solved(study, run);
  const steps::BestPlaces result = steps::best_places(study, solution, run);
  run.show(show::placement_table(solution, result, run.options().all));
  show::leave_placement(study, solution, result, run, true);
}

}  // namespace

constinit const Command place_command{
    .name = "place",
    .summary = "where the collocated pair belongs; layouts scored and chosen",
    .run = run_place,
};

}  // namespace chladni::app
