// Shapes of a modal model at fewer places than cross-validation can carry.
#include "priors/residual/one_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "base/diagonal.h"
#include "priors/constants.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/modal_field.h"

namespace chladni::priors {
namespace {

FitSummary::Parameter one_value(const std::string& name, double value) {
  return {name, "1", Eigen::VectorXd::Constant(1, value)};
}

// Part of the shape's mean square over the surface that is expected to be wrong.
double expected_error(const ModalBasis& basis, const ShapeCoefficients& shape) {
  const double left = (basis.gram * shape.root).cwiseProduct(shape.root).sum() + shape.beyond;
  const double seen = shape.mean.dot(basis.gram * shape.mean);
  return left / (seen + left);
}

// A place that was measured keeps its value, with what the structure deviates there from the
// simulated shapes; an actuator's only where the scale to the sensors' side is known.
class OneScaleField : public ModalField {
 public:
  OneScaleField(MeasuredShapes measured, const Places& surface,
                std::vector<ShapeCoefficients> shapes, FitSummary summary)
      : ModalField(std::move(shapes), std::move(summary)),
        measured_(std::move(measured)),
        near_(diagonal_of(measured_.places.position) * Constants::same_place),
        through_(diagonal_of(surface.position) * Constants::through_body) {}

 protected:
  [[nodiscard]] Field field_at(const Places& places) const override {
    auto field = ModalField::field_at(places);
    for (Eigen::Index i = 0; i < places.count(); ++i) {
      for (const auto k : rows_at(places, i)) keep(k, i, field);
    }
    return field;
  }

 private:
  // Two faces of a plate are one place for what moves across it. The ends of a bar are two places
  // for what moves along it.
  [[nodiscard]] bool is_same(const Places& places, Eigen::Index i, Eigen::Index k) const {
    const Eigen::RowVector3d direction = measured_.places.direction.row(k);
    const Eigen::RowVector3d apart = places.position.row(i) - measured_.places.position.row(k);
    const double along = direction.dot(apart);
    return std::abs(along) <= through_ && (apart - direction * along).norm() <= near_ &&
           (places.direction.row(i) - direction).norm() <= Constants::same_direction;
  }

  // The rows measured at a place, the one that counts last: the nearest, of one place a sensor.
  [[nodiscard]] std::vector<Eigen::Index> rows_at(const Places& places, Eigen::Index i) const {
    std::vector<std::tuple<double, bool, Eigen::Index>> rows;
    for (Eigen::Index k = 0; k < measured_.places.count(); ++k) {
      if (!is_same(places, i, k)) continue;
      const double apart = (places.position.row(i) - measured_.places.position.row(k)).norm();
      rows.emplace_back(apart <= near_ ? 0.0 : apart,
                        measured_.sides->actuator[static_cast<std::size_t>(k)], k);
    }
    std::sort(rows.rbegin(), rows.rend());
    std::vector<Eigen::Index> order;
    for (const auto& row : rows) order.push_back(std::get<2>(row));
    return order;
  }

  void keep(Eigen::Index row, Eigen::Index place, Field& field) const {
    constexpr double kKnownScale = 0.05;  // deviation of δ
    const auto& sides = *measured_.sides;
    const bool actuator = sides.actuator[static_cast<std::size_t>(row)];
    for (Eigen::Index m = 0; m < field.mean.cols(); ++m) {
      const double scale = actuator ? 2.0 * sides.log_deviation(m) : 0.0;
      if (scale > 2.0 * kKnownScale) continue;
      const double value = measured_.values(row, m);
      field.mean(place, m) = value;
      field.deviation(place, m) = std::hypot(sides.noise(row, m), scale * value);
    }
  }

  MeasuredShapes measured_;
  double near_, through_;  // [m]
};

}  // namespace

std::unique_ptr<ModeField> one_scale_field(const MeasuredShapes& measured,
                                           const Simulation& simulation) {
  const auto basis = modal_basis(simulation);
  const OneScale body(measured, basis);
  const auto errors = body.learned();
  const auto plausible = body.about(errors);
  FitSummary summary;
  summary.includes_scale = true;
  std::vector<ShapeCoefficients> shapes;
  Eigen::VectorXd expected(measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    shapes.push_back(body.shape(i, plausible));
    expected(i) = expected_error(basis, shapes.back());
    if (expected(i) <= kHardlySeen) continue;
    summary.notes.push_back(
        fmt::format("mode {}: the places hardly see it, {:.0f} % of its mean square is expected "
                    "to be wrong",
                    i + 1, 100.0 * expected(i)));
  }
  summary.parameters = {
      {"expected_error", "1", expected},      one_value("eta", errors.prior.eta),
      one_value("kappa", errors.prior.kappa), one_value("gamma", errors.prior.gamma),
      one_value("scale", errors.scale),       one_value("place_deviation", errors.deviation)};
  if (!simulation.corrections.empty()) {
    summary.notes.push_back(fmt::format(
        "{} places: the simulation is not corrected, with fewer than {} it could not be tested by "
        "leaving some out; all modes have one scale instead",
        measured.places.count(), Constants::fewest_places));
  }
  return std::make_unique<OneScaleField>(measured, simulation.surface, std::move(shapes),
                                         std::move(summary));
}

}  // namespace chladni::priors
