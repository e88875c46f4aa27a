#include "io/matrix_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/figure/drawing.h"
#include "io/figure/painted.h"

namespace chladni::io {
namespace {

using Place = Eigen::Vector2d;

constexpr Colour kMatrixInk{0.13, 0.14, 0.16}, kWhite{1.0, 1.0, 1.0}, kEmpty{0.94, 0.94, 0.95};
constexpr double kMatrixMargin = 24.0, kHead = 60.0, kName = 14.0, kMatrixLabel = 16.0,
                 kLeast = 4.0, kLargest = 64.0, kTallest = 6000.0;
constexpr Eigen::Index kMost = 200;

/// The layout of the picture [px].
struct MatrixSheet {
  double width, height;
  Place corner;         // of the first square
  double square, text;  // side of a square; size of the numbers in it (0: none)
  double head;          // height of the title
  double column_names;  // height of the names above the columns
};

void check(const MatrixPicture& of) {
  require(of.value.size() > 0 && static_cast<Eigen::Index>(of.rows.size()) == of.value.rows() &&
              static_cast<Eigen::Index>(of.columns.size()) == of.value.cols(),
          fmt::format("matrix picture \"{}\": {} x {} values for {} rows and {} columns", of.title,
                      of.value.rows(), of.value.cols(), of.rows.size(), of.columns.size()));
  require(of.value.rows() <= kMost && of.value.cols() <= kMost,
          fmt::format("matrix picture \"{}\": {} x {} values, expected 200 x 200 at most", of.title,
                      of.value.rows(), of.value.cols()));
}

double widest(const std::vector<std::string>& words) {
  double width = 0.0;
  for (const auto& one : words) width = std::max(width, text_width(one, kName));
  return width;
}

std::string number(const MatrixPicture& of, Eigen::Index i, Eigen::Index j) {
  return fmt::format("{:.{}f}", of.value(i, j), of.decimals);
}

double widest_number(const MatrixPicture& of) {
  double width = 0.0;
  for (Eigen::Index i = 0; i < of.value.rows(); ++i) {
    for (Eigen::Index j = 0; j < of.value.cols(); ++j) {
      if (std::isfinite(of.value(i, j))) width = std::max(width, text_width(number(of, i, j), 1.0));
    }
  }
  return width;
}

// The width, if that leaves room for squares beside the names. A screen's picture becomes wider.
double roomy(double width, double least, const PictureFile& file) {
  if (!file.print()) return std::max(width, least);
  if (width >= least) return width;
  const double wider_mm = std::ceil(least / width * file.print()->width_mm);
  throw InvalidInput(
      fmt::format("the names leave no room for the squares at {:.6g} mm: it takes {:.0f} mm",
                  file.print()->width_mm, wider_mm));
}

MatrixSheet matrix_sheet(const MatrixPicture& of, const PictureFile& file) {
  MatrixSheet sheet{};
  sheet.head = file.print() || of.title.empty() ? 4.0 : kHead;
  sheet.column_names = widest(of.columns) + 8.0;
  const double left = kMatrixMargin + 26.0 + widest(of.rows) + 10.0;
  sheet.corner = Place(left, sheet.head + 26.0 + sheet.column_names);
  const double columns = static_cast<double>(of.value.cols());
  sheet.width = roomy(file.layout_width(columns > 24.0 ? 1400.0 : 1000.0),
                      left + kLeast * columns + kMatrixMargin, file);
  const double room = sheet.width - left - kMatrixMargin;
  sheet.square =
      std::min({kLargest, room / columns, kTallest / static_cast<double>(of.value.rows())});
  sheet.height =
      sheet.corner(1) + sheet.square * static_cast<double>(of.value.rows()) + kMatrixMargin;
  const double fits = 0.86 * sheet.square / std::max(widest_number(of), 1e-9);
  sheet.text = fits >= 9.0 ? std::min(fits, 15.0) : 0.0;
  return sheet;
}

double darkness(const MatrixPicture& of, double value) {
  return std::clamp((value - of.light) / (of.dark - of.light), 0.0, 1.0);
}

void paint_squares(Drawing& drawing, const MatrixPicture& of, const MatrixSheet& sheet) {
  for (Eigen::Index i = 0; i < of.value.rows(); ++i) {
    for (Eigen::Index j = 0; j < of.value.cols(); ++j) {
      const Place at =
          sheet.corner + sheet.square * Place(static_cast<double>(j), static_cast<double>(i));
      const double s = sheet.square - (sheet.square > 12.0 ? 1.0 : 0.0);
      const bool known = std::isfinite(of.value(i, j));
      const double dark = known ? darkness(of, of.value(i, j)) : 0.0;
      drawing.polygons({{at, at + Place(s, 0.0), at + Place(s, s), at + Place(0.0, s)}},
                       known ? sequential(1.0 - dark) : kEmpty);
      if (!known || sheet.text == 0.0) continue;
      drawing.text(at + Place(0.5 * s, 0.5 * s + 0.35 * sheet.text), number(of, i, j), sheet.text,
                   dark > 0.45 ? kWhite : kMatrixInk, Drawing::Align::centre);
    }
  }
}

// Paints every name where there is room, else every second, third, ... name.
void paint_names(Drawing& drawing, const MatrixPicture& of, const MatrixSheet& sheet) {
  const auto every =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.2 * kName / sheet.square)));
  const auto centre = [&](std::size_t k) {
    return sheet.square * (static_cast<double>(k) + 0.5) + 0.35 * kName;
  };
  for (std::size_t i = 0; i < of.rows.size(); i += every) {
    drawing.text(sheet.corner + Place(-8.0, centre(i)), of.rows[i], kName, kMatrixInk,
                 Drawing::Align::right);
  }
  for (std::size_t j = 0; j < of.columns.size(); j += every) {
    drawing.text(sheet.corner + Place(centre(j), -8.0), of.columns[j], kName, kMatrixInk,
                 Drawing::Align::left, false, true);
  }
  const Place whole = sheet.square * Place(static_cast<double>(of.value.cols()),
                                           static_cast<double>(of.value.rows()));
  drawing.text({sheet.corner(0) + 0.5 * whole(0), sheet.head + 14.0}, of.column_label, kMatrixLabel,
               kMatrixInk, Drawing::Align::centre);
  drawing.text({kMatrixMargin + 12.0, sheet.corner(1) + 0.5 * whole(1)}, of.row_label, kMatrixLabel,
               kMatrixInk, Drawing::Align::centre, false, true);
}

}  // namespace

void draw_matrix(const PictureFile& png, const MatrixPicture& picture) {
  check(picture);
  const std::string title = png.print() ? "" : picture.title;  // on paper it is in the caption
  const MatrixSheet sheet = matrix_sheet(picture, png);
  Drawing drawing(sheet.width, sheet.height);
  double size = 24.0;
  while (size > 14.0 && text_width(title, size) > sheet.width - 2.0 * kMatrixMargin) size -= 1.0;
  drawing.text({kMatrixMargin, 40.0}, title, size, kMatrixInk, Drawing::Align::left, true);
  paint_squares(drawing, picture, sheet);
  paint_names(drawing, picture, sheet);
  leave_drawing(png, drawing);
}

}  // namespace chladni::io
