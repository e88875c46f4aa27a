// The modes for a placement, how the channels see them, and the noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "base/error.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

std::set<Eigen::Index> columns_asked_for(const study::Study& study, const stage::Solution& solution,
                                         const study::PlacementPlan& plan) {
  const auto& modes = solution.modes;
  const Eigen::Index flexible = modes.mode_count() - modes.rigid_count;
  std::set<Eigen::Index> columns;
  if (plan.up_to_hz > 0.0) {
    for (Eigen::Index i = modes.rigid_count; i < modes.mode_count(); ++i) {
      if (modes.frequency_hz(i) <= plan.up_to_hz) columns.insert(i);
    }
    require(!columns.empty(),
            fmt::format("placement.up_to is {:.6g} Hz, but the first flexible mode lies at "
                        "{:.6g} Hz",
                        plan.up_to_hz, flexible > 0 ? modes.frequency_hz(modes.rigid_count) : 0.0));
    return columns;
  }
  for (const int mode : plan.modes) columns.insert(modes.rigid_count + mode - 1);
  const Eigen::Index highest = columns.empty() ? 0 : *columns.rbegin() - modes.rigid_count + 1;
  require(highest <= flexible,
          fmt::format("placement.modes asks for flexible mode {}, but {} were computed; raise "
                      "modes.count",
                      highest, flexible));
  const Eigen::Index ordinary = plan.modes.empty() ? std::min<Eigen::Index>(3, flexible) : 0;
  for (Eigen::Index i = 0; i < ordinary; ++i) columns.insert(modes.rigid_count + i);
  require(!columns.empty(), study.file.string() + ": placement needs a flexible mode");
  return columns;
}

// Adds all modes of a group: a part of a repeated mode has no meaning.
void complete_groups(const modal::Modes& modes, double tolerance, std::set<Eigen::Index>& columns,
                     std::vector<std::string>& notes) {
  const Eigen::Index rigid = modes.rigid_count;
  const auto all = modal::groups(modes.frequency_hz.tail(modes.mode_count() - rigid), tolerance);
  for (const auto& [first, size] : all) {
    const Eigen::Index begin = rigid + first;
    const auto known = columns.lower_bound(begin);
    const bool touched = known != columns.end() && *known < begin + size;
    if (!touched) continue;
    for (Eigen::Index i = begin; i < begin + size; ++i) {
      if (!columns.insert(i).second) continue;
      notes.push_back(
          fmt::format("mode {} ({:.2f} Hz) is within {:.2g} % of its neighbour and is "
                      "looked at together with it",
                      i + 1, modes.frequency_hz(i), 100.0 * tolerance));
    }
  }
}

Eigen::VectorXd picked(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& columns) {
  return values(columns);
}

// Root of the sum of squares at some channels, for each wanted mode; the surface's mean if there
// are none.
Eigen::VectorXd drive(const std::vector<study::Channel>& channels,
                      const std::vector<mesh::Site>& sites, const stage::Solution& solution,
                      const WantedModes& wanted) {
  if (channels.empty()) return wanted.rms;
  const Eigen::MatrixXd shapes = stage::shapes_at(channels, sites, solution.modes);
  return shapes(Eigen::all, wanted.columns).colwise().norm().transpose();
}

// Standard deviations of the entries of L and R from a fit to FRFs with noise s on every line. At a
// resonance the peak is φ_s φ_a / (2 ζ ω²), and π ζ f / Δf lines contribute to it.
void set_noise_of_frf(const study::Study& study, const stage::Solution& solution,
                      const study::PlacementPlan& plan, WantedModes& wanted) {
  const Eigen::VectorXd frequency = picked(solution.modes.frequency_hz, wanted.columns);
  const Eigen::VectorXd damping = picked(solution.modes.damping_ratio, wanted.columns);
  require(damping.minCoeff() > 0.0,
          "placement.frf_noise needs modes.damping_ratio: it says how high a resonance stands");
  const Eigen::ArrayXd omega = 2.0 * std::numbers::pi * frequency.array();
  const Eigen::ArrayXd lines =
      (std::numbers::pi * damping.array() * frequency.array() / plan.resolution_hz).max(1.0);
  const Eigen::ArrayXd product =
      2.0 * damping.array() * omega.square() * plan.frf_noise / lines.sqrt();
  const auto& model = solution.model;
  wanted.sensor_noise =
      (product / drive(study.actuators, model.actuators, solution, wanted).array().max(1e-12));
  wanted.actuator_noise =
      (product / drive(study.sensors, model.sensors, solution, wanted).array().max(1e-12));
}

}  // namespace

