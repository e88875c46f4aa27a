// Light-weighted tables as bricks: pockets and cut-outs are voids of the grid.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/shapes/body_checks.h"
#include "mesh/shapes/brick_grid.h"
#include "mesh/shapes/table.h"

namespace chladni::mesh {
namespace {

struct Interval {
  double low, high;  // [m]
  [[nodiscard]] bool holds(double x) const { return low < x && x < high; }
};

// The intervals of the pockets along an axis.
std::vector<Interval> pockets_along(double length, int count, double rib, double rim) {
  std::vector<Interval> pockets;
  const double width = pocket_width(length, count, rib, rim);
  for (int p = 0; p < count; ++p) {
    // The centre is computed from the middle of the table, so that mirrored pockets have exactly
    // mirrored ends.
    const double centre = (p - (count - 1) / 2.0) * (width + rib);
    pockets.push_back({centre - width / 2.0, centre + width / 2.0});
  }
  return pockets;
}

// A rectangle in the plan that is cut out over the whole height.
struct Cutout {
  Interval x, y;
  [[nodiscard]] bool holds(double px, double py, double wall) const {
    return Interval{x.low - wall, x.high + wall}.holds(px) &&
           Interval{y.low - wall, y.high + wall}.holds(py);
  }
};

std::vector<Cutout> cutouts_of(const WaferTable& table) {
  const double x = table.length / 2.0;
  const double y = table.width / 2.0;
  std::vector<Cutout> cutouts;
  if (table.edge_cutout_depth > 0.0) {
    const Interval along{-table.edge_cutout_length / 2.0, table.edge_cutout_length / 2.0};
    const double deep = table.edge_cutout_depth;
    cutouts.push_back({{-x, deep - x}, along});
    cutouts.push_back({{x - deep, x}, along});
    cutouts.push_back({along, {-y, deep - y}});
    cutouts.push_back({along, {y - deep, y}});
  }
  if (const double side = table.corner_cutout; side > 0.0) {
    for (const Interval& in_x : {Interval{-x, side - x}, Interval{x - side, x}}) {
      for (const Interval& in_y : {Interval{-y, side - y}, Interval{y - side, y}}) {
        cutouts.push_back({in_x, in_y});
      }
    }
  }
  return cutouts;
}

// The ends of all stretches along an axis that lie within the body, ascending.
std::vector<double> breaks(double length, const std::vector<Interval>& pockets,
                           const std::vector<Interval>& cutouts, double wall) {
  const double half = length / 2.0;
  std::vector<double> ends{-half, half};
  for (const Interval& pocket : pockets) ends.insert(ends.end(), {pocket.low, pocket.high});
  for (const Interval& cutout : cutouts) {
    ends.insert(ends.end(), {cutout.low, cutout.high});
    if (!pockets.empty()) ends.insert(ends.end(), {cutout.low - wall, cutout.high + wall});
  }
  std::erase_if(ends, [&](double at) { return std::abs(at) > half; });
  std::sort(ends.begin(), ends.end());
  const auto same = [&](double a, double b) { return b - a < 1e-6 * length; };
  std::vector<double> merged{-half};
  for (const double at : ends) {
    if (!same(merged.back(), at)) merged.push_back(at);
  }
  if (same(merged[merged.size() - 1], half)) merged.back() = half;
  return merged;
}

// Adds a pocket's stretch, with a row of cells of width `strip` along both walls where there is
// room.
void add_pocket(std::vector<Stretch>& stretches, double from, double to, const Layering& layering) {
  const double strip = layering.edge_strip;
  if (strip > 0.0 && to - from > 3.0 * strip) {
    stretches.push_back({from + strip, 1});
    stretches.push_back({to - strip, cells_in(to - from - 2.0 * strip, layering.edge_length)});
    stretches.push_back({to, 1});
  } else {
    stretches.push_back({to, cells_in(to - from, layering.edge_length)});
  }
}

std::vector<double> lines_along(double length, const std::vector<Interval>& pockets,
                                const std::vector<Interval>& cutouts, const WaferTable& table,
                                const Layering& layering) {
  const std::vector<double> ends = breaks(length, pockets, cutouts, rim_of(table));
  std::vector<Stretch> stretches;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const double span = ends[i] - ends[i - 1];
    const double middle = (ends[i - 1] + ends[i]) / 2.0;
    if (std::any_of(pockets.begin(), pockets.end(),
                    [&](const Interval& p) { return p.holds(middle); })) {
      add_pocket(stretches, ends[i - 1], ends[i], layering);
      continue;
    }
    int cells = cells_in(span, layering.edge_length);
    if (!pockets.empty()) cells = std::max(cells, cells_in(span * layering.across_ribs, table.rib));
    stretches.push_back({ends[i], cells});
  }
  return mirrored_lines(-length / 2.0, stretches);
}

// Marks the bricks of pockets (1) and cut-outs (2).
void cut_voids(BrickGrid& grid, const WaferTable& table,
               const std::array<std::vector<Interval>, 2>& pockets,
               const std::vector<Cutout>& cutouts) {
  const auto middle = [](const std::vector<double>& line, int i) {
    return (line[static_cast<std::size_t>(i)] + line[static_cast<std::size_t>(i) + 1]) / 2.0;
  };
  const auto inside = [](const std::vector<Interval>& intervals, double at) {
    return std::any_of(intervals.begin(), intervals.end(),
                       [&](const Interval& i) { return i.holds(at); });
  };
  for (int j = 0; j + 1 < static_cast<int>(grid.y.size()); ++j) {
    const double y = middle(grid.y, j);
    for (int i = 0; i + 1 < static_cast<int>(grid.x.size()); ++i) {
      const double x = middle(grid.x, i);
      const auto cut = [&](double wall) {
        return std::any_of(cutouts.begin(), cutouts.end(),
                           [&](const Cutout& c) { return c.holds(x, y, wall); });
      };
      const bool pocket = inside(pockets[0], x) && inside(pockets[1], y) && !cut(rim_of(table));
      const bool hole = cut(0.0);
      for (int k = 0; k + 1 < static_cast<int>(grid.z.size()); ++k) {
        const bool below = middle(grid.z, k) < -table.face_sheet;
        grid.kind[grid.brick(i, j, k)] = static_cast<std::int8_t>(hole              ? 2
                                                                  : pocket && below ? 1
                                                                                    : 0);
      }
    }
  }
}

}  // namespace

