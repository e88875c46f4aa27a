#include "priors/interpolator.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/diagonal.h"
#include "base/error.h"
#include "priors/constants.h"
#include "priors/methods/interpolators.h"

namespace chladni::priors {
namespace {

constexpr std::array kAll{
    &dynamic_residual_interpolator,
    &dynamic_residual_orthogonal_interpolator,
    &dynamic_residual_alone_interpolator,
    &energy_spline_interpolator,
    &strain_energy_spline_interpolator,
    &ensemble_interpolator,
    &modal_expansion_interpolator,
    &serep_interpolator,
    &thin_plate_spline_interpolator,
    &thin_plate_spline_gcv_interpolator,
    &thin_plate_spline_leave_one_out_interpolator,
    &surface_matern_interpolator,
    &squared_exponential_interpolator,
    &squared_exponential_per_mode_interpolator,
    &squared_exponential_symmetrised_interpolator,
    &squared_exponential_matched_interpolator,
    &squared_exponential_evidence_interpolator,
    &matern_5_2_interpolator,
    &matern_3_2_interpolator,
};

constexpr double kUnequalGains = 0.1;  // of two channels at one point, at most

std::string at(Eigen::Index place, Eigen::Index mode) {
  return "place " + fmt::to_string(place + 1) + ", mode " + fmt::to_string(mode + 1);
}

void require_fitting(const Places& places, const std::string& what) {
  const auto count = fmt::to_string(places.position.rows());
  require(places.direction.rows() == places.position.rows(),
          what + " have " + count + " positions and " + fmt::to_string(places.direction.rows()) +
              " directions; expected as many");
  for (const auto* array : {&places.shapes, &places.harmonics}) {
    require(array->size() == 0 || array->rows() == places.position.rows(),
            what + " have " + count + " positions and shapes of " + fmt::to_string(array->rows()) +
                "; expected as many");
  }
  require(places.position.allFinite() && places.direction.allFinite() &&
              places.shapes.allFinite() && places.harmonics.allFinite(),
          what + " hold a position, direction or shape that is not finite");
}

void require_sizes(const MeasuredShapes& measured, const Simulation& simulation) {
  const auto s = measured.places.count();
  const auto m = measured.mode_count();
  const auto size = [](const Eigen::MatrixXd& a) {
    return fmt::to_string(a.rows()) + "x" + fmt::to_string(a.cols());
  };
  require(m > 0, "interpolation: no measured shapes");
  require(s >= 3, "interpolation: " + fmt::to_string(s) +
                      " measured place(s); expected three or more, a shape as a whole has three "
                      "unknowns already");
  for (const auto* array : {&measured.values, &measured.noise}) {
    require(array->rows() == s && array->cols() == m,
            "interpolation: values or noise are " + size(*array) + "; expected places x modes, " +
                fmt::to_string(s) + "x" + fmt::to_string(m));
  }
  require_fitting(measured.places, "the measured places");
  require_fitting(simulation.surface, "the points of the surface");
  require(simulation.area.size() == simulation.surface.count(),
          "interpolation: the surface has " + fmt::to_string(simulation.surface.count()) +
              " points and " + fmt::to_string(simulation.area.size()) + " areas");
}

void require_sound_values(const MeasuredShapes& measured) {
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const double frequency = measured.frequency_hz(i);
    require(std::isfinite(frequency) && frequency >= 0.0,
            "interpolation: mode " + fmt::to_string(i + 1) + " has the frequency " +
                fmt::format("{:.6g}", frequency) + " Hz; expected a finite one, 0 or more");
    for (Eigen::Index k = 0; k < measured.places.count(); ++k) {
      require(std::isfinite(measured.values(k, i)),
              "interpolation: the value at " + at(k, i) + " is not a finite number");
      require(std::isfinite(measured.noise(k, i)) && measured.noise(k, i) > 0.0,
              "interpolation: the noise at " + at(k, i) + " is " +
                  fmt::format("{:.6g}", measured.noise(k, i)) +
                  "; expected a positive standard deviation");
    }
  }
}

// As many marks and deviations as there are places and modes, none of them negative.
void require_sides(const MeasuredShapes& measured) {
  if (!measured.sides) return;
  const auto& sides = *measured.sides;
  const auto s = measured.places.count();
  const auto m = measured.mode_count();
  require(std::ssize(sides.actuator) == s,
          fmt::format("interpolation: there are {} marks of actuators for {} places",
                      sides.actuator.size(), s));
  require(sides.log_deviation.size() == m,
          fmt::format("interpolation: there are {} deviations of the scale for {} modes",
                      sides.log_deviation.size(), m));
  require(sides.noise.rows() == s && sides.noise.cols() == m,
          fmt::format("interpolation: the noise without the scale is {}x{}; expected places x "
                      "modes, {}x{}",
                      sides.noise.rows(), sides.noise.cols(), s, m));
  for (Eigen::Index i = 0; i < m; ++i) {
    require(std::isfinite(sides.log_deviation(i)) && sides.log_deviation(i) >= 0.0,
            fmt::format("interpolation: the deviation of the scale of mode {} is {:.6g}; expected "
                        "0 or more",
                        i + 1, sides.log_deviation(i)));
    for (Eigen::Index k = 0; k < s; ++k) {
      require(std::isfinite(sides.noise(k, i)) && sides.noise(k, i) > 0.0,
              fmt::format("interpolation: the noise without the scale at {} is {:.6g}; expected a "
                          "positive standard deviation",
                          at(k, i), sides.noise(k, i)));
    }
  }
}

// Two places that are one, and by how much the gain of the second is above that of the first.
struct SamePlace {
  Eigen::Index first = 0, second = 0;
  double gain = 0.0;
};

std::vector<SamePlace> same_places(const Places& places) {
  const auto& position = places.position;
  const double size = diagonal_of(position) * Constants::same_place;
  std::vector<SamePlace> found;
  for (Eigen::Index a = 0; a < position.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < position.rows(); ++b) {
      const bool same = (position.row(a) - position.row(b)).norm() <= size &&
                        places.direction.row(a).dot(places.direction.row(b)) > 1.0 - 1e-9;
      if (same) found.push_back({a, b, 0.0});
    }
  }
  return found;
}

