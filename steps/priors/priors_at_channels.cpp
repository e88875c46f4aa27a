// Value of learned hyper-parameters at the study's own channels: figure 5.12 of the thesis.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "priors/interpolator.h"
#include "stage/faces.h"
#include "steps/interpolation.h"
#include "steps/priors.h"

namespace chladni::steps {
namespace {

constexpr double kNoNoise = 1e-6;  // of a shape's root mean square: samples of a simulation
constexpr double kAlong = 0.999;   // cosine
constexpr std::array kSplines{"thin_plate_spline", "thin_plate_spline_gcv",
                              "thin_plate_spline_leave_one_out"};

// Error Σ w (φ̂ − φ)² / Σ w φ² of a mode interpolated from its values at the channels.
double gaussian_error(const LearnedPriors& result, const priors::Learned& one,
                      const priors::Places& places, const Eigen::VectorXd& values,
                      const Eigen::VectorXd& truth) {
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(values.size(), one.noise * one.noise);
  const priors::GaussianProcess process(priors::prior_of(result.kernel, one, {}), places.position,
                                        noise);
  const auto& sites = result.surface.sites;
  return priors::squared_error(process.at(sites.position, values).mean, truth, sites.area)(0);
}

// Cosine between a channel's direction and that of the surface's nearest point.
double cosine(const ChannelSite& channel, const placement::Sites& sites, const Points& directions) {
  Eigen::Index nearest = 0;
  (sites.position.rowwise() - channel.site.position.transpose())
      .rowwise()
      .squaredNorm()
      .minCoeff(&nearest);
  return directions.row(nearest).dot(channel.direction.transpose());
}

}  // namespace

priors::Places channels_on_surface(const study::Study& study, const stage::Solution& solution,
                                   LearnedPriors& result) {
  const auto& sites = result.surface.sites;
  const auto directions = stage::directions_on(sites, result.plan.direction);
  std::vector<ChannelSite> along;
  std::string others;
  for (auto channel : channel_sites(study, solution.model)) {
    const double c = cosine(channel, sites, directions);
    if (std::abs(c) > kAlong) {
      if (c < 0.0) channel.direction *= -1.0;
      along.push_back(channel);
    } else {
      others += (others.empty() ? "" : ", ") + channel.name;
    }
  }
  if (!others.empty()) {
    result.notes.push_back(
        "not along the surface's direction, and so no part of the columns at the "
        "channels: " +
        others);
  }
  return places_at(along, solution.modes);
}

void add_channel_errors(const stage::Solution& solution, const priors::Places& places,
                        LearnedPriors& result) {
  if (places.count() < 3) return;
  const auto& sites = result.surface.sites;
  const Eigen::MatrixXd values = places.shapes(Eigen::all, result.columns);
  const Eigen::MatrixXd truth = sites.shapes(Eigen::all, result.columns);
  const auto count = static_cast<Eigen::Index>(result.columns.size());
  for (auto& at : result.by_samples) {
    at.channel_error.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      at.channel_error(i) = gaussian_error(result, at.per_mode[static_cast<std::size_t>(i)], places,
                                           values.col(i), truth.col(i));
    }
  }
  priors::Simulation simulation;
  simulation.frequency_hz = solution.modes.frequency_hz;
  simulation.surface = {sites.position, stage::directions_on(sites, result.plan.direction),
                        sites.shapes};
  simulation.area = sites.area;
  const Eigen::MatrixXd noise =
      kNoNoise * Eigen::VectorXd::Ones(values.rows()) * result.rms.transpose();
  const priors::MeasuredShapes measured{places, solution.modes.frequency_hz(result.columns), values,
                                        noise};
  for (const auto* name : kSplines) {
    try {
      const auto field = priors::mode_field(priors::interpolator(name), measured, simulation)
                             ->at(simulation.surface);
      result.spline_error.emplace_back(name, priors::squared_error(field.mean, truth, sites.area));
    } catch (const InvalidInput& e) {
      result.notes.push_back(std::string(name) + " is left out at the channels: " + e.what());
    }
  }
}

}  // namespace chladni::steps
