// Scores of layouts, with what is there beside them.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "placement/best_layouts.h"
#include "placement/constants.h"
#include "placement/optimum/present.h"

namespace chladni::placement {

LayoutScorer::LayoutScorer(const Structure& structure, const Sites& surface, WantedModes wanted,
                           const Plan& plan)
    : structure_(structure),
      surface_(surface),
      wanted_(std::move(wanted)),
      frequency_tolerance_(plan.frequency_tolerance),
      devices_(devices_of(plan, wanted_)) {
  if (plan.observer) observer_ = std::make_shared<ObserverModel>(*plan.observer);
  const auto& columns = wanted_.columns;
  view_.groups = wanted_.groups;
  view_.frequency_hz = structure.frequency_hz(columns);
  view_.damping_ratio = structure.damping_ratio(columns);
  view_.rms = wanted_.rms;
  view_.sensor_noise = wanted_.sensor_noise;
  view_.actuator_noise = wanted_.actuator_noise;
  view_.position_error = plan.position_error;
  view_.prior = shape_prior(surface.shapes, surface.area, structure.frequency_hz, columns);
  view_.surface_all = surface.shapes;
  view_.interest_all = structure.interest;
  view_.interest_all.conservativeResize(structure.interest.rows(), structure.frequency_hz.size());
  view_.interest = view_.interest_all(Eigen::all, columns);
}

// With some channels of the structure.
LayoutView LayoutScorer::view_of(const std::vector<std::size_t>& sensors,
                                 const std::vector<std::size_t>& actuators) const {
  const auto chosen = [](const Channels& channels, const std::vector<std::size_t>& rows) {
    for (const auto row : rows) {
      require(static_cast<Eigen::Index>(row) < channels.count(),
              fmt::format("placement: channel {} of a layout does not exist; there are {}", row,
                          channels.count()));
    }
    return Lines{channels.lines.position(rows, Eigen::all),
                 channels.lines.direction(rows, Eigen::all)};
  };
  auto view = view_;
  view.pairs = collocated_pairs(chosen(structure_.sensors, sensors),
                                chosen(structure_.actuators, actuators), structure_.size);
  view.pair_slopes.resize(std::ssize(view.pairs), std::ssize(wanted_.columns));
  for (std::size_t p = 0; p < view.pairs.size(); ++p) {
    const auto sensor = sensors[static_cast<std::size_t>(view.pairs[p].first)];
    view.pair_slopes.row(static_cast<Eigen::Index>(p)) =
        slopes_of(structure_.sensors, static_cast<Eigen::Index>(sensor), surface_)(wanted_.columns);
  }
  const auto modes = structure_.frequency_hz.size();
  view.sensors_all.resize(0, modes);
  if (!sensors.empty()) view.sensors_all = structure_.sensors.shapes(sensors, Eigen::all);
  view.actuators_all.resize(0, modes);
  if (!actuators.empty()) view.actuators_all = structure_.actuators.shapes(actuators, Eigen::all);
  return view;
}

LayoutView LayoutScorer::view_of_those_that_stay() const {
  return view_of(those_there(structure_.sensors, false), those_there(structure_.actuators, false));
}

LayoutScore LayoutScorer::of_channels(const std::vector<std::size_t>& sensors,
                                      const std::vector<std::size_t>& actuators) const {
  auto view = view_of(sensors, actuators);
  const Eigen::MatrixXd watched = view.sensors_all;
  const Eigen::MatrixXd disturbing =
      actuators.empty() ? rows_there(structure_, structure_.actuators, true) : view.actuators_all;
  return scored(std::move(view), watched, disturbing);
}

LayoutScore LayoutScorer::of_sensors(const Eigen::MatrixXd& shapes) const {
  auto view = view_of_those_that_stay();
  view.sensors_all = stacked(view.sensors_all, shapes);
  const Eigen::MatrixXd watched = view.sensors_all;
  return scored(std::move(view), watched, rows_there(structure_, structure_.actuators, true));
}

LayoutScore LayoutScorer::of_devices(const Optimum& optimum) const {
  const auto sensors = optimum.sensing(), actuators = optimum.acting();
  auto view = view_of_those_that_stay();
  auto sensor = view.sensors_all.rows(), actuator = view.actuators_all.rows();
  for (std::size_t i = 0; i < optimum.kinds.size(); ++i) {
    const auto kind = optimum.kinds[i];
    if (kind == DeviceKind::pair) {
      view.pairs.emplace_back(sensor, actuator);
      view.pair_slopes.conservativeResize(std::ssize(view.pairs), Eigen::NoChange);
      view.pair_slopes.bottomRows<1>() =
          slopes_near(optimum.sites.row(static_cast<Eigen::Index>(i)), surface_)(wanted_.columns);
    }
    if (kind != DeviceKind::actuator) ++sensor;
    if (kind != DeviceKind::sensor) ++actuator;
  }
  view.sensors_all = stacked(view.sensors_all, sensors);
  view.actuators_all = stacked(view.actuators_all, actuators);
  return scored(std::move(view), stacked(sensors_there(structure_, devices_), sensors),
                stacked(actuators_there(structure_, devices_), actuators));
}

// `watched` and `disturbing`: sensors and actuators of an observer.
LayoutScore LayoutScorer::scored(LayoutView view, const Eigen::MatrixXd& watched,
                                 const Eigen::MatrixXd& disturbing) const {
  view.sensors = view.sensors_all(Eigen::all, wanted_.columns);
  view.actuators = view.actuators_all(Eigen::all, wanted_.columns);
  LayoutScore layout;
  layout.pairs = static_cast<int>(view.pairs.size());
  if (observer_ && watched.rows() > 0) {
    layout.observer = view.observer = observer_->value(watched, disturbing);
    layout.motion_deviation = estimate_deviation(layout.observer->coordinates, surface_.shapes);
  }
  const auto criteria = layout_criteria();
  layout.scores.resize(static_cast<Eigen::Index>(criteria.size()));
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    layout.scores(static_cast<Eigen::Index>(c)) = criteria[c]->value(view);
  }
  layout.blind = blind_modes(view);
  const auto points = samples(view);
  if (points.rows.rows() > 0) {
    layout.deviation = expected_deviation(view.prior, points.rows, points.noise, view.surface_all)
                           .cwiseAbs2()
                           .rowwise()
                           .mean()
                           .cwiseSqrt();
  }
  return layout;
}

