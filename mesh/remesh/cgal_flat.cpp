// Delaunay triangles between straight lines in a plane, by CGAL. Only files named cgal_* include
// CGAL.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <map>
#include <new>
#include <vector>

#include "mesh/remesh/cgal_quiet.h"
#include "mesh/remesh/flat.h"

namespace chladni::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Faces =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

// Sets the face infos: 1 inside, 0 outside. The parity of the lines crossed on the way from
// infinity decides.
void mark_inside(Triangulation& triangulation, const std::vector<Line2>& lines) {
  std::map<std::pair<int, int>, int> uses;
  for (const Line2& line : lines) uses[std::minmax(line.from, line.to)] += line.uses;
  for (auto face : triangulation.all_face_handles()) face->info() = -1;
  std::vector<Triangulation::Face_handle> ahead{triangulation.infinite_face()};
  ahead[0]->info() = 0;
  while (!ahead.empty()) {
    const Triangulation::Face_handle face = ahead.back();
    ahead.pop_back();
    for (int k = 0; k < 3; ++k) {
      const Triangulation::Face_handle next = face->neighbor(k);
      if (next->info() >= 0) continue;
      int crossed = 0;
      if (face->is_constrained(k)) {
        const int a = face->vertex(Triangulation::cw(k))->info();
        const int b = face->vertex(Triangulation::ccw(k))->info();
        const auto line = uses.find(std::minmax(a, b));
        crossed = line == uses.end() ? 0 : line->second;
      }
      next->info() = (face->info() + crossed) % 2;
      ahead.push_back(next);
    }
  }
}

}  // namespace

std::optional<std::vector<Eigen::Vector3i>> flat_triangles(
    const std::vector<Eigen::Vector2d>& points, const std::vector<Line2>& lines) {
  const CgalQuiet quiet;
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> vertices;
  try {
    for (std::size_t i = 0; i < points.size(); ++i) {
      vertices.push_back(triangulation.insert(Kernel::Point_2(points[i].x(), points[i].y())));
      vertices.back()->info() = static_cast<int>(i);
    }
    if (triangulation.number_of_vertices() != points.size()) return std::nullopt;
    for (const Line2& line : lines) {
      triangulation.insert_constraint(vertices[static_cast<std::size_t>(line.from)],
                                      vertices[static_cast<std::size_t>(line.to)]);
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // lines cross
    return std::nullopt;
  }
  if (triangulation.dimension() < 2) return std::nullopt;
  mark_inside(triangulation, lines);
  std::vector<Eigen::Vector3i> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    if (face->info() != 1) continue;
    triangles.emplace_back(face->vertex(0)->info(), face->vertex(1)->info(),
                           face->vertex(2)->info());
  }
  return triangles;
}

}  // namespace chladni::mesh
