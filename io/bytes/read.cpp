#include "io/read.h"

#include <fmt/format.h>

#include <array>
#include <new>

#include "base/error.h"
#include "base/quantity.h"
#include "host/atomic_file.h"
#include "io/scan.h"
#include "io/surface/step.h"
#include "io/vtu.h"

namespace chladni::io {
namespace {

struct Reader {
  std::string_view ending;
  mesh::Surface (*surface)(std::string_view, Notes*);
  mesh::TetMesh (*tets)(std::string_view, Notes*);
};

constexpr std::array<Reader, 6> kReaders{{{".stl", parse_stl, nullptr},
                                          {".off", parse_off, nullptr},
                                          {".ply", parse_ply, nullptr},
                                          {".obj", parse_obj, nullptr},
                                          {".msh", nullptr, parse_msh},
                                          {".inp", nullptr, parse_inp}}};

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

Geometry parsed(const Reader& reader, const std::string& bytes) {
  Geometry geometry;
  if (reader.surface != nullptr) {
    geometry.body = reader.surface(bytes, &geometry.notes);
  } else {
    geometry.body = reader.tets(bytes, &geometry.notes);
  }
  return geometry;
}

Geometry scaled(Geometry geometry, double factor) {
  std::visit([&](auto& body) { body.points *= factor; }, geometry.body);
  return geometry;
}

Geometry read_with(const Reader& reader, const std::filesystem::path& file,
                   const std::string& unit) {
  const std::string bytes = read_whole(file);
  refuse_utf16(bytes, file.string());
  require(!unit.empty(), file.string() + ": a " + std::string(reader.ending) +
                             " file has no length unit, expected one: unit = \"mm\"");
  const double factor = unit_factor(unit, "m");
  try {
    return scaled(parsed(reader, bytes), factor);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw OutOfResources(file.string() + ": no memory to read its " + fmt::to_string(bytes.size()) +
                         " bytes");
  }
}

// Reads a .vtu file. Our own files are in metres; files of other programs may have any unit.
Geometry read_grid(const std::filesystem::path& file, const std::string& unit) {
  Geometry geometry;
  geometry.body = read_vtu(file, &geometry.notes);
  if (unit.empty()) geometry.notes.emplace_back("no length unit stated: taken as metres");
  return scaled(std::move(geometry), unit.empty() ? 1.0 : unit_factor(unit, "m"));
}

}  // namespace

Geometry read_geometry(const std::filesystem::path& file, const std::string& unit) {
  const std::string ending = lower(file.extension().string());
  for (const Reader& reader : kReaders) {
    if (reader.ending == ending) return read_with(reader, file, unit);
  }
  if (ending == ".step" || ending == ".stp") return read_step(file, unit);
  if (ending == ".vtu") return read_grid(file, unit);
  throw InvalidInput(file.string() + ": ending " + shown(ending) +
                     ", expected .step, .stp, .stl, .off, .ply, .obj (a closed surface), .msh, "
                     ".inp or .vtu (tetrahedra)");
}

}  // namespace chladni::io
