// Thin-plate splines through measured shapes, one for each shape.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "priors/methods/blocks.h"
#include "priors/methods/interpolators.h"
#include "priors/spline/thin_plate_spline.h"

namespace chladni::priors {
namespace {

// Noise of a shape's values: their geometric mean, and each value relative to it.
struct Noise {
  double level = 1.0;
  Eigen::VectorXd relative;
};

Noise noise_of(const Eigen::VectorXd& deviation) {
  const double level = std::exp(deviation.array().log().mean());
  return {level, deviation / level};
}

// Shapes with equal noise up to its level: they share one factorisation.
struct AlikeShapes {
  Smoother smoother;
  Eigen::VectorXd relative;
  std::vector<Eigen::Index> modes;
  std::vector<Smoothing> smoothings;
};

class SplineField final : public ModeField {
 public:
  SplineField(SplineDomain domain, Eigen::MatrixXd knots, Eigen::MatrixXd weights,
              Eigen::MatrixXd trends, std::vector<AlikeShapes> alike, FitSummary summary)
      : ModeField(std::move(summary)),
        domain_(std::move(domain)),
        knots_(std::move(knots)),
        weights_(std::move(weights)),
        trends_(std::move(trends)),
        alike_(std::move(alike)) {}

  [[nodiscard]] Field field_at(const Places& places) const override {
    const auto n = places.count();
    const Eigen::VectorXd sense = senses(domain_.direction, places.direction);
    const Eigen::MatrixXd where = coordinates(domain_, places.position);
    Field field{Eigen::MatrixXd(n, weights_.cols()), Eigen::MatrixXd(n, weights_.cols())};
    for_blocks(
        n, [&](Eigen::Index first, Eigen::Index count) { evaluate(where, first, count, field); });
    field.mean.array().colwise() *= sense.array();
    return field;
  }

 private:
  void evaluate(const Eigen::MatrixXd& where, Eigen::Index first, Eigen::Index count,
                Field& field) const {
    const Eigen::MatrixXd block = where.middleRows(first, count);
    const Eigen::MatrixXd kernel = bending_kernel(block, knots_);
    const Eigen::MatrixXd plane = plane_functions(block);
    field.mean.middleRows(first, count) = kernel * weights_ + plane * trends_;
    for (const auto& shapes : alike_) {
      // Three places determine only a plane: they give no information on the bending.
      const bool unknown = shapes.smoother.contrast_count() == 0;
      const Eigen::MatrixXd variance =
          shapes.smoother.variance(kernel, Eigen::VectorXd::Zero(count), plane, shapes.smoothings);
      for (std::size_t k = 0; k < shapes.modes.size(); ++k) {
        field.deviation.col(shapes.modes[k]).segment(first, count) =
            unknown ? Eigen::VectorXd::Constant(count, std::numeric_limits<double>::quiet_NaN())
                    : Eigen::VectorXd(variance.col(static_cast<Eigen::Index>(k)).cwiseSqrt());
      }
    }
  }

