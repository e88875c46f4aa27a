#include "diagnosis/fit/deviations.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/index.h"
#include "diagnosis/body_fields.h"
#include "diagnosis/constants.h"
#include "diagnosis/effects/moved_channel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void put(std::vector<Deviation>& all, std::string name,
         std::function<void(State&, double eta)> apply) {
  all.push_back({std::move(name), std::move(apply)});
}

void add_gains(const Structure& structure, double tolerance, std::vector<Deviation>& all) {
  if (tolerance <= 0.0) return;
  for (Index i = 0; i < structure.output_count(); ++i) {
    put(all, "gain of sensor " + structure.outputs.names[at(i)],
        [i, tolerance](State& state, double eta) {
          state.output_paths[at(i)].gain *= std::exp(tolerance * eta);
        });
  }
  for (Index j = 0; j < structure.input_count(); ++j) {
    put(all, "gain of actuator " + structure.inputs.names[at(j)],
        [j, tolerance](State& state, double eta) {
          state.input_paths[at(j)].gain *= std::exp(tolerance * eta);
        });
  }
}

// Change of a channel's row for one step along an axis. The modes above come from the surface, as
// the central difference of a step in both directions.
ChannelChange place_slope(const Structure& structure, Side which, Index i, Index axis,
                          double step) {
  const auto& side = which == Side::sensors ? structure.outputs : structure.inputs;
  const Eigen::Vector2d by = step * Eigen::Vector2d::Unit(axis);
  const VectorXd plus = channel_change(structure, side, i, by).upper;
  const VectorXd minus = channel_change(structure, side, i, -by).upper;
  const auto& slopes = axis == 0 ? side.slope_u : side.slope_v;
  ChannelChange change{step * slopes.row(i).transpose(), {}};
  if (plus.size() > 0 && minus.size() > 0) change.upper = 0.5 * (plus - minus);
  return change;
}

void add_positions(const Structure& structure, Side which, double tolerance,
                   std::vector<Deviation>& all) {
  if (tolerance <= 0.0) return;
  const bool outputs = which == Side::sensors;
  const auto& side = outputs ? structure.outputs : structure.inputs;
  for (Index i = 0; i < side.count(); ++i) {
    for (const Index axis : {0, 1}) {
      const auto by = place_slope(structure, which, i, axis, tolerance);
      if (by.shape.isZero(0.0)) continue;
      put(all,
          fmt::format("place of {} {} along {}", outputs ? "sensor" : "actuator", side.names[at(i)],
                      axis == 0 ? "u" : "v"),
          [i, by, which](State& state, double eta) {
            move_channel(state, which, i, {eta * by.shape, eta * by.upper});
          });
    }
  }
}

// Groups of neighbouring flexible modes that cannot be told apart.
std::vector<std::pair<Index, Index>> clusters(const Structure& structure, double high_hz) {
  std::vector<std::pair<Index, Index>> all;  // first, size
  for (Index k = structure.rigid_count; k < structure.mode_count(); ++k) {
    const double f = structure.frequency_hz(k);
    if (f > high_hz) break;
    const double damping = std::max(structure.damping_ratio(k), kConstants.least_damping);
    const bool near =
        !all.empty() && f - structure.frequency_hz(k - 1) < kConstants.one_cluster * damping * f;
    if (near) {
      ++all.back().second;
    } else {
      all.emplace_back(k, 1);
    }
  }
  return all;
}

// Adds a shared part of two modes of a cluster: a fraction of the root of their product.
void couple(Eigen::MatrixXd& entries, Index i, Index j, double part) {
  const double more = part * std::sqrt(entries(i, i) * entries(j, j));
  entries(i, j) += more;
  entries(j, i) += more;
}

