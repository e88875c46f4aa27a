#include "placement/wanted_modes.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"

namespace chladni::placement {
namespace {

std::set<Eigen::Index> columns_asked_for(const Structure& structure, const Plan& plan) {
  const auto rigid = structure.rigid_count;
  const auto count = structure.frequency_hz.size();
  const Eigen::Index flexible = count - rigid;
  std::set<Eigen::Index> columns;
  if (plan.up_to_hz > 0.0) {
    for (Eigen::Index i = rigid; i < count; ++i) {
      if (structure.frequency_hz(i) <= plan.up_to_hz) columns.insert(i);
    }
    require(!columns.empty(),
            fmt::format("placement.up_to is {:.6g} Hz, but the first flexible mode lies at "
                        "{:.6g} Hz",
                        plan.up_to_hz, flexible > 0 ? structure.frequency_hz(rigid) : 0.0));
    return columns;
  }
  for (const int mode : plan.modes) {
    require(mode >= 1, fmt::format("placement.modes holds {}; expected numbers of flexible modes, "
                                   "counted from 1",
                                   mode));
    columns.insert(rigid + mode - 1);
  }
  const Eigen::Index highest = columns.empty() ? 0 : *columns.rbegin() - rigid + 1;
  require(highest <= flexible,
          fmt::format("placement.modes asks for flexible mode {}, but {} were computed; raise "
                      "modes.count",
                      highest, flexible));
  const Eigen::Index ordinary = plan.modes.empty() ? std::min<Eigen::Index>(3, flexible) : 0;
  for (Eigen::Index i = 0; i < ordinary; ++i) columns.insert(rigid + i);
  require(!columns.empty(), "placement needs a flexible mode");
  return columns;
}

// Adds all modes of a group. That of the last mode may go on beyond what was computed.
void complete_groups(const Structure& structure, double tolerance, std::set<Eigen::Index>& columns,
                     std::vector<std::string>& notes) {
  const Eigen::Index rigid = structure.rigid_count;
  const auto flexible = structure.frequency_hz.size() - rigid;
  for (const auto& [first, size] :
       modal::groups(structure.frequency_hz.tail(flexible), tolerance)) {
    const Eigen::Index begin = rigid + first;
    const auto known = columns.lower_bound(begin);
    const bool touched = known != columns.end() && *known < begin + size;
    if (!touched) continue;
    for (Eigen::Index i = begin; i < begin + size; ++i) {
      if (!columns.insert(i).second) continue;
      notes.push_back(
          fmt::format("mode {} ({:.2f} Hz) is within {:.2g} % of its neighbour and is "
                      "looked at together with it",
                      i + 1, structure.frequency_hz(i), 100.0 * tolerance));
    }
    if (first + size < flexible) continue;
    notes.push_back(fmt::format(
        "mode {} ({:.2f} Hz) is the last that was computed: one within {:.2g} % above it would "
        "belong to it and is not looked at; raise modes.count to know",
        rigid + flexible, structure.frequency_hz(rigid + flexible - 1), 100.0 * tolerance));
  }
}

// How strongly some channels drive or see a group [kg^-1/2]: for a single mode the root of its sum
// of squares. An entry of k repeated modes is known from the others with the covariance (ΦᵀΦ)⁻¹,
// whose mean the root of the harmonic mean of the eigenvalues gives in every basis. With fewer
// channels than modes it is the share of one mode, as in `visibility`.
double drive_of(const Eigen::MatrixXd& shapes) {
  const Eigen::MatrixXd gram = shapes.transpose() * shapes;
  const double size = static_cast<double>(shapes.cols());
  if (shapes.cols() == 1 || shapes.rows() < shapes.cols()) return std::sqrt(gram.trace() / size);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram, Eigen::EigenvaluesOnly);
  return std::sqrt(size / solver.eigenvalues().cwiseMax(1e-24).cwiseInverse().sum());
}

// The same for each wanted mode; the surface's mean if there are no channels.
Eigen::VectorXd drive(const Channels& channels, const WantedModes& wanted) {
  if (channels.count() == 0) return wanted.rms;
  const Eigen::MatrixXd shapes = channels.shapes(Eigen::all, wanted.columns);
  Eigen::VectorXd drives(shapes.cols());
  for (const auto& [first, size] : wanted.groups) {
    drives.segment(first, size).setConstant(drive_of(shapes.middleCols(first, size)));
  }
  return drives;
}

// Each group's mean: a rotation within it moves no member away from the others.
Eigen::ArrayXd mean_of_groups(const Eigen::VectorXd& values, const WantedModes& wanted) {
  Eigen::ArrayXd means = values;
  for (const auto& [first, size] : wanted.groups) {
    means.segment(first, size).setConstant(values.segment(first, size).mean());
  }
  return means;
}

// Standard deviations of the entries of L and R from a fit to FRFs with noise s on every line. At a
// resonance the peak is φ_s φ_a / (2 ζ ω²), and π ζ f / Δf lines contribute to it.
void set_noise_of_frf(const Structure& structure, const Plan& plan, WantedModes& wanted) {
  const Eigen::VectorXd known = structure.damping_ratio(wanted.columns);
  require(known.minCoeff() > 0.0,
          "placement.frf_noise needs modes.damping_ratio: it says how high a resonance stands");
  const auto frequency = mean_of_groups(structure.frequency_hz(wanted.columns), wanted);
  const auto damping = mean_of_groups(known, wanted);
  const Eigen::ArrayXd omega = 2.0 * std::numbers::pi * frequency;
  const Eigen::ArrayXd lines =
      (std::numbers::pi * damping * frequency / plan.resolution_hz).max(1.0);
  const Eigen::ArrayXd product = 2.0 * damping * omega.square() * plan.frf_noise / lines.sqrt();
  wanted.sensor_noise = (product / drive(structure.actuators, wanted).array().max(1e-12));
  wanted.actuator_noise = (product / drive(structure.sensors, wanted).array().max(1e-12));
}

}  // namespace

