#include "app/variation.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "app/upper_face.h"
#include "base/error.h"

namespace chladni::app {
namespace {

constexpr double kStep = 5e-3;  // of the logarithm, between two regions

double wave_sum(const std::array<double, 5>& waves, const Eigen::Vector2d& at) {
  const double u = at(0);
  const double v = at(1);
  return waves[0] * u + waves[1] * v + waves[2] * (1.5 * u * u - 0.5) + waves[3] * u * v +
         waves[4] * (1.5 * v * v - 0.5);
}

// What the varied quantity is multiplied by at a place of the chart.
double factor_at(const VariationPlan& plan, const Chart& chart, const Eigen::Vector2d& place) {
  const Eigen::Vector2d unit =
      2.0 * (place - chart.from).cwiseQuotient(chart.size) - Eigen::Vector2d::Ones();
  double factor = 1.0 + wave_sum(plan.waves, unit);
  if (plan.at) {
    const double t =
        (place - chart.place(plan.at->point)).squaredNorm() / (plan.radius * plan.radius);
    factor *= 1.0 + plan.relative * std::exp(-0.25 * std::numbers::pi * t * t);
  }
  return factor;
}

Eigen::Vector3d centre_of(const mesh::TetMesh& body, Eigen::Index tet) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int a = 0; a < 4; ++a) centre += 0.25 * body.points.row(body.tets(tet, a)).transpose();
  return centre;
}

}  // namespace

Eigen::MatrixX2d varied_factors(const Study& study, const mesh::TetMesh& body) {
  const Chart chart = chart_of(body);
  Eigen::MatrixX2d factors = Eigen::MatrixX2d::Ones(body.tet_count(), 2);
  for (std::size_t n = 0; n < study.variations.size(); ++n) {
    const auto& plan = study.variations[n];
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      const double factor = factor_at(plan, chart, chart.place(centre_of(body, t)));
      require(factor > 0.0, fmt::format("{}: variation {} makes the {} {:.3g} times as large; "
                                        "expected more than 0",
                                        study.file.string(), n + 1, plan.of, factor));
      factors(t, 0) *= plan.of == "thickness" ? factor * factor * factor : factor;
      if (plan.of == "thickness") factors(t, 1) *= factor;
    }
  }
  return factors;
}

void vary(const Study& study, mesh::TetMesh& body, std::vector<fem::Material>& materials) {
  if (study.variations.empty()) return;
  const Eigen::MatrixX2d factors = varied_factors(study, body);
  std::map<std::tuple<int, long, long>, int> regions;  // region and steps: the new one
  const auto names = body.region_names;
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const long stiffer = std::lround(std::log(factors(t, 0)) / kStep);
    const long heavier = std::lround(std::log(factors(t, 1)) / kStep);
    if (stiffer == 0 && heavier == 0) continue;
    const int own = body.region(t);
    const auto [found, is_new] =
        regions.try_emplace({own, stiffer, heavier}, static_cast<int>(materials.size()));
    body.region(t) = found->second;
    if (!is_new) continue;
    auto material = materials[static_cast<std::size_t>(own)];
    material.stiffness *= std::exp(kStep * static_cast<double>(stiffer));
    material.density *= std::exp(kStep * static_cast<double>(heavier));
    materials.push_back(material);
    body.region_names.push_back(
        fmt::format("{}, varied {}", names[static_cast<std::size_t>(own)], regions.size()));
  }
}

}  // namespace chladni::app
