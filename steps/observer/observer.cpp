#include "steps/observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "stage/points_on_body.h"
#include "steps/observer/deviations.h"
#include "steps/observer/stated.h"
#include "steps/predicted.h"
#include "steps/rigid_body.h"

namespace chladni::steps {
namespace {

using identification::ObservedPlaces;
using identification::PlacesOfInterest;

// Shapes and residual at sites, by the first method of interpolation.
PlacesOfInterest interest_at(const Interpolated& shapes, const stage::Solution& solution,
                             const std::vector<mesh::Site>& sites, const Points& directions) {
  const auto places = places_at(sites, directions, solution.modes, shapes.harmonics);
  return places_of_interest(shapes, places, field_at(shapes.methods.front(), places));
}

Eigen::RowVector3d direction_of(const std::optional<Eigen::Vector3d>& stated,
                                const Interpolated& shapes, const mesh::Site& site) {
  return stated.value_or(shapes.direction.value_or(site.normal)).transpose();
}

void append_rows(Eigen::MatrixXd& rows, const Eigen::MatrixXd& below) {
  if (below.rows() == 0) return;
  const auto n = rows.rows();
  rows.conservativeResize(n + below.rows(), below.cols());
  rows.bottomRows(below.rows()) = below;
}

void append(PlacesOfInterest& all, const PlacesOfInterest& more) {
  append_rows(all.shapes, more.shapes);
  append_rows(all.deviation, more.deviation);
  append_rows(all.residual, more.residual);
  append_rows(all.imaginary, more.imaginary);
  append_rows(all.imaginary_deviation, more.imaginary_deviation);
  append_rows(all.residual_deviation, more.residual_deviation);
}

void add_note(const std::string& note, Observer& result) {
  if (!note.empty()) result.notes.push_back(note);
}

// The points of the study, then the held-out sensors of displacement.
void add_points(const study::Study& study, const stage::Solution& solution,
                const mesh::SiteFinder& finder, const Interpolated& shapes, Observer& result) {
  const auto& plan = *study.observer;
  std::vector<mesh::Site> sites;
  Points directions(std::ssize(plan.points), 3);
  const double reach = stage::reach_of(solution.model.body);
  for (const auto& point : plan.points) {
    sites.push_back(site_of(study, finder, reach, point.at, "point \"" + point.name + "\""));
    directions.row(std::ssize(sites) - 1) = direction_of(point.direction, shapes, sites.back());
    result.places.points.push_back(point.name);
  }
  if (!sites.empty()) result.places.at_points = interest_at(shapes, solution, sites, directions);
  add_note(left_out_across_z(shapes, result.places.points, directions), result);
  const auto& hidden = shapes.measured.hidden_channels;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const auto at = index_of(study.sensors, hidden[i]);
    if (at < 0 || study.sensors[static_cast<std::size_t>(at)].quantity != "displacement") continue;
    require(std::ranges::find(result.places.points, hidden[i]) == result.places.points.end(),
            "observer.point: \"" + hidden[i] + "\" is a held-out sensor, which is a point already");
    rows.push_back(static_cast<Eigen::Index>(i));
    result.places.points.push_back(hidden[i]);
  }
  result.judges = std::ssize(rows);
  require(!result.places.points.empty(),
          "the observer has nothing to estimate; expected [[observer.point]] with name and at, or "
          "sensors in measurement.hold_out");
  if (rows.empty()) return;
  const auto places = priors::part(shapes.measured.hidden.places, rows);
  const auto& field = shapes.methods.front().hidden;
  append(result.places.at_points,
         places_of_interest(shapes, places,
                            {field.mean(rows, Eigen::all), field.deviation(rows, Eigen::all)}));
}

Eigen::VectorXd floor_of(const study::Study& study, const IdentifiedModel& model) {
  const auto body = rigid_body_of_channels(study, model);
  std::vector<Eigen::Index> rigid;
  for (Eigen::Index m = 0; m < model.found.fit.model.rigid_count; ++m) rigid.push_back(m);
  if (body) rigid.insert(rigid.end(), body->suspended.begin(), body->suspended.end());
  Eigen::VectorXd along(std::ssize(model.match.rows));
  for (std::size_t i = 0; i < model.match.rows.size(); ++i) {
    const auto& row = model.match.rows[i];
    const auto& side = row.actuator ? model.seen.inputs : model.seen.outputs;
    along(static_cast<Eigen::Index>(i)) = side[static_cast<std::size_t>(row.channel)].direction.z();
  }
  auto floor = identification::floor_participation(model.match, rigid, along);
  require(floor.size() > 0,
          "observer.disturbance of the floor: no identified mode moves the body as a whole, so "
          "that nothing says how the floor moves it; expected rigid-body or suspended modes");
  return floor;
}

// Forces at places and the floor become inputs; each disturbance acts at one.
void add_disturbances(const study::Study& study, const stage::Solution& solution,
                      const mesh::SiteFinder& finder, const Interpolated& shapes,
                      Observer& result) {
  const auto& model = identified_of(shapes);
  const auto actuators = std::ssize(model.seen.inputs);
  std::vector<mesh::Site> sites;
  std::vector<Eigen::RowVector3d> along;
  std::vector<const study::DisturbancePlan*> on_floor;
  const double reach = stage::reach_of(solution.model.body);
  for (const auto& plan : study.observer->disturbances) {
    if (plan.kind == "floor") on_floor.push_back(&plan);
    if (plan.kind == "force") {
      sites.push_back(site_of(study, finder, reach, plan.at, "disturbance \"" + plan.name + "\""));
      along.push_back(direction_of(plan.direction, shapes, sites.back()));
      result.force_directions.emplace_back(along.back().transpose());
      result.places.forces.push_back(plan.name);
      result.disturbances.push_back(
          disturbance_of(plan, plan.name, actuators + std::ssize(sites) - 1));
    }
    if (plan.kind != "actuators") continue;
    for (Eigen::Index j = 0; j < actuators; ++j) {
      const auto& name = model.seen.inputs[static_cast<std::size_t>(j)].name;
      const auto& chosen = plan.actuators;
      if (!chosen.empty() && std::ranges::find(chosen, name) == chosen.end()) continue;
      result.disturbances.push_back(disturbance_of(plan, plan.name + "_" + name, j));
    }
  }
  if (!sites.empty()) {
    Points directions(std::ssize(sites), 3);
    for (std::size_t i = 0; i < along.size(); ++i) {
      directions.row(static_cast<Eigen::Index>(i)) = along[i];
    }
    result.places.at_forces = interest_at(shapes, solution, sites, directions);
    add_note(left_out_across_z(shapes, result.places.forces, directions), result);
  }
  if (on_floor.empty()) return;
  result.places.floor = floor_of(study, model);
  for (const auto* plan : on_floor) {
    result.disturbances.push_back(disturbance_of(*plan, plan->name, actuators + std::ssize(sites)));
  }
}

double sample_time(const study::Study& study, const Recordings* recorded) {
  const double asked = study.observer->sample_rate_hz;
  if (recorded != nullptr) {
    const double rate = 1.0 / recorded->sample_time_s;
    require(asked == 0.0 || std::abs(asked - rate) <= 1e-6 * rate,
            fmt::format("observer.sample_rate is {:.9g} Hz and {} has {:.9g} Hz; expected one rate",
                        asked, recorded->file, rate));
    return recorded->sample_time_s;
  }
  const double rate = stated_sample_rate(study);
  require(rate > 0.0,
          "the observer has no sample rate; expected observer.sample_rate = \"10 kHz\", or "
          "recordings");
  return 1.0 / rate;
}

Eigen::VectorXd sensor_noise(const study::Study& study, Eigen::Index sensors,
                             const Recordings* recorded) {
  if (study.observer->noise > 0.0) return Eigen::VectorXd::Constant(sensors, study.observer->noise);
  const Eigen::VectorXd found = recorded != nullptr ? Eigen::VectorXd(recorded->noise.head(sensors))
                                                    : Eigen::VectorXd::Zero(sensors);
  require(found.allFinite() && found.minCoeff() > 0.0,
          "the noise of the sensors is not known: there are no recordings with two periods or more "
          "that differ; expected observer.noise, such as \"2 nm\"");
  return found;
}

// m×n: the modal coordinates [kg^1/2 m] of the plant's states. They are outputs with unit shapes.
Eigen::MatrixXd modal_coordinates(const IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  const auto m = fit.model.mode_count();
  ObservedPlaces unit;
  for (Eigen::Index k = 0; k < m; ++k) unit.points.push_back(fmt::format("coordinate_{}", k + 1));
  unit.at_points.shapes = Eigen::MatrixXd::Identity(m, m);
  unit.at_points.residual = Eigen::MatrixXd::Zero(m, fit.model.input_count());
  if (fit.complex) unit.at_points.imaginary = Eigen::MatrixXd::Zero(m, m);
  return identification::observed_plant(fit, model.match, model.seen.outputs, model.seen.inputs,
                                        unit)
      .space.c.bottomRows(m);
}

// Forces that were measured go on between their samples; commands are held.
modal::InputCourse course_of(const study::Study& study) {
  const bool measured = study.measurement && study.measurement->recording.inputs == "forces";
  return measured ? modal::InputCourse::linear : modal::InputCourse::held;
}

}  // namespace