// Modes of the whole structure, counted from 1, that the points cannot see.
std::vector<int> LayoutScorer::blind_modes(LayoutView view) const {
  const Eigen::Index rigid = structure_.rigid_count;
  const Eigen::Index flexible = structure_.frequency_hz.size() - rigid;
  view.groups = modal::groups(structure_.frequency_hz.tail(flexible), frequency_tolerance_);
  const auto norms = group_norms(surface_.shapes.rightCols(flexible), surface_.area, view.groups);
  view.rms.resize(flexible);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    view.rms.segment(view.groups[g].first, view.groups[g].size)
        .setConstant(norms.rms(static_cast<Eigen::Index>(g)));
  }
  view.sensors = view.sensors_all.rightCols(flexible).eval();
  view.actuators = view.actuators_all.rightCols(flexible).eval();
  const Eigen::VectorXd seen = sight(view);
  std::vector<int> blind;
  const double still = 1e-3 / std::sqrt(structure_.mass_kg);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    const auto [first, size] = view.groups[g];
    // A mode that hardly moves the surface in this direction is not counted.
    if (seen(static_cast<Eigen::Index>(g)) >= Constants::blind || view.rms(first) < still) continue;
    for (Eigen::Index i = 0; i < size; ++i) {
      blind.push_back(static_cast<int>(rigid + first + i + 1));
    }
  }
  return blind;
}

}  // namespace chladni::placement