// The deviation of stiffness or damping that the modes i and j of a cluster share. Repeated modes
// need the whole block; otherwise a deviation would depend on how the solver rotated them.
void add_frequency(Index i, Index j, double by, std::string name, std::vector<Deviation>& all) {
  if (by <= 0.0) return;
  put(all, std::move(name), [=](State& state, double eta) {
    if (i == j) state.stiffness(i, i) *= std::exp(by * eta);
    if (i != j) couple(state.stiffness, i, j, by * eta);
  });
}

void add_damping(Index i, Index j, double by, std::string name, std::vector<Deviation>& all) {
  if (by <= 0.0) return;
  put(all, std::move(name), [=](State& state, double eta) {
    if (i == j) deviate_damping(state, i, by * eta);
    if (i != j) couple(state.damping, i, j, by * eta);
  });
}

// Frequency tolerance of the modes i and j together: the general tolerance and the error of their
// own mesh. No mesh error if frequencies are known exactly.
double frequency_tolerance(const Structure& structure, const Tolerances& tolerances, Index i,
                           Index j) {
  const auto& error = structure.frequency_error;
  if (tolerances.frequency <= 0.0 || error.size() == 0) return tolerances.frequency;
  return std::hypot(tolerances.frequency, std::sqrt(error(i) * error(j)));
}

void add_modes(const Structure& structure, const Tolerances& tolerances, double high_hz,
               std::vector<Deviation>& all) {
  for (const auto& [first, size] : clusters(structure, high_hz)) {
    for (Index i = first; i < first + size; ++i) {
      for (Index j = i; j < first + size; ++j) {
        const auto of = fmt::format("{} {:.4g} Hz", i == j ? "of the mode at" : "between modes at",
                                    structure.frequency_hz(i));
        add_frequency(i, j, 2.0 * frequency_tolerance(structure, tolerances, i, j),
                      "frequency " + of, all);
        add_damping(i, j, tolerances.damping, "damping " + of, all);
      }
    }
  }
}

// The shorter waves of a line get smaller tolerances: divided by their order minus one.
void add_thickness(const Structure& structure, double tolerance, std::vector<Deviation>& all) {
  put(all, "thickness",
      [by = thickness_slope(structure), t = tolerance, power = structure.bending_power](
          State& state, double eta) {
        state.stiffness += t * eta * by.stiffness;
        state.mass += t * eta * by.mass;
        scale_residual(state, std::exp(-power * t * eta));
      });
  Index waves = 0;
  const auto add_wave = [&](const BodyChange& by, double t) {
    put(all, fmt::format("smooth wave {} of thickness", ++waves),
        [by, t](State& state, double eta) {
          state.stiffness += t * eta * by.stiffness;
          state.mass += t * eta * by.mass;
        });
  };
  for (Index f = 0; f < smooth_fields(structure.cells).cols(); ++f) {
    add_wave(thickness_slope(structure, f), tolerance);
  }
  const MatrixXd shorter = short_waves(structure.cells);
  for (Index f = 0; f < shorter.cols(); ++f) {
    const auto order = static_cast<double>(f + 3);
    add_wave(thickness_slope(structure, VectorXd(shorter.col(f))), tolerance / (order - 1.0));
  }
}

void add_body(const Structure& structure, const Tolerances& tolerances,
              std::vector<Deviation>& all) {
  if (tolerances.modulus > 0.0) {
    put(all, "Young's modulus", [t = tolerances.modulus](State& state, double eta) {
      scale_stiffness(state, std::exp(t * eta));
    });
  }
  if (tolerances.density > 0.0) {
    put(all, "density", [t = tolerances.density](State& state, double eta) {
      scale_mass(state, std::exp(t * eta));
    });
  }
  for (const auto* side : {&structure.outputs, &structure.inputs}) {
    if (tolerances.mass <= 0.0) break;
    const MatrixXd by = tolerances.mass * side->shapes.transpose() * side->shapes;
    put(all, side == &structure.outputs ? "mass of every sensor" : "mass of every actuator",
        [by](State& state, double eta) { attach_mass(state, eta * by); });
  }
  if (tolerances.orthotropy > 0.0 && structure.directional.along_u.size() > 0) {
    const auto add = [&](const char* what, const MatrixXd& matrix) {
      put(all, what, [matrix, t = tolerances.orthotropy](State& state, double eta) {
        state.stiffness += t * eta * matrix;
      });
    };
    add("stiffness along u", structure.directional.along_u);
    add("stiffness in shear", structure.directional.shear);
  }
  if (tolerances.thickness > 0.0 && structure.cells.count() > 0) {
    add_thickness(structure, tolerances.thickness, all);
  }
}