  SplineDomain domain_;
  Eigen::MatrixXd knots_;    // s×d
  Eigen::MatrixXd weights_;  // s×m
  Eigen::MatrixXd trends_;   // (1+d)×m
  std::vector<AlikeShapes> alike_;
};

AlikeShapes& alike(const Eigen::VectorXd& relative, const Eigen::MatrixXd& knots,
                   std::vector<AlikeShapes>& groups) {
  for (auto& group : groups) {
    if ((group.relative - relative).cwiseAbs().maxCoeff() < 1e-12) return group;
  }
  groups.push_back(
      {Smoother(bending_kernel(knots, knots), plane_functions(knots), relative), relative, {}, {}});
  return groups.back();
}

// Factor of λ between the domain's own unit of length and metres.
double length_power(const SplineDomain& domain) {
  return std::pow(domain.size, 4.0 - static_cast<double>(domain.dimensions()));
}

void note(Eigen::Index mode, const Smoothing& smoothing, const Smoother& smoother,
          std::vector<std::string>& notes) {
  if (smoother.contrast_count() == 0) {
    notes.push_back(fmt::format(
        "mode {}: as many places as a plane has unknowns; the bending is not known at all",
        mode + 1));
  } else if (std::isinf(smoothing.lambda)) {
    notes.push_back(fmt::format(
        "mode {}: the smoothing is at its upper bound, no bending is found beyond the noise and "
        "the shape is a plane",
        mode + 1));
  } else if (smoothing.interpolates) {
    notes.push_back(fmt::format(
        "mode {}: the smoothing is at its lower bound, the values are followed without any noise",
        mode + 1));
  }
}

FitSummary summary_of(const SplineDomain& domain, const std::vector<AlikeShapes>& groups,
                      Eigen::Index m, bool given) {
  FitSummary summary;
  Eigen::VectorXd lambda(m);
  Eigen::VectorXd noise(m);
  bool at_bound = false;
  summary.log_evidence.resize(m);
  if (domain.dimensions() == 1) {
    summary.notes.emplace_back(
        "the places lie on one line: a cubic spline along it, the same all across it");
  }
  std::map<Eigen::Index, std::pair<const AlikeShapes*, std::size_t>> of;
  for (const auto& group : groups) {
    for (std::size_t k = 0; k < group.modes.size(); ++k) of[group.modes[k]] = {&group, k};
  }
  for (const auto& [mode, where] : of) {
    const auto& smoothing = where.first->smoothings[where.second];
    lambda(mode) = smoothing.lambda * length_power(domain);
    noise(mode) = smoothing.noise;
    summary.log_evidence(mode) = smoothing.log_likelihood;
    at_bound = at_bound || (!given && (std::isinf(smoothing.lambda) || smoothing.interpolates));
    note(mode, smoothing, where.first->smoother, summary.notes);
  }
  summary.parameters = {{"smoothing", domain.dimensions() == 1 ? "m3" : "m2", lambda, at_bound},
                        {"noise", "unit of the values", noise, false}};
  return summary;
}

}  // namespace

std::unique_ptr<ModeField> thin_plate_spline(const MeasuredShapes& measured,
                                             const SplineOptions& options) {
  const auto m = measured.mode_count();
  require(measured.places.count() >= 3,
          "thin plate spline: " + fmt::to_string(measured.places.count()) +
              " places, expected three or more");
  auto domain = spline_domain(measured.places);
  const Eigen::MatrixXd knots = coordinates(domain, measured.places.position);
  const Eigen::VectorXd sense = senses(domain.direction, measured.places.direction);
  Eigen::MatrixXd weights(knots.rows(), m);
  Eigen::MatrixXd trends(1 + knots.cols(), m);
  std::vector<AlikeShapes> groups;
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto noise = noise_of(measured.noise.col(i));
    auto& group = alike(noise.relative, knots, groups);
    const Eigen::VectorXd values = measured.values.col(i).cwiseProduct(sense);
    group.modes.push_back(i);
    group.smoothings.push_back(
        options.lambda
            ? group.smoother.given(values, *options.lambda / length_power(domain), noise.level)
            : group.smoother.chosen(values, options.rule, noise.level));
    const auto function = group.smoother.fit(values, group.smoothings.back().lambda);
    weights.col(i) = function.weights;
    trends.col(i) = function.trend;
  }
  auto summary = summary_of(domain, groups, m, options.lambda.has_value());
  return std::make_unique<SplineField>(std::move(domain), knots, std::move(weights),
                                       std::move(trends), std::move(groups), std::move(summary));
}

const Interpolator thin_plate_spline_interpolator{
    .name = "thin_plate_spline",
    .summary = "the thin plate of least bending, as smooth as the stated noise makes likely",
    .source = "thesis, appendix A; smoothing by restricted likelihood (Wahba 1985)",
    .uses_modes = false,
    .has_deviation = true,
    .fit = [](const MeasuredShapes& measured,
              const Simulation&) { return thin_plate_spline(measured); },
};

const Interpolator thin_plate_spline_gcv_interpolator{
    .name = "thin_plate_spline_gcv",
    .summary = "the same, smoothed by generalised cross-validation; flattens complex shapes",
    .source = "thesis, (5.13) and appendix A",
    .uses_modes = false,
    .has_deviation = true,
    .fit =
        [](const MeasuredShapes& measured, const Simulation&) {
          return thin_plate_spline(measured, {SmoothingRule::generalised_cross_validation, {}});
        },
};

const Interpolator thin_plate_spline_leave_one_out_interpolator{
    .name = "thin_plate_spline_leave_one_out",
    .summary = "the same, smoothed by leave-one-out; flattens complex shapes",
    .source = "thesis, (5.12) and appendix A",
    .uses_modes = false,
    .has_deviation = true,
    .fit =
        [](const MeasuredShapes& measured, const Simulation&) {
          return thin_plate_spline(measured, {SmoothingRule::leave_one_out, {}});
        },
};

}  // namespace chladni::priors
