// The blocks of a report as HTML.
#pragma once

#include <string>

#include "io/report.h"

namespace chladni::io {

/// Appends the block to the page, its text escaped.
void append(std::string& page, const Block& block);

/// A figure for curves.js: the controls, an empty place for the panes, and the data as JSON.
void append_curves(std::string& page, const Curves& curves);

/// @throws InvalidInput  there are no choices, an array is not as long as its x, or a choice has
///                       another number of arrays than the series need
void check_curves(const Curves& curves);

}  // namespace chladni::io
