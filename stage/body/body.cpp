#include "stage/body.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "io/read.h"
#include "mesh/check.h"
#include "mesh/disc.h"
#include "mesh/patches.h"
#include "stage/forecast.h"
#include "stage/kept/kept_mesh.h"

namespace chladni::stage {
namespace {

constexpr int kPreferredOrder = 3;
constexpr Eigen::Index kMostCubicTets = 60000;
constexpr double kCurved = 1e-4;  // a cell that bends less is straight but for its file's digits

bool is_layered(const study::Study& study) {
  const auto* table = std::get_if<mesh::WaferTable>(&study.geometry.body);
  const bool cut = table != nullptr && (!table->bores.empty() || table->wafer_diameter > 0.0);
  const bool can = study.geometry.kind != "file" && !cut;
  require(can || study.mesh.mesher != "layered",
          study.file.string() + ": mesh.mesher is \"layered\", but " +
              (cut ? "a table with bores or a wafer" : "a body from a file") +
              " can only be meshed by \"tetgen\"");
  require(study.geometry.kind != "quadrilateral" || study.mesh.mesher != "tetgen",
          study.file.string() + ": a quadrilateral is laid in layers only; leave mesh.mesher out");
  return can && study.mesh.mesher != "tetgen";
}

template <typename Body>
mesh::Layering layering_of(const Body& body, const study::MeshPlan& plan, int order) {
  mesh::Layering layering = default_layering(body, order);
  if (plan.edge_length > 0.0) layering.edge_length = plan.edge_length;
  if (plan.layers > 0) layering.layers = plan.layers;
  if (plan.across_ribs > 0) layering.across_ribs = plan.across_ribs;
  if (layering.edge_strip > 0.5 * layering.edge_length) layering.edge_strip = 0.0;
  return layering;
}

/// Layers of a plate on four corners: those of the rectangle of its longer sides, however it is
/// turned.
mesh::Layering layering_of(const mesh::Quadrilateral& body, const study::MeshPlan& plan,
                           int order) {
  const auto side = [&](int a, int b) {
    return (body.corners.row(a) - body.corners.row(b)).norm();
  };
  auto layering = layering_of(mesh::Plate{.length = std::max(side(0, 1), side(3, 2)),
                                          .width = std::max(side(1, 2), side(0, 3)),
                                          .thickness = body.thickness},
                              plan, order);
  layering.edge_strip = 0.0;
  return layering;
}

/// With cells of the shape that elements of `order` need.
mesh::TetMesh laid(const study::Geometry& geometry, const study::MeshPlan& plan, int order) {
  if (const auto* sphere = std::get_if<mesh::Sphere>(&geometry.body)) {
    const double edge = plan.edge_length > 0.0 ? plan.edge_length : sphere->diameter / 8.0;
    return layered(*sphere, edge);
  }
  return std::visit(
      [&](const auto& body) -> mesh::TetMesh {
        using Body = std::decay_t<decltype(body)>;
        if constexpr (std::is_same_v<Body, study::FileGeometry> ||
                      std::is_same_v<Body, mesh::Sphere>) {
          throw InvalidInput("this body cannot be laid in layers");
        } else {
          return layered(body, layering_of(body, plan, order));
        }
      },
      geometry.body);
}

/// Whether the cells are laid with the sizes that are known to do for their order.
bool has_default_cells(const study::Study& study) {
  const auto& plan = study.mesh;
  return plan.edge_length == 0.0 && plan.layers == 0 && plan.across_ribs == 0 &&
         study.geometry.kind != "sphere" && is_layered(study);
}

/// Laid for the order that `order_for` chooses.
mesh::TetMesh layered_body(const study::Study& study) {
  const auto& plan = study.mesh;
  auto mesh = laid(study.geometry, plan, plan.order == 0 ? kPreferredOrder : plan.order);
  if (plan.order != 0 || study.geometry.kind == "sphere") return mesh;  // laid alike for all orders
  const int order = order_for(study, mesh.tet_count(), 0);
  return order != kPreferredOrder ? laid(study.geometry, plan, order) : mesh;
}

/// The surface for TetGen, of a body that is given by its dimensions.
mesh::Surface parametric_surface(const study::Geometry& geometry, double edge_length) {
  if (const auto* plate = std::get_if<mesh::Plate>(&geometry.body)) return surface(*plate);
  if (const auto* disc = std::get_if<mesh::Disc>(&geometry.body)) {
    return surface(*disc, edge_length > 0.0 ? edge_length : disc->diameter / 40.0);
  }
  if (const auto* sphere = std::get_if<mesh::Sphere>(&geometry.body)) {
    return surface(*sphere, edge_length > 0.0 ? edge_length : sphere->diameter / 12.0);
  }
  const auto& table = std::get<mesh::WaferTable>(geometry.body);
  return surface(table, edge_length > 0.0 ? edge_length : table.length / 40.0);
}

/// Its triangles as the boundary of a mesh that has no cells yet. Patches between two regions bound
/// nothing and have no triangles in it: no place lies there, and no support holds there.
mesh::TetMesh shell_of(const mesh::Surface& surface) {
  mesh::TetMesh shell;
  shell.points = surface.points;
  shell.patch_names = surface.patch_names;
  shell.tets.resize(0, 4);
  for (const auto& region : surface.regions) shell.region_names.push_back(region.name);
  if (shell.region_names.empty()) shell.region_names = {"body"};
  shell.faces = surface.triangles;
  shell.face_patch = surface.patch;
  if (surface.regions.size() < 2) return shell;
  const auto bounds = mesh::bounding_patches(surface);
  std::vector<Eigen::Index> outer;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (bounds[static_cast<std::size_t>(surface.patch(t))] != 0) outer.push_back(t);
  }
  shell.faces = Cells(surface.triangles(outer, Eigen::all));
  shell.face_patch = Eigen::VectorXi(surface.patch(outer));
  return shell;
}

/// @param nameless  its patches are found by angle
Outline outline_of_surface(mesh::Surface surface, const study::MeshPlan& plan, bool nameless,
                           std::vector<std::string> notes) {
  Outline outline;
  outline.notes = std::move(notes);
  const auto report = check_and_repair(surface, {.fill_holes = plan.fill_holes});
  require(report.fit(), report.text());
  if (nameless) mesh::name_patches(surface);
  for (const auto& finding : report.findings) outline.notes.push_back(finding.what);
  outline.volume = report.volume;
  outline.shell = shell_of(surface);
  outline.surface = std::move(surface);
  return outline;
}

Outline outline_of_tets(mesh::TetMesh mesh, std::vector<std::string> notes) {
  check(mesh);
  Outline outline;
  outline.notes = std::move(notes);
  outline.volume = mesh::volume(mesh);
  outline.shell = std::move(mesh);
  return outline;
}

// The keys of [mesh] that a file of tetrahedra leaves without effect.
std::vector<std::string> keys_not_used(const study::MeshPlan& plan) {
  std::vector<std::string> keys;
  const auto add = [&](bool stated, const char* key) {
    if (stated) keys.push_back(std::string("mesh.") + key);
  };
  add(plan.edge_length > 0.0, "edge_length");
  add(plan.layers > 0, "layers");
  add(plan.across_ribs > 0, "across_ribs");
  add(!plan.mesher.empty(), "mesher");
  add(!plan.remesh, "remesh");
  add(plan.fill_holes, "repair");
  return keys;
}

Outline outline_of_file(mesh::TetMesh mesh, const study::MeshPlan& plan,
                        std::vector<std::string> notes) {
  const auto keys = keys_not_used(plan);
  if (!keys.empty()) {
    notes.push_back(fmt::format("the file has tetrahedra, which are used as they are: {} {} no use",
                                fmt::join(keys, ", "), keys.size() == 1 ? "is of" : "are of"));
  }
  Outline outline = outline_of_tets(std::move(mesh), std::move(notes));
  outline.file_has_cells = true;
  return outline;
}

bool is_round(const study::Study& study) {
  return study.geometry.kind == "disc" || study.geometry.kind == "sphere";
}

/// The volume of a sphere is that of the sphere; the polygon around a disc has the disc's.
Outline outline_of_shape(const study::Study& study, Outline outline) {
  if (const auto* sphere = std::get_if<mesh::Sphere>(&study.geometry.body)) {
    outline.volume = std::numbers::pi / 6.0 *
                     (std::pow(sphere->diameter, 3) - std::pow(sphere->hole_diameter, 3));
  }
  return outline;
}

void project(mesh::TetMesh& body, const study::Study& study, int order) {
  if (const auto* sphere = std::get_if<mesh::Sphere>(&study.geometry.body)) {
    project_to_sphere(body, *sphere);
  } else if (order > 1) {
    project_to_disc(body, std::get<mesh::Disc>(study.geometry.body), order);
  }
}

/// A disc or sphere of linear cells or faces in `order`, its outside on the circles or spheres.
mesh::TetMesh on_circles(const study::Study& study, mesh::TetMesh body, int order) {
  project(body, study, order);
  if (order != body.order()) body = with_order(body, order);
  project(body, study, order);
  return body;
}

/// @throws InvalidInput  a cell is turned over, because its wall is too thin for its bent face
void require_upright(const study::Study& study, const mesh::TetMesh& body) {
  try {
    check(body);
  } catch (const InvalidInput& e) {
    throw InvalidInput(
        fmt::format("{}: the round faces bend over cells of the wall; shorten mesh.edge_length: {}",
                    study.file.string(), e.what()));
  }
}

// The body in another order than its file's.
mesh::TetMesh reordered(const study::Study& study, const mesh::TetMesh& body, int order,
                        Work& work) {
  mesh::TetMesh result = with_order(body, order);
  if (order > body.order() || largest_bend(body) < kCurved) return result;
  if (order > 1) check(result);
  work.warn(fmt::format(
      "{}: mesh.order is {}, and the file has curved cells of order {}: the "
      "volume changes from {:.6g} to {:.6g} cm3; leave mesh.order out",
      study.file.string(), order, body.order(), 1e6 * volume(body), 1e6 * volume(result)));
  return result;
}

}  // namespace

