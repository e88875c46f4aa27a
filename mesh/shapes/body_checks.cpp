#include "mesh/shapes/body_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/text_stream.h"

namespace chladni::mesh {
namespace {

std::string text(double metres) {
  TextWriter words;
  words.precision(6);
  words << metres << " m";
  return words.str();
}

void require_not_negative(const std::string& body, const std::string& dimension, double value) {
  require(std::isfinite(value) && value >= 0.0,
          body + ": " + dimension + " is " + text(value) + ", expected 0 or a positive length");
}

void require_less(const std::string& body, const std::string& dimension, double value,
                  const std::string& bound, double limit) {
  require(value < limit, body + ": " + dimension + " is " + text(value) + ", expected less than " +
                             bound + ", " + text(limit));
}

void require_pockets_fit(const WaferTable& table) {
  const std::string body = "wafer table";
  require(table.pockets_x >= 0 && table.pockets_y >= 0 &&
              (table.pockets_x == 0) == (table.pockets_y == 0),
          body + ": pockets are " + fmt::to_string(table.pockets_x) + " by " +
              fmt::to_string(table.pockets_y) + ", expected 0 by 0 or at least 1 by 1");
  require(std::max(table.pockets_x, table.pockets_y) <= 1000,
          body + ": more than 1000 pockets in a row");
  if (table.pockets_x == 0) return;
  require_positive(body, "face_sheet", table.face_sheet);
  require_less(body, "face_sheet", table.face_sheet, "the height", table.height);
  require_positive(body, "rib", table.rib);
  require_not_negative(body, "rim", table.rim);
  const auto check = [&](const std::string& axis, double length, int count) {
    const double pitch = length / count;
    require(pocket_width(length, count, table.rib, rim_of(table)) > 1e-6 * length,
            body + ": ribs of " + text(table.rib) + " and a rim of " + text(rim_of(table)) +
                " leave no room for " + fmt::to_string(count) + " pockets along " + axis +
                " (pitch " + text(pitch) + ")");
  };
  check("x", table.length, table.pockets_x);
  check("y", table.width, table.pockets_y);
}

void require_cutouts_fit(const WaferTable& table) {
  const std::string body = "wafer table";
  require_not_negative(body, "edge_cutout_length", table.edge_cutout_length);
  require_not_negative(body, "edge_cutout_depth", table.edge_cutout_depth);
  require_not_negative(body, "corner_cutout", table.corner_cutout);
  require((table.edge_cutout_length > 0.0) == (table.edge_cutout_depth > 0.0),
          body + ": edge_cutout_length is " + text(table.edge_cutout_length) +
              " and edge_cutout_depth " + text(table.edge_cutout_depth) +
              ", expected both or neither");
  const double least = std::min(table.length, table.width);
  require_less(body, "corner_cutout", table.corner_cutout, "half of the shorter side", least / 2.0);
  require_less(body, "edge_cutout_length", table.edge_cutout_length,
               "what the cut-outs at corners and edges leave of the shorter side",
               least - 2.0 * std::max(table.corner_cutout, table.edge_cutout_depth));
}

void require_bores_fit(const WaferTable& table) {
  for (std::size_t b = 0; b < table.bores.size(); ++b) {
    const Bore& bore = table.bores[b];
    const std::string body = "wafer table: bore " + fmt::to_string(b + 1);
    require_positive(body, "diameter", bore.diameter);
    require_not_negative(body, "depth", bore.depth);
    require_less(body, "depth", bore.depth, "the height", table.height);
    require(bore.centre.allFinite() &&
                std::abs(bore.centre.x()) + bore.diameter / 2.0 < table.length / 2.0 &&
                std::abs(bore.centre.y()) + bore.diameter / 2.0 < table.width / 2.0,
            body + " at (" + text(bore.centre.x()) + ", " + text(bore.centre.y()) +
                ") with diameter " + text(bore.diameter) + " reaches outside the table of " +
                text(table.length) + " x " + text(table.width));
  }
}

}  // namespace

void require_positive(const std::string& body, const std::string& dimension, double value) {
  require(std::isfinite(value) && value > 0.0,
          body + ": " + dimension + " is " + text(value) + ", expected a positive length");
}

void require_fit(const Plate& plate) {
  require_positive("plate", "length", plate.length);
  require_positive("plate", "width", plate.width);
  require_positive("plate", "thickness", plate.thickness);
}

void require_fit(const Disc& disc) {
  require_positive("disc", "diameter", disc.diameter);
  require_positive("disc", "thickness", disc.thickness);
  require_not_negative("disc", "hole_diameter", disc.hole_diameter);
  require_less("disc", "hole_diameter", disc.hole_diameter, "the diameter", disc.diameter);
}

void require_fit(const Sphere& sphere) {
  require_positive("sphere", "diameter", sphere.diameter);
  require_not_negative("sphere", "hole_diameter", sphere.hole_diameter);
  require_less("sphere", "hole_diameter", sphere.hole_diameter, "the diameter", sphere.diameter);
}

void require_fit(const WaferTable& table) {
  require_positive("wafer table", "length", table.length);
  require_positive("wafer table", "width", table.width);
  require_positive("wafer table", "height", table.height);
  require_pockets_fit(table);
  require_cutouts_fit(table);
  require_bores_fit(table);
  require_not_negative("wafer table", "wafer_diameter", table.wafer_diameter);
  require_not_negative("wafer table", "wafer_thickness", table.wafer_thickness);
  require((table.wafer_diameter > 0.0) == (table.wafer_thickness > 0.0),
          "wafer table: wafer_diameter is " + text(table.wafer_diameter) + " and wafer_thickness " +
              text(table.wafer_thickness) + ", expected both or neither");
  if (table.wafer_diameter > 0.0) {
    require_less("wafer table", "wafer_diameter", table.wafer_diameter, "the shorter side",
                 std::min(table.length, table.width));
  }
}

void require_fit(const Layering& layering) {
  require_positive("mesh", "edge length", layering.edge_length);
  require_not_negative("mesh", "edge strip", layering.edge_strip);
  require(layering.layers >= 1 && layering.layers <= 1000,
          "mesh: layers is " + fmt::to_string(layering.layers) + ", expected 1 ... 1000");
  require(layering.across_ribs >= 1 && layering.across_ribs <= 100,
          "mesh: cells across a rib are " + fmt::to_string(layering.across_ribs) +
              ", expected 1 ... 100");
}

int cells_in(double length, double edge_length) {
  const double cells = std::ceil(length / edge_length - 1e-6);
  require(cells <= 1e5, "mesh: an edge length of " + text(edge_length) + " cuts " + text(length) +
                            " into more than 100 000 cells; is the unit right?");
  return std::max(1, static_cast<int>(cells));
}

double pocket_width(double length, int count, double rib, double rim) {
  return (length - 2.0 * rim - (count - 1) * rib) / count;
}

double rim_of(const WaferTable& table) { return table.rim > 0.0 ? table.rim : table.rib; }

Surface boundary_surface(const TetMesh& mesh) {
  Surface result;
  std::vector<std::int32_t> fresh(static_cast<std::size_t>(mesh.points.rows()), -1);
  std::vector<Eigen::Index> used;
  result.triangles.resize(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      std::int32_t& number = fresh[static_cast<std::size_t>(mesh.faces(f, a))];
      if (number < 0) {
        number = static_cast<std::int32_t>(used.size());
        used.push_back(mesh.faces(f, a));
      }
      result.triangles(f, a) = number;
    }
  }
  result.points.resize(static_cast<Eigen::Index>(used.size()), 3);
  for (std::size_t p = 0; p < used.size(); ++p) {
    result.points.row(static_cast<Eigen::Index>(p)) = mesh.points.row(used[p]);
  }
  result.patch = mesh.face_patch;
  result.patch_names = mesh.patch_names;
  return result;
}

}  // namespace chladni::mesh
