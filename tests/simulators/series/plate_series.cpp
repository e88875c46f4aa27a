#include "simulators/series/plate_series.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/index.h"
#include "simulators/plates/ritz_structure.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {
namespace {

using diagnosis::CalibratedConstant;
using Eigen::Index;
using Eigen::MatrixXd;
using Kind = CalibratedConstant::Kind;

constexpr double kLength = 0.5, kWidth = 0.29, kThickness = 4.8e-3, kDensity = 420.0;
constexpr int kModelDegree = 9, kTrueDegree = 11;
constexpr Index kModelModes = 28;
constexpr double kShapeError = 0.05;

// A spruce-like board.
PlaneStiffness board() {
  return {.q11 = 10.9e9, .q12 = 0.34e9, .q22 = 0.86e9, .q66 = 0.70e9, .shear = 0.5e9};
}

RitzBody uniform_plate_of_wood(int degree) {
  RitzBody body;
  body.length = kLength;
  body.width = kWidth;
  body.stiffness = board();
  body.density = kDensity;
  body.thickness = MatrixXd::Constant(1, 1, kThickness);
  body.degree = degree;
  return body;
}

TableChannels channels() {
  TableChannels all;
  all.outputs.resize(9, 2);
  all.outputs << -0.24, -0.14, 0.02, -0.135, 0.235, -0.12, -0.22, -0.01, 0.05, 0.03, 0.24, 0.015,
      -0.23, 0.13, -0.03, 0.125, 0.22, 0.14;
  all.inputs.resize(1, 2);
  all.inputs << 0.23, -0.13;
  for (int i = 1; i <= 9; ++i) all.output_names.push_back("s" + std::to_string(i));
  all.input_names = {"a1"};
  return all;
}

const diagnosis::Structure& model() {
  static const auto made = ritz_structure(
      ritz_modes(uniform_plate_of_wood(kModelDegree)), channels(),
      {.modes = kModelModes, .damping_ratio = 8e-3, .cells = 6, .fine = 6, .scan = 15});
  return made;
}

// Legendre coefficients of a field over the plate, of degree 1 to 3, relative.
MatrixXd field(Dice& dice, double size) {
  MatrixXd field = MatrixXd::Zero(4, 4);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; i + j < 4; ++j) {
      if (i + j > 0) field(i, j) = size * dice.normal() / static_cast<double>(i + j);
    }
  }
  return field;
}

// What all plates of a series have and the model has not.
struct SharedNature {
  MatrixXd thickness, modulus;
  Eigen::Vector2d label;
  double mass = 0.0;    // of the label [kg]
  Eigen::Array4d mean;  // ln of q11, q22, q66 and density
};

SharedNature shared_nature(Dice& dice, double size) {
  SharedNature nature;
  nature.thickness = field(dice, 0.06 * size);
  nature.modulus = field(dice, 0.15 * size);
  nature.label = {dice.between(-0.2, 0.2), dice.between(-0.11, 0.11)};
  nature.mass = 0.02 * size * kDensity * kLength * kWidth * kThickness;
  for (double& one : nature.mean) one = 0.08 * dice.normal();
  return nature;
}

struct RealPlate {
  RitzBody body;
  double mass = 0.0;  // [kg]
};

RealPlate real_plate(Dice& dice, const SharedNature& shared, const PlateSeriesOptions& options,
                     double thicker) {
  RealPlate plate{uniform_plate_of_wood(kTrueDegree), 0.0};
  auto& body = plate.body;
  const auto by = [&](double scatter, int i) {
    return std::exp(shared.mean(i) + scatter * dice.normal());
  };
  body.stiffness.q11 *= by(options.stiffness_scatter, 0);
  const double across = by(options.stiffness_scatter, 1);
  body.stiffness.q22 *= across;
  body.stiffness.q12 *= across;
  body.stiffness.q66 *= by(options.stiffness_scatter, 2);
  body.density *= by(options.density_scatter, 3);
  body.length *= std::exp(1e-3 * dice.normal());
  body.width *= std::exp(1e-3 * dice.normal());
  const double thickness = kThickness * std::exp(thicker + 5e-3 * dice.normal());
  body.thickness = shared.thickness + field(dice, 0.01 * options.own);
  body.thickness(0, 0) = 1.0;
  body.thickness *= thickness;
  body.modulus = shared.modulus + field(dice, 0.03 * options.own);
  body.modulus(0, 0) = 1.0;
  body.fixtures.push_back({.place = shared.label, .footprint = 0.03, .mass = shared.mass});
  plate.mass = body.density * body.length * body.width * thickness + shared.mass;
  return plate;
}

