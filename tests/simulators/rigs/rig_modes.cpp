// The modes of a whole rig: the bare modes as coordinates, attachments, damping that is not
// proportional, model-form error, and the records.
#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "simulators/plates/gauss_rule.h"
#include "simulators/rigs/rig_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double kRigidHz = 0.05;
constexpr double kDynamic = 2.5;     // times the band: modes with damping
constexpr double kSeen = 3e-2;       // of the median residue
constexpr double kPadPitch = 0.2;    // of the radius
constexpr double kSlopeStep = 2e-3;  // of the body's length

struct System {
  Eigen::MatrixXd mass, stiffness, damping;
  Eigen::MatrixXd channels;  // (p+q)×size

  void mass_at(const Eigen::VectorXd& shape, double m) { mass += m * shape * shape.transpose(); }
  void spring_at(const Eigen::VectorXd& shape, double k) {
    stiffness += k * shape * shape.transpose();
  }
  void damper_at(const Eigen::VectorXd& shape, double c) {
    damping += c * shape * shape.transpose();
  }
};

Eigen::VectorXd row_at(const BareModes& bare, const Eigen::Vector2d& place, Index size) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
  row.head(bare.frequency_hz.size()) = bare.shapes_at(place.transpose()).row(0).transpose();
  return row;
}

// Rows of a place on the upper face, which moves aside by half the thickness for each slope:
// 2×size.
Eigen::MatrixXd aside_at(const RealBody& body, const BareModes& bare, const Eigen::Vector2d& place,
                         Index size) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, size);
  for (Index axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kSlopeStep * body.size() * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d ahead = body.covers(place + step) ? Eigen::Vector2d(place + step) : place;
    const Eigen::Vector2d behind =
        body.covers(place - step) ? Eigen::Vector2d(place - step) : place;
    const double apart = (ahead - behind).norm();
    if (apart == 0.0) continue;
    rows.row(axis) = 0.5 * body.rig.body.thickness(0, 0) / apart *
                     (row_at(bare, ahead, size) - row_at(bare, behind, size)).transpose();
  }
  return rows;
}

// Places on a regular grid within the pad and on the body.
Eigen::MatrixX2d pad_places(const RealBody& body, const RitzPad& pad) {
  std::vector<Eigen::Vector2d> all{pad.centre};
  const double pitch = kPadPitch * pad.radius;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const Eigen::Vector2d place = pad.centre + pitch * Eigen::Vector2d(i, j);
      const bool first = i == 0 && j == 0;
      if (!first && (place - pad.centre).norm() <= pad.radius && body.covers(place, 1e-3)) {
        all.push_back(place);
      }
    }
  }
  Eigen::MatrixX2d places(static_cast<Index>(all.size()), 2);
  for (std::size_t i = 0; i < all.size(); ++i) places.row(static_cast<Index>(i)) = all[i];
  return places;
}

void attach(System& system, const RigRecipe& recipe, const BareModes& bare) {
  const Index n = bare.frequency_hz.size();
  const Index size = system.mass.rows();
  for (const auto& point : recipe.points) {
    const auto shape = row_at(bare, point.place, size);
    system.mass_at(shape, point.mass);
    for (const auto aside : aside_at(recipe.body, bare, point.place, size).rowwise()) {
      system.mass_at(aside.transpose(), point.mass);
    }
    system.spring_at(shape, point.stiffness);
    system.damper_at(shape, point.damping);
  }
  Index dof = n;
  for (const auto& one : recipe.resonators) {
    const double omega = 2.0 * pi * one.frequency_hz;
    Eigen::VectorXd stretch = -row_at(bare, one.place, size);
    stretch(dof) = 1.0;
    system.mass(dof, dof) = one.mass;
    system.spring_at(stretch, one.mass * omega * omega);
    system.damper_at(stretch, 2.0 * one.damping_ratio * one.mass * omega);
    ++dof;
  }
  for (const auto& pad : recipe.pads) {
    const Eigen::MatrixXd rows = bare.shapes_at(pad_places(recipe.body, pad));
    system.stiffness.topLeftCorner(n, n) +=
        pad.stiffness / static_cast<double>(rows.rows()) * rows.transpose() * rows;
  }
}

// Adds the errors to modes `first` and above: their frequencies, and their shapes in the columns.
void add_errors(const ModelFormError& error, Index first, Eigen::VectorXd& omega,
                Eigen::MatrixXd& channels) {
  const Index drawn = std::min(error.frequency_draw.size(), omega.size() - first);
  for (Index k = 0; k < drawn; ++k) {
    omega(first + k) *= std::exp(error.frequency * error.frequency_draw(k));
    auto shape = channels.col(first + k);
    const double rms = std::sqrt(shape.squaredNorm() / static_cast<double>(shape.size()));
    // The sign of an eigenvector is free; uneven weights decide.
    const auto n = static_cast<double>(shape.size());
    const Eigen::ArrayXd weight = (2.3 * Eigen::ArrayXd::LinSpaced(shape.size(), 1.0, n)).cos();
    const double sign = (weight * shape.array()).sum() < 0.0 ? -1.0 : 1.0;
    shape += sign * error.shape * rms * error.shape_draw.col(k);
  }
}

