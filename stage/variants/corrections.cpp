#include "stage/corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/field_matrices.h"
#include "mesh/surface.h"
#include "stage/estimates/waves.h"
#include "stage/plane_stress.h"
#include "stage/reduction/modal_stiffness.h"

namespace chladni::stage {
namespace {

void add_waves(const Solution& solution, const BodyUncertainty& uncertain,
               std::vector<priors::Correction>& all) {
  const int w = uncertain.waves;
  const auto& body = solution.model.body;
  const Eigen::MatrixXd fields = waves(body, w).rightCols(w * w - 1);  // all except the constant
  const auto matrices = fem::field_matrices(body, solution.model.materials, solution.modes.shapes,
                                            fields, Eigen::MatrixXd(body.tet_count(), 0));
  for (int k = 1; k < w * w; ++k) {
    const int a = k / w;
    const int b = k % w;
    all.push_back({fmt::format("stiffness wave {},{}", a, b),
                   unstrained(matrices.stiffness[static_cast<std::size_t>(k - 1)],
                              solution.modes.frequency_hz),
                   {},
                   uncertain.stiffness / std::sqrt(1.0 + 0.5 * (a * a + b * b))});
  }
}

void add_anisotropy(const Solution& solution, double deviation,
                    std::vector<priors::Correction>& all) {
  using Constants = Eigen::Matrix<double, 6, 6>;
  const auto add = [&](const std::string& name, const Constants& relative) {
    const auto change = [&](const fem::Material& material) -> Constants {
      return relative.cwiseProduct(material.stiffness);
    };
    all.push_back({name, modal_stiffness(solution.model, solution.modes, change), {}, deviation});
  };
  const auto [u, v] = longest_sides(solution.model.body);
  Constants relative = Constants::Zero();
  relative(u, u) = 1.0;
  relative(v, v) = -1.0;
  add("stiffness of one side against the other", relative);
  relative.setZero();
  relative(u, v) = relative(v, u) = 1.0;
  add("stiffness across", relative);
  relative.setZero();
  relative(shear_of(u, v), shear_of(u, v)) = 1.0;
  add("stiffness in shear", relative);
}

// Boundary nodes next to the points of a grid over the two longest sides; none if the boundary is
// more than half a pitch away.
std::vector<Eigen::Index> grid_nodes(const mesh::TetMesh& body, int along_first) {
  const auto box = mesh::bounding_box(body.points);
  const auto [u, v] = longest_sides(body);
  const Eigen::RowVector3d size = box.row(1) - box.row(0);
  const double pitch = size(u) / std::max(along_first - 1, 1);
  const int along_second = std::max(1, static_cast<int>(std::lround(size(v) / pitch)) + 1);
  std::vector<Eigen::Index> nodes;
  for (int k = 0; k < along_first * along_second; ++k) {
    const double at_v =
        along_second > 1 ? static_cast<double>(k / along_first) / (along_second - 1) : 0.5;
    const Eigen::Vector2d place(box(0, u) + pitch * (k % along_first), box(0, v) + at_v * size(v));
    double least = 0.5 * pitch;
    Eigen::Index nearest = -1;
    for (const auto node : body.faces.reshaped()) {
      const Eigen::Vector2d at(body.points(node, u), body.points(node, v));
      const double distance = (at - place).norm();
      if (distance > least - 1e-9 * pitch) continue;  // keeps the first of equally near ones
      least = distance;
      nearest = node;
    }
    if (nearest >= 0) nodes.push_back(nearest);
  }
  return nodes;
}

void add_masses(const Solution& solution, const BodyUncertainty& uncertain,
                std::vector<priors::Correction>& all) {
  const auto& body = solution.model.body;
  const auto nodes = grid_nodes(body, uncertain.masses);
  for (const auto node : nodes) {
    const auto rows = solution.modes.shapes.middleRows<3>(3 * node);
    const Eigen::RowVector3d at = body.points.row(node);
    all.push_back(
        {fmt::format("kg at ({:.3f}, {:.3f}, {:.3f}) m", at.x(), at.y(), at.z()),
         {},
         rows.transpose() * rows,
         uncertain.point_mass * solution.model.mass.mass_kg / static_cast<double>(nodes.size())});
  }
}

}  // namespace

std::vector<priors::Correction> corrections(const Solution& solution,
                                            const BodyUncertainty& uncertain) {
  std::vector<priors::Correction> all;
  if (uncertain.waves > 1) add_waves(solution, uncertain, all);
  if (uncertain.anisotropy > 0.0) add_anisotropy(solution, uncertain.anisotropy, all);
  if (uncertain.masses > 0) add_masses(solution, uncertain, all);
  return all;
}

}  // namespace chladni::stage