Outline outline_of(const study::Study& study, const Progress& progress) {
  tell(progress, "reading the geometry");
  if (is_layered(study)) return outline_of_shape(study, outline_of_tets(layered_body(study), {}));
  if (const auto* file = std::get_if<study::FileGeometry>(&study.geometry.body)) {
    auto geometry = io::read_geometry(file->file, file->unit);
    if (auto* tets = std::get_if<mesh::TetMesh>(&geometry.body)) {
      return outline_of_file(std::move(*tets), study.mesh, std::move(geometry.notes));
    }
    auto& surface = std::get<mesh::Surface>(geometry.body);
    const bool nameless = surface.patch_names.size() < 2;  // one solid, or none with a name
    return outline_of_surface(std::move(surface), study.mesh, nameless, std::move(geometry.notes));
  }
  auto surface = parametric_surface(study.geometry, study.mesh.edge_length);
  return outline_of_shape(study, outline_of_surface(std::move(surface), study.mesh, false, {}));
}

mesh::TetMesh body_of(const study::Study& study, const Outline& outline, Work& work) {
  mesh::TetMesh body = outline.shell;
  if (outline.surface) {
    mesh::MesherOptions options;
    options.edge_length = study.mesh.edge_length;
    options.remesh_surface = study.mesh.remesh;
    body = kept_mesh(*outline.surface, options, work);
  }
  const int own_order = outline.file_has_cells ? body.order() : 0;
  const int order = order_for(study, body.tet_count(), own_order);
  tell(work.progress(), "placing nodes");
  if (is_round(study)) {
    body = on_circles(study, std::move(body), order);
    require_upright(study, body);
  } else if (order != body.order()) {
    body = reordered(study, body, order, work);
  }
  if (own_order > 0) sort_in_space(body);
  return body;
}

