// The window for painting a picture, with text and flat shapes.
#pragma once

#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "io/figure/colours.h"

namespace chladni::picture {

using io::Colour;

inline constexpr Colour kWhite{1.0, 1.0, 1.0}, kInk{0.13, 0.14, 0.16}, kGrey{0.45, 0.47, 0.50},
    kPale{0.78, 0.79, 0.81};

struct TextStyle {
  double size = 20.0;  ///< height of a capital letter and its leading [px]
  Colour colour = kInk;
  bool bold = false;
  enum class Align { left, centre, right } align = Align::left;
  bool upwards = false;  ///< rotated by a quarter turn, to be read from below
};

/// A white offscreen canvas. Places are in pixels of the finished picture from its upper left
/// corner. The picture is painted twice as large and averaged, so that lines and letters are smooth
/// on every machine.
class Canvas {
 public:
  /// @throws InvalidInput  a side is below 1 px or above 8192
  Canvas(int width, int height);

  /// A part of the canvas for three-dimensional objects, with a transparent background.
  [[nodiscard]] vtkRenderer* panel(const Eigen::Vector2d& corner, const Eigen::Vector2d& size);

  /// Text with the left end, middle or right end of the baseline at `at`. A "?" stands for letters
  /// that the font lacks and for bytes that are not UTF-8: VTK paints nothing for them.
  void text(const Eigen::Vector2d& at, const std::string& words, const TextStyle& style);
  /// The width of `words` [px].
  [[nodiscard]] double text_width(const std::string& words, const TextStyle& style);

  /// A filled polygon with an outline of `line` px, drawn above the panels.
  void polygon(const std::vector<Eigen::Vector2d>& corners, const Colour& fill,
               const Colour& border = kInk, double line = 1.0);

  /// Many lines through points, or many filled convex polygons, in one colour.
  void lines(const std::vector<std::vector<Eigen::Vector2d>>& paths, const Colour& colour,
             double width);
  void polygons(const std::vector<std::vector<Eigen::Vector2d>>& paths, const Colour& colour);

  /// Paints and returns the picture as PNG. The same input gives the same bytes.
  /// @throws InvalidInput  it is larger than what the display can paint
  [[nodiscard]] std::string png();

 private:
  void add_paths(const std::vector<std::vector<Eigen::Vector2d>>& paths, const Colour& colour,
                 double width, bool filled);

  [[nodiscard]] std::string known_letters(const std::string& words);
  [[nodiscard]] double measured(const std::string& words, const TextStyle& style);

  int width_, height_;
  std::map<std::string, bool, std::less<>> has_letter_;  // those asked for, beyond ASCII
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderer> front_;
};

}  // namespace chladni::picture
