#include "io/patches_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "base/error.h"
#include "io/bytes/message.h"
#include "io/figure/colours.h"
#include "io/figure/drawing.h"
#include "io/figure/painted.h"
#include "io/figure/seen_parts.h"
#include "io/figure/skin.h"
#include "io/figure/view.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

constexpr Eigen::Index kMostVertices = 80'000;      // more are not visible at this size
constexpr std::size_t kMostNamed = 120;             // in the table below
constexpr double kPanel = 650.0, kHighest = 620.0;  // [px]
constexpr std::array kLetters{16.0, 13.0, 10.5};    // [px]

// For each patch, the patches that share a vertex with it.
std::vector<std::set<int>> neighbours_of(const Skin& skin, std::size_t patches) {
  std::vector<std::set<int>> at_vertex(static_cast<std::size_t>(skin.vertex_count()));
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    for (const auto v : skin.triangles.row(t)) {
      at_vertex[static_cast<std::size_t>(v)].insert(skin.patch(t));
    }
  }
  std::vector<std::set<int>> neighbours(patches);
  for (const auto& here : at_vertex) {
    for (const int a : here)
      neighbours[static_cast<std::size_t>(a)].insert(here.begin(), here.end());
  }
  return neighbours;
}

// A colour for each patch: if possible a colour that no neighbour has, and the least used of these.
std::vector<int> colours_of(const Skin& skin, std::size_t patches) {
  const auto neighbours = neighbours_of(skin, patches);
  std::vector<int> colour(patches, -1);
  std::array<int, kCategories> taken{};
  for (std::size_t p = 0; p < patches; ++p) {
    std::array<int, kCategories> cost = taken;
    for (const int other : neighbours[p]) {
      const int theirs = colour[static_cast<std::size_t>(other)];
      if (theirs >= 0) cost[static_cast<std::size_t>(theirs)] += 1'000'000;
    }
    const auto best = std::min_element(cost.begin(), cost.end()) - cost.begin();
    colour[p] = static_cast<int>(best);
    ++taken[static_cast<std::size_t>(best)];
  }
  return colour;
}

// The true area of each patch [m²].
std::vector<double> areas_of(const mesh::TetMesh& mesh) {
  std::vector<double> areas(mesh.patch_names.size(), 0.0);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    areas[static_cast<std::size_t>(mesh.face_patch(f))] +=
        mesh::area(mesh.points, mesh.faces.block(f, 0, 1, 3));
  }
  return areas;
}

struct Label {
  std::string words;
  double size;
};

// The label that fits in a disc of `radius` px: the name, in smaller letters if necessary, or the
// number. Without words where neither fits.
Label label_of(const std::string& name, std::size_t number, double radius) {
  const double room = 2.3 * radius;
  for (const auto& words : {name, fmt::to_string(number)}) {
    for (const double size : kLetters) {
      if (text_width(words, size) <= room && size <= room) return {words, size};
    }
  }
  return {"", 0.0};
}

// Adds a panel with the body from one side: the points on the paper, and the labels of the visible
// patches.
Json add_panel(Message& request, std::size_t number, const Points& on_paper, const Skin& skin,
               const std::vector<std::string>& names) {
  const auto box = mesh::bounding_box(on_paper);
  const Eigen::Vector2d extent = (box.row(1) - box.row(0)).head<2>().transpose();
  const double scale = 0.98 * std::min(kPanel / extent.x(), kHighest / extent.y());
  const auto seen =
      seen_parts(on_paper, skin.triangles, skin.patch, static_cast<int>(names.size()));
  JsonArray labels;
  std::vector<Eigen::Vector2d> places;
  for (std::size_t p = 0; p < names.size(); ++p) {
    const auto label = label_of(names[p], p + 1, scale * seen[p].radius);
    if (label.words.empty()) continue;
    labels.emplace_back(JsonObject{{"words", label.words}, {"size", label.size}});
    places.push_back(seen[p].at);
  }
  auto& at = request.doubles["labels_" + fmt::to_string(number)];
  at.resize(static_cast<Eigen::Index>(places.size()), 2);
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    at.row(i) = places[static_cast<std::size_t>(i)].transpose();
  }
  request.doubles["points_" + fmt::to_string(number)] = on_paper;
  return JsonObject{{"title", number == 0 ? "from one side" : "from the opposite side"},
                    {"labels", std::move(labels)}};
}

// The table of numbers, names and areas, of the largest patches where there are many.
JsonArray table_of(const mesh::TetMesh& mesh, const std::vector<int>& colours) {
  const auto areas = areas_of(mesh);
  std::vector<std::size_t> shown(areas.size());
  std::iota(shown.begin(), shown.end(), 0U);
  std::stable_sort(shown.begin(), shown.end(),
                   [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
  shown.resize(std::min(shown.size(), kMostNamed));
  std::sort(shown.begin(), shown.end());
  JsonArray rows;
  for (const auto p : shown) {
    rows.emplace_back(JsonObject{{"number", fmt::to_string(p + 1)},
                                 {"name", mesh.patch_names[p]},
                                 {"area", fmt::format("{:.4g} cm\u00b2", 1e4 * areas[p])},
                                 {"colour", colours[p]}});
  }
  return rows;
}

}  // namespace

void draw_patches(const PictureFile& png, const mesh::TetMesh& mesh, const std::string& title) {
  const auto& names = mesh.patch_names;
  require(mesh.faces.rows() > 0 && mesh.face_patch.size() == mesh.faces.rows() && !names.empty(),
          "picture of the patches: the mesh's boundary has none");
  const Skin body = decimated(smooth_skin(mesh, kMostVertices), mesh.points, kMostVertices);
  const auto colours = colours_of(body, names.size());
  Message request;
  const Points at = vertices(body, mesh.points);
  const View view = view_of(at);
  Eigen::Matrix3d behind = view.axes;  // half a turn about the "up" direction of the paper
  behind.row(0) *= -1.0;
  behind.row(2) *= -1.0;
  JsonArray panels;
  panels.emplace_back(add_panel(request, 0, at * view.axes.transpose(), body, names));
  panels.emplace_back(add_panel(request, 1, at * behind.transpose(), body, names));
  request.integers["triangles"] = body.triangles;
  request.integers["outline"] = body.outline;
  Cells& colour = request.integers["colours"];
  colour.resize(body.patch.size(), 1);
  for (Eigen::Index t = 0; t < colour.rows(); ++t) {
    colour(t) = colours[static_cast<std::size_t>(body.patch(t))];
  }
  const auto rows = table_of(mesh, colours);
  const auto more = static_cast<long long>(names.size() - rows.size());
  request.head =
      JsonObject{{"kind", "patches"},     {"title", title},           {"panels", std::move(panels)},
                 {"panel_width", kPanel}, {"panel_height", kHighest}, {"rows", rows},
                 {"more", more}};
  png.paint([request = std::move(request)] { return painted(request); });
}

}  // namespace chladni::io
