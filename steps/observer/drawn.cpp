#include "steps/observer/drawn.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/turn.h"
#include "identification/spatio_temporal.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

bool is_known(const Eigen::MatrixXd& covariance, Eigen::Index i) {
  return std::isfinite(covariance(i, i)) && covariance.row(i).allFinite();
}

// A draw from a covariance; entries without one deviate by their size, which is all that is known
// of them. Negative eigenvalues are rounding.
Eigen::VectorXd drawn(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& size, Draw& draw) {
  Eigen::VectorXd normal(covariance.rows());
  for (double& value : normal) value = draw.normal();
  Eigen::MatrixXd known = covariance;
  for (Eigen::Index i = 0; i < known.rows(); ++i) {
    if (is_known(covariance, i)) continue;
    known.row(i).setZero();
    known.col(i).setZero();
    known(i, i) = size(i) * size(i);
  }
  const Eigen::VectorXd scale = known.diagonal().unaryExpr(
      [](double variance) { return variance > 0.0 ? std::sqrt(variance) : 1.0; });
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(inverse.asDiagonal() * known * inverse.asDiagonal()));
  return scale.cwiseProduct(solver.eigenvectors() *
                            solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseProduct(normal));
}

double rms_of(const Eigen::VectorXd& values) {
  return values.norm() / std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, values.size())));
}

// Sizes of ω, ζ, L and R of a mode.
Eigen::VectorXd sizes_of(const modal::ReducedModel& model, Eigen::Index m) {
  Eigen::VectorXd size(2 + model.output_count() + model.input_count());
  size << kTwoPi * model.frequency_hz(m), model.damping_ratio(m),
      Eigen::VectorXd::Constant(model.output_count(), rms_of(model.output_shapes.col(m))),
      Eigen::VectorXd::Constant(model.input_count(), rms_of(model.input_shapes.row(m).transpose()));
  return size;
}

// Modes that are not drawn. Modes beyond the lines are known together, by what they add within the
// lines, and none by itself: drawn one by one they would be anywhere.
bool stays(const IdentifiedModel& model, Eigen::Index m) {
  const auto& beyond = model.judgement.beyond_lines;
  return std::find(beyond.begin(), beyond.end(), m) != beyond.end();
}

// The factors of the modes at 0 Hz, all together: their basis is free.
void draw_rigid(identification::ModalFit& fit, Draw& draw) {
  auto& model = fit.model;
  const auto p = model.output_count();
  const auto q = model.input_count();
  const auto r = model.rigid_count;
  if (r == 0 || fit.rigid_covariance.rows() != r * (p + q)) return;
  Eigen::VectorXd size(r * (p + q));
  size << Eigen::VectorXd::Constant(r * p, rms_of(model.output_shapes.leftCols(r).reshaped())),
      Eigen::VectorXd::Constant(r * q, rms_of(model.input_shapes.topRows(r).reshaped()));
  const auto change = drawn(fit.rigid_covariance, size, draw);
  model.output_shapes.leftCols(r) += change.head(r * p).reshaped(p, r);
  model.input_shapes.topRows(r) += change.tail(r * q).reshaped(r, q);
}

// The relative change of all shapes of a mode at once.
struct ScaleChange {
  double drawn = 0.0, deviation = 0.0;
};

// 0 of modes at 0 Hz, whose basis is free, and where the fit does not tell it.
ScaleChange scale_of(const identification::ModalFit& fit, const identification::ModalFit& drawn,
                     Eigen::Index m) {
  if (m < fit.model.rigid_count) return {};
  const auto p = fit.model.output_count();
  const Eigen::VectorXd shapes = fit.model.output_shapes.col(m);
  const double square = shapes.squaredNorm();
  const Eigen::MatrixXd own = fit.mode_covariance[static_cast<std::size_t>(m)].block(2, 2, p, p);
  if (square == 0.0 || !own.allFinite()) return {};
  return {shapes.dot(drawn.model.output_shapes.col(m) - shapes) / square,
          std::sqrt(std::max(0.0, shapes.dot(own * shapes))) / square};
}

// The deviation holds the change of the scale as far as it is large enough, and a rest.
double drawn_shape(double shape, double deviation, const ScaleChange& scale, double normal) {
  const double held = identification::part_of_scale(shape, deviation, scale.deviation);
  const double open = held * shape * scale.deviation;
  const double rest = std::sqrt(std::max(0.0, deviation * deviation - open * open));
  return shape * (1.0 + held * scale.drawn) + rest * normal;
}

}  // namespace

Eigen::Index unknown_numbers(const IdentifiedModel& model, const Eigen::MatrixXd& points) {
  const auto& fit = model.found.fit;
  Eigen::Index count = 0;
  for (Eigen::Index m = 0; m < points.cols(); ++m) {
    if (!stays(model, m)) count += points.rows() - points.col(m).array().isFinite().count();
  }
  for (Eigen::Index i = 0; i < fit.rigid_covariance.rows(); ++i) {
    count += is_known(fit.rigid_covariance, i) ? 0 : 1;
  }
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    if (stays(model, m)) continue;
    const auto& covariance = fit.mode_covariance[static_cast<std::size_t>(m)];
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) count += is_known(covariance, i) ? 0 : 1;
  }
  return count;
}

identification::ModalFit drawn_fit(const IdentifiedModel& identified, Draw& draw) {
  auto fit = identified.found.fit;
  auto& model = fit.model;
  draw_rigid(fit, draw);
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    if (stays(identified, m)) continue;
    const auto change =
        drawn(fit.mode_covariance[static_cast<std::size_t>(m)], sizes_of(model, m), draw);
    const auto p = model.output_count();
    const auto q = model.input_count();
    // To first order the draw itself, but never negative.
    const auto factor = [](double relative) { return std::exp(std::clamp(relative, -0.5, 0.5)); };
    model.frequency_hz(m) *= factor(change(0) / (kTwoPi * model.frequency_hz(m)));
    if (model.damping_ratio(m) > 0.0) {
      model.damping_ratio(m) *= factor(change(1) / model.damping_ratio(m));
    }
    model.output_shapes.col(m) += change.segment(2, p);
    model.input_shapes.row(m) += change.segment(2 + p, q).transpose();
  }
  return fit;
}

identification::ObservedPlaces drawn_places(identification::ObservedPlaces places,
                                            const Observer& observer,
                                            const identification::ModalFit& drawn, Draw& draw) {
  const auto& deviation = observer.places.at_points.deviation;
  const auto& model = identified_of(*observer.shapes);
  for (Eigen::Index m = 0; m < deviation.cols(); ++m) {
    if (stays(model, m)) continue;
    const double size = rms_of(model.match.shapes.col(m));
    const auto scale = scale_of(model.found.fit, drawn, m);
    for (Eigen::Index i = 0; i < deviation.rows(); ++i) {
      const bool known = std::isfinite(deviation(i, m));
      auto& shape = places.at_points.shapes(i, m);
      shape = drawn_shape(shape, known ? deviation(i, m) : size, scale, draw.normal());
    }
  }
  return places;
}

}  // namespace chladni::steps