study::PlacementPlan placement_plan(const study::Study& study) {
  return study.placement.value_or(study::PlacementPlan{});
}

bool stays(const study::PlacementPlan& plan, const study::Channel& channel) {
  return std::find(plan.there.begin(), plan.there.end(), channel.name) != plan.there.end();
}

WantedModes wanted_modes(const study::Study& study, const stage::Solution& solution,
                         const study::PlacementPlan& plan, const placement::Surface& surface,
                         std::vector<std::string>& notes) {
  const auto& modes = solution.modes;
  auto columns = columns_asked_for(study, solution, plan);
  complete_groups(modes, plan.frequency_tolerance, columns, notes);
  WantedModes wanted;
  wanted.columns.assign(columns.begin(), columns.end());
  wanted.groups =
      modal::groups(picked(modes.frequency_hz, wanted.columns), plan.frequency_tolerance);
  const auto& sites = surface.sites;
  const auto norms =
      placement::group_norms(sites.shapes(Eigen::all, wanted.columns), sites.area, wanted.groups);
  wanted.rms.resize(static_cast<Eigen::Index>(wanted.columns.size()));
  for (std::size_t g = 0; g < wanted.groups.size(); ++g) {
    const auto [first, size] = wanted.groups[g];
    const double rms = norms.rms(static_cast<Eigen::Index>(g));
    const double moves = rms * std::sqrt(solution.model.mass.mass_kg);
    require(moves > 1e-3,
            fmt::format("mode {} hardly moves the surface that devices may be on along their "
                        "direction; choose other modes, another direction or other patches",
                        group_name(solution, wanted, static_cast<int>(g))));
    wanted.rms.segment(first, size).setConstant(rms);
  }
  wanted.sensor_noise = plan.noise * wanted.rms;
  wanted.actuator_noise = wanted.sensor_noise;
  if (plan.frf_noise > 0.0) set_noise_of_frf(study, solution, plan, wanted);
  return wanted;
}

Views::Views(const study::Study& study, const stage::Solution& solution,
             const study::PlacementPlan& plan, const placement::Surface& surface,
             const WantedModes& wanted, std::vector<stage::Member> members)
    : wanted_(wanted),
      members_(std::move(members)),
      position_error_(plan.position_error),
      over_(plan.uncertainty && !plan.uncertainty->worst ? placement::Over::mean
                                                         : placement::Over::worst) {
  const auto& sites = surface.sites;
  for (std::size_t k = 0; k <= members_.size(); ++k) {
    norms_.push_back(placement::group_norms(seen(sites.shapes, k), sites.area, wanted_.groups));
  }
  actuators_ = stage::shapes_at(study.actuators, solution.model.actuators, solution.modes);
  present_.resize(0, solution.modes.mode_count());
  for (const auto& [s, a] : pairs_of(study, solution)) {
    if (!stays(plan, study.sensors[static_cast<std::size_t>(s)]) ||
        !stays(plan, study.actuators[static_cast<std::size_t>(a)])) {
      continue;
    }
    present_.conservativeResize(present_.rows() + 1, Eigen::NoChange);
    present_.bottomRows<1>() = actuators_.row(a);
  }
}

Eigen::MatrixXd Views::seen(const Eigen::MatrixXd& shapes, std::size_t member) const {
  if (member == 0) return shapes(Eigen::all, wanted_.columns);
  const Eigen::MatrixXd turn = members_[member - 1].turn(Eigen::all, wanted_.columns);
  return shapes * turn;
}

std::vector<placement::PairView> Views::of(const placement::Sites& sites) const {
  std::vector<placement::PairView> views;
  for (std::size_t k = 0; k < norms_.size(); ++k) {
    placement::PairView view;
    view.groups = wanted_.groups;
    view.shapes = seen(sites.shapes, k);
    view.slopes = sites.slopes(Eigen::all, wanted_.columns);
    view.present = seen(present_, k);
    view.present_slopes = Eigen::MatrixXd::Zero(view.present.rows(), view.present.cols());
    view.actuators = seen(actuators_, k);
    view.largest = norms_[k].largest;
    view.rms = norms_[k].rms;
    view.sensor_noise = wanted_.sensor_noise;
    view.actuator_noise = wanted_.actuator_noise;
    view.position_error = position_error_;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace chladni::steps
