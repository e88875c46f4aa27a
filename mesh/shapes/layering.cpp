// The default cell sizes: one rule per kind of body.
//
// Measured largest errors of 20 flexible modes of free bodies at the default layering:
// Plate 600 x 600 x 20 mm. Order 3: 16 k degrees of freedom, 1.1e-3 (4.7e-3 without the strip,
// because twist bends the edges of a plate within a layer as wide as its thickness). Order 2: 48 k,
// 7e-3.
// Beam 2 x 20 x 500 mm. Order 3: 12 k, 3.4e-3. Order 2: 20 k, 8e-3.
// Wafer 300 x 0.775 mm. Order 3: 16 k, 4e-3 (14 k and 3.2e-2 with 24 edges around the rim).
// Table 600 x 600 x 50 mm with 9 x 9 pockets. Order 3: 36 mm cells and strips of two ribs along the
// walls, 296 k; the frequency of the twist of the open ribs is 4e-3 lower than with as many equal
// cells. One cell instead of two in the depth of the pockets: 227 k, twist 8e-3 higher.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/shapes/body_checks.h"

namespace chladni::mesh {
namespace {

void require_order(int order) {
  require(order >= 1 && order <= 3,
          "element order is " + fmt::to_string(order) + ", expected 1, 2 or 3");
}

// Cells per half wave of the 20th mode.
double cells_per_half_wave(int order) { return order == 1 ? 12.0 : order == 2 ? 7.0 : 2.0; }

// Half the wavelength of the 20th mode. A plate of area A has N = A k^2 / 4 pi modes below the wave
// number k (Courant and Hilbert 1953). A beam has about 12 bending modes among its first 20 modes.
double half_wave(double longest, double middle) {
  constexpr double kPlate = 0.198;  // sqrt(pi / (4 N)), N = 20
  return std::max(kPlate * std::sqrt(longest * middle), longest / 12.0);
}

Layering of_plate(double length, double width, double thickness, int order) {
  require_order(order);
  std::array<double, 3> extent{length, width, thickness};
  std::sort(extent.begin(), extent.end());
  Layering result;
  result.edge_length = half_wave(extent[2], extent[1]) / cells_per_half_wave(order);
  result.layers = std::min(cells_in(thickness, 1.2 * result.edge_length), 1000);
  if (thickness < 0.5 * result.edge_length) result.edge_strip = 0.6 * thickness;
  return result;
}

}  // namespace

Layering default_layering(const Plate& plate, int order) {
  require_fit(plate);
  return of_plate(plate.length, plate.width, plate.thickness, order);
}

Layering default_layering(const Disc& disc, int order) {
  require_fit(disc);
  // Short enough for 48 edges around the rim instead of 24. The bent sides of cubic cells at 24
  // edges rise by more than the thickness of a wafer, and such cells bend too stiffly.
  constexpr double kRound = 0.185;  // of the radius
  Layering result = of_plate(disc.diameter, disc.diameter, disc.thickness, order);
  result.edge_length = std::min(result.edge_length, kRound * 0.5 * disc.diameter);
  result.edge_strip = 0.0;
  return result;
}

Layering default_layering(const WaferTable& table, int order) {
  require_fit(table);
  Layering result = of_plate(table.length, table.width, table.height, order);
  if (table.pockets_x == 0) return result;
  const double rim = rim_of(table);
  const double pocket = std::min(pocket_width(table.length, table.pockets_x, table.rib, rim),
                                 pocket_width(table.width, table.pockets_y, table.rib, rim));
  result.layers = 1;
  result.across_ribs = order == 3 ? 1 : 2;
  result.edge_strip = 2.0 * table.rib;  // walls bend and twist most near their junctions
  result.edge_length = std::min(result.edge_length, pocket * (order == 3 ? 0.6 : 0.25));
  return result;
}

}  // namespace chladni::mesh
