// chladni convert IN OUT: geometry from one format to another.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <ostream>

#include "app/command.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/read.h"
#include "io/vtu.h"

namespace chladni::app {
namespace {

/// Corner nodes of the boundary's triangles.
mesh::Surface boundary_of(const mesh::TetMesh& mesh) {
  mesh::Surface surface;
  surface.points = mesh.points;
  surface.triangles = mesh.faces.leftCols(3);
  return surface;
}

void append(std::string& bytes, const void* value, std::size_t size) {
  const auto at = bytes.size();
  bytes.resize(at + size);
  std::memcpy(bytes.data() + at, value, size);
}

void append(std::string& bytes, const Eigen::Vector3d& vector) {
  const Eigen::Vector3f single = vector.cast<float>();
  append(bytes, single.data(), 3 * sizeof(float));
}

/// Binary STL in mm: 80 bytes of header, the count, then normal, corners and two empty bytes each.
std::string stl_of(const mesh::Surface& surface) {
  std::string bytes = "chladni, lengths in mm";
  bytes.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(surface.triangles.rows());
  append(bytes, &count, sizeof count);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return 1e3 * surface.points.row(surface.triangles(t, k)).transpose();
    };
    append(bytes, (corner(1) - corner(0)).cross(corner(2) - corner(0)).stableNormalized());
    for (int k = 0; k < 3; ++k) append(bytes, corner(k));
    bytes.append(2, '\0');
  }
  return bytes;
}

}  // namespace

int convert(const std::filesystem::path& from, const std::filesystem::path& to,
            const std::string& unit, bool hdf5, std::ostream& results) {
  require(!hdf5 || to.extension() == ".mat",
          to.string() + ": --hdf5 writes version 7.3 of .mat; expected OUT to end in .mat");
  if (io::is_measured_file(from)) return convert_data(from, to, unit, hdf5, results);
  const auto geometry = io::read_geometry(from, unit);
  for (const auto& note : geometry.notes) results << note << '\n';
  const auto* tets = std::get_if<mesh::TetMesh>(&geometry.body);
  const std::string ending = to.extension().string();
  if (ending == ".stl") {
    write_atomically(
        to, stl_of(tets != nullptr ? boundary_of(*tets) : std::get<mesh::Surface>(geometry.body)));
  } else if (ending == ".vtu") {
    require(tets != nullptr, from.string() +
                                 " holds a surface, and .vtu holds tetrahedra; mesh it "
                                 "with `chladni mesh` first");
    io::write_vtu(to, *tets, {});
  } else {
    throw InvalidInput("cannot write \"" + ending + "\" (" + to.string() +
                       "); expected .stl (a surface) or .vtu (tetrahedra)");
  }
  results << fmt::format("{} -> {}\n", from.string(), to.string());
  return 0;
}

}  // namespace chladni::app
