// The style sheet and the script of the report, built into the program.
#pragma once

#include <string_view>

namespace chladni::io {

extern const std::string_view page_css;
extern const std::string_view page_js;

}  // namespace chladni::io
