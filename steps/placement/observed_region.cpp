// What the layout of an observer is to know, from [placement.observer] and [observer].
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"
#include "stage/points_on_body.h"
#include "steps/observer/stated.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

using placement::ObserverTask;

void require_stated(const study::Study& study) {
  const std::string file = study.file.string();
  require(
      study.observer && !study.observer->disturbances.empty(),
      file +
          ": a layout for an observer needs to know what disturbs the body, and no disturbance is "
          "stated; expected [observer] with noise and [[observer.disturbance]] with name, kind "
          "and rms");
  require(study.observer->noise > 0.0,
          file +
              ": a layout for an observer needs the noise of the sensors, which is not stated; "
              "expected observer.noise, such as \"2 nm\"");
  require(stated_sample_rate(study) > 0.0,
          file +
              ": a layout for an observer needs the rate of its filter; expected "
              "observer.sample_rate = \"10 kHz\"");
  for (const auto& sensor : study.sensors) {
    require(sensor.quantity == "displacement",
            file + ": a layout for an observer has sensors of displacement; sensor \"" +
                sensor.name + "\" measures " + sensor.quantity);
  }
}

// Mean of ψ ψᵀ. @param weight  of each point
Eigen::MatrixXd mean_square(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weight) {
  return shapes.transpose() * (weight / weight.sum()).asDiagonal() * shapes;
}

Eigen::MatrixXd shapes_along(const std::vector<mesh::Site>& sites,
                             const std::vector<std::optional<Eigen::Vector3d>>& stated,
                             const stage::Solution& solution, const study::PlacementPlan& plan) {
  Points directions(std::ssize(sites), 3);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    directions.row(static_cast<Eigen::Index>(i)) =
        stated[i].value_or(plan.direction.value_or(sites[i].normal)).transpose();
  }
  return stage::shapes_at(sites, directions, solution.modes);
}

// The zones of the study, else the points of its observer, else the whole surface.
Eigen::MatrixXd region_of(const study::Study& study, const stage::Solution& solution,
                          const study::PlacementPlan& plan, const placement::Sites& surface,
                          const mesh::SiteFinder& finder) {
  const auto& zones = plan.observer->region;
  if (!zones.empty()) {
    const auto& body = solution.model.body;
    const auto rows =
        placement::within(surface, zones_of(body, zones, "placement.observer.region"));
    require(!rows.empty(),
            fmt::format(
                "{}:{}: placement.observer.region has no point of the faces that devices may be "
                "on (placement.on); expected a zone that covers some of their {} points",
                study.file.string(), plan.observer->line, surface.count()));
    return mean_square(surface.shapes(rows, Eigen::all), surface.area(rows));
  }
  const auto& points = study.observer->points;
  if (points.empty()) return mean_square(surface.shapes, surface.area);
  std::vector<mesh::Site> sites;
  std::vector<std::optional<Eigen::Vector3d>> along;
  const double reach = stage::reach_of(solution.model.body);
  for (const auto& point : points) {
    sites.push_back(site_of(study, finder, reach, point.at, "point \"" + point.name + "\""));
    along.push_back(point.direction);
  }
  return mean_square(shapes_along(sites, along, solution, plan),
                     Eigen::VectorXd::Ones(std::ssize(points)));
}

// −Φᵀ M e_z [kg^1/2]: what the acceleration of the floor does to the motion relative to it.
Eigen::RowVectorXd floor_shape(const study::Study& study, const stage::Solution& solution) {
  const auto& system = *solution.system;
  const auto& dofs = system.dofs;
  require(
      dofs.extra_count() == 0,
      study.file.string() +
          ": a disturbance of the floor beside attachments that move by themselves is not known in "
          "a layout for an observer; expected forces or actuators");
  Eigen::VectorXd up = Eigen::VectorXd::Zero(dofs.free_count);
  for (Eigen::Index node = 0; node < dofs.node_count; ++node) {
    const auto row = dofs.free_dof(3 * node + 2);
    if (row >= 0) up(row) = 1.0;
  }
  const Eigen::VectorXd carried = system.mass.selfadjointView<Eigen::Lower>() * up;
  return -(fem::on_nodes(dofs, carried).transpose() * solution.modes.shapes);
}

