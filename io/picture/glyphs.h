// Small signs for channels and attachments on the body.
#pragma once

#include <cstddef>
#include <string>

#include "io/picture/canvas.h"

namespace chladni::picture {

/// Draws a sign of `radius` px at `at`: sensors are round, those that are held out hollow,
/// actuators are triangles, all others are squares.
void draw_glyph(Canvas& canvas, const std::string& kind, const Eigen::Vector2d& at, double radius);

/// "1 sensor", "2 masses", "3 torsion springs".
[[nodiscard]] std::string counted_glyphs(const std::string& kind, std::size_t count);

/// The layer of a glyph. Higher layers are drawn later, so that all glyphs at one place are seen.
[[nodiscard]] int glyph_layer(const std::string& kind);

}  // namespace chladni::picture
