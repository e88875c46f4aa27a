// The head of a picture.
#pragma once

#include <string>

#include "io/picture/canvas.h"

namespace chladni::picture {

/// One line between the margins: smaller letters, then fewer, until the words fit [px].
void paint_title(Canvas& canvas, std::string words, double margin, double width);

}  // namespace chladni::picture
