// Small signs for what is on the body.
#pragma once

#include <string>

#include "io/picture/canvas.h"

namespace chladni::picture {

/// A sign of `radius` px at `at`: sensors round, actuators triangular, all else square.
void draw_glyph(Canvas& canvas, const std::string& kind, const Eigen::Vector2d& at, double radius);

/// The order to draw glyphs in, so that those in one place are all seen: higher ones later.
[[nodiscard]] int glyph_layer(const std::string& kind);

}  // namespace chladni::picture
