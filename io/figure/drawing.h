// Flat shapes and words at pixel positions, for the painter.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/bytes/message.h"
#include "io/figure/colours.h"

namespace chladni::io {

/// A drawing. Later shapes lie above earlier ones, and words lie above all shapes. Places are in
/// pixels from the upper left corner.
class Drawing {
 public:
  Drawing(double width, double height) : width_(width), height_(height) {}

  using Path = std::vector<Eigen::Vector2d>;
  enum class Align { left, centre, right };

  /// Lines through points, all of one colour and width [px].
  void lines(const std::vector<Path>& paths, const Colour& colour, double width);
  /// Filled convex polygons of one colour.
  void polygons(const std::vector<Path>& paths, const Colour& colour);
  /// Words with the left end, middle or right end of the baseline at `at`.
  /// @param upwards  rotated, to be read from below
  void text(const Eigen::Vector2d& at, const std::string& words, double size, const Colour& colour,
            Align align = Align::left, bool bold = false, bool upwards = false);

  /// The request to the painter (io/picture/pictures.h, `drawing`).
  [[nodiscard]] Message request() const;

 private:
  void add(const char* kind, const std::vector<Path>& paths, const Colour& colour, double width);

  double width_, height_;
  JsonArray shapes_, texts_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<std::int32_t> counts_;  // points of each path
};

/// The approximate width of the words [px].
[[nodiscard]] double text_width(const std::string& words, double size);

}  // namespace chladni::io
