#include "recordings/rigid_chain.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "base/error.h"
#include "base/turn.h"

namespace chladni::recordings {
namespace {

void check(const RigidChain& chain) {
  const auto positive = [](double value, const char* what) {
    require(std::isfinite(value) && value > 0.0, std::string("rigid chain: ") + what + " is " +
                                                     fmt::format("{:.6g}", value) +
                                                     "; expected a positive number");
  };
  positive(chain.length_m, "the length [m]");
  positive(chain.width_m, "the width [m]");
  positive(chain.thickness_m, "the thickness [m]");
  positive(chain.youngs_modulus, "Young's modulus [Pa]");
  positive(chain.density, "the density [kg/m^3]");
  require(chain.bodies >= 3,
          "rigid chain: " + fmt::to_string(chain.bodies) + " bodies; expected 3 or more");
  for (const auto& mass : chain.masses) positive(mass.mass_kg, "a mass [kg]");
  for (const auto& body : chain.carried) {
    positive(body.mass_kg, "a carried mass [kg]");
    positive(body.frequency_hz, "the frequency of a carried mass [Hz]");
    require(body.damping_ratio >= 0.0, "rigid chain: a damping ratio is negative");
  }
  require((chain.sway_hz == 0.0) == (chain.turn_hz == 0.0),
          "rigid chain: one frequency of the suspension is 0; expected both or none");
  if (chain.sway_hz != 0.0) {
    positive(chain.sway_hz, "the sway frequency [Hz]");
    positive(chain.turn_hz - chain.sway_hz, "the turn frequency less the sway frequency [Hz]");
    require(2.0 * chain.flexure_m < chain.length_m && chain.flexure_m >= 0.0,
            "rigid chain: the flexures are off the strip");
  }
  require(chain.suspension_damping_ratio >= 0.0 && chain.joint_damping_ratio >= 0.0,
          "rigid chain: a damping ratio is negative");
}

// The body at a place and the relative position within it.
struct Row {
  Eigen::Index body;
  double along;  // 0 ... 1
};

Row row_at(const ChainMatrices& chain, double at_m) {
  const double length = chain.body_length_m * static_cast<double>(chain.bodies);
  require(at_m >= 0.0 && at_m <= length * (1.0 + 1e-12),
          "rigid chain: the place " + fmt::format("{:.6g}", 1e3 * at_m) +
              " mm is off the strip of " + fmt::format("{:.6g}", 1e3 * length) + " mm");
  const double in_bodies = at_m / chain.body_length_m;
  const auto body = std::min(static_cast<Eigen::Index>(std::floor(in_bodies)), chain.bodies - 1);
  return {body, in_bodies - static_cast<double>(body)};
}

Eigen::VectorXd displacement(const ChainMatrices& chain, double at_m) {
  const Row row = row_at(chain, at_m);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(chain.mass.rows());
  result(row.body) = 1.0 - row.along;
  result(row.body + 1) = row.along;
  return result;
}

Eigen::VectorXd rotation(const ChainMatrices& chain, double at_m) {
  const Row row = row_at(chain, at_m);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(chain.mass.rows());
  result(row.body) = -1.0 / chain.body_length_m;
  result(row.body + 1) = 1.0 / chain.body_length_m;
  return result;
}

// Each body is a uniform rod with the strip's thickness.
void add_strip(const RigidChain& strip, ChainMatrices& chain) {
  const double h = chain.body_length_m;
  const double mass = strip.density * strip.width_m * strip.thickness_m * h;
  Eigen::Matrix2d rod;
  rod << 2.0, 1.0, 1.0, 2.0;
  Eigen::Matrix2d turn;
  turn << 1.0, -1.0, -1.0, 1.0;
  const double thickness2 = strip.thickness_m * strip.thickness_m;
  for (Eigen::Index i = 0; i < chain.bodies; ++i) {
    chain.mass.block<2, 2>(i, i) += mass / 6.0 * rod + mass * thickness2 / (12.0 * h * h) * turn;
  }
}

void add_masses(const RigidChain& strip, ChainMatrices& chain) {
  for (const auto& mass_there : strip.masses) {
    const Eigen::VectorXd row = displacement(chain, mass_there.at_m);
    chain.mass += mass_there.mass_kg * row * row.transpose();
  }
}

// A joint has the stiffness of the strip over one body's length: EI / h.
Eigen::MatrixXd joint_stiffness(const RigidChain& strip, const ChainMatrices& chain) {
  const double h = chain.body_length_m;
  const double bending =
      strip.youngs_modulus * strip.width_m * std::pow(strip.thickness_m, 3) / 12.0;
  const Eigen::Vector3d kink = Eigen::Vector3d(1.0, -2.0, 1.0) / h;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(chain.mass.rows(), chain.mass.rows());
  for (Eigen::Index i = 1; i < chain.bodies; ++i) {
    result.block<3, 3>(i - 1, i - 1) += bending / h * kink * kink.transpose();
  }
  return result;
}

void add_carried(const RigidChain& strip, ChainMatrices& chain) {
  for (std::size_t k = 0; k < strip.carried.size(); ++k) {
    const auto& body = strip.carried[k];
    const auto own = chain.bodies + 1 + static_cast<Eigen::Index>(k);
    chain.mass(own, own) = body.mass_kg;
    Eigen::VectorXd stretch = displacement(chain, body.at_m);
    stretch(own) = -1.0;
    const double omega = kTwoPi * body.frequency_hz;
    chain.stiffness += body.mass_kg * omega * omega * stretch * stretch.transpose();
    chain.damping +=
        2.0 * body.damping_ratio * omega * body.mass_kg * stretch * stretch.transpose();
  }
}

struct Spectrum {
  Eigen::VectorXd omega2;
  Eigen::MatrixXd shapes;  // of unit modal mass
};

Spectrum spectrum(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  if (solver.info() != Eigen::Success) throw NumericalFailure("rigid chain: no modes");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

// Form matrices of the two flexures: the sums of squared displacements and of squared rotations.
struct Flexures {
  Eigen::MatrixXd sway, turn;
};

Flexures flexures(const RigidChain& strip, const ChainMatrices& chain) {
  const auto n = chain.mass.rows();
  Flexures result{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (const double at : {strip.flexure_m, strip.length_m - strip.flexure_m}) {
    const Eigen::VectorXd moved = displacement(chain, at);
    const Eigen::VectorXd turned = rotation(chain, at);
    result.sway += moved * moved.transpose();
    result.turn += turned * turned.transpose();
  }
  return result;
}

// φᵀAφ and φᵀBφ of the two lowest modes, one row per mode.
Eigen::Matrix2d shares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Spectrum& modes) {
  Eigen::Matrix2d result;
  for (int i = 0; i < 2; ++i) {
    result(i, 0) = modes.shapes.col(i).dot(a * modes.shapes.col(i));
    result(i, 1) = modes.shapes.col(i).dot(b * modes.shapes.col(i));
  }
  return result;
}

// Newton's method on ω² of the two lowest modes; `shares` gives its Jacobian.
void tune_stiffness(const RigidChain& strip, const Flexures& held, ChainMatrices& chain) {
  const Eigen::Vector2d wanted(std::pow(kTwoPi * strip.sway_hz, 2),
                               std::pow(kTwoPi * strip.turn_hz, 2));
  const Spectrum start = spectrum(chain.mass + chain.stiffness, chain.mass);
  const double inertia = 1.0 / (start.shapes.row(0).cwiseAbs2().maxCoeff());
  Eigen::Vector2d stiffness(wanted(0) * inertia, 1e-3 * wanted(0) * inertia);
  for (int iteration = 0; iteration < 60; ++iteration) {
    const auto modes =
        spectrum(chain.stiffness + stiffness(0) * held.sway + stiffness(1) * held.turn, chain.mass);
    const Eigen::Vector2d missing = wanted - modes.omega2.head(2);
    if (missing.cwiseQuotient(wanted).cwiseAbs().maxCoeff() < 1e-9) break;
    const Eigen::Vector2d step = shares(held.sway, held.turn, modes).partialPivLu().solve(missing);
    for (int i = 0; i < 2; ++i) {
      stiffness(i) = std::max(stiffness(i) + step(i), 0.2 * stiffness(i));
    }
  }
  chain.stiffness += stiffness(0) * held.sway + stiffness(1) * held.turn;
  const Eigen::Vector2d reached = spectrum(chain.stiffness, chain.mass).omega2.head(2);
  if (!((reached - wanted).cwiseQuotient(wanted).cwiseAbs().maxCoeff() < 1e-6)) {
    throw NumericalFailure("rigid chain: no flexures give " + fmt::format("{:.6g}", strip.sway_hz) +
                           " and " + fmt::format("{:.6g}", strip.turn_hz) + " Hz");
  }
  chain.sway_stiffness = stiffness(0);
  chain.turn_stiffness = stiffness(1);
}

// The joint damping gives the first flexible mode its ratio. The damping that the two lowest modes
// still need comes from dashpots in the flexures, with drag along the strip or, if that fails, with
// dashpots against rotation.
void tune_damping(const RigidChain& strip, const Flexures& held, const Eigen::MatrixXd& joints,
                  const Eigen::MatrixXd& drag, ChainMatrices& chain) {
  const auto modes = spectrum(chain.stiffness, chain.mass);
  const auto projected = [&](const Eigen::MatrixXd& matrix, Eigen::Index mode) {
    return modes.shapes.col(mode).dot(matrix * modes.shapes.col(mode));
  };
  const double omega = std::sqrt(modes.omega2(2));
  chain.damping += 2.0 * strip.joint_damping_ratio * omega / projected(joints, 2) * joints;
  if (strip.sway_hz == 0.0) return;
  Eigen::Vector2d missing;
  for (int i = 0; i < 2; ++i) {
    missing(i) = 2.0 * strip.suspension_damping_ratio * std::sqrt(modes.omega2(i)) -
                 projected(chain.damping, i);
  }
  for (const auto* other : {&drag, &held.turn}) {
    const Eigen::Vector2d found = shares(held.sway, *other, modes).partialPivLu().solve(missing);
    if (!(found.minCoeff() >= 0.0)) continue;
    chain.damping += found(0) * held.sway + found(1) * *other;
    return;
  }
  throw NumericalFailure("rigid chain: no dashpots give both lowest modes a damping ratio of " +
                         fmt::format("{:.6g}", strip.suspension_damping_ratio));
}

RigidChain beam(double coil_kg) {
  RigidChain chain;
  for (const double at : {0.05, 0.15, 0.25, 0.35, 0.45}) chain.masses.push_back({at, coil_kg});
  return chain;
}

}  // namespace

RigidChain beam_with_coils() { return beam(0.029331949749); }

RigidChain beam_with_carried_body() {
  RigidChain chain = beam(0.0272382862);
  chain.carried.push_back(
      {.at_m = 0.15, .mass_kg = 0.02, .frequency_hz = 50.2498538, .damping_ratio = 0.01});
  return chain;
}

ChainMatrices matrices(const RigidChain& chain) {
  check(chain);
  ChainMatrices result;
  result.bodies = chain.bodies;
  result.body_length_m = chain.length_m / static_cast<double>(chain.bodies);
  const auto n = chain.bodies + 1 + static_cast<Eigen::Index>(chain.carried.size());
  result.mass.setZero(n, n);
  result.damping.setZero(n, n);
  add_strip(chain, result);
  const Eigen::MatrixXd drag = result.mass;  // proportional to the strip's own mass
  add_masses(chain, result);
  const Eigen::MatrixXd joints = joint_stiffness(chain, result);
  result.stiffness = joints;
  add_carried(chain, result);
  const auto held = flexures(chain, result);
  if (chain.sway_hz > 0.0) tune_stiffness(chain, held, result);
  tune_damping(chain, held, joints, drag, result);
  return result;
}

Eigen::MatrixXd displacement_rows(const ChainMatrices& chain, const Eigen::VectorXd& at_m) {
  Eigen::MatrixXd rows(at_m.size(), chain.mass.rows());
  for (Eigen::Index i = 0; i < at_m.size(); ++i) {
    rows.row(i) = displacement(chain, at_m(i)).transpose();
  }
  return rows;
}

modal::ReducedModel reduced_model(const ChainMatrices& chain, const Eigen::VectorXd& sensors_m,
                                  const Eigen::VectorXd& actuators_m, Eigen::Index modes) {
  const auto n = chain.mass.rows();
  require(modes >= 1 && modes <= n, "rigid chain: " + fmt::to_string(modes) +
                                        " modes asked for; expected 1 to " + fmt::to_string(n));
  const Eigen::MatrixXd sensors = displacement_rows(chain, sensors_m);
  const Eigen::MatrixXd actuators = displacement_rows(chain, actuators_m);
  const auto all = spectrum(chain.stiffness, chain.mass);
  modal::ReducedModel result;
  result.rigid_count = chain.sway_stiffness == 0.0 ? std::min<Eigen::Index>(2, modes) : 0;
  result.frequency_hz = all.omega2.head(modes).cwiseMax(0.0).cwiseSqrt() / kTwoPi;
  result.frequency_hz.head(result.rigid_count).setZero();
  result.damping_ratio.setZero(modes);
  for (Eigen::Index i = result.rigid_count; i < modes; ++i) {
    const auto shape = all.shapes.col(i);
    result.damping_ratio(i) = shape.dot(chain.damping * shape) / (2.0 * std::sqrt(all.omega2(i)));
  }
  const Eigen::MatrixXd kept = all.shapes.leftCols(modes);
  const Eigen::MatrixXd left = all.shapes.rightCols(n - modes);
  const Eigen::VectorXd flexibility = all.omega2.tail(n - modes).cwiseInverse();
  result.output_shapes = sensors * kept;
  result.input_shapes = (actuators * kept).transpose();
  result.residual =
      sensors * left * flexibility.asDiagonal() * left.transpose() * actuators.transpose();
  const auto p = sensors.rows();
  const auto q = actuators.rows();
  result.dampers = {Eigen::MatrixXd(0, modes), Eigen::MatrixXd(p, 0), Eigen::MatrixXd(0, q),
                    Eigen::MatrixXd(0, 0)};
  return result;
}

modal::Frf frf(const ChainMatrices& chain, const Eigen::VectorXd& sensors_m,
               const Eigen::VectorXd& actuators_m, const Eigen::VectorXd& frequency_hz) {
  const Eigen::MatrixXcd sensors = displacement_rows(chain, sensors_m);
  const Eigen::MatrixXcd forces = displacement_rows(chain, actuators_m).transpose();
  modal::Frf result{.frequency_hz = frequency_hz, .value = {}};
  for (const double f : frequency_hz) {
    require(std::isfinite(f) && f >= 0.0 && (f > 0.0 || chain.sway_stiffness > 0.0),
            "rigid chain: no response at " + fmt::format("{:.6g}", f) + " Hz");
    const double omega = kTwoPi * f;
    Eigen::MatrixXcd dynamic(chain.mass.rows(), chain.mass.rows());
    dynamic.real() = chain.stiffness - omega * omega * chain.mass;
    dynamic.imag() = omega * chain.damping;
    result.value.emplace_back(sensors * dynamic.partialPivLu().solve(forces));
  }
  return result;
}

}  // namespace chladni::recordings
