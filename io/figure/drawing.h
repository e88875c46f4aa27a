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
  /// @param finer  pixels of the picture for one of the drawing
  [[nodiscard]] Message request(double finer = 1.0) const;
  /// The same as SVG 1.1, on white, words as text. Coordinates are rounded to 0.01 px.
  /// @param width_mm  of the whole on paper; 0: one pixel of a screen for each
  [[nodiscard]] std::string svg(double width_mm = 0.0) const;
  [[nodiscard]] double width() const { return width_; }
  /// Width and height of the picture that request() asks for: whole numbers [px].
  [[nodiscard]] Eigen::Vector2d pixels(double finer = 1.0) const;

 private:
  struct Shape {
    bool filled = false;
    Colour colour;
    double width = 0.0;
    std::vector<Path> paths;
  };
  struct Words {
    Eigen::Vector2d at;
    std::string words;
    double size = 0.0;
    Colour colour;
    Align align = Align::left;
    bool bold = false, upwards = false;
  };

  [[nodiscard]] JsonArray texts_json(double finer) const;

  double width_, height_;
  std::vector<Shape> shapes_;
  std::vector<Words> texts_;
};

/// The approximate width of the words [px].
[[nodiscard]] double text_width(const std::string& words, double size);

}  // namespace chladni::io
