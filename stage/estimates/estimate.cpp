#include "stage/forecast.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.h"
#include "fem/error_estimate.h"
#include "mesh/surface.h"
#include "mesh/tetrahedralize.h"
#include "stage/estimates/sides.h"
#include "stage/model.h"

namespace chladni::stage {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRigid = 6.0;
constexpr double kInPlane = 3.0;         // rigid-body motions that Weyl's law of a plate leaves out
constexpr double kFreeRim = 1.75;        // share of a free rim in the modes of a plate, per wave
constexpr double kFittedModes = 26.0;    // modes in the runs that the forecast is fitted to
constexpr double kVectorsPerMode = 5.5;  // shapes and the iteration: 20 and 200 modes of a plate
constexpr double kSystemBytes = 700.0;   // stiffness and mass of a degree of freedom, order 2
constexpr double kCopiesOfShapes = 4.0;  // while modes from elsewhere are checked
constexpr double kTimePerMode = 0.02;    // part of the total time, per mode beyond kFittedModes
constexpr double kBelieved = 0.75;       // part of a forecast without a mesh that is believed
constexpr double kFewest = 3.0;    // of a number of modes that is trusted: below it is a guess
constexpr double kManyMore = 2.0;  // modes_below is right within 1.5 for ten and more
constexpr double kModesPerFreedom = 0.1;  // above this no mesh of any kind resolves them

/// Length, width and thickness: the body's sides by size, and the thickness that fits its volume.
struct Slab {
  double length, width, thickness;
};

Slab slab_of(const Understood& body) {
  const auto& sides = body.sides_m;
  return {sides(0), sides(1), body.volume_m3 / (sides(0) * sides(1))};
}

/// Young's modulus and Poisson's ratio in the plane, averaged over x and y.
std::pair<double, double> plane_constants(const fem::Material& material) {
  const Eigen::Matrix<double, 6, 6> compliance = material.stiffness.inverse();
  const double mean = 0.5 * (compliance(0, 0) + compliance(1, 1));
  return {1.0 / mean, -compliance(0, 1) / mean};
}

/// The highest flexible mode whose frequency is expected; 0 for none.
int highest_expected(const study::Study& study) {
  int highest = 0;
  for (const auto& expectation : study.expectations) {
    if (!expectation.key.starts_with("frequency_")) continue;
    highest = std::max(highest, std::stoi(expectation.key.substr(expectation.key.find('_') + 1)));
  }
  return highest;
}

double wafer_volume(const mesh::WaferTable& table) {
  return 0.25 * kPi * table.wafer_diameter * table.wafer_diameter * table.wafer_thickness;
}

/// The volume of each region of the shell [m^3].
Eigen::VectorXd region_volumes(const study::Study& study, const Outline& outline) {
  const auto& shell = outline.shell;
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(std::ssize(shell.region_names));
  for (Eigen::Index t = 0; t < shell.tet_count(); ++t) {
    Eigen::Matrix3d sides;
    for (int k = 0; k < 3; ++k) {
      sides.row(k) = shell.points.row(shell.tets(t, k + 1)) - shell.points.row(shell.tets(t, 0));
    }
    volume(shell.region(t)) += std::abs(sides.determinant()) / 6.0;
  }
  if (volume.sum() > 0.0) return volume * (outline.volume / volume.sum());  // cells may be curved
  const auto* table = std::get_if<mesh::WaferTable>(&study.geometry.body);
  if (table != nullptr && volume.size() > 1) volume(1) = wafer_volume(*table);
  volume(0) = outline.volume - volume.sum();
  return volume;
}

/// The material of each region. Where a region has none, the study is refused later.
std::vector<fem::Material> region_materials(const study::Study& study, const Outline& outline) {
  std::vector<fem::Material> materials;
  for (const auto& region : outline.shell.region_names) {
    const auto* found = material_for(study, region);
    materials.push_back((found != nullptr ? *found : study.materials.front()).material);
  }
  return materials;
}

double attached_mass(const study::Study& study) {
  double mass = 0.0;
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

double hz_of(double omega_squared) { return std::sqrt(omega_squared) / (2.0 * kPi); }

/// The two ways in which a slender ring bends with two nodal diameters [Hz]: out of its plane,
/// where it also twists, and in its plane (Love 1944, 293; torsion of a rectangle: Roark).
std::pair<double, double> slender_ring(const mesh::Disc& ring, double mass, double modulus,
                                       double poisson) {
  const double wall = 0.5 * (ring.diameter - ring.hole_diameter);
  const double radius = 0.25 * (ring.diameter + ring.hole_diameter);
  const double h = ring.thickness;
  const double shorter = std::min(wall, h);
  const double slim = shorter / std::max(wall, h);
  const double twisted =
      wall * h * shorter * shorter * (1.0 / 3.0 - 0.21 * slim * (1.0 - std::pow(slim, 4) / 12.0));
  const double upright = modulus * wall * h * h * h / 12.0;
  const double level = modulus * h * wall * wall * wall / 12.0;
  const double torsion = 0.5 * modulus / (1.0 + poisson) * twisted;
  const double inertia = mass / (2.0 * kPi * radius) * std::pow(radius, 4);
  return {hz_of(36.0 / (4.0 + upright / torsion) * upright / inertia),
          hz_of(36.0 / 5.0 * level / inertia)};
}

/// The (2, 0) mode. What lies between a full disc and a slender ring is softer than both; this mean
/// is within 5 % of finite elements for all holes where the height is below a thirtieth of the
/// diameter. There is no shear in it: a thick ring has less, up to a fifth where its height is a
/// fifth of the diameter.
Estimate round_frequency(const mesh::Disc& disc, double mass, double modulus, double poisson) {
  constexpr double kMean = -6.0;
  const double radius = 0.5 * disc.diameter;
  const double hole = 0.5 * disc.hole_diameter;
  const double per_area = mass / (kPi * (radius * radius - hole * hole));
  const double rigidity =
      modulus * std::pow(disc.thickness, 3) / (12.0 * (1.0 - poisson * poisson));
  const double full = 5.253 / (2.0 * kPi * radius * radius) * std::sqrt(rigidity / per_area);
  if (!(hole > 0.0)) return {full, "disc"};
  const auto [out_of_plane, in_plane] = slender_ring(disc, mass, modulus, poisson);
  const double bent = std::pow(std::pow(full, kMean) + std::pow(out_of_plane, kMean), 1.0 / kMean);
  return {std::min(bent, in_plane), "ring"};
}

Estimate first_frequency(const study::Study& study, const Understood& body) {
  const auto [modulus, poisson] = plane_constants(body.material);
  if (const auto* disc = std::get_if<mesh::Disc>(&study.geometry.body)) {
    return round_frequency(*disc, body.mass_kg, modulus, poisson);
  }
  const Slab slab = slab_of(body);
  const double areal_mass = body.mass_kg / (slab.length * slab.width);
  const double h = slab.thickness;
  const double bending = 22.373 / (2.0 * kPi * slab.length * slab.length) *
                         std::sqrt(modulus * h * h * h / 12.0 / areal_mass);
  const double rigidity = modulus * h * h * h / (12.0 * (1.0 - poisson * poisson));
  const double plate = std::sqrt(rigidity / areal_mass) / (2.0 * kPi);
  const double twist = 13.49 * plate / (slab.length * slab.width);
  const bool flat = study.geometry.kind == "plate" || study.geometry.kind == "beam";
  if (slab.length > 4.0 * slab.width) return {std::min(bending, twist), flat ? "beam" : "box"};
  return {std::min(bending, twist), flat ? "plate" : "box"};
}

bool is_round(const Understood& body) {
  return body.estimate_name == "disc" || body.estimate_name == "ring";
}

/// "600.0", "0.775", "0.0123": four digits and at least `least` decimals, without further zeros.
std::string in_digits(double value, int least) {
  constexpr int kDigits = 4;
  constexpr int kMost = 15;
  int decimals = least;
  if (value > 0.0 && std::isfinite(value)) {
    const int behind = kDigits - 1 - static_cast<int>(std::floor(std::log10(value)));
    decimals = std::clamp(behind, least, kMost);
  }
  auto text = fmt::format("{:.{}f}", value, decimals);
  for (; decimals > least && text.back() == '0'; --decimals) text.pop_back();
  return text;
}

/// Cells of the mesher. A wafer may be too thin for the edge length.
mesh::CellCount cell_count(const study::Study& study, const Outline& outline, double edge) {
  const double area = mesh::area(outline.surface->points, outline.surface->triangles);
  const auto count = mesh::expected_count(outline.volume, area, edge);
  const auto* table = std::get_if<mesh::WaferTable>(&study.geometry.body);
  if (table == nullptr || !(table->wafer_diameter > 0.0)) return count;
  const auto wafer = mesh::thin_wall_count(wafer_volume(*table), table->wafer_thickness, edge, 1);
  return {count.tets + wafer.tets, count.faces + wafer.faces};
}

/// Nodes by Euler's formula.
double node_count(const mesh::CellCount& count, int order) {
  const double inner = std::max(0.0, count.tets - 1.6 * count.faces) / 5.5;
  const double vertices = 0.5 * count.faces + inner;
  const double faces = 2.0 * count.tets + 0.5 * count.faces;
  const double edges = vertices + faces - count.tets;
  return vertices + (order - 1) * edges + (order == 3 ? faces : 0.0);
}

struct Cells {
  double nodes, tets;
  int order;
  bool exact;  // counted, not estimated
};

/// Time and memory. The peak is that of the solution, or that of the mesh error's estimate after
/// the factor is freed: system, shapes twice, its own data. With mirrors the solution is that of
/// one part beside the whole system and the shapes.
Cost cost_of(const Cells& cells, double modes, std::size_t mirrors) {
  Cost cost;
  cost.exact = cells.exact;
  cost.order = cells.order;
  cost.degrees_of_freedom = 3.0 * cells.nodes;
  const double parts = std::pow(2.0, static_cast<double>(mirrors));
  const double size = cost.degrees_of_freedom / 1e5 / parts;
  const double more = std::max(0.0, modes - kFittedModes);
  const double vector = 8.0 * cost.degrees_of_freedom;
  const double whole = kSystemBytes * cost.degrees_of_freedom + 2.0 * modes * vector;
  const double solving = (cells.order == 3 ? 630e6 : 440e6) * std::pow(size, 1.17) +
                         kVectorsPerMode * vector * more / parts + (mirrors > 0 ? whole : 0.0);
  const double estimating = whole + fem::frequency_error_bytes(cells.tets);
  cost.memory_bytes = 50e6 + std::max(solving, estimating);
  cost.memory_beside_ranks_bytes = 50e6 + estimating + kCopiesOfShapes * modes * vector;
  cost.seconds = 7.8 * parts * std::pow(size, 1.08) * (1.0 + kTimePerMode * more);
  return cost;
}

/// Factor on `hz` at which the estimate is at most half of `most` modes, so that `most` is safe; 0
/// where there is none: some modes are counted below every frequency.
double frequency_ratio(const Understood& body, double hz, double most) {
  constexpr double kLeast = 1e-12;
  double ratio = 1.0;
  while (modes_below(body, ratio * hz) > 0.5 * most) {
    ratio *= 0.9;
    if (ratio < kLeast) return 0.0;
  }
  return ratio;
}

}  // namespace

std::string Understood::line() const {
  const Eigen::Vector3d mm = 1e3 * extent_m;
  const std::string round = is_round(*this) ? " (diameter " + in_digits(mm(0), 1) + " mm)" : "";
  const std::string mass =
      mass_kg < 1.0 ? in_digits(1e3 * mass_kg, 2) + " g" : in_digits(mass_kg, 2) + " kg";
  return fmt::format("{} x {} x {} mm{}  {}  first {} estimate {:.{}f} Hz{}", in_digits(mm(0), 1),
                     in_digits(mm(1), 1), in_digits(mm(2), 1), round, mass, estimate_name,
                     first_frequency_hz, first_frequency_hz < 100.0 ? 1 : 0,
                     is_held ? ", were it free" : "");
}

Understood understood(const study::Study& study, const Outline& outline) {
  Understood body;
  const auto box = mesh::bounding_box(outline.shell.points);
  body.extent_m = (box.row(1) - box.row(0)).transpose();
  body.sides_m = sides_of(outline.shell);
  if (const auto* disc = std::get_if<mesh::Disc>(&study.geometry.body)) {
    body.extent_m = {disc->diameter, disc->diameter, disc->thickness};  // the outline is a polygon
    body.sides_m = body.extent_m;
    std::sort(body.sides_m.data(), body.sides_m.data() + 3, std::greater<>());
  }
  body.volume_m3 = outline.volume;
  const auto volume = region_volumes(study, outline);
  const auto materials = region_materials(study, outline);
  body.mass_kg = attached_mass(study);
  for (std::size_t r = 0; r < materials.size(); ++r) {
    body.mass_kg += materials[r].density * volume(static_cast<Eigen::Index>(r));
  }
  Eigen::Index largest = 0;
  volume.maxCoeff(&largest);
  body.material = materials[static_cast<std::size_t>(largest)];
  const auto estimate = first_frequency(study, body);
  body.first_frequency_hz = estimate.hz;
  body.estimate_name = estimate.name;
  body.is_held = !study.supports.empty();
  return body;
}

double modes_below(const Understood& body, double hz) {
  const auto [modulus, poisson] = plane_constants(body.material);
  Slab slab = slab_of(body);
  const double area = is_round(body) ? body.volume_m3 / body.extent_m(2) : slab.length * slab.width;
  slab.thickness = body.volume_m3 / area;
  const double density = body.mass_kg / body.volume_m3;
  const double omega = 2.0 * kPi * hz;
  const double in_plane = modulus / (density * (1.0 - poisson * poisson));  // c², of a thin plate
  const double shear = 0.5 * modulus / (density * (1.0 + poisson));         // c²
  const double wave = std::sqrt(omega * std::sqrt(12.0 / in_plane) / slab.thickness);  // [1/m]
  const double rim = 2.0 * (slab.length + slab.width);
  const double bending = (area * wave * wave + kFreeRim * rim * wave) / (4.0 * kPi);
  const double membrane = omega * omega / (4.0 * kPi) * area * (1.0 / in_plane + 1.0 / shear);
  const double pressure = shear * (2.0 - 2.0 * poisson) / std::max(1e-3, 1.0 - 2.0 * poisson);
  const double solid = std::pow(omega, 3) / (6.0 * kPi * kPi) * body.volume_m3 *
                       (std::pow(pressure, -1.5) + 2.0 * std::pow(shear, -1.5));
  double beam = 0.0;
  if (slab.length > 4.0 * slab.width) {
    for (const double h : {slab.thickness, slab.width}) {
      beam += slab.length / kPi * std::sqrt(omega / h) * std::pow(12.0 * density / modulus, 0.25);
    }
  }
  return kInPlane + std::max(beam, bending + membrane) + solid;
}

int wanted_count(const study::Study& study) {
  return std::max(study.modes.count, highest_expected(study));
}

double modes_wanted(const study::Study& study, const Understood& body) {
  if (!(study.modes.up_to_hz > 0.0)) return kRigid + static_cast<double>(wanted_count(study));
  return std::max(kRigid, modes_below(body, study.modes.up_to_hz));
}

std::vector<std::string> unlikely_modes(const study::Study& study, const Understood& body) {
  const double up_to = study.modes.up_to_hz;
  if (!(up_to > 0.0)) return {};
  const double likely = std::max(kFewest, modes_below(body, up_to) - kRigid);
  std::vector<std::string> warnings;
  const auto look = [&](const char* key, int highest) {
    if (highest <= kManyMore * likely) return;
    warnings.push_back(fmt::format(
        "{}: {} asks for flexible mode {}, but only about {:.0f} lie below {:.6g} Hz; raise "
        "modes.up_to if there are fewer",
        study.file.string(), key, highest, likely, up_to));
  };
  if (const auto& plan = study.placement; plan && !plan->modes.empty()) {
    look("placement.modes", *std::max_element(plan->modes.begin(), plan->modes.end()));
  }
  if (study.priors) look("priors.modes", study.priors->modes);
  look("expect", highest_expected(study));
  return warnings;
}

Cost forecast(const study::Study& study, const Outline& outline) {
  const double modes = modes_wanted(study, understood(study, outline));
  if (!outline.surface) {
    const int own_order = outline.file_has_cells ? outline.shell.order() : 0;
    const int order = order_for(study, outline.shell.tet_count(), own_order);
    const double nodes = order == outline.shell.order()
                             ? static_cast<double>(outline.shell.node_count())
                             : node_count(outline.shell, order);
    return cost_of({nodes, static_cast<double>(outline.shell.tet_count()), order, true}, modes,
                   study.modes.mirrors.size());
  }
  const double edge =
      study.mesh.edge_length > 0.0 ? study.mesh.edge_length : default_edge_length(*outline.surface);
  const auto count = cell_count(study, outline, edge);
  const int order = order_for(study, static_cast<Eigen::Index>(count.tets), 0);
  return cost_of({node_count(count, order), count.tets, order, false}, modes,
                 study.modes.mirrors.size());
}

Cost forecast(const study::Study& study, const mesh::TetMesh& mesh, const Understood& body) {
  return cost_of({static_cast<double>(mesh.node_count()), static_cast<double>(mesh.tet_count()),
                  mesh.order(), true},
                 modes_wanted(study, body), study.modes.mirrors.size());
}

double frequency_of(double flexible, const Understood& body) {
  double low = 0.0;
  double high = body.first_frequency_hz;
  if (!(high > 0.0)) return 0.0;
  while (modes_below(body, high) < kRigid + flexible) high *= 2.0;
  for (int halving = 0; halving < 20; ++halving) {
    const double middle = 0.5 * (low + high);
    (modes_below(body, middle) < kRigid + flexible ? low : high) = middle;
  }
  return high;
}

void refuse_too_many_modes(const study::Study& study, const Understood& body, const Cost& cost) {
  const double up_to = study.modes.up_to_hz;
  const double modes = modes_wanted(study, body);
  const double most = kModesPerFreedom * cost.degrees_of_freedom;
  if (!(up_to > 0.0 && modes > most)) return;
  const double safe = up_to * frequency_ratio(body, up_to, most);
  throw InvalidInput(fmt::format(
      "{}: modes.up_to is {:.6g} Hz, and about {:.2g} modes lie below it; a mesh of {:.0f} degrees "
      "of freedom has {:.0f} at most. {} mesh.edge_length",
      study.file.string(), up_to, modes, cost.degrees_of_freedom, most,
      safe > 0.0 ? fmt::format("Ask for less than about {:.2g} Hz, or shorten", safe) : "Shorten"));
}

bool fits(const Cost& cost, double have_bytes) {
  return (cost.exact ? 1.0 : kBelieved) * cost.memory_bytes <= have_bytes;
}

}  // namespace chladni::stage