Observer observer(const study::Study& study, const stage::Solution& solution,
                  std::shared_ptr<const Interpolated> shapes, const Recordings* recorded,
                  stage::Work& work) {
  require(study.observer.has_value(), study.file.string() + ": there is no [observer]");
  const auto& model = identified_of(*shapes);
  const mesh::SiteFinder finder(solution.model.body);
  Observer result;
  add_points(study, solution, finder, *shapes, result);
  add_disturbances(study, solution, finder, *shapes, result);
  result.sample_time_s = sample_time(study, recorded);
  result.plant = identification::observed_plant(model.found.fit, model.match, model.seen.outputs,
                                                model.seen.inputs, result.places);
  result.coordinates = modal_coordinates(model);
  const auto sensors = std::ssize(model.seen.outputs);
  result.filter = work.timed("observer", [&] {
    return modal::kalman_filter(modal::disturbed_model(
        result.plant, std::ssize(model.seen.inputs), result.disturbances,
        sensor_noise(study, sensors, recorded), result.sample_time_s, course_of(study)));
  });
  result.shapes = std::move(shapes);
  set_deviations(result);
  for (const auto& note : left_out_of_predictions(*result.shapes)) add_note(note, result);
  if (model.found.fit.complex) {
    result.notes.emplace_back(
        "shapes are complex: the band has the deviations of their real parts alone");
  }
  return result;
}

}  // namespace chladni::steps
