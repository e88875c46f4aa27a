// The style sheets and scripts of the report, built into the program.
#pragma once

#include <string_view>

namespace chladni::io {

extern const std::string_view page_css;
extern const std::string_view page_js;    ///< what the others share
extern const std::string_view viewer_js;  ///< the body that turns
extern const std::string_view tables_js;  ///< copies of tables
extern const std::string_view plot_js;    ///< ticks, marks and curves as SVG
extern const std::string_view curves_js;  ///< curves by uPlot

/// uPlot as it was released (vendor/uplot), and its licence.
extern const std::string_view uplot_css, uplot_js, uplot_licence;

}  // namespace chladni::io
