// Unites, cuts and bonds bodies by corefinement, by CGAL. Only files named cgal_* include CGAL.
#include <fmt/format.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <new>
#include <set>

#include "base/error.h"
#include "mesh/check.h"
#include "mesh/remesh/cgal_quiet.h"
#include "mesh/soundness/clean.h"
#include "mesh/soundness/inside_point.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using PatchMap = Mesh::Property_map<Mesh::Face_index, int>;
namespace pmp = CGAL::Polygon_mesh_processing;

// The patches of each mesh in use.
using PatchMaps = std::map<const Mesh*, PatchMap>;

// Gives each new triangle the patch of the triangle that it is a part or a copy of.
struct PatchKeeper : pmp::Corefinement::Default_visitor<Mesh> {
  explicit PatchKeeper(PatchMaps& maps) : patches(&maps) {}
  void before_subface_creations(Mesh::Face_index old, const Mesh& mesh) {
    patch = patches->at(&mesh)[old];
  }
  void after_subface_created(Mesh::Face_index added, const Mesh& mesh) {
    patches->at(&mesh)[added] = patch;
  }
  void after_face_copy(Mesh::Face_index old, const Mesh& from, Mesh::Face_index added,
                       const Mesh& to) {
    patches->at(&to)[added] = patches->at(&from)[old];
  }

  PatchMaps* patches;
  int patch = 0;
};

PatchMap add_patches(Mesh& mesh) {
  return mesh.add_property_map<Mesh::Face_index, int>("f:of", 0).first;
}

// The index of each name of `added` in `names`. New names are appended to `names`.
std::vector<int> numbers_in(std::vector<std::string>& names,
                            const std::vector<std::string>& added) {
  std::vector<int> numbers;
  for (const std::string& name : added) {
    const auto known = std::find(names.begin(), names.end(), name);
    numbers.push_back(static_cast<int>(known - names.begin()));
    if (known == names.end()) names.push_back(name);
  }
  return numbers;
}

void fill(Mesh& mesh, PatchMap patches, const Surface& surface, const std::vector<int>& patch) {
  std::vector<Mesh::Vertex_index> vertices;
  for (const Eigen::RowVector3d p : surface.points.rowwise()) {
    vertices.push_back(mesh.add_vertex({p.x(), p.y(), p.z()}));
  }
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corner = [&](int k) {
      return vertices[static_cast<std::size_t>(surface.triangles(t, k))];
    };
    patches[mesh.add_face(corner(0), corner(1), corner(2))] =
        patch[static_cast<std::size_t>(surface.patch[t])];
  }
}

Surface surface_of(const Mesh& mesh, const PatchMap& patches, std::vector<std::string> names) {
  Surface surface;
  surface.patch_names = std::move(names);
  surface.points.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
  std::map<Mesh::Vertex_index, int> number;
  for (const Mesh::Vertex_index v : mesh.vertices()) {
    const int i = static_cast<int>(number.size());
    number[v] = i;
    surface.points.row(i) << mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z();
  }
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> patch;
  for (const Mesh::Face_index face : mesh.faces()) {
    Eigen::Vector3i corners;
    int k = 0;
    for (const Mesh::Vertex_index v : mesh.vertices_around_face(mesh.halfedge(face))) {
      corners[k++] = number[v];
    }
    triangles.push_back(corners);
    patch.push_back(patches[face]);
  }
  surface.triangles.resize(0, 3);
  append_triangles(surface, triangles, patch);
  return surface;
}

Surface sound(const Surface& surface, const std::string& what) {
  require(surface.regions.size() < 2,
          what + ": it has " + fmt::to_string(surface.regions.size()) + " regions, expected one");
  Surface body = surface;
  const SurfaceReport report = check_and_repair(body);
  require(report.fit(), what + ": " + report.text());
  return body;
}

// The meshes of two sound bodies. The patch numbers of both refer to one list of names.
struct TwoBodies {
  TwoBodies(const Surface& a, const Surface& b) : names(a.patch_names) {
    maps = {{&first, add_patches(first)}, {&second, add_patches(second)}};
    std::vector<std::string> none;
    fill(first, maps.at(&first), a, numbers_in(none, a.patch_names));
    names = none;
    fill(second, maps.at(&second), b, numbers_in(names, b.patch_names));
  }

  Mesh first, second;
  PatchMaps maps;
  std::vector<std::string> names;
};