System assembled(const RigRecipe& recipe, const BareModes& bare) {
  const Index n = bare.frequency_hz.size();
  const Index size = n + static_cast<Index>(recipe.resonators.size());
  Eigen::VectorXd omega = 2.0 * pi * bare.frequency_hz;
  Eigen::MatrixXd channels(recipe.channels.outputs.rows() + recipe.channels.inputs.rows(), n);
  channels << bare.shapes_at(recipe.channels.outputs), bare.shapes_at(recipe.channels.inputs);
  if (recipe.error.of_body) add_errors(recipe.error, bare.rigid_count, omega, channels);
  Eigen::VectorXd damping = 2.0 * recipe.body.rig.damping_ratio * omega;
  const Index spread = std::min(n, recipe.damping_factor.size());
  damping.head(spread).array() *= recipe.damping_factor.head(spread).array();
  System system;
  system.mass = Eigen::MatrixXd::Zero(size, size);
  system.stiffness = system.damping = system.mass;
  system.mass.diagonal().head(n).setOnes();
  system.stiffness.diagonal().head(n) = omega.cwiseAbs2();
  system.damping.diagonal().head(n) = damping;
  system.channels = Eigen::MatrixXd::Zero(channels.rows(), size);
  system.channels.leftCols(n) = channels;
  attach(system, recipe, bare);
  return system;
}

// Undamped modes of the whole, with the model-form error of frequency and shape.
struct Undamped {
  Eigen::VectorXd omega;
  Eigen::MatrixXd damping;
  Eigen::MatrixXd channels;  // (p+q)×size
  Index rigid = 0;
};

Undamped undamped(const System& system, const ModelFormError& error, Index untouched) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solved(system.stiffness,
                                                                         system.mass);
  Undamped all;
  all.omega = solved.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd& v = solved.eigenvectors();
  all.damping = v.transpose() * system.damping * v;
  all.channels = system.channels * v;
  all.rigid = (all.omega.array() < 2.0 * pi * kRigidHz).count();
  if (!error.of_body) add_errors(error, untouched, all.omega, all.channels);
  return all;
}

// The damped modes of the coordinates from `first` on.
struct Damped {
  Eigen::VectorXcd pole;
  Eigen::MatrixXcd shapes;  // channels×m, so that the residue of each is shape shape'
};

Damped damped(const Undamped& all, Index first, Index count) {
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  const Eigen::MatrixXd damping = all.damping.block(first, first, count, count);
  state.topRightCorner(count, count).setIdentity();
  state.bottomLeftCorner(count, count).diagonal() = -all.omega.segment(first, count).cwiseAbs2();
  state.bottomRightCorner(count, count) = -damping;
  const Eigen::EigenSolver<Eigen::MatrixXd> solved(state);
  std::vector<Index> upper;
  for (Index k = 0; k < 2 * count; ++k) {
    if (solved.eigenvalues()(k).imag() > 0.0) upper.push_back(k);
  }
  std::ranges::sort(upper, {}, [&](Index k) { return std::abs(solved.eigenvalues()(k)); });
  Damped modes;
  modes.pole.resize(static_cast<Index>(upper.size()));
  modes.shapes.resize(all.channels.rows(), modes.pole.size());
  for (std::size_t i = 0; i < upper.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const Complex pole = solved.eigenvalues()(upper[i]);
    Eigen::VectorXcd u = solved.eigenvectors().col(upper[i]).head(count);
    // G = Σ u uᵀ / (s − p) with uᵀ (2 p I + D) u = 1.
    const Complex norm = (u.transpose() * (2.0 * pole * u + damping.cast<Complex>() * u)).value();
    u *= std::sqrt(Complex(0.0, 2.0 * pole.imag()) / norm);
    modes.pole(at) = pole;
    modes.shapes.col(at) = all.channels.middleCols(first, count).cast<Complex>() * u;
  }
  return modes;
}

// The phases by which channels of a mode differ.
void turn(Damped& modes, const ModelFormError& error) {
  const Index drawn = std::min(error.phase_draw.cols(), modes.pole.size());
  for (Index k = 0; k < drawn; ++k) {
    auto shape = modes.shapes.col(k);
    const double rms = std::sqrt(shape.squaredNorm() / static_cast<double>(shape.size()));
    shape += Complex(0.0, error.phase * rms) * error.phase_draw.col(k).cast<Complex>();
  }
}