BrickGrid grid_of(const WaferTable& table, const Layering& layering) {
  const double rim = rim_of(table);
  const auto in_x = pockets_along(table.length, table.pockets_x, table.rib, rim);
  const auto in_y = pockets_along(table.width, table.pockets_y, table.rib, rim);
  const std::vector<Cutout> cutouts = cutouts_of(table);
  std::vector<Interval> cut_x, cut_y;
  for (const Cutout& cutout : cutouts) {
    cut_x.push_back(cutout.x);
    cut_y.push_back(cutout.y);
  }
  std::vector<Stretch> up;  // from the bottom
  const double sheet = in_x.empty() ? table.height : table.face_sheet;
  if (!in_x.empty()) {
    up.push_back({-sheet, cells_in(table.height - sheet, layering.edge_length)});
  }
  up.push_back({0.0, layering.layers});
  BrickGrid grid = BrickGrid::block(lines_along(table.length, in_x, cut_x, table, layering),
                                    lines_along(table.width, in_y, cut_y, table, layering),
                                    lines(-table.height, up));
  grid.void_patch = {"pockets", "cutouts"};
  cut_voids(grid, table, {in_x, in_y}, cutouts);
  return grid;
}

TetMesh layered(const WaferTable& table, const Layering& layering) {
  require_fit(table);
  require_fit(layering);
  require(table.bores.empty() && table.wafer_diameter == 0.0,
          "wafer table: bores and wafers cannot be laid in layers; take mesh::surface and "
          "tetrahedralize");
  return tetrahedra(grid_of(table, layering));
}

}  // namespace chladni::mesh
