// Files of `diagnose`: the result, the extended study, the map on the body, the responses.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "host/atomic_file.h"
#include "io/heat_map_picture.h"
#include "io/vtu.h"
#include "show/comparison.h"
#include "show/diagnosis.h"
#include "show/diagnosis/errors_told.h"
#include "show/diagnosis/left_told.h"
#include "show/figures/stored_curves.h"
#include "stage/diagnosis_faces.h"
#include "steps/diagnosis.h"

namespace chladni::show {
namespace {

using Eigen::Index;

// The body's upper boundary, with new node numbers.
struct Top {
  Points points;
  Cells triangles;
};

Top top_of(const mesh::TetMesh& body, const stage::DiagnosedFaces& looked_at) {
  const auto& [chart, chosen, notes] = looked_at;
  std::vector<Index> kept;
  for (Index f = 0; f < body.faces.rows(); ++f) {
    if (!chosen.empty() && chosen[static_cast<std::size_t>(f)] == 0) continue;
    const Eigen::Vector3d a = body.points.row(body.faces(f, 0));
    const Eigen::Vector3d b = body.points.row(body.faces(f, 1));
    const Eigen::Vector3d c = body.points.row(body.faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.dot(chart.axes.col(2)) > 0.5 * normal.norm()) kept.push_back(f);
  }
  Top top;
  std::vector<std::int32_t> number(static_cast<std::size_t>(body.points.rows()), -1);
  std::vector<Index> nodes;
  top.triangles.resize(static_cast<Index>(kept.size()), 3);
  for (std::size_t n = 0; n < kept.size(); ++n) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto node = body.faces(kept[n], corner);
      auto& own = number[static_cast<std::size_t>(node)];
      if (own < 0) {
        own = static_cast<std::int32_t>(nodes.size());
        nodes.push_back(node);
      }
      top.triangles(static_cast<Index>(n), corner) = own;
    }
  }
  top.points = body.points(nodes, Eigen::all);
  return top;
}

// Values of the scan at points: a mean over its places, weighted by (d² + ¼ mean area)^-3.
Eigen::VectorXd at_points(const diagnosis::Surface& surface, const Eigen::VectorXd& values,
                          const Top& top, const stage::Chart& chart) {
  Eigen::VectorXd result(top.points.rows());
  const double soft = 0.25 * surface.area.mean();
  for (Index n = 0; n < result.size(); ++n) {
    const Eigen::Vector2d place = chart.place(top.points.row(n).transpose());
    const Eigen::ArrayXd distance2 =
        (surface.places.rowwise() - place.transpose()).rowwise().squaredNorm();
    const Eigen::ArrayXd weight = (distance2 + soft).pow(-3);
    result(n) = (weight * values.array()).sum() / weight.sum();
  }
  return result;
}

void leave_map(const study::Study& study, const steps::Diagnosed& one, Run& run) {
  const stage::Solution& solution = one.before;
  const auto& surface = one.structure.surface;
  const auto& map = one.result.map;
  if (map.explained.size() == 0) {
    run.put_aside("cause_map.vtu");
    run.put_aside("cause_map.png");
    return;
  }
  const auto faces = stage::diagnosed_faces(study, solution.model.body);
  const auto& chart = faces.chart;
  const Top top = top_of(solution.model.body, faces);
  const Eigen::VectorXd explained = at_points(surface, map.explained, top, chart);
  const Eigen::VectorXd posterior =
      at_points(surface, map.posterior.cwiseQuotient(surface.area.cwiseMax(1e-300)), top, chart);
  io::write_surface_vtu(run / "cause_map.vtu", top.points, top.triangles,
                        {{"explained", explained}, {"posterior_per_m2", posterior}},
                        {study.title, {"length: m", "explained: part of the misfit over noise"}});
  if (!run.options().pictures) return run.put_aside("cause_map.png");
  const double most = std::clamp(explained.maxCoeff(), 1e-3, 1.0);
  io::HeatMapPicture picture;
  picture.title = "Where one thing in one place would explain the difference";
  picture.scale = "part of the misfit over noise and tolerances";
  picture.lowest = "0 %";
  picture.highest = fmt::format("{:.3g} %", 100.0 * most);
  picture.points = top.points;
  picture.triangles = top.triangles;
  picture.value = (explained.array() / most).max(0.0).min(1.0);
  picture.forbidden.assign(static_cast<std::size_t>(explained.size()), 0);
  for (const auto& cause : one.result.best.causes) {
    if (!cause.place) continue;
    picture.best.push_back({surface.in_body(*cause.place), cause.effect});
  }
  picture.star = "the cause";
  picture.markers = stage::markers_of(study, solution.model);
  run.paint("cause_map.png", [&](const auto& png) { io::draw_heat_map(png, picture); });
}

}  // namespace

bool is_fitted(const steps::Diagnosed& one, Index i, Index j) {
  return std::ranges::binary_search(one.measured.outputs, i) &&
         std::ranges::binary_search(one.measured.inputs, j);
}

void leave_diagnosis(const study::Study& study, const steps::Diagnosed& one, Run& run,
                     bool main_result) {
  run.leave("diagnosis.json", diagnosis_json(one), main_result);
  if (one.extended) {
    write_atomically(run / "extended.toml", one.extended->text);
  } else {
    run.put_aside("extended.toml");
  }
  leave_map(study, one, run);
  if (one.modes) {
    return;
  }
  const auto& after = with_the_causes(one);
  const auto seen = [&](Index i, Index j) { return is_fitted(one, i, j); };
  run.paint("prediction.png", [&](const auto& png) {
    draw_responses(png, one.measured.all, one.predictions.before, after, seen);
  });
  leave_curves(run, "prediction_curves.json", [&] {
    return compared_responses(one.measured.all, one.predictions.before, after, seen,
                              kStoredCurvesBytes);
  });
  run.paint("errors_over_frequency.png",
            [&](const auto& png) { draw_errors_over_frequency(png, one.errors); });
  run.paint("mac.png", [&](const auto& png) { draw_mac(png, one.comparison); });
}

}  // namespace chladni::show
