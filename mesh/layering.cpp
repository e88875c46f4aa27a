// How fine is fine enough: one rule per kind of body, measured with free bodies of every kind.
#include <algorithm>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/body_checks.h"

namespace chladni::mesh {
namespace {

// Cells per longest side; the 20th mode of a square plate has about three waves along it.
double cells_along(int order) {
  switch (order) {
    case 1:
      return 60.0;
    case 2:
      return 24.0;
    default:
      return 12.0;
  }
}

Layering of_plate(double length, double width, double thickness, int order) {
  require(order >= 1 && order <= 3,
          "element order is " + std::to_string(order) + ", expected 1, 2 or 3");
  const double longest = std::max(length, width);
  const double shortest = std::min(length, width);
  Layering result;
  // A narrow strip has many waves along it for each across.
  const double slender = std::min(longest / shortest, 4.0);
  result.edge_length = std::min(longest / (cells_along(order) * std::sqrt(slender)),
                                std::max(shortest / 2.0, thickness));
  result.layers = std::clamp(cells_in(thickness, 1.5 * result.edge_length), 1, 1000);
  if (thickness < 0.5 * result.edge_length) result.edge_strip = thickness;
  return result;
}

}  // namespace

Layering default_layering(const Plate& plate, int order) {
  require_fit(plate);
  return of_plate(plate.length, plate.width, plate.thickness, order);
}

Layering default_layering(const Disc& disc, int order) {
  require_fit(disc);
  Layering result = of_plate(disc.diameter, disc.diameter, disc.thickness, order);
  result.edge_strip = 0.0;
  return result;
}

Layering default_layering(const WaferTable& table, int order) {
  require_fit(table);
  Layering result = of_plate(table.length, table.width, table.height, order);
  result.edge_strip = 0.0;
  if (table.pockets_x == 0) return result;
  result.layers = 1;
  result.across_ribs = order == 1 ? 4 : order == 2 ? 2 : 1;
  const double rim = rim_of(table);
  const double pocket = std::min(pocket_width(table.length, table.pockets_x, table.rib, rim),
                                 pocket_width(table.width, table.pockets_y, table.rib, rim));
  const double cells_per_pocket = order == 1 ? 6.0 : order == 2 ? 3.0 : 2.0;
  result.edge_length = std::min(result.edge_length, pocket / cells_per_pocket);
  return result;
}

}  // namespace chladni::mesh