WantedModes wanted_modes(const Structure& structure, const Sites& surface, const Plan& plan,
                         std::vector<std::string>& notes) {
  require_fit(structure, surface);
  auto columns = columns_asked_for(structure, plan);
  complete_groups(structure, plan.frequency_tolerance, columns, notes);
  WantedModes wanted;
  wanted.columns.assign(columns.begin(), columns.end());
  const Eigen::VectorXd frequency = structure.frequency_hz(wanted.columns);
  wanted.groups = modal::groups(frequency, plan.frequency_tolerance);
  const auto norms =
      group_norms(surface.shapes(Eigen::all, wanted.columns), surface.area, wanted.groups);
  wanted.rms.resize(static_cast<Eigen::Index>(wanted.columns.size()));
  for (std::size_t g = 0; g < wanted.groups.size(); ++g) {
    const auto [first, size] = wanted.groups[g];
    const double rms = norms.rms(static_cast<Eigen::Index>(g));
    const double moves = rms * std::sqrt(structure.mass_kg);
    require(moves > 1e-3,
            fmt::format("mode {} hardly moves the surface that devices may be on along their "
                        "direction; choose other modes, another direction or other patches",
                        group_name(structure.frequency_hz, structure.rigid_count, wanted,
                                   static_cast<int>(g))));
    wanted.rms.segment(first, size).setConstant(rms);
  }
  wanted.sensor_noise = plan.noise * wanted.rms;
  wanted.actuator_noise = wanted.sensor_noise;
  if (plan.frf_noise > 0.0) set_noise_of_frf(structure, plan, wanted);
  return wanted;
}

std::string group_name(const Eigen::VectorXd& frequency_hz, Eigen::Index rigid_count,
                       const WantedModes& wanted, int group) {
  const auto [first, size] = wanted.groups[static_cast<std::size_t>(group)];
  const auto column = wanted.columns[static_cast<std::size_t>(first)];
  const auto flexible = column - rigid_count + 1;
  const double frequency = frequency_hz(column);
  if (size == 1) return fmt::format("{} (flex {}, {:.2f} Hz)", column + 1, flexible, frequency);
  return fmt::format("{}-{} (flex {}-{}, {:.2f} Hz)", column + 1, column + size, flexible,
                     flexible + size - 1, frequency);
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated_pairs(const Lines& sensors,
                                                                    const Lines& actuators,
                                                                    double size) {
  constexpr double kBeside = 1e-3;  // [m]
  return collocated(sensors, actuators, std::min(kBeside, 0.01 * size), 0.05 * size);
}

}  // namespace chladni::placement