void add_disturbance(const study::Study& study, const stage::Solution& solution,
                     const study::PlacementPlan& plan, const placement::Structure& structure,
                     const mesh::SiteFinder& finder, const study::DisturbancePlan& stated,
                     ObserverTask& task) {
  const auto course = disturbance_of(stated, stated.name, 0);
  if (stated.kind == "floor") {
    task.fixed.push_back({floor_shape(study, solution), course});
  } else if (stated.kind == "force") {
    const auto site = site_of(study, finder, stage::reach_of(solution.model.body), stated.at,
                              "disturbance \"" + stated.name + "\"");
    task.fixed.push_back({shapes_along({site}, {stated.direction}, solution, plan).row(0), course});
  } else if (stated.actuators.empty()) {
    task.at_actuators.push_back(course);
  } else {
    for (std::size_t j = 0; j < study.actuators.size(); ++j) {
      if (std::ranges::find(stated.actuators, study.actuators[j].name) == stated.actuators.end()) {
        continue;
      }
      task.fixed.push_back({structure.actuators.shapes.row(static_cast<Eigen::Index>(j)), course});
    }
  }
}

std::vector<std::string> limits_of(const stage::Solution& solution, const ObserverTask& task) {
  std::vector<std::string> notes;
  if (task.rigid_count > 0) {
    notes.push_back(fmt::format(
        "layout for an observer: {} rigid-body modes without stiffness are held at {:.3g} Hz "
        "(placement.observer.suspension)",
        task.rigid_count, task.suspension_hz));
  }
  if (solution.system->damping.nonZeros() > 0) {
    notes.emplace_back(
        "layout for an observer: dashpots are left out; modes have modes.damping_ratio alone");
  }
  const double half = 0.5 / task.sample_time_s;
  const auto above = (task.frequency_hz.array() > half).count();
  if (above > 0) {
    notes.push_back(
        fmt::format("layout for an observer: {} of {} modes lie above half of the sample rate, "
                    "{:.6g} Hz, and are seen as lower ones",
                    above, task.frequency_hz.size(), half));
  }
  return notes;
}

}  // namespace

ObserverTask observer_task(const study::Study& study, const stage::Solution& solution,
                           const study::PlacementPlan& plan, const placement::Structure& structure,
                           const placement::Sites& surface, std::vector<std::string>& notes) {
  require_stated(study);
  const placement::Sampler sampler(solution.model.body, solution.modes, {plan.direction, 0.0});
  const auto& finder = sampler.finder();
  ObserverTask task;
  task.frequency_hz = structure.frequency_hz;
  task.damping_ratio = structure.damping_ratio;
  task.rigid_count = structure.rigid_count;
  task.suspension_hz = plan.observer->suspension_hz;
  task.frequency_tolerance = plan.frequency_tolerance;
  task.region = region_of(study, solution, plan, surface, finder);
  task.sensor_rms = study.observer->noise;
  task.sample_time_s = 1.0 / stated_sample_rate(study);
  task.effort = plan.observer->effort;
  for (const auto& stated : study.observer->disturbances) {
    add_disturbance(study, solution, plan, structure, finder, stated, task);
  }
  const bool acted =
      structure.actuators.count() > 0 || plan.observer->actuators + plan.observer->pairs > 0;
  require(!task.fixed.empty() || acted,
          study.file.string() +
              ": the disturbances of [observer] act at actuators, and the study has "
              "none; expected [[actuator]] or a disturbance of kind \"force\"");
  for (auto& note : limits_of(solution, task)) notes.push_back(std::move(note));
  return task;
}

}  // namespace chladni::steps
