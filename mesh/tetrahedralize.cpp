#include "mesh/tetrahedralize.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "host/worker.h"
#include "mesh/mesher/wire.h"
#include "mesh/remesh/attempts.h"
#include "mesh/remesh/remesh.h"
#include "mesh/soundness/shells.h"
#include "mesh/tets/relax.h"

namespace chladni::mesh {
namespace {

// Whether the mesher may refine the surface.
enum class OfSurface { refined, stays };

constexpr double largest_cell_count = 1e6;
constexpr double most_cells = 3e7;  // hours, and more memory than a computer has beside K and M
// TetGen's cells have between a third of and the whole largest volume. With this factor their mean
// edge is the wanted one.
constexpr double largest_over_regular_volume = 1.6;

double regular_tet_volume(double edge) { return edge * edge * edge / (6.0 * std::sqrt(2.0)); }

std::string in_mm(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g mm", 1e3 * length);
  return text;
}

void check_options(const MesherOptions& options) {
  require(std::isfinite(options.edge_length) && options.edge_length >= 0.0,
          "mesh: edge_length is " + in_mm(options.edge_length) + ", expected a positive length");
  require(options.largest_radius_edge >= 1.1 && options.largest_radius_edge <= 100.0,
          "mesh: the largest radius-edge ratio is " + fmt::to_string(options.largest_radius_edge) +
              ", expected 1.1 to 100 (TetGen need not end below 1.4)");
  require(options.smallest_dihedral_degrees >= 0.0 && options.smallest_dihedral_degrees <= 25.0,
          "mesh: the smallest dihedral angle is " +
              fmt::to_string(options.smallest_dihedral_degrees) + " degrees, expected 0 to 25");
}

// A slip of units must not take hours and the memory.
void require_affordable(const SurfaceReport& report, double edge_length) {
  const double cells = expected_count(report.volume, report.area, edge_length).tets;
  require(cells <= most_cells,
          fmt::format("mesh: an edge_length of {} makes about {:.3g} million tetrahedra, at most "
                      "{:.0f} million can be made; take a longer one, or look at its unit and at "
                      "that of the dimensions",
                      in_mm(edge_length), 1e-6 * cells, 1e-6 * most_cells));
}

// The shift towards the origin. Far from the origin TetGen's sums lose the digits that its tests
// need.
Eigen::RowVector3d shift_of(const Points& points) {
  const auto box = bounding_box(points);
  const double extent = (box.row(1) - box.row(0)).maxCoeff();
  const bool far = points.cwiseAbs().maxCoeff() > 1e3 * extent;
  return far ? Eigen::RowVector3d(box.colwise().mean()) : Eigen::RowVector3d::Zero();
}

wire::Request request_for(const Surface& surface, const MesherOptions& options, double edge_length,
                          const Eigen::RowVector3d& shift, OfSurface of_surface) {
  wire::Request request;
  request.surface_stays = of_surface == OfSurface::stays ? 1 : 0;
  request.largest_radius_edge = options.largest_radius_edge;
  request.smallest_dihedral_degrees = options.smallest_dihedral_degrees;
  request.largest_volume = largest_over_regular_volume * regular_tet_volume(edge_length);
  const Points shifted = surface.points.rowwise() - shift;
  request.points.assign(shifted.data(), shifted.data() + shifted.size());
  request.triangles.assign(surface.triangles.data(),
                           surface.triangles.data() + surface.triangles.size());
  for (const int patch : surface.patch) request.markers.push_back(patch + 1);
  if (surface.regions.size() < 2) return request;
  for (const Region& region : surface.regions) {
    const Eigen::RowVector3d seed = region.inside.transpose() - shift;
    request.seeds.push_back({seed.x(), seed.y(), seed.z(), request.largest_volume});
  }
  return request;
}

wire::Reply reply_to(const wire::Request& request, const MesherOptions& options,
                     double edge_length) {
  const WorkerLimits limits{
      .time = options.time_limit, .memory_bytes = options.memory_limit_bytes, .confined = true};
  try {
    return wire::reply_from(
        run_worker(worker_path("chladni-tetgen"), {}, wire::bytes_of(request), limits).output);
  } catch (const UnusableReply&) {
    throw;
  } catch (const ForbiddenCall&) {
    throw;
  } catch (const WorkerDied& death) {
    throw WorkerDied("the mesher died on a surface of " + fmt::to_string(request.markers.size()) +
                     " triangles with edge_length " + in_mm(edge_length) + " (" + death.what() +
                     "); try a coarser edge_length, remesh = true, or mend the surface in CAD");
  } catch (const NumericalFailure&) {
    throw;
  } catch (const OutOfResources&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw WorkerDied("the mesher's answer cannot be read: " + std::string(error.what()));
  }
}

// Maps TetGen's part numbers to the surface's regions. The part of seed i has the number i + 1.
// Region −1 is a void.
class PartRegions {
 public:
  explicit PartRegions(const Surface& surface)
      : surface_(surface), outer_(static_cast<std::size_t>(surface.triangles.rows())) {
    const Material filled = material(surface, shells(surface));
    for (std::size_t t = 0; t < outer_.size(); ++t) {
      outer_[t] = static_cast<int>(filled.back[t]) - static_cast<int>(filled.front[t]);
    }
  }

