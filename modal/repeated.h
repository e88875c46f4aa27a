// When modes of neighbouring frequencies count as repeated: three questions, three numbers.
#pragma once

namespace chladni::modal {

/// Relative difference of frequencies below which a mesh may have split a true pair: half a cell
/// more on one side of a square plate does that much. Chained from neighbour to neighbour, since
/// each of a family of five may be split from the next. Modes so near are reported as a cluster,
/// and a count of modes never cuts one.
inline constexpr double kSplitByMesh = 1e-3;

/// Relative difference below which a real body, or another model of it, may have split what this
/// one has as a pair, and shapes are compared by the subspace they span: tolerances of manufacture
/// split the pairs of a square plate by a few in a thousand. Counted from the first of the group
/// and not chained: in a dense spectrum a chain would run on until every shape lies in the span.
inline constexpr double kSplitByManufacture = 5e-3;

/// Relative difference of ω² below which modes are equal to the solver's accuracy, so that their
/// basis is arbitrary and is turned into one orientation (docs/reference/modes.md). Above it each
/// shape is itself, however near its neighbour.
inline constexpr double kEqualToTheSolver = 1e-8;

}  // namespace chladni::modal
