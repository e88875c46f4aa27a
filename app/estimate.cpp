#include "app/estimate.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/surface.h"
#include "mesh/tetrahedralize.h"

namespace chladni::app {
namespace {

constexpr double kPi = std::numbers::pi;

/// Length, width and thickness: the box's sides by size, and the thickness that its volume gives.
struct Slab {
  double length, width, thickness;
};

Slab slab_of(const Understood& body) {
  Eigen::Vector3d sides = body.extent_m;
  std::sort(sides.data(), sides.data() + 3);
  return {sides(2), sides(1), body.volume_m3 / (sides(2) * sides(1))};
}

/// Young's modulus and Poisson's ratio in the plane, averaged over x and y.
std::pair<double, double> plane_constants(const fem::Material& material) {
  const Eigen::Matrix<double, 6, 6> compliance = material.stiffness.inverse();
  const double mean = 0.5 * (compliance(0, 0) + compliance(1, 1));
  return {1.0 / mean, -compliance(0, 1) / mean};
}

/// The material that most of the body is made of: that of the first region.
const StudyMaterial& main_material(const Study& study, const Outline& outline) {
  const std::string& region = outline.shell.region_names.front();
  const auto named = std::find_if(study.materials.begin(), study.materials.end(),
                                  [&](const auto& m) { return m.region == region; });
  return named != study.materials.end() ? *named : study.materials.front();
}

const StudyMaterial& wafer_material(const Study& study, const StudyMaterial& fallback) {
  const auto named = std::find_if(study.materials.begin(), study.materials.end(),
                                  [](const auto& m) { return m.region == "wafer"; });
  return named != study.materials.end() ? *named : fallback;
}

double mass_of(const Study& study, const Outline& outline) {
  const auto& main = main_material(study, outline);
  double mass = main.material.density * outline.volume;
  const auto* table = std::get_if<mesh::WaferTable>(&study.geometry.body);
  if (table != nullptr && table->wafer_diameter > 0.0) {
    const double wafer =
        0.25 * kPi * table->wafer_diameter * table->wafer_diameter * table->wafer_thickness;
    mass += wafer * (wafer_material(study, main).material.density - main.material.density);
  }
  for (const auto& plan : study.attachments) {
    if (const auto* point = std::get_if<fem::PointMass>(&plan.what)) mass += point->mass;
    if (const auto* resonator = std::get_if<fem::Resonator>(&plan.what)) mass += resonator->mass;
  }
  return mass;
}

struct Estimate {
  double hz;
  const char* name;
};

Estimate first_frequency(const Study& study, const Understood& body,
                         const fem::Material& material) {
  const auto [modulus, poisson] = plane_constants(material);
  const Slab slab = slab_of(body);
  const double areal_mass = body.mass_kg / (slab.length * slab.width);
  const double h = slab.thickness;
  const double bending = 22.373 / (2.0 * kPi * slab.length * slab.length) *
                         std::sqrt(modulus * h * h * h / 12.0 / areal_mass);
  const double rigidity = modulus * h * h * h / (12.0 * (1.0 - poisson * poisson));
  const double plate = std::sqrt(rigidity / areal_mass) / (2.0 * kPi);
  if (study.geometry.kind == "disc") {
    const double radius = 0.5 * slab.length;
    const double per_disc_area = areal_mass * slab.length * slab.length / (kPi * radius * radius);
    const double true_h = std::get<mesh::Disc>(study.geometry.body).thickness;
    const double d = modulus * true_h * true_h * true_h / (12.0 * (1.0 - poisson * poisson));
    return {5.253 / (2.0 * kPi * radius * radius) * std::sqrt(d / per_disc_area), "disc"};
  }
  const double twist = 13.49 * plate / (slab.length * slab.width);
  const bool flat = study.geometry.kind == "plate" || study.geometry.kind == "beam";
  if (slab.length > 4.0 * slab.width) return {std::min(bending, twist), flat ? "beam" : "box"};
  return {std::min(bending, twist), flat ? "plate" : "box"};
}

/// "0.52 GB", "140 MB".
std::string bytes_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6)
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

/// Cells and boundary triangles of TetGen on an isotropic surface, from volume and area; fitted to
/// plates, a disc, a torus and a ribbed table, within a factor of 1.2. What is thinner than an edge
/// has cells between the two sides of its surface only.
struct Count {
  double tets, faces;
};

Count tetgen_count(const Outline& outline, double edge) {
  const double surface = mesh::area(outline.shell.points, outline.shell.faces);
  const double faces = 1.16 * surface / (0.433 * edge * edge);
  const double core = std::max(0.0, outline.volume - 0.5 * edge * surface);
  return {1.6 * faces + 1.22 * core / (0.1179 * edge * edge * edge), faces};
}

/// Nodes by Euler's formula.
double node_count(const Count& count, int order) {
  const double inner = std::max(0.0, count.tets - 1.6 * count.faces) / 5.5;
  const double vertices = 0.5 * count.faces + inner;
  const double faces = 2.0 * count.tets + 0.5 * count.faces;
  const double edges = vertices + faces - count.tets;
  return vertices + (order - 1) * edges + (order == 3 ? faces : 0.0);
}

}  // namespace

