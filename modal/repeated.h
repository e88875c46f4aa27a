// Limits for frequencies of repeated modes: three purposes, three numbers.
#pragma once

namespace chladni::modal {

/// Relative difference of frequencies below which a mesh may have split a true pair: half a cell
/// more on one side of a square plate has this effect. It is chained from neighbour to neighbour,
/// since each mode of a family of five may be split from the next. Modes that close are reported as
/// a cluster, and a count of modes never cuts a cluster.
inline constexpr double kSplitByMesh = 1e-3;

/// Relative difference below which a real body, or another model of it, may have split a pair of
/// this one; shapes are then compared by the subspace they span. Tolerances of manufacture split
/// the pairs of a square plate by a few parts in a thousand. It counts from the first of the group
/// and is not chained: in a dense spectrum a chain would grow until its span holds every shape.
inline constexpr double kSplitByManufacture = 5e-3;

/// Relative difference of ω² below which modes are equal to the solver's accuracy. Their basis is
/// then arbitrary and is rotated into one orientation (docs/reference/modes.md). Above it each
/// shape is unique, however close its neighbour.
inline constexpr double kEqualToTheSolver = 1e-8;

}  // namespace chladni::modal
