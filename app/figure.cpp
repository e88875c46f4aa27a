// chladni figure RESULTS: figures for a paper from results that are there.
#include <fmt/format.h>

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
  require(40.0 <= asked.width_mm && asked.width_mm <= 400.0,
          fmt::format("a figure of {:.6g} mm; expected a width of 40 to 400 mm", asked.width_mm));
  require(50.0 <= asked.dpi && asked.dpi <= 1200.0,
          fmt::format("{:.6g} pixels per inch; expected 50 to 1200", asked.dpi));
  for (const auto& format : asked.formats) {
    require(format == "svg" || format == "png",
            "the format \"" + format + "\" is not known; expected svg or png");
  }
  require(!asked.formats.empty(), "no format is asked for; expected svg, png or both");
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