void add_modes_above(const Structure& structure, double tolerance, std::vector<Deviation>& all) {
  if (tolerance <= 0.0 || structure.residual.isZero(0.0)) return;
  put(all, "modes above those in use",
      [t = tolerance](State& state, double eta) { scale_residual(state, std::exp(t * eta)); });
  // A frame far above the band has the same effect.
  const MatrixXd along = parts_along_normal(structure, structure.outputs) *
                         parts_along_normal(structure, structure.inputs).transpose();
  put(all, "what all responses share of the modes above",
      [t = tolerance, along](State& state, double eta) {
        state.residual += t * eta * state.residual.cwiseAbs().mean() * along;
      });
}

// Deviations common to all channels.
void add_shared(const Tolerances& tolerances, std::vector<Deviation>& all) {
  if (tolerances.loaded_damping > 0.0) {
    put(all, "damping ratios of the modes with what hangs on them",
        [t = tolerances.loaded_damping](State& state, double eta) {
          state.loaded_damping += t * eta;
        });
  }
  if (tolerances.scale > 0.0) {
    put(all, "scale of all responses", [t = tolerances.scale](State& state, double eta) {
      for (auto& path : state.output_paths) path.gain *= std::exp(t * eta);
    });
  }
  if (tolerances.delay > 0.0) {
    put(all, "delay", [t = tolerances.delay](State& state, double eta) {
      for (auto& path : state.output_paths) path.delay += t * eta;
    });
  }
}

}  // namespace

std::vector<Deviation> deviations(const Structure& structure, const Tolerances& tolerances,
                                  double high_hz) {
  std::vector<Deviation> all;
  add_modes(structure, tolerances, high_hz, all);
  add_body(structure, tolerances, all);
  add_gains(structure, tolerances.gain, all);
  add_positions(structure, Side::sensors, tolerances.position, all);
  add_positions(structure, Side::actuators, tolerances.position, all);
  add_modes_above(structure, tolerances.residual, all);
  add_shared(tolerances, all);
  return all;
}

State deviating(const Structure& structure, const std::vector<Deviation>& deviations,
                const VectorXd& eta) {
  State state = state_of(structure);
  for (Index i = 0; i < eta.size(); ++i) {
    const auto& one = deviations[at(i)];
    if (eta(i) != 0.0 || one.is_constant) one.apply(state, eta(i));
  }
  return state;
}

std::vector<Deviation> shape_deviations(const Structure& structure, double response,
                                        double high_hz) {
  std::vector<Deviation> all;
  if (response <= 0.0) return all;
  for (Index k = structure.rigid_count; k < structure.mode_count(); ++k) {
    if (structure.frequency_hz(k) > high_hz) break;
    for (const auto* side : {&structure.outputs, &structure.inputs}) {
      const bool outputs = side == &structure.outputs;
      const auto channels = static_cast<double>(side->count());
      const double by = response * side->shapes.col(k).norm() / std::sqrt(channels);
      for (Index i = 0; i < side->count(); ++i) {
        put(all,
            fmt::format("shape at {:.4g} Hz of {}", structure.frequency_hz(k), side->names[at(i)]),
            [=](State& state, double eta) {
              (outputs ? state.outputs(i, k) : state.inputs(k, i)) += by * eta;
            });
      }
    }
  }
  return all;
}

}  // namespace chladni::diagnosis
