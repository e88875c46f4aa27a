// Eigen counts with signed numbers, the standard library with unsigned ones.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace chladni {

/// The index of an array of Eigen as the index of a standard container.
/// @pre  i ≥ 0
[[nodiscard]] constexpr std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

}  // namespace chladni
