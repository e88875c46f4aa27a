#include "steps/interpolation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "modal/frf.h"
#include "placement/interpolation.h"
#include "stage/corrections.h"
#include "stage/faces.h"
#include "stage/points_on_body.h"
#include "steps/observer/stated.h"

namespace chladni::steps {
namespace {

constexpr double kAssumedDamping = 0.005;  // for compared FRFs, if none was measured
constexpr int kFrfLines = 400;
constexpr int kHarmonics = 150;  // of the body, for methods that measure distance along it

// The default method and those that the thesis compares it with, as far as they exist.
std::vector<std::string> default_methods() {
  constexpr std::array kNames{"dynamic_residual", "thin_plate_spline", "squared_exponential"};
  std::vector<std::string> names;
  for (const auto* method : priors::interpolators()) {
    if (std::find(kNames.begin(), kNames.end(), std::string_view(method->name)) != kNames.end()) {
      names.emplace_back(method->name);
    }
  }
  return names;
}

study::InterpolationPlan interpolation_plan(const study::Study& study) {
  auto plan = study.interpolation.value_or(study::InterpolationPlan{});
  if (plan.methods.empty()) plan.methods = default_methods();
  return plan;
}

bool wants(const study::InterpolationPlan& plan, std::string_view method) {
  return std::find(plan.methods.begin(), plan.methods.end(), method) != plan.methods.end();
}

std::vector<priors::SimilarModel> similar_models(const study::Study& study,
                                                 const stage::Solution& solution, unsigned seed) {
  study::UncertaintyPlan unknown{.modulus = 0.05, .density = 0.05, .thickness = 0.05};
  unknown.attached_mass = 0.01 * solution.model.mass.mass_kg;
  unknown.members = 120;
  if (study.placement && study.placement->uncertainty) unknown = *study.placement->uncertainty;
  return stage::ensemble(solution, unknown, seed);
}

// The simulation on the surface, with the additional data that the wanted methods need.
void add_simulation(const study::Study& study, const stage::Solution& solution,
                    const study::InterpolationPlan& plan, unsigned seed, Interpolated& result) {
  const auto& sites = result.surface.sites;
  auto& simulation = result.simulation;
  simulation.frequency_hz = solution.modes.frequency_hz;
  simulation.surface = {sites.position, stage::directions_on(sites, plan.direction), sites.shapes};
  simulation.area = sites.area;
  if (wants(plan, "dynamic_residual")) simulation.corrections = stage::corrections(solution);
  if (wants(plan, "ensemble")) simulation.similar = similar_models(study, solution, seed);
  if (wants(plan, "surface_matern")) {
    result.harmonics = fem::laplace_spectrum(mesh::body_laplacian(solution.model.body), kHarmonics);
    simulation.harmonic_eigenvalue = result.harmonics.eigenvalue;
    simulation.surface.harmonics = result.harmonics.functions(result.surface.node, Eigen::all);
  }
}

void add_points(const study::Study& study, const study::InterpolationPlan& plan,
                const stage::Solution& solution, const mesh::SiteFinder& finder,
                Interpolated& result) {
  std::vector<mesh::Site> sites;
  Points directions(static_cast<Eigen::Index>(plan.points.size()), 3);
  const double reach = stage::reach_of(solution.model.body);
  for (const auto& point : plan.points) {
    const auto site = site_of(study, finder, reach, point.at, "point \"" + point.name + "\"");
    directions.row(static_cast<Eigen::Index>(sites.size())) =
        plan.direction.value_or(site.normal).transpose();
    sites.push_back(site);
    result.points.push_back(point.name);
  }
  result.point_places = places_at(sites, directions, solution.modes, result.harmonics);
}

// Sensors of the study that are not in the fit: their responses are predicted.
void add_unmeasured(const study::Study& study, const stage::Solution& solution,
                    Interpolated& result) {
  if (!result.measured.identified) return;
  std::vector<ChannelSite> sites;
  const auto& seen = result.measured.identified->seen.outputs;
  for (const auto& site : channel_sites(study, solution.model)) {
    const auto is_it = [&](const auto& channel) { return channel.name == site.name; };
    if (!std::any_of(study.sensors.begin(), study.sensors.end(), is_it) ||
        std::any_of(seen.begin(), seen.end(), is_it)) {
      continue;
    }
    sites.push_back(site);
    result.unmeasured.push_back(site.name);
  }
  result.unmeasured_places = places_at(sites, solution.modes, result.harmonics);
}

// Expected error of each simulated mode with the measured channels.
Eigen::VectorXd expected_before(const Interpolated& result, double noise) {
  const auto& simulation = result.simulation;
  std::vector<Eigen::Index> flexible;
  for (auto j = simulation.rigid_count(); j < simulation.mode_count(); ++j) flexible.push_back(j);
  const auto prior = placement::shape_prior(simulation.surface.shapes, simulation.area,
                                            simulation.frequency_hz, flexible);
  const auto& rows = result.measured.shapes.places.shapes;
  const auto m = static_cast<Eigen::Index>(flexible.size());
  Eigen::VectorXd expected =
      Eigen::VectorXd::Constant(simulation.mode_count(), std::numeric_limits<double>::quiet_NaN());
  expected.tail(m) =
      placement::expected_error(prior, rows, Eigen::MatrixXd::Constant(rows.rows(), m, noise))
          .per_mode;
  return expected;
}

// FRFs between one place and the measured channels: k·s values in one column.
Eigen::VectorXcd responses(const Measured& measured, const Eigen::RowVectorXd& shape) {
  modal::ReducedModel model;
  model.frequency_hz = measured.shapes.frequency_hz;
  model.damping_ratio = measured.damping_ratio;
  for (double& ratio : model.damping_ratio) ratio = ratio > 0.0 ? ratio : kAssumedDamping;
  model.output_shapes = shape;
  model.input_shapes = measured.shapes.values.transpose();
  model.residual = Eigen::MatrixXd::Zero(1, measured.shapes.places.count());
  const double low = 0.5 * model.frequency_hz.minCoeff();
  const double high = 1.1 * model.frequency_hz.maxCoeff();
  const auto frf = modal::frf(model, Eigen::VectorXd::LinSpaced(kFrfLines, low, high));
  Eigen::VectorXcd values(kFrfLines * model.input_count());
  for (Eigen::Index k = 0; k < kFrfLines; ++k) {
    values.segment(k * model.input_count(), model.input_count()) =
        frf.value[static_cast<std::size_t>(k)].row(0).transpose();
  }
  return values;
}

void score_hidden(const Interpolated& result, Interpolation& interpolation) {
  const auto& measured = result.measured;
  const auto& hidden = measured.hidden;
  const auto h = hidden.places.count();
  interpolation.hidden_error.resize(h);
  interpolation.hidden_frf_error.resize(h);
  interpolation.hidden_covered.resize(h);
  const bool has_frf = !measured.identified && measured.shapes.frequency_hz.minCoeff() > 0.0;
  const auto modes = scored_modes(measured);
  for (Eigen::Index c = 0; c < h; ++c) {
    const Eigen::RowVectorXd real = hidden.values.row(c)(modes);
    const Eigen::RowVectorXd wrong = interpolation.hidden.mean.row(c)(modes) - real;
    interpolation.hidden_error(c) = wrong.norm() / real.norm();
    const Eigen::ArrayXd band = (interpolation.hidden.deviation.row(c)(modes).array().square() +
                                 hidden.noise.row(c)(modes).array().square())
                                    .sqrt();
    interpolation.hidden_covered(c) =
        !band.isFinite().all()
            ? std::numeric_limits<double>::quiet_NaN()
            : (wrong.transpose().array().abs() <= priors::kTwoSided95 * band).cast<double>().mean();
    interpolation.hidden_frf_error(c) = std::numeric_limits<double>::quiet_NaN();
    if (!has_frf) continue;
    const auto whole = responses(measured, hidden.values.row(c));
    interpolation.hidden_frf_error(c) =
        (responses(measured, interpolation.hidden.mean.row(c)) - whole).norm() / whole.norm();
  }
  if (measured.identified)
    interpolation.hidden_frf_error = held_out_frf_errors(result, interpolation);
}

// Adds what one standard deviation of the scale changes to the deviation of a field at places.
void widen(const Interpolation& interpolation, const priors::Places& places, priors::Field& field) {
  if (places.count() == 0 || interpolation.with_scale_off == nullptr) return;
  const Eigen::ArrayXXd moved = interpolation.with_scale_off->at(places).mean - field.mean;
  field.deviation = (field.deviation.array().square() + moved.square()).sqrt();
}

// Adds the uncertainty of each mode's scale to the deviations. The scale is common to all actuator
// rows of a mode, so its error does not average out as independent errors do. The error is put on
// the actuator rows, so responses to the actuators change only with the shape.
void widen_by_scale(const Interpolated& result, Interpolation& interpolation) {
  if (interpolation.field->summary().includes_scale) return;
  const auto off = with_scale_off(result.measured);
  if (!off) return;
  interpolation.with_scale_off = priors::mode_field(*interpolation.method, *off, result.simulation);
  widen(interpolation, result.simulation.surface, interpolation.surface);
  widen(interpolation, result.measured.hidden.places, interpolation.hidden);
  widen(interpolation, result.point_places, interpolation.points);
  widen(interpolation, result.unmeasured_places, interpolation.unmeasured);
}

// The first default method accepts any places. If another one does not, a note says so.
void add_method(const std::string& name, bool asked_for, Interpolated& result, stage::Work& work) {
  tell(work.progress(), "interpolating: " + name);
  work.timed("interpolate: " + name, [&] {
    try {
      result.methods.push_back(interpolated_by(priors::interpolator(name), result));
    } catch (const InvalidInput& e) {
      if (asked_for || result.methods.empty()) throw;
      work.note(name + " is left out: " + e.what());
    }
    return 0;
  });
}

}  // namespace

std::vector<Eigen::Index> scored_modes(const Measured& measured) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(measured.shapes.mode_count()));
  std::iota(all.begin(), all.end(), 0);
  if (!measured.identified) return all;
  const auto within = modes_within(*measured.identified);
  std::vector<Eigen::Index> scored;
  for (const auto k : all) {
    const auto mode = measured.fitted_mode[static_cast<std::size_t>(k)];
    if (std::ranges::find(within, mode) != within.end()) scored.push_back(k);
  }
  return scored.empty() ? all : scored;
}

