// Reads STEP with OpenCASCADE, in a separate program.
#pragma once

#include <filesystem>
#include <string>

#include "io/read.h"

namespace chladni::io {

/// The single solid of a STEP file as a surface [m]. The triangles lie within 0.0002 of the solid's
/// size and 0.2 rad of the true faces. They are joined along the edges that the solid's faces
/// share. Each face is a patch with its name in the file, else "face_1", "face_2", ...
/// @param unit  empty, or the length unit, which must be the file's own
/// @throws InvalidInput  built without OpenCASCADE (says which packages), not a STEP file, no
///                       solid, several solids (their volumes), a face that gets no triangles,
///                       another unit
/// @throws WorkerDied    OpenCASCADE crashed or exceeded its limits
[[nodiscard]] Geometry read_step(const std::filesystem::path& file, const std::string& unit);

}  // namespace chladni::io
