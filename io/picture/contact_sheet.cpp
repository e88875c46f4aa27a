#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "io/figure/view.h"
#include "io/picture/body.h"
#include "io/picture/canvas.h"
#include "io/picture/glyphs.h"
#include "io/picture/pictures.h"
#include "io/picture/title.h"
#include "mesh/surface.h"

namespace chladni::picture {
namespace {

constexpr double kWidth = 1400.0, kMargin = 40.0, kGap = 36.0;  // [px]
constexpr double kHeader = 96.0, kLabel = 44.0, kFooter = 84.0;

using Align = TextStyle::Align;

struct Panel {
  std::string title, note;
  Points moved;           // V×3
  Eigen::VectorXd value;  // V, in [−1, 1]
};

struct Sheet {
  std::string title;
  Body body;
  std::vector<Panel> panels;
  std::vector<std::string> marker_kinds;
  Cells marker_vertex;                    // M×1
  std::vector<std::size_t> marker_order;  // sensors last, so that they are on top
};

// The layout of the panels.
struct Layout {
  int columns = 1, rows = 1;
  Eigen::Vector2d size;  // of a panel, without its label [px]

  [[nodiscard]] Eigen::Vector2d corner(std::size_t panel) const {
    const auto column = static_cast<double>(panel % static_cast<std::size_t>(columns));
    const auto row = static_cast<double>(panel / static_cast<std::size_t>(columns));
    return {kMargin + column * (size.x() + kGap),
            kHeader + kLabel + row * (size.y() + kLabel + kGap)};
  }
  [[nodiscard]] double height() const {
    return kHeader + rows * (size.y() + kLabel + kGap) + kFooter;
  }
};

Panel panel_of(const Body& body, const Points& shape, const io::Json& head, double deformation) {
  Panel panel{head.at("title").string(), head.at("note").string(),
              body.points + deformation * body.diagonal * shape,
              shape.col(static_cast<Eigen::Index>(head.at("axis").number()))};
  const double largest = panel.value.cwiseAbs().maxCoeff();
  if (largest > 0.0) panel.value /= largest;
  return panel;
}

Sheet sheet_of(const io::Message& request) {
  Sheet sheet;
  sheet.title = request.head.at("title").string();
  sheet.body.points = request.numbers("points");
  sheet.body.triangles = request.cells("triangles");
  sheet.body.outline = request.cells("outline");
  const auto box = mesh::bounding_box(sheet.body.points);
  sheet.body.diagonal = (box.row(1) - box.row(0)).norm();
  Eigen::Index column = 0;
  for (const io::Json& head : request.head.at("panels").array()) {
    const Points shape = request.numbers("shapes").middleCols<3>(column);
    sheet.panels.push_back(
        panel_of(sheet.body, shape, head, request.head.at("deformation").number()));
    column += 3;
  }
  for (const io::Json& marker : request.head.at("markers").array()) {
    sheet.marker_kinds.push_back(marker.at("kind").string());
  }
  sheet.marker_vertex = request.cells("marker_vertex");
  sheet.marker_order.resize(sheet.marker_kinds.size());
  std::iota(sheet.marker_order.begin(), sheet.marker_order.end(), 0U);
  std::stable_sort(sheet.marker_order.begin(), sheet.marker_order.end(), [&](auto a, auto b) {
    return glyph_layer(sheet.marker_kinds[a]) < glyph_layer(sheet.marker_kinds[b]);
  });
  return sheet;
}

// The points of all states of the body. All of them must fit into a panel.
Points all_states(const Sheet& sheet) {
  const Eigen::Index count = sheet.body.points.rows();
  Points all(count * static_cast<Eigen::Index>(sheet.panels.size() + 1), 3);
  all.topRows(count) = sheet.body.points;
  Eigen::Index row = count;
  for (const Panel& panel : sheet.panels) {
    all.middleRows(row, count) = panel.moved;
    row += count;
  }
  return all;
}

Layout layout_of(std::size_t panels, double aspect) {
  Layout layout;
  layout.columns = std::min(static_cast<int>(panels), aspect < 3.0 ? 3 : 2);
  layout.rows =
      static_cast<int>(panels + static_cast<std::size_t>(layout.columns) - 1) / layout.columns;
  const int cells = std::max(layout.columns, 2);  // a single panel does not fill the sheet
  layout.size.x() = std::floor((kWidth - 2.0 * kMargin - (cells - 1) * kGap) / cells);
  layout.size.y() = std::clamp(std::round(layout.size.x() / aspect), 90.0, 640.0);
  return layout;
}

// The view that shows `states` as large as a panel allows.
io::View fitted(io::View view, const Points& states, const Eigen::Vector2d& size) {
  const auto seen =
      ((states.rowwise() - view.centre.transpose()) * view.axes.topRows<2>().transpose()).eval();
  const Eigen::RowVector2d low = seen.colwise().minCoeff(), high = seen.colwise().maxCoeff();
  view.centre += view.axes.topRows<2>().transpose() * (0.5 * (low + high)).transpose();
  view.pixels_per_metre = 0.97 * (size.array() / (high - low).transpose().array()).minCoeff();
  return view;
}

void paint_panel(Canvas& canvas, const Sheet& sheet, const Panel& panel, const io::View& view,
                 const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  vtkRenderer* space = canvas.panel(corner, size);
  add_ghost(space, sheet.body, sheet.body.points, view);
  add_skin(space, sheet.body, panel.moved, panel.value);
  add_zero_lines(space, sheet.body, panel.moved, panel.value, view);
  look(space, view, size.y(), sheet.body.diagonal);
  for (const std::size_t m : sheet.marker_order) {
    const auto vertex = sheet.marker_vertex(static_cast<Eigen::Index>(m), 0);
    const Eigen::Vector2d at = view.at(panel.moved.row(vertex).transpose());
    draw_glyph(canvas, sheet.marker_kinds[m], corner + 0.5 * size + at, 6.5);
  }
  const Eigen::Vector2d label(corner.x(), corner.y() - kLabel + 6.0);
  canvas.text(label + Eigen::Vector2d(0.0, 24.0), panel.title, {.size = 23.0, .bold = true});
  canvas.text(label + Eigen::Vector2d(size.x(), 22.5), panel.note,
              {.size = 20.0, .colour = kGrey, .align = Align::right});
}

double paint_colour_bar(Canvas& canvas, double left, double middle) {
  constexpr int steps = 81;
  constexpr double width = 3.0, height = 16.0;
  const TextStyle small{.size = 18.0, .colour = kGrey};
  for (int i = 0; i < steps; ++i) {
    const double x = left + width * i;
    canvas.polygon({{x, middle - height / 2},
                    {x + width, middle - height / 2},
                    {x + width, middle + height / 2},
                    {x, middle + height / 2}},
                   io::diverging(2.0 * i / (steps - 1) - 1.0), kInk, 0.0);
  }
  const double right = left + width * steps;
  canvas.text({left, middle + 34.0}, "\u2212", small);
  canvas.text({0.5 * (left + right), middle + 34.0}, "0",
              {.size = 18.0, .colour = kGrey, .align = Align::centre});
  canvas.text({right, middle + 34.0}, "+", {.size = 18.0, .colour = kGrey, .align = Align::right});
  return right;
}

double paint_sample(Canvas& canvas, double left, double middle, const Colour& colour,
                    double thickness, const std::string& words) {
  const TextStyle small{.size = 18.0, .colour = kGrey};
  canvas.polygon({{left, middle - thickness / 2},
                  {left + 34.0, middle - thickness / 2},
                  {left + 34.0, middle + thickness / 2},
                  {left, middle + thickness / 2}},
                 colour, colour, 0.0);
  canvas.text({left + 44.0, middle + 8.0}, words, small);
  return left + 44.0 + canvas.text_width(words, small) + 36.0;
}

void paint_footer(Canvas& canvas, const Sheet& sheet, double top) {
  const TextStyle small{.size = 18.0, .colour = kGrey};
  const double middle = top + 26.0;
  double x = paint_colour_bar(canvas, kMargin, middle) + 18.0;
  const std::string scale = "displacement along the axis named";
  canvas.text({x, middle + 8.0}, scale, small);
  x += canvas.text_width(scale, small) + 36.0;
  x = paint_sample(canvas, x, middle, {0.0, 0.0, 0.0}, 3.0, "nodal line");
  x = paint_sample(canvas, x, middle, kPale, 2.0, "at rest");
  std::map<std::string, std::size_t> kinds;
  for (const std::string& kind : sheet.marker_kinds) ++kinds[kind];
  for (const auto& [kind, count] : kinds) {
    const std::string words = counted_glyphs(kind, count);
    draw_glyph(canvas, kind, {x + 8.0, middle}, 8.0);
    canvas.text({x + 24.0, middle + 8.0}, words, small);
    x += 24.0 + canvas.text_width(words, small) + 30.0;
  }
}

}  // namespace

std::string contact_sheet(const io::Message& request) {
  const Sheet sheet = sheet_of(request);
  const Points states = all_states(sheet);
  const io::View unit = io::view_of(sheet.body.points);
  const Eigen::Vector2d extent = unit.extent(states);
  const Layout layout = layout_of(sheet.panels.size(), extent.x() / extent.y());
  const io::View view = fitted(unit, states, layout.size);
  Canvas canvas(static_cast<int>(kWidth), static_cast<int>(std::ceil(layout.height())));
  paint_title(canvas, sheet.title, kMargin, kWidth);
  for (std::size_t p = 0; p < sheet.panels.size(); ++p) {
    paint_panel(canvas, sheet, sheet.panels[p], view, layout.corner(p), layout.size);
  }
  paint_footer(canvas, sheet, layout.height() - kFooter);
  return canvas.png();
}

}  // namespace chladni::picture