Interpolated interpolated(const study::Study& study, const stage::Solution& solution,
                          stage::Work& work, const OnIdentified& on_identified) {
  auto plan = interpolation_plan(study);
  const auto& body = solution.model.body;
  const auto faces = stage::faces_of(study, body, plan.on, "interpolation.on");
  for (const auto& note : faces.notes) work.note(note);
  plan.direction = stage::direction_on(faces, plan);
  const placement::Sampler sampler(body, solution.modes, {plan.direction, 0.0});
  Interpolated result;
  result.direction = plan.direction;
  result.surface = stage::surface_on(sampler, faces);
  add_simulation(study, solution, plan, work.seed(), result);
  result.measured =
      measured(study, solution, result.simulation, result.harmonics, work, on_identified);
  add_points(study, plan, solution, sampler.finder(), result);
  add_unmeasured(study, solution, result);
  const double noise = study.measurement->noise;
  if (result.measured.shapes.places.count() > 0) {
    result.expected_error = expected_before(result, noise);
  }
  const bool asked_for = study.interpolation && !study.interpolation->methods.empty();
  for (const auto& name : plan.methods) add_method(name, asked_for, result, work);
  return result;
}

Interpolation interpolated_by(const priors::Interpolator& method, const Interpolated& result) {
  const auto& measured = result.measured;
  Interpolation interpolation;
  interpolation.method = &method;
  interpolation.field = priors::mode_field(method, measured.shapes, result.simulation);
  interpolation.surface = interpolation.field->at(result.simulation.surface);
  if (measured.hidden.places.count() > 0)
    interpolation.hidden = interpolation.field->at(measured.hidden.places);
  if (!result.points.empty()) interpolation.points = interpolation.field->at(result.point_places);
  if (!result.unmeasured.empty())
    interpolation.unmeasured = interpolation.field->at(result.unmeasured_places);
  widen_by_scale(result, interpolation);
  if (measured.hidden.places.count() > 0) score_hidden(result, interpolation);
  if (measured.truth.size() > 0) {
    interpolation.error =
        priors::squared_error(interpolation.surface.mean, measured.truth, measured.truth_area);
    interpolation.covered =
        priors::coverage(interpolation.surface, measured.truth, measured.truth_area);
  }
  return interpolation;
}

priors::Field field_at(const Interpolation& interpolation, const priors::Places& places) {
  auto field = interpolation.field->at(places);
  widen(interpolation, places, field);
  return field;
}

}  // namespace chladni::steps