std::string Understood::line() const {
  const Eigen::Vector3d mm = 1e3 * extent_m;
  return fmt::format("{:.1f} x {:.1f} x {:.1f} mm  {:.{}f} {}  first {} estimate {:.{}f} Hz", mm(0),
                     mm(1), mm(2), mass_kg < 1.0 ? 1e3 * mass_kg : mass_kg, 2,
                     mass_kg < 1.0 ? "g" : "kg", estimate_name, first_frequency_hz,
                     first_frequency_hz < 100.0 ? 1 : 0);
}

Understood understood(const Study& study, const Outline& outline) {
  Understood body;
  const auto box = mesh::bounding_box(outline.shell.points);
  body.extent_m = (box.row(1) - box.row(0)).transpose();
  body.volume_m3 = outline.volume;
  body.mass_kg = mass_of(study, outline);
  const auto estimate = first_frequency(study, body, main_material(study, outline).material);
  body.first_frequency_hz = estimate.hz;
  body.estimate_name = estimate.name;
  return body;
}

Cost forecast(const Study& study, const Outline& outline) {
  Cost cost;
  cost.exact = !outline.surface.has_value();
  int order = 0;
  double nodes = 0.0;
  if (outline.surface) {
    const double edge = study.mesh.edge_length > 0.0 ? study.mesh.edge_length
                                                     : default_edge_length(*outline.surface);
    const Count count = tetgen_count(outline, edge);
    order = order_for(study, static_cast<Eigen::Index>(count.tets), 0);
    nodes = node_count(count, order);
  } else {
    const int own_order = study.geometry.kind == "file" ? outline.shell.order() : 0;
    order = order_for(study, outline.shell.tet_count(), own_order);
    nodes = order == outline.shell.order() ? static_cast<double>(outline.shell.node_count())
                                           : node_count(outline.shell, order);
  }
  cost.degrees_of_freedom = 3.0 * nodes;
  const double size = cost.degrees_of_freedom / 1e5;
  cost.memory_bytes = 50e6 + (order == 3 ? 630e6 : 440e6) * std::pow(size, 1.17);
  cost.seconds = 7.8 * std::pow(size, 1.08);
  return cost;
}

std::string Cost::line() const {
  return fmt::format(
      "forecast: {}{:.0f} degrees of freedom, about {} of memory and {} s of one core",
      exact ? "" : "about ", degrees_of_freedom, bytes_text(memory_bytes),
      fmt::format("{:.{}f}", seconds, seconds < 9.5 ? 1 : 0));
}

std::vector<std::string> implausible(const Understood& body) {
  std::vector<std::string> warnings;
  const double longest = body.extent_m.maxCoeff();
  const auto unit_question = " long: is the length unit right?";
  if (longest > 10.0 * (1.0 + 1e-9)) {
    warnings.push_back(fmt::format("the body is {:.4g} m{}", longest, unit_question));
  }
  if (longest < 1e-3) {
    warnings.push_back(fmt::format("the body is {:.4g} mm{}", 1e3 * longest, unit_question));
  }
  const double hz = body.first_frequency_hz;
  if (hz < 1.0 || hz > 1e5) {
    warnings.push_back(
        fmt::format("its first flexible mode is estimated at {:.4g} Hz, outside 1 Hz "
                    "to 100 kHz: are the dimensions and the material right?",
                    hz));
  }
  return warnings;
}

}  // namespace chladni::app