diagnosis::MeasuredModes measured_on(const RitzModes& real, Dice& dice,
                                     const PlateSeriesOptions& options) {
  const Index m = options.modes;
  const Index rigid = real.body.rigid_count();
  diagnosis::MeasuredModes measured;
  measured.frequency_hz = real.frequency_hz.segment(rigid, m);
  for (double& hz : measured.frequency_hz) hz *= std::exp(5e-4 * dice.normal());
  std::sort(measured.frequency_hz.begin(), measured.frequency_hz.end());
  measured.frequency_std = Eigen::VectorXd::Constant(m, 5e-4);
  measured.damping_ratio = Eigen::VectorXd::Constant(m, std::nan(""));
  measured.damping_std = Eigen::VectorXd::Zero(m);
  measured.input_shapes.resize(0, m);
  measured.input_std.resize(0, m);
  MatrixXd shapes(0, m);
  if (options.shapes) {
    const auto seen = channels();
    measured.outputs = seen.output_names;
    shapes = modal_rows(real, seen.outputs).deflection.middleCols(rigid, m);
    const double size = shapes.norm() / std::sqrt(static_cast<double>(shapes.size()));
    shapes += kShapeError * size * dice.normal(shapes.rows(), m);
    measured.output_std = MatrixXd::Constant(shapes.rows(), m, 0.01 * size);
  } else {
    measured.output_std.resize(0, m);
  }
  measured.output_shapes = shapes.cast<std::complex<double>>();
  return measured;
}

std::vector<CalibratedConstant> sheet(double mass) {
  const auto q = board();
  return {{"material.youngs_modulus[0]", "Pa", q.q11, "stiffness_along_u", 0.15, Kind::known},
          {"material.youngs_modulus[1]", "Pa", q.q22, "stiffness_along_v", 0.15, Kind::known},
          {"material.shear_modulus[2]", "Pa", q.q66, "shear_stiffness", 0.15, Kind::known},
          {"material.density", "kg/m^3", kDensity, "density", 0.10, Kind::known},
          {"geometry.plate.length", "m", kLength, "length_along_u", 2e-3, Kind::measured},
          {"geometry.plate.width", "m", kWidth, "length_along_v", 2e-3, Kind::measured},
          {"geometry.plate.thickness", "m", kThickness, "thickness", 0.01, Kind::measured},
          {"measurement.mass", "kg", mass, "mass", 0.01, Kind::measured}};
}

}  // namespace

PlateSeries plate_series(unsigned seed, const std::string& hidden,
                         const PlateSeriesOptions& options) {
  require(hidden == "none" || hidden == "thickness" || hidden == "mass",
          hidden + " is nothing that a sheet has; expected none, thickness or mass");
  Dice dice(seed);
  const SharedNature shared = shared_nature(dice, options.shared);
  PlateSeries series;
  const Index odd = dice.below(options.specimens);
  const double sign = dice.uniform() < 0.5 ? -1.0 : 1.0;
  const double change = sign * dice.between(options.least, options.most);
  if (hidden != "none") {
    series.odd = static_cast<int>(odd);
    series.odd_effect = hidden;
    series.odd_change = change;
  }
  for (Index s = 0; s < options.specimens; ++s) {
    const bool is_odd = hidden != "none" && s == odd;
    const double thicker = is_odd && hidden == "thickness" ? change : 0.0;
    const RealPlate plate = real_plate(dice, shared, options, thicker);
    const double weighed = plate.mass * std::exp(3e-3 * dice.normal());
    const double written = is_odd && hidden == "mass" ? weighed * std::exp(-change) : weighed;
    diagnosis::Specimen one;
    one.name = "plate " + std::to_string(s + 1);
    one.structure = model();
    one.measured = measured_on(ritz_modes(plate.body), dice, options);
    one.constants = sheet(written);
    series.specimens.push_back(std::move(one));
  }
  return series;
}

SeriesErrors errors_of_series(unsigned seed, const PlateSeriesOptions& options) {
  Dice dice(seed);
  const SharedNature shared = shared_nature(dice, options.shared);
  PlateSeriesOptions without = options;
  without.stiffness_scatter = without.density_scatter = 0.0;
  const Index m = options.modes;
  RitzBody mean = uniform_plate_of_wood(kModelDegree);
  mean.stiffness.q11 *= std::exp(shared.mean(0));
  mean.stiffness.q22 *= std::exp(shared.mean(1));
  mean.stiffness.q12 *= std::exp(shared.mean(1));
  mean.stiffness.q66 *= std::exp(shared.mean(2));
  mean.density *= std::exp(shared.mean(3));
  const Eigen::VectorXd simulated = ritz_modes(mean).frequency_hz.segment(3, m);
  MatrixXd off(m, options.specimens);
  for (Index s = 0; s < options.specimens; ++s) {
    const auto plate = real_plate(dice, shared, without, 0.0);
    off.col(s) =
        (ritz_modes(plate.body).frequency_hz.segment(3, m).array() / simulated.array()).log();
    off.col(s).array() -= off.col(s).mean();
  }
  const Eigen::VectorXd common = off.rowwise().mean();
  const double n = static_cast<double>(m);
  return {std::sqrt(common.squaredNorm() / n),
          (off.colwise() - common).norm() / std::sqrt(n * (options.specimens - 1.0))};
}

}  // namespace chladni::simulators
