// Files of `interpolate` for ParaView, a controller and the user.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/csv.h"
#include "io/heat_map_picture.h"
#include "io/vtu.h"
#include "mesh/surface.h"
#include "priors/polynomial.h"
#include "show/interpolation.h"
#include "show/modes_uff.h"
#include "steps/interpolation.h"

namespace chladni::show {
namespace {

constexpr Eigen::Index kMostPanels = 12;

std::string mode_of(const steps::Interpolated& result, Eigen::Index mode) {
  return fmt::format("mode_{:03d}_{:.2f}Hz", mode + 1, result.measured.shapes.frequency_hz(mode));
}

void leave_vtu(const std::string& title, const steps::Interpolated& result, const Run& run) {
  const auto& shown = result.methods.front();
  std::vector<io::NodeField> fields;
  for (Eigen::Index i = 0; i < shown.surface.mean.cols(); ++i) {
    fields.push_back({mode_of(result, i) + "_mean", shown.surface.mean.col(i)});
    fields.push_back({mode_of(result, i) + "_std", shown.surface.deviation.col(i)});
    if (result.measured.truth.size() == 0) continue;
    fields.push_back({mode_of(result, i) + "_truth", result.measured.truth.col(i)});
  }
  io::write_surface_vtu(run / "mode_field.vtu", result.surface.sites.position,
                        result.surface.triangles, fields,
                        {title, {"length: m", "shapes: the unit of the measured ones"}});
}

std::vector<io::Marker> measured_markers(const steps::Interpolated& result) {
  std::vector<io::Marker> markers;
  const auto add = [&](const priors::Places& places, const std::vector<std::string>& names,
                       const char* kind) {
    for (Eigen::Index k = 0; k < places.count(); ++k) {
      markers.push_back({names[static_cast<std::size_t>(k)], kind,
                         places.position.row(k).transpose(), places.direction.row(k).transpose()});
    }
  };
  add(result.measured.shapes.places, result.measured.channels, "sensor");
  add(result.measured.hidden.places, result.measured.hidden_channels, "held_out_sensor");
  return markers;
}

// Standard deviation of each shape on the surface: one panel per mode.
void leave_picture(const steps::Interpolated& result, Run& run) {
  const auto& shown = result.methods.front();
  const auto& area = result.simulation.area;
  io::LayoutsPicture picture{
      .title = std::string("Standard deviation of the interpolated shapes, ") + shown.method->name,
      .scale = "1 sigma over the shape's root mean square",
      .lightest = "0 %",
      .darkest = "100 %",
      .points = result.surface.sites.position,
      .triangles = result.surface.triangles,
      .panels = {}};
  const auto markers = measured_markers(result);
  for (Eigen::Index i = 0; i < std::min(kMostPanels, shown.surface.mean.cols()); ++i) {
    const double square = shown.surface.mean.col(i).cwiseAbs2().dot(area) / area.sum();
    const Eigen::ArrayXd part = shown.surface.deviation.col(i).array() / std::sqrt(square);
    picture.panels.push_back(
        {fmt::format("mode {}, {:.1f} Hz", i + 1, result.measured.shapes.frequency_hz(i)),
         fmt::format("largest {:.3g} %", 100.0 * part.maxCoeff()),
         (1.0 - part.min(1.0).sqrt()).matrix(), markers});
  }
  run.paint("mode_field.png", [&](const auto& png) { io::draw_layouts(png, picture); });
}

// A grid over the faces that the interpolation is on, seen from above, for a real-time target.
void leave_table(const steps::Interpolated& result, const stage::Solution& solution,
                 const study::InterpolationPlan& plan, const Run& run) {
  const placement::FaceFinder finder(solution.model.body, result.surface.faces);
  const auto box = mesh::bounding_box(result.surface.sites.position);
  std::vector<mesh::Site> sites;
  const Eigen::RowVector3d size = box.row(1) - box.row(0);
  const Eigen::Array2d count =
      (size.head<2>().array() / plan.table_pitch * (1.0 + 1e-12)).floor().transpose();
  require((count + 1.0).prod() < 1e7,
          "interpolation.table_pitch asks for more than 10 million "
          "places; choose a larger one");
  const auto steps = [&](Eigen::Index axis) { return static_cast<int>(count(axis)); };
  for (int i = 0; i <= steps(0); ++i) {
    for (int j = 0; j <= steps(1); ++j) {
      const double x =
          box(0, 0) + 0.5 * (size(0) - steps(0) * plan.table_pitch) + i * plan.table_pitch;
      const double y =
          box(0, 1) + 0.5 * (size(1) - steps(1) * plan.table_pitch) + j * plan.table_pitch;
      if (const auto site = finder.on_line(x, y)) sites.push_back(*site);
    }
  }
  Points directions(static_cast<Eigen::Index>(sites.size()), 3);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    directions.row(static_cast<Eigen::Index>(k)) =
        result.direction.value_or(sites[k].normal).transpose();
  }
  const auto places = steps::places_at(sites, directions, solution.modes, result.harmonics);
  const auto field = steps::field_at(result.methods.front(), places);
  std::vector<io::CsvColumn> columns = {{"x_m", Eigen::VectorXd(places.position.col(0))},
                                        {"y_m", Eigen::VectorXd(places.position.col(1))},
                                        {"z_m", Eigen::VectorXd(places.position.col(2))}};
  for (Eigen::Index i = 0; i < field.mean.cols(); ++i) {
    columns.push_back({fmt::format("mean_{}", i + 1), Eigen::VectorXd(field.mean.col(i))});
    columns.push_back({fmt::format("std_{}", i + 1), Eigen::VectorXd(field.deviation.col(i))});
  }
  io::write_csv(run / "mode_field.csv", columns);
}

// Polynomials are of x and y.
void require_seen_from_above(const placement::Sites& sites) {
  const Eigen::RowVector3d extent =
      sites.position.colwise().maxCoeff() - sites.position.colwise().minCoeff();
  for (const Eigen::Index axis : {0, 1}) {
    require(extent(axis) > 1e-6 * extent.maxCoeff(),
            fmt::format("interpolation.polynomial_degree: the places of the surface have one {}; "
                        "expected faces that are seen along z",
                        axis == 0 ? "x" : "y"));
  }
}

void leave_polynomials(const steps::Interpolated& result, int degree, Run& run) {
  require_seen_from_above(result.surface.sites);
  const auto& shown = result.methods.front();
  const auto fitted = priors::polynomials(result.surface.sites.position.leftCols<2>(),
                                          result.simulation.area, shown.surface.mean, degree);
  io::JsonArray powers;
  for (const auto row : fitted.powers.rowwise()) {
    powers.push_back(io::JsonArray{row(0), row(1)});
  }
  run.leave("mode_field_polynomial.json",
            {{"method", shown.method->name},
             {"basis",
              "sum of coefficients[mode][k] T_p(u) T_q(v), [p, q] = powers[k], Chebyshev; u "
              "= (x_m - centre_m[0]) / half_width_m[0], v likewise"},
             {"frequency_hz", io::Json(result.measured.shapes.frequency_hz)},
             {"centre_m", io::Json(fitted.centre)},
             {"half_width_m", io::Json(fitted.half_width)},
             {"powers", powers},
             {"coefficients", io::Json::rows(fitted.coefficients.transpose())},
             {"rms_error", io::Json(fitted.rms_error)},
             {"largest_error", io::Json(fitted.largest_error)}},
            false);
}

}  // namespace

void leave_interpolation(const study::Study& study, const stage::Solution& solution,
                         const steps::Interpolated& result, Run& run, bool main_result) {
  leave_vtu(study.title, result, run);
  leave_modes_uff(study, result, run);
  const auto plan = study.interpolation.value_or(study::InterpolationPlan{});
  if (plan.table_pitch > 0.0) leave_table(result, solution, plan, run);
  if (plan.polynomial_degree > 0) leave_polynomials(result, plan.polynomial_degree, run);
  if (result.measured.identified) leave_predictions(result, plan.predicted, run);
  if (run.options().pictures) {
    tell(run.progress(), "drawing");
    leave_picture(result, run);
  }
  run.leave("interpolation.json", interpolation_json(result), main_result);
}

}  // namespace chladni::show