// Frames are modes of their own.
void append(RigModes& modes, const FrameMode& frame) {
  const double omega = 2.0 * pi * frame.frequency_hz;
  const double zeta = frame.damping_ratio;
  const Index m = modes.pole.size();
  modes.pole.conservativeResize(m + 1);
  modes.outputs.conservativeResize(Eigen::NoChange, m + 1);
  modes.inputs.conservativeResize(Eigen::NoChange, m + 1);
  modes.pole(m) = omega * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
  modes.outputs.col(m) = (frame.outputs / std::sqrt(frame.mass)).cast<Complex>();
  modes.inputs.col(m) = (frame.inputs / std::sqrt(frame.mass)).cast<Complex>();
}

void sort(RigModes& modes) {
  std::vector<Index> order(static_cast<std::size_t>(modes.pole.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Index k) { return std::abs(modes.pole(k)); });
  modes.pole = Eigen::VectorXcd(modes.pole(order));
  modes.outputs = Eigen::MatrixXcd(modes.outputs(Eigen::all, order));
  modes.inputs = Eigen::MatrixXcd(modes.inputs(Eigen::all, order));
}

// Each record shows one sensor with its gain.
template <class Matrix>
Matrix recorded(const RigRecipe& recipe, const Matrix& sensors) {
  const Matrix scaled = recipe.output_gain.asDiagonal() * sensors;
  return scaled(recipe.output_of, Eigen::all);
}

}  // namespace

Eigen::VectorXd RigModes::frequency_hz() const { return pole.cwiseAbs() / (2.0 * pi); }

RigModes rig_modes(const RigRecipe& recipe, const BareModes& bare) {
  const auto system = assembled(recipe, bare);
  const auto all = undamped(system, recipe.error, bare.rigid_count);
  const Index p = recipe.channels.outputs.rows();
  const Index q = recipe.channels.inputs.rows();
  const double top = 2.0 * pi * kDynamic * recipe.body.rig.high_hz;
  const Index count = (all.omega.array() < top).count() - all.rigid;
  auto body = damped(all, all.rigid, count);
  turn(body, recipe.error);
  RigModes modes;
  const auto inputs = recipe.input_gain.asDiagonal();
  modes.rigid_outputs = recorded(recipe, Eigen::MatrixXd(all.channels.topLeftCorner(p, all.rigid)));
  modes.rigid_inputs = inputs * all.channels.bottomLeftCorner(q, all.rigid);
  modes.pole = body.pole;
  modes.outputs = body.shapes.topRows(p);
  modes.inputs = body.shapes.bottomRows(q);
  for (const auto& frame : recipe.frames) append(modes, frame);
  sort(modes);
  modes.outputs = recorded(recipe, modes.outputs);
  modes.inputs = (inputs * modes.inputs).eval();
  const Index rest = all.omega.size() - all.rigid - count;
  const Eigen::VectorXd yield = all.omega.tail(rest).cwiseAbs2().cwiseInverse();
  modes.above = recorded(recipe, Eigen::MatrixXd(all.channels.topRightCorner(p, rest))) *
                yield.asDiagonal() * all.channels.bottomRightCorner(q, rest).transpose() * inputs;
  return modes;
}

std::vector<Eigen::MatrixXcd> receptances(const RigModes& modes, const Eigen::VectorXd& hz) {
  std::vector<Eigen::MatrixXcd> all;
  const Eigen::MatrixXcd above = modes.above.cast<Complex>();
  const Eigen::MatrixXd rigid = modes.rigid_outputs * modes.rigid_inputs.transpose();
  for (const double line : hz) {
    const Complex s(0.0, 2.0 * pi * line);
    // Residues: shape shape' / (2i ω_d).
    Eigen::MatrixXcd g = above + rigid.cast<Complex>() / (s * s);
    for (Index k = 0; k < modes.pole.size(); ++k) {
      const Complex pole = modes.pole(k);
      const Eigen::MatrixXcd residue =
          modes.outputs.col(k) * modes.inputs.col(k).transpose() / Complex(0.0, 2.0 * pole.imag());
      g += residue / (s - pole) + residue.conjugate() / (s - std::conj(pole));
    }
    all.push_back(g);
  }
  return all;
}

std::vector<Index> seen_modes(const RigModes& modes, double low_hz, double high_hz) {
  const Eigen::VectorXd hz = modes.frequency_hz();
  const auto size = [&](Index k) {
    return modes.outputs.col(k).norm() * modes.inputs.col(k).norm();
  };
  std::vector<Index> within;
  std::vector<double> sizes;
  for (Index k = 0; k < hz.size(); ++k) {
    if (hz(k) < low_hz || hz(k) > high_hz) continue;
    within.push_back(k);
    sizes.push_back(size(k));
  }
  if (within.empty()) return within;
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
  const double least = kSeen * sizes[sizes.size() / 2];
  std::erase_if(within, [&](Index k) { return size(k) < least; });
  return within;
}

}  // namespace chladni::simulators
