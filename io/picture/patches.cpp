#include <algorithm>
#include <cmath>

#include "io/picture/body.h"
#include "io/picture/canvas.h"
#include "io/picture/letters.h"
#include "io/picture/map_frame.h"
#include "io/picture/pictures.h"
#include "io/picture/title.h"
#include "mesh/surface.h"

namespace chladni::picture {
namespace {

constexpr double kWidth = 1400.0, kMargin = 40.0, kHeader = 96.0, kRow = 24.0;  // [px]
constexpr int kColumns = 4;
const TextStyle kSmall{.size = 17.0, .colour = kGrey};

// Paints the body and the labels of one panel.
void paint_panel(Canvas& canvas, const io::Message& request, std::size_t number,
                 const Eigen::Vector2d& corner) {
  const auto suffix = "_" + std::to_string(number);
  Body body;
  body.points = request.numbers("points" + suffix);
  body.triangles = request.cells("triangles");
  body.outline = request.cells("outline");
  const auto box = mesh::bounding_box(body.points);
  body.diagonal = (box.row(1) - box.row(0)).norm();
  const auto& head = request.head.at("panels").array()[number];
  const MapFrame frame = map_frame(body.points, corner, request.head.at("panel_width").number(),
                                   request.head.at("panel_height").number());
  vtkRenderer* space = canvas.panel(frame.corner, frame.size);
  add_parts(space, body, request.cells("colours"));
  look(space, frame.view, frame.size.y(), body.diagonal);
  const auto& places = request.numbers("labels" + suffix);
  const auto& labels = head.at("labels").array();
  for (Eigen::Index l = 0; l < places.rows(); ++l) {
    const auto& label = labels[static_cast<std::size_t>(l)];
    const double size = label.at("size").number();
    const Eigen::Vector2d at = frame.on_canvas({places(l, 0), places(l, 1), 0.0});
    canvas.text(at + Eigen::Vector2d(0.0, 0.45 * size), label.at("words").string(),
                {.size = size, .align = TextStyle::Align::centre});
  }
  canvas.text(frame.corner - Eigen::Vector2d(0.0, 4.0), head.at("title").string(), kSmall);
}

void paint_row(Canvas& canvas, const io::Json& row, double left, double top, double width) {
  paint_rectangle(canvas, left, top, 40.0, 18.0,
                  io::categorical(static_cast<int>(row.at("colour").number())), 0.6);
  canvas.text({left + 20.0, top + 15.0}, row.at("number").string(),
              {.size = 14.0, .align = TextStyle::Align::centre});
  const std::string& area = row.at("area").string();
  canvas.text({left + width - 24.0, top + 15.0}, area,
              {.size = 15.0, .colour = kGrey, .align = TextStyle::Align::right});
  const double room = width - 24.0 - 50.0 - canvas.text_width(area, kSmall);
  const auto fits = [&](const std::string& part) {
    return canvas.text_width(part, kSmall) <= room;
  };
  canvas.text({left + 48.0, top + 15.0}, shortened(row.at("name").string(), fits), {.size = 17.0});
}

}  // namespace

std::string patches(const io::Message& request) {
  const auto& rows = request.head.at("rows").array();
  const auto lines = static_cast<int>((rows.size() + kColumns - 1) / kColumns);
  const auto more = static_cast<long long>(request.head.at("more").number());
  double below = kHeader;
  const double width = request.head.at("panel_width").number();
  for (std::size_t p = 0; p < request.head.at("panels").array().size(); ++p) {
    below = std::max(below,
                     kHeader + map_frame(request.numbers("points_" + std::to_string(p)), {0.0, 0.0},
                                         width, request.head.at("panel_height").number())
                                   .size.y());
  }
  below += 30.0;
  const double height = below + (lines + (more > 0 ? 1 : 0)) * kRow + 24.0;
  Canvas canvas(static_cast<int>(kWidth), static_cast<int>(std::ceil(height)));
  paint_title(canvas, request.head.at("title").string(), kMargin, kWidth);
  for (std::size_t p = 0; p < request.head.at("panels").array().size(); ++p) {
    const double left = kMargin + static_cast<double>(p) * (kWidth - 2.0 * kMargin - width);
    paint_panel(canvas, request, p, {left, kHeader + 8.0});
  }
  const double wide = (kWidth - 2.0 * kMargin) / kColumns;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto column = static_cast<double>(r / static_cast<std::size_t>(lines));
    const auto line = static_cast<double>(r % static_cast<std::size_t>(lines));
    paint_row(canvas, rows[r], kMargin + column * wide, below + line * kRow, wide);
  }
  if (more > 0) {
    canvas.text({kMargin, below + lines * kRow + 17.0},
                "and " + std::to_string(more) +
                    " smaller ones: mesh.json names them, mesh.vtu "
                    "shows them",
                kSmall);
  }
  return canvas.png();
}

}  // namespace chladni::picture