  int of(int part, const Eigen::Vector3d& inside) {
    const auto known = region_.find(part);
    return known != region_.end() ? known->second : region_[part] = found(part, inside);
  }

 private:
  [[nodiscard]] int found(int part, const Eigen::Vector3d& inside) const {
    const auto regions = static_cast<int>(surface_.regions.size());
    if (regions > 1 && part >= 1 && part <= regions) return part - 1;
    if (winding_number(surface_, outer_, inside) < 0.5) return -1;
    if (regions < 2) return 0;
    throw InvalidInput("mesh: the part of the body around (" + in_mm(inside.x()) + ", " +
                       in_mm(inside.y()) + ", " + in_mm(inside.z()) + ") belongs to none of its " +
                       fmt::to_string(regions) +
                       " regions; expected a region whose inside point lies there");
  }

  const Surface& surface_;
  std::vector<int> outer_;  // the sign of each outer triangle, 0 for those between two regions
  std::map<int, int> region_;
};

using Corners = std::array<std::int32_t, 3>;
struct CornersHash {
  std::size_t operator()(const Corners& c) const {
    std::size_t hash = 0;
    for (const std::int32_t i : c)
      hash = (hash ^ static_cast<std::size_t>(i)) * 0x9E3779B97F4A7C15U;
    return hash ^ (hash >> 29U);
  }
};

Corners sorted(Corners corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

// Adds the cells that are material. Left-handed cells of TetGen are turned.
void add_cells(TetMesh& mesh, const wire::Reply& reply, PartRegions& regions) {
  std::vector<std::int32_t> kept;
  std::vector<int> region;
  for (std::size_t i = 0; i < reply.parts.size(); ++i) {
    std::array<std::int32_t, 4> tet{};
    std::copy_n(reply.tets.begin() + static_cast<std::ptrdiff_t>(4 * i), 4, tet.begin());
    const Eigen::RowVector3d a = mesh.points.row(tet[0]);
    const Eigen::Vector3d u = mesh.points.row(tet[1]) - a;
    const Eigen::Vector3d v = mesh.points.row(tet[2]) - a;
    const Eigen::Vector3d w = mesh.points.row(tet[3]) - a;
    const int r = regions.of(reply.parts[i], a.transpose() + (u + v + w) / 4.0);
    if (r < 0) continue;
    if (u.cross(v).dot(w) < 0.0) std::swap(tet[2], tet[3]);
    kept.insert(kept.end(), tet.begin(), tet.end());
    region.push_back(r);
  }
  const auto count = static_cast<Eigen::Index>(region.size());
  mesh.tets = Eigen::Map<const Cells>(kept.data(), count, 4);
  mesh.region = Eigen::Map<const Eigen::VectorXi>(region.data(), count);
}

// Adds the faces that belong to one cell only, outward, with the patch of their facet.
void add_faces(TetMesh& mesh, const wire::Reply& reply) {
  constexpr int outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct Face {
    int marker = 0, cells = 0;
    Corners corners{};
  };
  std::unordered_map<Corners, Face, CornersHash> faces(2 * reply.face_markers.size());
  for (std::size_t f = 0; f < reply.face_markers.size(); ++f) {
    const Corners corners{reply.faces[3 * f], reply.faces[3 * f + 1], reply.faces[3 * f + 2]};
    faces[sorted(corners)].marker = reply.face_markers[f];
  }
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (const auto& side : outward) {
      const Corners corners{mesh.tets(t, side[0]), mesh.tets(t, side[1]), mesh.tets(t, side[2])};
      const auto face = faces.find(sorted(corners));
      if (face == faces.end()) continue;
      ++face->second.cells;
      face->second.corners = corners;
    }
  }
  std::vector<std::int32_t> outer;
  std::vector<int> patch;
  for (std::size_t f = 0; f < reply.face_markers.size(); ++f) {
    const Face& face =
        faces[sorted({reply.faces[3 * f], reply.faces[3 * f + 1], reply.faces[3 * f + 2]})];
    if (face.cells != 1) continue;
    outer.insert(outer.end(), face.corners.begin(), face.corners.end());
    patch.push_back(face.marker - 1);
  }
  const auto count = static_cast<Eigen::Index>(patch.size());
  mesh.faces = Eigen::Map<const Cells>(outer.data(), count, 3);
  mesh.face_patch = Eigen::Map<const Eigen::VectorXi>(patch.data(), count);
}

void drop_unused_points(TetMesh& mesh) {
  Eigen::VectorXi number = Eigen::VectorXi::Constant(mesh.points.rows(), -1);
  for (const std::int32_t i : mesh.tets.reshaped()) number[i] = 0;
  int used = 0;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    if (number[i] < 0) continue;
    mesh.points.row(used) = mesh.points.row(i);
    number[i] = used++;
  }
  mesh.points.conservativeResize(used, 3);
  for (std::int32_t& i : mesh.tets.reshaped()) i = number[i];
  for (std::int32_t& i : mesh.faces.reshaped()) i = number[i];
}

TetMesh mesh_of(const wire::Reply& reply, const Surface& surface, const Eigen::RowVector3d& shift) {
  TetMesh mesh;
  mesh.patch_names = surface.patch_names;
  for (const Region& region : surface.regions) mesh.region_names.push_back(region.name);
  if (mesh.region_names.empty()) mesh.region_names = {"body"};
  mesh.points = Eigen::Map<const Points>(reply.points.data(),
                                         static_cast<Eigen::Index>(reply.points.size() / 3), 3);
  mesh.points.rowwise() += shift;
  if (mesh.points.rows() >= surface.points.rows()) {  // TetGen keeps the input's points, in order
    mesh.points.topRows(surface.points.rows()) = surface.points;
  }
  PartRegions regions(surface);
  add_cells(mesh, reply, regions);
  add_faces(mesh, reply);
  drop_unused_points(mesh);
  return mesh;
}

void check_volume(const TetMesh& mesh, double expected, double edge_length) {
  const double found = mesh.tet_count() > 0 ? volume(mesh) : 0.0;
  if (std::abs(found - expected) <= 1e-6 * expected) return;
  char text[256];
  std::snprintf(
      text, sizeof text,
      "the mesher returned %td cells of %.6g mm^3 for a surface that encloses %.6g mm^3; ",
      mesh.tet_count(), found * 1e9, expected * 1e9);
  throw NumericalFailure(text + ("try another edge_length than " + in_mm(edge_length)) +
                         ", remesh = true, or mend the surface in CAD");
}

TetMesh meshed(const Surface& body, const MesherOptions& options, double edge_length,
               OfSurface of_surface) {
  const Eigen::RowVector3d shift = shift_of(body.points);
  const wire::Request request = request_for(body, options, edge_length, shift, of_surface);
  TetMesh mesh = mesh_of(reply_to(request, options, edge_length), body, shift);
  check_volume(mesh, material(body, shells(body)).volume, edge_length);
  check(mesh);
  relax(mesh, 15.0);
  return mesh;
}

// The smallest angle with which the first attempt is taken [degrees]. Between the sides of a body
// that is much thinner than an edge, every cell is flat: the angle at the side of an equilateral
// triangle as far below its corner as the body is thick. Uneven triangles leave 0.74 of it and more
// on plates and discs of a thirtieth to a sixth of an edge. The angle that is wanted elsewhere lies
// in the midst of these at 6 to 9 thicknesses: one worst cell decided whether the mesh had 20 times
// the cells.
double angle_good_enough(const MesherOptions& options, double thickness, double edge_length) {
  constexpr double nearly = 2.0;        // degrees
  constexpr double part_of_even = 0.6;  // of the angle under even triangles
  const double height = 0.5 * std::sqrt(3.0) * edge_length;
  const double even = std::atan(thickness / height) * 180.0 / std::numbers::pi;
  return std::min(options.smallest_dihedral_degrees - nearly, part_of_even * even);
}

// Meshes the body on the better of two surfaces. TetGen must keep every edge of a refined curved
// surface and splits these edges, which gives twice as many and worse cells than an isotropic
// surface that stays as it is. Where one wall of a thicker body is thin, the refined surface is the
// better one: its cells there are as small as the wall is thick.
TetMesh on_best_surface(const Surface& body, const MesherOptions& options, double thickness,
                        double edge_length) {
  const auto isotropic_surface = [&] {
    return meshed(remesh(body, edge_length), options, edge_length, OfSurface::stays);
  };
  const auto few_planes = [&] {
    return meshed(with_fewest_planes(body, edge_length), options, edge_length, OfSurface::refined);
  };
  return better_mesh(isotropic_surface, few_planes,
                     angle_good_enough(options, thickness, edge_length), options.on_death);
}

}  // namespace

