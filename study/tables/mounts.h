// Kinematic mounts and air bearings as springs.
#pragma once

#include <vector>

#include "study/problems.h"
#include "study/tables/array_places.h"

namespace chladni::study {

/// True for an attachment of kind "kinematic_mount" or "air_bearing".
[[nodiscard]] bool is_mount(const TomlNode& element);

/// The attachments of kind "spring" that an element with one place stands for.
///
/// A ball in a groove holds the body along z and across the groove: two springs, "name_z" and
/// "name_t". Three grooves towards one centre hold a body without strain (Maxwell; Slocum,
/// Precision Machine Design, 1992, 7.7). A pad of uniform stiffness k and radius r is six springs
/// of k/6 on a ring of radius r/√2: the same stiffness, and k r²/4 against tilting about any axis.
[[nodiscard]] std::vector<TomlNode> springs_of(const TomlNode& element, const ArrayPlace& place,
                                               Problems& problems);

}  // namespace chladni::study
