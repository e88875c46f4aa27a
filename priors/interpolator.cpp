#include "priors/interpolator.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

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

// Two channels at one point may differ only by their noise.
void require_agreement(const MeasuredShapes& measured) {
  const auto& position = measured.places.position;
  const double size = (position.colwise().maxCoeff() - position.colwise().minCoeff()).norm() *
                      Constants::same_place;
  for (Eigen::Index a = 0; a < position.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < position.rows(); ++b) {
      const bool same =
          (position.row(a) - position.row(b)).norm() <= size &&
          measured.places.direction.row(a).dot(measured.places.direction.row(b)) > 1.0 - 1e-9;
      if (!same) continue;
      for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
        const double apart = std::abs(measured.values(a, i) - measured.values(b, i));
        const double noise = std::hypot(measured.noise(a, i), measured.noise(b, i));
        require(apart <= Constants::same_value * noise,
                "interpolation: places " + fmt::to_string(a + 1) + " and " + fmt::to_string(b + 1) +
                    " are the same point, and their values in mode " + fmt::to_string(i + 1) +
                    " differ by " + fmt::format("{:.6g}", apart / noise) +
                    " deviations of their noise; expected at most 8");
      }
    }
  }
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
  require_agreement(measured);
  if (method.uses_modes) {
    const auto r = simulation.mode_count();
    require(r > 0 && measured.places.shapes.cols() == r && simulation.surface.shapes.cols() == r &&
                measured.places.shapes.rows() == measured.places.count(),
            std::string("interpolation: ") + method.name +
                " needs the simulation's modes at every place; expected " + fmt::to_string(r) +
                " columns, found " + fmt::to_string(measured.places.shapes.cols()));
  }
  return method.fit(measured, simulation);
}

Eigen::VectorXd squared_error(const Eigen::MatrixXd& mean, const Eigen::MatrixXd& truth,
                              const Eigen::VectorXd& area) {
  const Eigen::VectorXd wrong = (mean - truth).array().square().matrix().transpose() * area;
  const Eigen::VectorXd whole = truth.array().square().matrix().transpose() * area;
  return wrong.cwiseQuotient(whole);
}

Eigen::VectorXd coverage(const Field& field, const Eigen::MatrixXd& truth,
                         const Eigen::VectorXd& area) {
  const Eigen::MatrixXd inside =
      ((field.mean - truth).array().abs() <= kTwoSided95 * field.deviation.array()).cast<double>();
  return inside.transpose() * area / area.sum();
}

}  // namespace chladni::priors
