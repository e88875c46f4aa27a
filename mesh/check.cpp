#include "mesh/check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mesh/soundness/clean.h"
#include "mesh/soundness/defects.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

using Severity = Finding::Severity;
constexpr std::size_t most_places = 20;
constexpr std::size_t most_crossings = 10;

template <typename... Arguments>
std::string text_of(const char* format, Arguments... arguments) {
  const int size = std::snprintf(nullptr, 0, format, arguments...);
  std::string text(static_cast<std::size_t>(size), '\0');
  std::snprintf(text.data(), text.size() + 1, format, arguments...);
  return text;
}

std::string place(const Eigen::Vector3d& point) {
  return text_of("(%.5g, %.5g, %.5g) mm", 1e3 * point.x(), 1e3 * point.y(), 1e3 * point.z());
}

std::string length_text(double length) {
  return length < 1.0 ? text_of("%.4g mm", 1e3 * length) : text_of("%.4g m", length);
}

// "1 hole", "3 holes"
std::string counted(std::size_t count, const std::string& thing) {
  return fmt::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

// "a, b, c and 4 more"
std::string listed(const std::vector<std::string>& things, std::size_t most = most_places) {
  std::string text;
  for (std::size_t i = 0; i < std::min(things.size(), most); ++i) {
    text += (i == 0 ? "" : ", ") + things[i];
  }
  return things.size() > most ? text + " and " + fmt::to_string(things.size() - most) + " more"
                              : text;
}

class Checker {
 public:
  Checker(Surface& surface, const RepairOptions& options) : surface_(surface), options_(options) {}

  SurfaceReport report() && {
    if (!has_sound_numbers()) return report_;
    note_size_and_place();
    if (!fills_space()) return report_;
    clean();
    fill_holes();
    const bool closed = find_holes();
    find_non_manifold();
    find_crossings();
    if (closed) orient_and_weigh();
    return report_;
  }

 private:
  void add(Severity severity, const std::string& what, const std::string& remedy = "") {
    report_.findings.push_back({severity, what, remedy});
  }

  bool has_sound_numbers() {
    if (surface_.triangles.rows() == 0) {
      add(Severity::refused, "the surface has no triangles", "give a closed surface");
    } else if (surface_.triangles.cols() != 3 ||
               surface_.patch.size() != surface_.triangles.rows()) {
      add(Severity::refused,
          text_of("%td patches for %td triangles of %td points", surface_.patch.size(),
                  surface_.triangles.rows(), surface_.triangles.cols()),
          "give one patch per triangle of three points");
    } else {
      find_wrong_indices();
      find_points_not_finite();
    }
    return report_.fit();
  }

  void find_wrong_indices() {
    std::vector<std::string> wrong;
    for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
      const auto row = surface_.triangles.row(t);
      const bool inside = row.minCoeff() >= 0 && row.maxCoeff() < surface_.points.rows();
      if (!inside) wrong.push_back(fmt::to_string(t));
      const int patch = surface_.patch[t];
      if (patch < 0 || patch >= static_cast<int>(surface_.patch_names.size())) {
        wrong.push_back(fmt::to_string(t) + " (patch " + fmt::to_string(patch) + ")");
      }
    }
    if (wrong.empty()) return;
    add(Severity::refused,
        "triangles that name a point or a patch there is none of: " + listed(wrong),
        text_of("expected points 0 to %td", surface_.points.rows() - 1));
  }

  void find_points_not_finite() {
    std::vector<std::string> wrong;
    for (Eigen::Index i = 0; i < surface_.points.rows(); ++i) {
      if (!surface_.points.row(i).allFinite()) wrong.push_back(fmt::to_string(i));
    }
    if (wrong.empty()) return;
    add(Severity::refused,
        counted(wrong.size(), "point") + " not finite (NaN or infinite): number " + listed(wrong),
        "export the surface again");
  }

  void note_size_and_place() {
    const auto box = bounding_box(surface_.points);
    const double extent = (box.row(1) - box.row(0)).maxCoeff();
    if (extent > 0.0 && (extent < 1e-3 || extent > 10.0)) {
      add(Severity::note, "the body is " + length_text(extent) + " long: is the unit right?");
    }
    const double away = box.cwiseAbs().maxCoeff();
    if (away > 1e4 * extent) {
      add(Severity::note,
          text_of("the body lies %.3g m from the origin, %.0e times its size: the last %.0f of 16 "
                  "digits of its coordinates are lost; move it to the origin",
                  away, away / extent, std::log10(away / extent)));
    }
  }

  // Whether the points span more than a plane.
  bool fills_space() {
    const Points centred = surface_.points.rowwise() - surface_.points.colwise().mean();
    const Eigen::Matrix3d scatter = centred.transpose() * centred;
    const Eigen::Vector3d spread =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
    const Eigen::Vector3d across =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
    const double thickness = (centred * across).cwiseAbs().maxCoeff();
    if (spread[2] > 0.0 && thickness > smallest_length(surface_)) return true;
    add(Severity::refused, "volume 0: all points lie in one plane",
        "give the body a thickness (is a dimension 0?)");
    return false;
  }

  void clean() {
    const double tolerance = smallest_length(surface_);
    const auto before = static_cast<double>(surface_.triangles.rows());
    const int merged = merge_points(surface_, tolerance);
    int degenerate = remove_degenerate_triangles(surface_, tolerance);
    const int duplicate = remove_duplicate_triangles(surface_);
    degenerate += remove_degenerate_triangles(surface_, tolerance);
    const int unused = remove_unused_points(surface_) - merged;
    say(merged, "merged ", "duplicate point");
    say(duplicate, "removed ", "duplicate triangle");
    say(degenerate, "removed ", "degenerate triangle");
    say(unused, "removed ", "unused point");
    if (duplicate + degenerate > 0.01 * before) {
      add(Severity::note, text_of("more than 1 %% of the triangles were degenerate or duplicates: "
                                  "look at where the surface comes from"));
    }
  }

  void say(int count, const std::string& done, const std::string& thing) {
    if (count > 0) add(Severity::repaired, done + counted(static_cast<std::size_t>(count), thing));
  }

  void fill_holes() {
    if (!options_.fill_holes) return;
    std::vector<Eigen::Vector3i> triangles;
    std::size_t filled = 0;
    for (const Hole& hole : holes(surface_)) {
      if (!hole.simple || hole.edges > options_.largest_hole_edges) continue;
      const std::vector<Eigen::Vector3i> patch = filling(surface_, hole.points);
      if (!patch.empty()) ++filled;
      triangles.insert(triangles.end(), patch.begin(), patch.end());
    }
    if (filled == 0) return;
    const auto patch = static_cast<int>(surface_.patch_names.size());
    surface_.patch_names.emplace_back("filled");
    append_triangles(surface_, triangles, std::vector<int>(triangles.size(), patch));
    remove_degenerate_triangles(surface_, smallest_length(surface_));
    add(Severity::repaired, counted(filled, "hole") + " filled with " +
                                counted(triangles.size(), "triangle") + " (patch \"filled\")");
  }

  bool find_holes() {
    const std::vector<Hole> open = holes(surface_);
    if (open.empty()) return true;
    add(Severity::refused,
        "the surface is open: " + counted(open.size(), "hole") + ", the largest near " +
            place(open[0].centre) + ", " + counted(static_cast<std::size_t>(open[0].edges), "edge"),
        options_.fill_holes ? "close it in CAD; too large or too tangled to fill"
                            : "close it in CAD, or set repair = \"fill\"");
    return false;
  }

  void find_non_manifold() {
    std::vector<std::string> places;
    if (surface_.regions.size() < 2) {
      for (const Eigen::Vector2i& edge : crowded_edges(surface_)) {
        places.push_back(place(surface_.points.row(edge[0])) + " to " +
                         place(surface_.points.row(edge[1])));
      }
    }
    if (!places.empty()) {
      add(Severity::refused,
          "not a manifold: " + counted(places.size(), "edge") +
              " with more than two triangles: " + listed(places),
          "unite the parts that touch there in CAD, or give them as two regions");
    }
    std::vector<std::string> pinched;
    for (const int i : pinched_points(surface_)) pinched.push_back(place(surface_.points.row(i)));
    if (pinched.empty()) return;
    add(Severity::refused,
        "not a manifold: " + counted(pinched.size(), "point") +
            " where parts touch in nothing but the point: " + listed(pinched),
        "separate or unite the parts in CAD");
  }

  void find_crossings() {
    const std::vector<Crossing> found = crossings(surface_);
    if (found.empty()) return;
    std::vector<std::string> pairs;
    for (const Crossing& c : found) {
      pairs.push_back(text_of("%d and %d near ", c.first, c.second) + place(c.place));
    }
    add(Severity::refused,
        "the surface intersects itself: " + counted(found.size(), "pair") + " of triangles, " +
            listed(pairs, most_crossings),
        "unite overlapping parts and remove folds in CAD");
  }

  void orient_and_weigh() {
    const Shells found = shells(surface_);
    const Material filled = material(surface_, found);
    turn(found, filled);
    report_.volume = filled.volume;
    report_.bodies = static_cast<int>(filled.bodies.size());
    for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
      if (filled.outer(static_cast<std::size_t>(t))) report_.area += area(t);
    }
    if (filled.void_count > 0) {
      add(Severity::note,
          counted(static_cast<std::size_t>(filled.void_count), "closed void") + " inside the body");
    }
    find_bodies(filled);
    find_seeds_outside(filled);
    find_thin_walls();
  }

  [[nodiscard]] double area(Eigen::Index t) const {
    const Eigen::Vector3d a = surface_.points.row(surface_.triangles(t, 0));
    const Eigen::Vector3d b = surface_.points.row(surface_.triangles(t, 1));
    const Eigen::Vector3d c = surface_.points.row(surface_.triangles(t, 2));
    return 0.5 * (b - a).cross(c - a).norm();
  }

  // Turns triangles so that the material is behind every outer triangle. Triangles between two
  // regions are all turned the same way.
  void turn(const Shells& found, const Material& filled) {
    std::size_t turned = 0;
    std::size_t outer = 0;
    for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
      const auto i = static_cast<std::size_t>(t);
      const bool is_outer = filled.outer(i);
      const bool wrong = is_outer ? filled.front[i] == 1 : found.front[i] < found.back[i];
      if (wrong) std::swap(surface_.triangles(t, 1), surface_.triangles(t, 2));
      outer += is_outer ? 1 : 0;
      turned += is_outer && wrong ? 1 : 0;
    }
    if (turned == 0) return;
    add(Severity::repaired,
        turned == outer
            ? "the surface was inside out: turned"
            : text_of("%zu of %zu triangles faced the wrong way: turned", turned, outer));
  }

  void find_bodies(const Material& filled) {
    if (filled.bodies.size() < 2) return;
    std::vector<std::string> list;
    for (const Material::Body& body : filled.bodies) {
      list.push_back(text_of("%.4g mm^3 around ", 1e9 * body.volume) + place(body.centre));
    }
    add(Severity::refused,
        fmt::to_string(list.size()) + " bodies that do not touch each other: " + listed(list),
        "give one body, or join them in CAD");
  }

  void find_seeds_outside(const Material& filled) {
    std::vector<int> sign;
    for (std::size_t t = 0; t < filled.front.size(); ++t) sign.push_back(filled.outer(t) ? 1 : 0);
    for (const Region& region : surface_.regions) {
      if (!region.inside.allFinite() || winding_number(surface_, sign, region.inside) < 0.5) {
        add(Severity::refused,
            "region \"" + region.name + "\": its inside point " + place(region.inside) +
                " lies outside of the body",
            "give a point inside");
      }
    }
  }

  void find_thin_walls() {
    const auto box = bounding_box(surface_.points);
    const double extent = (box.row(1) - box.row(0)).norm();
    const double wall = 2.0 * report_.volume / report_.area;
    if (wall > 1e-5 * extent) return;
    add(Severity::refused,
        "volume " + text_of("%.3g", report_.volume * 1e9) + " mm^3: walls of " + length_text(wall) +
            " on a body of " + length_text(extent),
        "tetrahedra need walls of at least 1e-5 of the body; is a dimension or its unit wrong?");
  }

  Surface& surface_;
  RepairOptions options_;
  SurfaceReport report_;
};

}  // namespace

bool SurfaceReport::fit() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.severity == Severity::refused; });
}

std::string SurfaceReport::text() const {
  std::string text;
  for (const Finding& finding : findings) {
    const char* kind = finding.severity == Severity::refused    ? "refused: "
                       : finding.severity == Severity::repaired ? "repaired: "
                                                                : "note: ";
    text += (text.empty() ? "" : "\n") + (kind + finding.what);
    if (!finding.remedy.empty()) text += "; " + finding.remedy;
  }
  return text;
}

SurfaceReport check_and_repair(Surface& surface, const RepairOptions& options) {
  return Checker(surface, options).report();
}

}  // namespace chladni::mesh
