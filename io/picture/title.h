// The head of a picture.
#pragma once

#include <string>

#include "io/picture/canvas.h"

namespace chladni::picture {

/// Paints one line between the margins [px]. The letters get smaller, then the words are cut, until
/// the line fits.
void paint_title(Canvas& canvas, const std::string& words, double margin, double width);

}  // namespace chladni::picture
