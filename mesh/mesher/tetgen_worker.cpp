// The program chladni-tetgen reads a closed surface from stdin and writes its tetrahedra to stdout
// (mesh/mesher/wire.h). It is a separate program because TetGen 1.5 aborts, crashes or hangs on bad
// input, and because TetGen has the licence AGPL-3.0-or-later. This file is the only one that
// includes TetGen and has the same licence. The exit status is 0, 3 (the request is refused), 4
// (TetGen gave up) or 5 (memory).
#define TETLIBRARY
#include <tetgen.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "host/worker_stdio.h"
#include "mesh/mesher/wire.h"

namespace wire = chladni::mesh::wire;

namespace {

void set_triangle(tetgenio::facet& facet, const std::int32_t* corners) {
  facet.polygonlist = new tetgenio::polygon[1];
  facet.numberofpolygons = 1;
  facet.holelist = nullptr;
  facet.numberofholes = 0;
  facet.polygonlist[0].numberofvertices = 3;
  facet.polygonlist[0].vertexlist = new int[3]{corners[0], corners[1], corners[2]};
}

void set_seeds(tetgenio& plc, const std::vector<wire::Seed>& seeds) {
  plc.numberofregions = static_cast<int>(seeds.size());
  if (seeds.empty()) return;
  plc.regionlist = new REAL[5 * seeds.size()];
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    REAL* seed = plc.regionlist + 5 * i;
    seed[0] = seeds[i].x;
    seed[1] = seeds[i].y;
    seed[2] = seeds[i].z;
    seed[3] = static_cast<REAL>(i + 1);
    seed[4] = seeds[i].largest_volume;
  }
}

void fill(tetgenio& plc, const wire::Request& request) {
  plc.numberofpoints = static_cast<int>(request.points.size() / 3);
  plc.pointlist = new REAL[request.points.size()];
  std::copy(request.points.begin(), request.points.end(), plc.pointlist);
  plc.numberoffacets = static_cast<int>(request.markers.size());
  plc.facetlist = new tetgenio::facet[request.markers.size()];
  plc.facetmarkerlist = new int[request.markers.size()];
  std::copy(request.markers.begin(), request.markers.end(), plc.facetmarkerlist);
  for (std::size_t i = 0; i < request.markers.size(); ++i) {
    set_triangle(plc.facetlist[i], request.triangles.data() + 3 * i);
  }
  set_seeds(plc, request.seeds);
}

// The switches of TetGen. p: a boundary of facets; q: quality; a: largest volumes, per seed and
// overall; A: parts get numbers; Q: silent; Y: the boundary is not refined. Without Y new points
// stay on the facets, because facets are flat.
std::string switches(const wire::Request& request) {
  char text[128];
  std::snprintf(text, sizeof text, "p%sq%.4f/%.4faa%.12eAQ", request.surface_stays == 1 ? "Y" : "",
                request.largest_radius_edge, request.smallest_dihedral_degrees,
                request.largest_volume);
  return text;
}

wire::Reply reply_of(const tetgenio& mesh) {
  wire::Reply reply;
  const auto tets = static_cast<std::size_t>(mesh.numberoftetrahedra);
  const auto faces = static_cast<std::size_t>(mesh.numberoftrifaces);
  if (mesh.numberofpoints > 0) {
    reply.points.assign(mesh.pointlist, mesh.pointlist + 3 * mesh.numberofpoints);
  }
  if (tets > 0) reply.tets.assign(mesh.tetrahedronlist, mesh.tetrahedronlist + 4 * tets);
  reply.parts.resize(tets, 0);
  for (std::size_t i = 0; i < tets && mesh.numberoftetrahedronattributes > 0; ++i) {
    const auto stride = static_cast<std::size_t>(mesh.numberoftetrahedronattributes);
    reply.parts[i] = static_cast<std::int32_t>(mesh.tetrahedronattributelist[i * stride]);
  }
  if (faces > 0 && mesh.trifacemarkerlist != nullptr) {
    reply.faces.assign(mesh.trifacelist, mesh.trifacelist + 3 * faces);
    reply.face_markers.assign(mesh.trifacemarkerlist, mesh.trifacemarkerlist + faces);
  }
  return reply;
}

// The meaning of a number that TetGen throws.
const char* meaning_of(int code) {
  switch (code) {
    case 2:
      return "TetGen met an internal error";
    case 3:
      return "TetGen found a self-intersection";
    case 4:
      return "TetGen found an input feature too small for it";
    case 5:
      return "TetGen found two facets very close to each other";
    case 10:
      return "TetGen refused its input";
    default:
      return "TetGen gave up";
  }
}

int run() {
  const wire::Request request = wire::request_from(chladni::all_of_stdin());
  tetgenio plc;
  tetgenio mesh;
  fill(plc, request);
  std::string text = switches(request);
  tetrahedralize(text.data(), &plc, &mesh);
  chladni::write_to_stdout(wire::bytes_of(reply_of(mesh)));
  return 0;
}

int failed(int status, const char* reason) {
  std::fprintf(stderr, "%s\n", reason);
  return status;
}

}  // namespace

int main() {
  try {
    return run();
  } catch (int code) {
    return code == 1 ? failed(5, "out of memory") : failed(4, meaning_of(code));
  } catch (const std::bad_alloc&) {
    return failed(5, "out of memory");
  } catch (const std::exception& error) {
    return failed(3, error.what());
  }
}