double default_edge_length(const Surface& surface) {
  const auto box = bounding_box(surface.points);
  const double enclosed = material(surface, shells(surface)).volume;
  const double wall = 2.0 * enclosed / area(surface.points, surface.triangles);
  const double wanted = std::min((box.row(1) - box.row(0)).maxCoeff() / 30.0, 2.2 * wall);
  const double affordable = std::cbrt(enclosed / regular_tet_volume(1.0) / largest_cell_count);
  return std::max(wanted, affordable);
}

CellCount expected_count(double volume, double area, double edge_length) {
  const double faces = 1.16 * area / (0.433 * edge_length * edge_length);
  const double core = std::max(0.0, volume - 0.5 * edge_length * area);
  return {1.6 * faces + 1.22 * core / (0.1179 * edge_length * edge_length * edge_length), faces};
}

CellCount thin_wall_count(double volume, double thickness, double edge_length, int bonded_sides) {
  constexpr double thinnest = 7.5;          // edges over thicknesses that leave angles of 8 degrees
  constexpr double volume_of_cell = 0.3;    // in cubes of the thickness
  constexpr double cells_beside = 1.3;      // of the other part, per bonded side
  constexpr double faces_per_cell = 0.645;  // of a wall with two free sides
  constexpr double faces_per_bonded = 0.18;  // that a bonded side has less
  if (bonded_sides == 0 || !(edge_length > thinnest * thickness)) return {0.0, 0.0};
  const double cells = volume / (volume_of_cell * thickness * thickness * thickness);
  return {cells * (1.0 + cells_beside * bonded_sides),
          cells * (faces_per_cell - faces_per_bonded * bonded_sides)};
}

TetMesh tetrahedralize(const Surface& surface, const MesherOptions& options,
                       const Progress& progress) {
  check_options(options);
  tell(progress, "check the surface");
  Surface body = surface;
  const SurfaceReport report = check_and_repair(body);
  require(report.fit(), report.text());
  const double edge_length =
      options.edge_length > 0.0 ? options.edge_length : default_edge_length(body);
  require_affordable(report, edge_length);
  tell(progress, "tetrahedra");
  const double thickness = 2.0 * report.volume / report.area;
  TetMesh mesh = options.remesh_surface ? on_best_surface(body, options, thickness, edge_length)
                                        : meshed(body, options, edge_length, OfSurface::refined);
  sort_in_space(mesh);
  return mesh;
}

}  // namespace chladni::mesh
