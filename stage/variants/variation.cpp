#include "stage/variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "base/error.h"
#include "stage/reduction/upper_face.h"

namespace chladni::stage {
namespace {

// Step in ln between two regions: at most this, and at most this part of the largest change.
constexpr double kMostStep = 5e-3;
constexpr double kStepsOfLargest = 256.0;

double wave_sum(const std::array<double, 5>& waves, const Eigen::Vector2d& at) {
  const double u = at(0);
  const double v = at(1);
  return waves[0] * u + waves[1] * v + waves[2] * (1.5 * u * u - 0.5) + waves[3] * u * v +
         waves[4] * (1.5 * v * v - 0.5);
}

// Factor of the varied quantity at a place of the chart.
double factor_at(const study::VariationPlan& plan, const Chart& chart,
                 const Eigen::Vector2d& place) {
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

// Four places within a cell; their mean is exact for any quadratic over it (Hammer and Stroud
// 1956).
std::array<Eigen::Vector3d, 4> places_in(const mesh::TetMesh& body, Eigen::Index tet) {
  constexpr double kNear = 0.5854101966249685;  // (5 + 3 √5) / 20
  constexpr double kFar = (1.0 - kNear) / 3.0;
  std::array<Eigen::Vector3d, 4> places;
  for (int p = 0; p < 4; ++p) {
    auto& place = places[static_cast<std::size_t>(p)];
    place.setZero();
    for (int a = 0; a < 4; ++a) {
      place += (a == p ? kNear : kFar) * body.points.row(body.tets(tet, a)).transpose();
    }
  }
  return places;
}

// Step that is small enough for small variations too.
double step_of(const Eigen::VectorXd& logarithms) {
  const double largest = logarithms.cwiseAbs().maxCoeff();
  return largest > 0.0 ? std::min(kMostStep, largest / kStepsOfLargest) : kMostStep;
}

}  // namespace

Eigen::MatrixX2d varied_factors(const study::Study& study, const mesh::TetMesh& body) {
  const Chart chart = chart_of(body);
  Eigen::MatrixX2d factors = Eigen::MatrixX2d::Ones(body.tet_count(), 2);
  for (std::size_t n = 0; n < study.variations.size(); ++n) {
    const auto& plan = study.variations[n];
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      Eigen::RowVector2d mean(0.0, 0.0);
      for (const auto& place : places_in(body, t)) {
        const double factor = factor_at(plan, chart, chart.place(place));
        require(factor > 0.0, fmt::format("{}: variation {} makes the {} {:.3g} times as large; "
                                          "expected more than 0",
                                          study.file.string(), n + 1, plan.of, factor));
        const bool thicker = plan.of == "thickness";
        mean += 0.25 * Eigen::RowVector2d(thicker ? factor * factor * factor : factor,
                                          thicker ? factor : 1.0);
      }
      factors.row(t).array() *= mean.array();
    }
  }
  return factors;
}

void vary(const study::Study& study, mesh::TetMesh& body, std::vector<fem::Material>& materials) {
  if (study.variations.empty()) return;
  const Eigen::MatrixX2d logarithms = varied_factors(study, body).array().log();
  const double stiffness_step = step_of(logarithms.col(0));
  const double mass_step = step_of(logarithms.col(1));
  std::map<std::tuple<int, long, long>, int> regions;  // (old region, steps) to new region
  const auto names = body.region_names;
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const long stiffer = std::lround(logarithms(t, 0) / stiffness_step);
    const long heavier = std::lround(logarithms(t, 1) / mass_step);
    if (stiffer == 0 && heavier == 0) continue;
    const int own = body.region(t);
    const auto [found, is_new] =
        regions.try_emplace({own, stiffer, heavier}, static_cast<int>(materials.size()));
    body.region(t) = found->second;
    if (!is_new) continue;
    auto material = materials[static_cast<std::size_t>(own)];
    material.stiffness *= std::exp(stiffness_step * static_cast<double>(stiffer));
    material.density *= std::exp(mass_step * static_cast<double>(heavier));
    materials.push_back(material);
    body.region_names.push_back(
        fmt::format("{}, varied {}", names[static_cast<std::size_t>(own)], regions.size()));
  }
}

}  // namespace chladni::stage
