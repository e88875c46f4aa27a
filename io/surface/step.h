// STEP through OpenCASCADE, in a program of its own.
#pragma once

#include <filesystem>
#include <string>

#include "io/read.h"

namespace chladni::io {

/// The one solid of a STEP file as a surface [m]: triangles within 0.0002 of its size and 0.2 rad
/// of the true faces, joined along the edges that the solid's topology shares; each face a patch
/// with the name it has in the file, else "face_1", "face_2", ...
/// @param unit  empty, or the length unit, which must be the file's own
/// @throws InvalidInput  built without OpenCASCADE (says which packages), not a STEP file, no
/// solid,
///                       several solids (their volumes), a face that gets no triangles, another
///                       unit
/// @throws WorkerDied    OpenCASCADE crashed or ran out of its limits
[[nodiscard]] Geometry read_step(const std::filesystem::path& file, const std::string& unit);

}  // namespace chladni::io
