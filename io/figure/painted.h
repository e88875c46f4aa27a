// The painter's answer to a request.
#pragma once

#include <string>

#include "io/bytes/message.h"
#include "io/figure/drawing.h"
#include "io/picture_file.h"

namespace chladni::io {

/// The PNG that the program chladni-painter makes from `request` (io/picture/pictures.h).
/// @throws WorkerDied  the painter or Xvfb is missing or died (says which package), or gave no PNG
[[nodiscard]] std::string painted(const Message& request);

/// Leaves the drawing as `file` asks for it: on the screen a PNG, on request an SVG; for paper in
/// its width, the PNG with its resolution stated.
/// @throws InvalidInput  a PNG for paper is larger than the painter makes, and nothing is left;
/// says
///                       which resolution is possible
/// @throws as painted, if there is no queue
void leave_drawing(const PictureFile& file, const Drawing& drawing);

}  // namespace chladni::io