// Deviations of their noise by which both differ in each mode, less a gain's part.
Eigen::ArrayXd differences(const MeasuredShapes& measured, const SamePlace& one) {
  const Eigen::ArrayXd a = measured.values.row(one.first).transpose();
  const Eigen::ArrayXd b = measured.values.row(one.second).transpose();
  const Eigen::ArrayXd square = (measured.noise.row(one.first).array().square() +
                                 measured.noise.row(one.second).array().square())
                                    .transpose();
  return (b - a - one.gain * 0.5 * (a + b)).abs() / square.sqrt();
}

// The one gain that takes the first's values to the second's, by least squares.
double gain_between(const MeasuredShapes& measured, const SamePlace& one) {
  const Eigen::ArrayXd a = measured.values.row(one.first).transpose();
  const Eigen::ArrayXd b = measured.values.row(one.second).transpose();
  const Eigen::ArrayXd weight = (measured.noise.row(one.first).array().square() +
                                 measured.noise.row(one.second).array().square())
                                    .inverse()
                                    .transpose();
  const Eigen::ArrayXd middle = 0.5 * (a + b);
  const double seen = (weight * middle.square()).sum();
  return seen > 0.0 ? (weight * middle * (b - a)).sum() / seen : 0.0;
}

// Two channels at one point may differ by their noise, or by one gain in all modes. Anything else
// is a channel at fault. @returns those whose gains differ beyond the noise
std::vector<SamePlace> unequal_gains(const MeasuredShapes& measured) {
  std::vector<SamePlace> unequal;
  for (auto one : same_places(measured.places)) {
    Eigen::Index worst = 0;
    const double apart = differences(measured, one).maxCoeff(&worst);
    if (apart <= Constants::same_value) continue;
    one.gain = gain_between(measured, one);
    require(std::abs(one.gain) <= kUnequalGains &&
                differences(measured, one).maxCoeff() <= Constants::same_value,
            "interpolation: places " + fmt::to_string(one.first + 1) + " and " +
                fmt::to_string(one.second + 1) + " are the same point, and their values in mode " +
                fmt::to_string(worst + 1) + " differ by " + fmt::format("{:.6g}", apart) +
                " deviations of their noise; expected at most 8, or one gain in all modes that is "
                "at most 10 % off");
    unequal.push_back(one);
  }
  return unequal;
}

