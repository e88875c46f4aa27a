// Twenty wafer tables that differ from any model, and models of these tables.
#pragma once

#include <string>

#include "simulators/plates/kirchhoff_plate.h"

namespace chladni::simulators {

/// The parts of a table beside the plate. The plate is aluminium (70 GPa, 0.3, 2700 kg/m³),
/// 600×600×20 mm; alone it has its first flexible mode at 183.5 Hz.
struct TableParts {
  bool pockets = false;  ///< 36×36 mm (cells permitting) in each 60 mm square between the mounts:
                         ///< mass per area ×0.5, D ×0.35
  bool corner_masses = false;    ///< 0.35 kg on each corner
  bool edge_masses = false;      ///< 0.3 kg on each edge, 75 mm off its middle
  bool actuator_masses = false;  ///< 0.1 kg at the 13 places of the quincunx
  bool cut_outs = false;         ///< 60×24 mm out of the middle of each edge
};

/// Cells along an edge. A 60 mm square has a whole number of cells; 3 of 5 cells are in a pocket.
inline constexpr int kTableCells = 50;

/// The table as drawn. With pockets the grid must have kTableCells cells along an edge.
/// @throws InvalidInput  pockets or cut-outs on another grid
[[nodiscard]] KirchhoffPlate nominal_table(const TableParts& parts, int cells = kTableCells);

/// The priors of placement-priors.md: P0 is the thesis's minimal model, P1 has the nominal corner
/// masses, P2 has all drawn parts.
[[nodiscard]] KirchhoffPlate minimal_table(int cells = 20);
[[nodiscard]] KirchhoffPlate minimal_table_with_corner_masses(int cells = 20);
[[nodiscard]] KirchhoffPlate accurate_table();

/// A table as built, with all parts; the studies use seeds 1 to 20. Its thickness has a smooth
/// relative field (mean 0, rms `thickness_rms`, correlated over 200 mm; 0.05 is ±10 % over most of
/// the plate, 0.10 is the harder case). The stiffnesses along x and y differ by up to ±12 % in
/// opposite senses, the corner masses by up to ±20 %, and D and mass of the pocket skins by up to
/// ±15 % and ±5 %. The first flexible mode is at 122 to 131 Hz (0.05) or 118 to 133 Hz (0.10).
/// Cost: 0.4 s of modes each.
/// @throws InvalidInput  thickness_rms is not 0 to 0.2
[[nodiscard]] KirchhoffPlate real_table(unsigned seed, double thickness_rms = 0.05);
inline constexpr unsigned kRealTables = 20;

/// Thirteen places of the 9×9 grid of mounts (pitch 60 mm, ±240 mm), n×2 [m]:
/// - "quincunx": 3×3 at 0 and ±240 mm, 2×2 at ±120 mm; all on mirror lines of the square
/// - "rings": by hand; the corners and four off the middles of the edges, four on a turned inner
///   square and one off the centre; no mirror or rotation maps it onto itself, every one of the
///   modes 1 to 12 is seen, and so is every sum of them
/// - "rand1", "rand2": drawn
/// Any other list of places can be used too. @throws InvalidInput  another name
[[nodiscard]] Eigen::MatrixX2d layout(const std::string& name);

/// All 81 mounts, n×2 [m], x fastest.
[[nodiscard]] Eigen::MatrixX2d mounts();

}  // namespace chladni::simulators
