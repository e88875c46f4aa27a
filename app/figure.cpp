// chladni figure RESULTS: figures for a paper from results that are there.
#include <algorithm>
#include <ostream>

#include "app/command.h"
#include "base/error.h"
#include "io/json.h"
#include "show/figures.h"

namespace chladni::app {
namespace {

bool has_format(const Figures& asked, const char* format) {
  return std::ranges::count(asked.formats, format) > 0;
}

}  // namespace

int figure(const Figures& asked, std::ostream& results) {
  const show::FiguresWanted wanted{.folder = show::results_folder(asked.results),
                                   .output = asked.output,
                                   .names = asked.names,
                                   .print = {.width_mm = asked.width_mm,
                                             .dpi = asked.dpi,
                                             .svg = has_format(asked, "svg"),
                                             .png = has_format(asked, "png")}};
  require(!asked.list || wanted.names.empty(),
          "--list tells all figures; expected no NAME with it");
  const auto figures =
      asked.list ? show::figures_in(wanted.folder, wanted.print) : show::draw_figures(wanted);
  results << (asked.json ? io::text(show::figures_json(wanted.folder, figures))
                         : show::figures_text(figures));
  return 0;
}

}  // namespace chladni::app