// Which of both gains is the right one is not known: each gets half of the square of their
// difference, and the mean of both is off by half of it.
void add_gain(const MeasuredShapes& measured, const SamePlace& one, MeasuredShapes& widened) {
  for (const auto row : {one.first, one.second}) {
    const Eigen::ArrayXXd off =
        0.5 * std::pow(one.gain, 2) * measured.values.row(row).array().square();
    const auto add = [&](Eigen::MatrixXd& noise) {
      noise.row(row) = (noise.row(row).array().square() + off).sqrt();
    };
    add(widened.noise);
    if (widened.sides) add(widened.sides->noise);
  }
}

std::string note_of(const SamePlace& one) {
  return fmt::format(
      "places {} and {} are the same point and their gains differ by {:.2g} %: both "
      "count, with noise that covers it",
      one.first + 1, one.second + 1, 100.0 * std::abs(one.gain));
}

}  // namespace

Field ModeField::at(const Places& places) const {
  require_fitting(places, "the places");
  return field_at(places);
}

Places part(const Places& places, const std::vector<Eigen::Index>& rows) {
  Places chosen;
  chosen.position = places.position(rows, Eigen::all);
  chosen.direction = places.direction(rows, Eigen::all);
  if (places.shapes.size() > 0) chosen.shapes = places.shapes(rows, Eigen::all);
  if (places.harmonics.size() > 0) chosen.harmonics = places.harmonics(rows, Eigen::all);
  return chosen;
}

std::span<const Interpolator* const> interpolators() { return kAll; }

const Interpolator& interpolator(const std::string& name) {
  std::string known;
  for (const auto* one : interpolators()) {
    if (name == one->name) return *one;
    known += (known.empty() ? "" : ", ") + std::string(one->name);
  }
  throw InvalidInput("there is no interpolation \"" + name + "\"; there are: " + known);
}

std::unique_ptr<ModeField> mode_field(const Interpolator& method, const MeasuredShapes& measured,
                                      const Simulation& simulation) {
  require_sizes(measured, simulation);
  require_sound_values(measured);
  require_sides(measured);
  const auto unequal = unequal_gains(measured);
  if (method.uses_modes) {
    const auto r = simulation.mode_count();
    require(r > 0 && measured.places.shapes.cols() == r && simulation.surface.shapes.cols() == r &&
                measured.places.shapes.rows() == measured.places.count(),
            std::string("interpolation: ") + method.name +
                " needs the simulation's modes at every place; expected " + fmt::to_string(r) +
                " columns, found " + fmt::to_string(measured.places.shapes.cols()));
  }
  if (unequal.empty()) return method.fit(measured, simulation);
  auto widened = measured;
  for (const auto& one : unequal) add_gain(measured, one, widened);
  auto field = method.fit(widened, simulation);
  for (const auto& one : unequal) field->summary_.notes.push_back(note_of(one));
  return field;
}

Eigen::VectorXd squared_error(const Eigen::MatrixXd& mean, const Eigen::MatrixXd& truth,
                              const Eigen::VectorXd& area) {
  const Eigen::VectorXd wrong = (mean - truth).array().square().matrix().transpose() * area;
  const Eigen::VectorXd whole = truth.array().square().matrix().transpose() * area;
  return wrong.cwiseQuotient(whole);
}

Eigen::VectorXd coverage(const Field& field, const Eigen::MatrixXd& truth,
                         const Eigen::VectorXd& area) {
  const Eigen::ArrayXXd wrong = (field.mean - truth).array().abs();
  const Eigen::MatrixXd inside = (wrong <= kTwoSided95 * field.deviation.array()).cast<double>();
  Eigen::VectorXd covered = inside.transpose() * area / area.sum();
  for (Eigen::Index i = 0; i < covered.size(); ++i) {
    const auto unknown = field.deviation.col(i).array().isNaN() && area.array() > 0.0;
    if (unknown.any()) covered(i) = std::numeric_limits<double>::quiet_NaN();
  }
  return covered;
}

}  // namespace chladni::priors