Surface boolean_of(const Surface& a, const Surface& b, bool unite) {
  const std::string verb = unite ? "united" : "difference";
  const CgalQuiet quiet;
  TwoBodies bodies(sound(a, verb + ", first body"), sound(b, verb + ", second body"));
  Mesh result;
  bodies.maps[&result] = add_patches(result);
  bool done = false;
  try {
    const auto keep = CGAL::parameters::visitor(PatchKeeper(bodies.maps));
    done = unite ? pmp::corefine_and_compute_union(bodies.first, bodies.second, result, keep)
                 : pmp::corefine_and_compute_difference(bodies.first, bodies.second, result, keep);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw NumericalFailure(verb + ": corefinement failed: " + error.what());
  }
  require(done, verb +
                    ": the bodies touch along an edge or at a point; expected bodies that "
                    "overlap or touch along faces");
  require(result.number_of_faces() > 0, verb + ": nothing is left of the body");
  Surface surface = surface_of(result, bodies.maps.at(&result), bodies.names);
  static_cast<void>(check_and_repair(surface));  // slivers of the cut
  return surface;
}

// The triangles of both bodies, with common triangles once. Sets `common` to their number.
Surface joined(const Surface& a, const Surface& b, int interface_patch, int& common) {
  Surface all = a;
  all.points.conservativeResize(a.points.rows() + b.points.rows(), 3);
  all.points.bottomRows(b.points.rows()) = b.points;
  all.patch_names = b.patch_names;
  std::vector<Eigen::Vector3i> added;
  std::vector<int> patches;
  for (Eigen::Index t = 0; t < b.triangles.rows(); ++t) {
    added.emplace_back(b.triangles.row(t).transpose().array() + static_cast<int>(a.points.rows()));
    patches.push_back(b.patch[t]);
  }
  append_triangles(all, added, patches);
  merge_points(all, 0.0);
  std::map<std::array<int, 3>, Eigen::Index> seen;
  common = 0;
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < all.triangles.rows(); ++t) {
    std::array<int, 3> key{all.triangles(t, 0), all.triangles(t, 1), all.triangles(t, 2)};
    std::sort(key.begin(), key.end());
    const auto [twin, is_new] = seen.emplace(key, kept);
    if (!is_new) {
      all.patch[twin->second] = interface_patch;
      ++common;
      continue;
    }
    all.triangles.row(kept) = all.triangles.row(t);
    all.patch[kept++] = all.patch[t];
  }
  all.triangles.conservativeResize(kept, 3);
  all.patch.conservativeResize(kept);
  remove_unused_points(all);
  return all;
}

}  // namespace

Surface united(const Surface& a, const Surface& b) { return boolean_of(a, b, true); }

Surface difference(const Surface& a, const Surface& b) { return boolean_of(a, b, false); }

Surface bonded(const Surface& a, const Surface& b, const std::string& name_a,
               const std::string& name_b) {
  const Surface first = sound(a, "bonded, first body (" + name_a + ")");
  const Surface second = sound(b, "bonded, second body (" + name_b + ")");
  const CgalQuiet quiet;
  TwoBodies bodies(first, second);
  try {
    pmp::corefine(bodies.first, bodies.second, CGAL::parameters::visitor(PatchKeeper(bodies.maps)));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw NumericalFailure("bonded: corefinement failed: " + std::string(error.what()));
  }
  std::vector<std::string> names = bodies.names;
  const int interface_patch = numbers_in(names, {"interface_" + name_b})[0];
  int common = 0;
  Surface all = joined(surface_of(bodies.first, bodies.maps.at(&bodies.first), names),
                       surface_of(bodies.second, bodies.maps.at(&bodies.second), names),
                       interface_patch, common);
  require(common > 0, "bonded: \"" + name_a + "\" and \"" + name_b +
                          "\" do not touch along a face; expected a common flat or matching face");
  all.regions = {{name_a, inside_point(first)}, {name_b, inside_point(second)}};
  const SurfaceReport report = check_and_repair(all);
  require(report.fit(), "bonded: " + report.text());
  const double apart = enclosed_volume(first) + enclosed_volume(second);
  require(std::abs(report.volume - apart) <= 1e-9 * apart,
          "bonded: \"" + name_a + "\" and \"" + name_b + "\" overlap; expected bodies that touch");
  return all;
}

}  // namespace chladni::mesh
