#include "placement/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "mesh/faces.h"
#include "placement/constants.h"

namespace chladni::placement {
namespace {

constexpr double kStraight = 1e-9;  // relative to its length: allowed distance of an inner node

bool forbids(const KeepOutBox& box, const Sites& sites, Eigen::Index i) {
  const Eigen::Array2d at = sites.position.row(i).head<2>().transpose();
  return (at >= box.from.array().min(box.to.array())).all() &&
         (at <= box.from.array().max(box.to.array())).all();
}

bool forbids(const KeepOutDisc& disc, const Sites& sites, Eigen::Index i) {
  const Eigen::Vector2d at = sites.position.row(i).head<2>().transpose();
  return (at - disc.centre).norm() <= 0.5 * disc.diameter;
}

bool forbids(const KeepOutPatch& patch, const Sites& sites, Eigen::Index i) {
  return sites.patch(i) == patch.patch;
}

bool forbids(const KeepFromEdges& edges, const Sites& sites, Eigen::Index i) {
  const Eigen::RowVector3d at = sites.position.row(i);
  const double reach = edges.distance * edges.distance;
  for (Eigen::Index e = 0; e < edges.from.rows(); ++e) {
    const Eigen::RowVector3d along = edges.to.row(e) - edges.from.row(e);
    const Eigen::RowVector3d away = at - edges.from.row(e);
    const double length = along.squaredNorm();
    const double t = length > 0.0 ? std::clamp(away.dot(along) / length, 0.0, 1.0) : 0.0;
    if ((away - t * along).squaredNorm() < reach * (1.0 - 1e-9)) return true;
  }
  return false;
}

bool forbids(const KeepFromPlaces& there, const Sites& sites, Eigen::Index i) {
  const Eigen::RowVector3d at = sites.position.row(i);
  for (const auto place : there.places.rowwise()) {
    if ((at - place).norm() < there.distance * (1.0 - 1e-9)) return true;
  }
  return false;
}

bool forbids(const WholeFootprints&, const Sites& sites, Eigen::Index i) {
  return sites.whole[static_cast<std::size_t>(i)] == 0;
}

// An edge of a face from end to end: its two ends if it is straight, else Constants::pieces
// pieces of its curve.
Points points_along(const mesh::TetMesh& body, Eigen::Index face, int edge) {
  const auto& [a, b] = mesh::kTriangleEdges[static_cast<std::size_t>(edge)];
  const int inner = body.order() - 1;
  Points nodes(2 + inner, 3);
  nodes.row(0) = body.points.row(body.faces(face, a));
  nodes.row(1) = body.points.row(body.faces(face, b));
  double off = 0.0;
  for (int k = 0; k < inner; ++k) {
    nodes.row(2 + k) = body.points.row(body.faces(face, 3 + edge * inner + k));
    const double t = (k + 1.0) / (inner + 1.0);
    off = std::max(off, (nodes.row(2 + k) - (1.0 - t) * nodes.row(0) - t * nodes.row(1)).norm());
  }
  if (off <= kStraight * (nodes.row(1) - nodes.row(0)).norm()) return nodes.topRows(2);
  Points line(Constants::pieces + 1, 3);
  for (int i = 0; i <= Constants::pieces; ++i) {
    const double t = static_cast<double>(i) / Constants::pieces;
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
    barycentric(a) = 1.0 - t;
    barycentric(b) = t;
    const Eigen::VectorXd shape = mesh::triangle_shape(body.order(), barycentric);
    line.row(i).setZero();
    for (Eigen::Index n = 0; n < shape.size(); ++n) {
      line.row(i) += shape(n) * body.points.row(body.faces(face, n));
    }
  }
  return line;
}

}  // namespace

Eigen::VectorXi forbidden_by(const Sites& sites, const std::vector<Rule>& rules) {
  Eigen::VectorXi forbidden = Eigen::VectorXi::Constant(sites.count(), -1);
  for (std::size_t r = 0; r < rules.size(); ++r) {
    for (Eigen::Index i = 0; i < sites.count(); ++i) {
      if (forbidden(i) >= 0) continue;
      const bool hit =
          std::visit([&](const auto& what) { return forbids(what, sites, i); }, rules[r].what);
      if (hit) forbidden(i) = static_cast<int>(r);
    }
  }
  return forbidden;
}

std::vector<Eigen::Index> within(const Sites& sites, const std::vector<Rule>& zones) {
  const Eigen::VectorXi zone = forbidden_by(sites, zones);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < zone.size(); ++i) {
    if (zone(i) >= 0) rows.push_back(i);
  }
  return rows;
}

std::vector<Eigen::Index> admissible(const Eigen::VectorXi& forbidden,
                                     const std::vector<Rule>& rules) {
  std::vector<Eigen::Index> rows;
  std::vector<int> taken(rules.size(), 0);
  for (Eigen::Index i = 0; i < forbidden.size(); ++i) {
    if (forbidden(i) < 0) {
      rows.push_back(i);
    } else {
      ++taken[static_cast<std::size_t>(forbidden(i))];
    }
  }
  if (!rows.empty()) return rows;
  std::string text = "placement: no admissible site is left of " + fmt::to_string(forbidden.size());
  std::string last;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    if (taken[r] == 0) continue;
    text += std::string(last.empty() ? ": " : ", ") + rules[r].name + " took " +
            fmt::to_string(taken[r]);
    last = rules[r].name;
  }
  throw InvalidInput(text + (last.empty() ? "" : "; the last ones went to " + last));
}

KeepFromEdges edges_of(const mesh::TetMesh& body, const std::vector<std::string>& patches,
                       double distance) {
  return edges_around(body, mesh::faces_of_patches(body, patches, "placement"), true, distance);
}

KeepFromEdges edges_around(const mesh::TetMesh& body, const std::vector<char>& faces,
                           bool between_patches, double distance) {
  struct Use {
    int patch, wanted, others;
    Eigen::Index face;
    int edge;
  };
  std::map<std::pair<int, int>, Use> uses;
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    const int patch = between_patches ? body.face_patch(f) : 0;
    for (int e = 0; e < 3; ++e) {
      const auto& [a, b] = mesh::kTriangleEdges[static_cast<std::size_t>(e)];
      const auto key = std::minmax({body.faces(f, a), body.faces(f, b)});
      Use& use = uses.try_emplace(key, Use{patch, 0, 0, f, e}).first->second;
      ++(faces[static_cast<std::size_t>(f)] != 0 ? use.wanted : use.others);
      if (use.patch != patch) ++use.others;
    }
  }
  std::vector<Eigen::RowVector3d> from;
  std::vector<Eigen::RowVector3d> to;
  for (const auto& [ends, use] : uses) {
    if (use.wanted == 0 || (use.others == 0 && use.wanted == 2)) continue;
    const Points line = points_along(body, use.face, use.edge);
    for (Eigen::Index k = 0; k + 1 < line.rows(); ++k) {
      from.emplace_back(line.row(k));
      to.emplace_back(line.row(k + 1));
    }
  }
  KeepFromEdges edges{distance, Points(std::ssize(from), 3), Points(std::ssize(from), 3)};
  for (std::size_t e = 0; e < from.size(); ++e) {
    edges.from.row(static_cast<Eigen::Index>(e)) = from[e];
    edges.to.row(static_cast<Eigen::Index>(e)) = to[e];
  }
  return edges;
}

}  // namespace chladni::placement
