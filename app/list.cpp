// chladni list WHAT: available choices, with their sources.
#include <fmt/format.h>

#include <array>
#include <ostream>
#include <utility>

#include "app/command.h"
#include "base/error.h"
#include "diagnosis/effect.h"
#include "fem/element.h"
#include "placement/criteria.h"
#include "placement/layout.h"
#include "priors/interpolator.h"
#include "priors/kernel.h"
#include "study/named_materials.h"
#include "study/schemas.h"

namespace chladni::app {
namespace {

using Row = std::pair<std::string_view, std::string_view>;

constexpr std::array kBodies = std::to_array<Row>({
    {"plate", "length, width, thickness"},
    {"beam", "length, width, thickness: a plate that is long"},
    {"disc", "diameter, thickness, hole_diameter"},
    {"quadrilateral", "corners (four, counter-clockwise), thickness"},
    {"sphere", "diameter, hole_diameter; centred at the origin"},
    {"wafer_table",
     "length, width, height, face_sheet, pockets, rib, rim, edge_cutout, "
     "corner_cutout, bores, wafer"},
    {"file", "a surface or tetrahedra, see `chladni list formats`"},
});
constexpr std::array kFormats = std::to_array<Row>({
    {".step .stp", "read: a solid; its faces become patches; carries its unit"},
    {".stl", "read (ASCII, binary), written (binary): a closed surface"},
    {".off .ply .obj", "read: a closed surface"},
    {".msh", "read: tetrahedra of Gmsh 2.2 and 4.1"},
    {".inp", "read: C3D4 and C3D10 of Abaqus and CalculiX; sets become regions and patches"},
    {".vtu", "read and written: tetrahedra of VTK, modes for ParaView"},
    {".csv", "read and written: measured responses and recordings; written: results"},
    {".csv.gz", "read: the same"},
    {".uff .unv",
     "read (58, 58b, 55, 2414, 15, 18, 82, 151, 164, 781, 2411, 2412, 2420) and written: "
     "measured data, modes"},
    {".mat", "read (4 to 7.3) and written (5, 7.3): measured data, state space"},
    {".json", "written: results"},
});
constexpr std::array kMaterials = std::to_array<Row>({
    {"isotropic", "youngs_modulus, poissons_ratio, density"},
    {"cubic", "c11, c12, c44, density; silicon: 165.7, 63.9, 79.6 GPa (Hopcroft et al. 2010)"},
    {"orthotropic",
     "youngs_modulus [E1, E2, E3], poissons_ratio [nu23, nu13, nu12], "
     "shear_modulus [G23, G13, G12], density"},
});
constexpr std::array kAttachments = std::to_array<Row>({
    {"mass", "mass, inertia (three about x, y, z)"},
    {"spring", "to the ground: direction, stiffness, damping"},
    {"damper", "to the ground: direction, damping"},
    {"torsion_spring", "to the ground: axis, stiffness, damping"},
    {"link", "between at and to: stiffness, damping, direction"},
    {"resonator",
     "a mass on a spring: direction, mass, frequency or stiffness, damping or "
     "damping_ratio"},
    {"kinematic_mount", "a ball in a groove, two springs: stiffness, lateral_stiffness, groove"},
    {"air_bearing", "a pad, six springs: stiffness, diameter, damping, direction"},
});

template <std::size_t N>
void print(const std::array<Row, N>& rows, std::ostream& results) {
  for (const auto& [name, summary] : rows) results << fmt::format("{:<16} {}\n", name, summary);
}

void print_materials(std::ostream& results) {
  results << "by their constants\n";
  print(kMaterials, results);
  results << "by name: typical values at room temperature\n";
  for (const auto& one : study::named_materials()) {
    std::string constants;
    for (const auto& [key, value] : one.constants) constants += fmt::format("{} {}, ", key, value);
    results << fmt::format("{:<20} {}[{}]\n", one.name, constants, one.source);
  }
}

void print_criteria(std::ostream& results) {
  results << "of the place of a collocated pair\n";
  for (const auto* one : placement::criteria()) {
    results << fmt::format("{:<26} {} [{}] ({})\n", one->name, one->summary, one->unit,
                           one->source);
  }
  results << "of a layout of sensors and actuators\n";
  for (const auto* one : placement::layout_criteria()) {
    results << fmt::format("{:<26} {} [{}] {} is better ({})\n", one->name, one->summary, one->unit,
                           one->larger_is_better ? "more" : "less", one->source);
  }
}

void print_effects(std::ostream& results) {
  for (const auto* one : diagnosis::effects()) {
    results << fmt::format("{:<20} {} [{}]; confusable with: {}\n", one->name, one->summary,
                           one->source, one->confusable);
  }
}

void print_interpolations(std::ostream& results) {
  for (const auto* one : priors::interpolators()) {
    results << fmt::format("{:<32} {} [{}]\n", one->name, one->summary, one->source);
  }
}

void print_kernels(std::ostream& results) {
  for (const auto* one : priors::kernels()) {
    results << fmt::format("{:<20} {} ({})\n", one->name, one->summary, one->source);
  }
}

}  // namespace

std::vector<std::string> listable() {
  return {"attachments", "bodies",         "criteria", "effects", "elements",
          "formats",     "interpolations", "kernels",  "keys",    "materials"};
}

int list(std::string_view what, std::ostream& results) {
  if (what == "attachments") print(kAttachments, results);
  if (what == "bodies") print(kBodies, results);
  if (what == "formats") print(kFormats, results);
  if (what == "materials") print_materials(results);
  if (what == "criteria") print_criteria(results);
  if (what == "effects") print_effects(results);
  if (what == "interpolations") print_interpolations(results);
  if (what == "kernels") print_kernels(results);
  if (what == "keys") results << study::page_of_keys();
  if (what != "elements") return 0;
  for (const auto* element : fem::elements()) {
    results << fmt::format("{:<16} {} nodes, order {}: {} [{}]\n", element->name, element->nodes,
                           element->order, element->summary, element->source);
  }
  return 0;
}

}  // namespace chladni::app
