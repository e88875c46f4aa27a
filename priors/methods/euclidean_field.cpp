#include "priors/methods/euclidean_field.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "host/parallel.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

void require_direction(const std::string& method, const Places& places,
                       const Eigen::RowVector3d& direction) {
  for (Eigen::Index i = 0; i < places.count(); ++i) {
    const Eigen::RowVector3d here = places.direction.row(i);
    require((here - direction).norm() <= Constants::same_direction,
            fmt::format("{}: place {} has the direction ({:.6g}, {:.6g}, {:.6g}), others "
                        "({:.6g}, {:.6g}, {:.6g}); it knows distances only and needs one direction "
                        "for all; dynamic_residual takes any",
                        method, i + 1, here(0), here(1), here(2), direction(0), direction(1),
                        direction(2)));
  }
}

}  // namespace

Eigen::RowVector3d common_direction(const std::string& method, const Places& places) {
  const Eigen::RowVector3d direction = places.direction.row(0);
  require_direction(method, places, direction);
  return direction;
}

Trend trend_of(const Places& places) {
  const auto trend = rigid_trend(places.position, places.direction.row(0));
  return places.count() > trend.count() + 1 ? trend : Trend{};
}

EuclideanShape euclidean_shape(const MeasuredShapes& measured, Eigen::Index mode,
                               const Kernel& kernel, const Eigen::VectorXd& parameters,
                               const Trend& trend) {
  const auto& position = measured.places.position;
  const Eigen::VectorXd values = measured.values.col(mode);
  const Eigen::VectorXd variance = measured.noise.col(mode).cwiseAbs2();
  const double amplitude = best_amplitude(covariance(kernel, parameters, position), variance,
                                          trend.at(position), values);
  GaussianProcess process({kernel, parameters, amplitude, trend}, position, variance);
  const double evidence = process.score(Merit::marginal_likelihood, values).value(0);
  const double freedom = static_cast<double>(values.size() - trend.count());
  const double widening = freedom > 3.0 ? std::sqrt(freedom / (freedom - 2.0)) : std::sqrt(3.0);
  return {std::move(process), values, evidence, widening};
}

EuclideanField::EuclideanField(std::vector<EuclideanShape> shapes,
                               const Eigen::RowVector3d& direction, std::string method,
                               FitSummary summary)
    : ModeField(std::move(summary)),
      shapes_(std::move(shapes)),
      direction_(direction),
      method_(std::move(method)) {}

Field EuclideanField::field_at(const Places& places) const {
  require_direction(method_, places, direction_);
  const auto n = places.count();
  const auto m = static_cast<Eigen::Index>(shapes_.size());
  Field field{Eigen::MatrixXd(n, m), Eigen::MatrixXd(n, m)};
  parallel_ranges(shapes_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& shape = shapes_[i];
      const auto found = shape.process.at(places.position, shape.values);
      field.mean.col(static_cast<Eigen::Index>(i)) = found.mean;
      field.deviation.col(static_cast<Eigen::Index>(i)) = shape.widening * found.deviation;
    }
  });
  return field;
}

}  // namespace chladni::priors