std::optional<mesh::TetMesh> rounded_outline(const study::Study& study, const Outline& outline) {
  if (!is_round(study)) return {};
  const auto& whole = outline.shell;
  mesh::TetMesh shell;
  shell.points = whole.points;
  shell.tets.resize(0, 4);
  shell.faces = whole.faces;
  shell.face_patch = whole.face_patch;
  shell.patch_names = whole.patch_names;
  shell.region_names = whole.region_names;
  return on_circles(study, std::move(shell), forecast(study, outline).order);
}

int order_for(const study::Study& study, Eigen::Index tets, int own_order) {
  if (study.mesh.order > 0) return study.mesh.order;
  if (own_order > 1) return own_order;
  if (has_default_cells(study)) return kPreferredOrder;
  return tets <= kMostCubicTets ? kPreferredOrder : 2;
}

double node_count(const mesh::TetMesh& linear, int order) {
  const auto vertices = static_cast<double>(linear.node_count());
  const auto tets = static_cast<double>(linear.tet_count());
  const double faces = 0.5 * (4.0 * tets + static_cast<double>(linear.faces.rows()));
  const double edges = vertices + faces - tets - 1.0;
  return vertices + (order - 1) * edges + (order == 3 ? faces : 0.0);
}

}  // namespace chladni::stage
