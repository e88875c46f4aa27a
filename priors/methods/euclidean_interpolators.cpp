// Gaussian processes on distances: the thesis' method (5.4.2, 5.4.3) and its closest variants.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/upper_median.h"
#include "priors/constants.h"
#include "priors/dynamic_residual.h"
#include "priors/methods/euclidean_field.h"
#include "priors/methods/interpolators.h"
#include "priors/methods/shape_symmetry.h"
#include "priors/simulated_lengths.h"

namespace chladni::priors {
namespace {

// Choices of a method for each mode, made before the values are used.
struct Settled {
  std::vector<Kernel> kernel;  // m
  Eigen::VectorXd length;      // m
  std::vector<bool> is_rigid;  // m: its plane is free. A flexible mode has no free plane (thesis
                               // 5.4.2): freeing it doubles the error
  bool at_bound = false;
  std::vector<std::string> notes;
};

Settled settled_with(const Kernel& kernel, Eigen::Index modes) {
  const auto count = static_cast<std::size_t>(modes);
  return {std::vector<Kernel>(count, kernel),
          Eigen::VectorXd(modes),
          std::vector<bool>(count, false),
          false,
          {}};
}

// Expectation of each measured shape from the simulation: a random sum of its modes.
class Expectation {
 public:
  Expectation(const MeasuredShapes& measured, const Simulation& simulation)
      : measured_(measured),
        simulation_(simulation),
        surface_(part(simulation.surface,
                      spread_points(simulation.surface.position, Constants::expected_samples))) {
    // The frequencies agree up to a factor: the median ratio, counted from the lowest modes.
    std::vector<double> ratio;
    Eigen::Index j = simulation.rigid_count();
    for (Eigen::Index i = 0; i < measured.mode_count() && j < simulation.mode_count(); ++i) {
      const double part = measured.frequency_hz(i) / simulation.frequency_hz(j);
      if (part < Constants::rigid_frequency) continue;
      ratio.push_back(part);
      ++j;
    }
    if (ratio.empty()) return;
    const double middle = upper_median(ratio);
    prior_.gamma = std::clamp(middle * middle, 0.25, 4.0);
  }

  [[nodiscard]] Task task(Eigen::Index mode) const {
    const double slowest = 0.01 * simulation_.frequency_hz(simulation_.mode_count() - 1);
    const double hz = std::max(measured_.frequency_hz(mode), slowest);
    const Eigen::VectorXd spread =
        coefficient_variances(simulation_.frequency_hz, hz, prior_).cwiseSqrt();
    Task task{measured_.places.position,
              measured_.places.shapes * spread.asDiagonal(),
              surface_.position,
              surface_.shapes * spread.asDiagonal(),
              Eigen::VectorXd::Ones(surface_.count()),
              0.01,
              {}};
    const double noise = measured_.noise.col(mode).norm();
    task.noise = noise / std::max(measured_.values.col(mode).norm(), noise);
    return task;
  }

  // A prior that is smoother than the shapes, or a shape that the places hardly see, makes the
  // deviation of a process too small. This function widens it to the expected error of the process'
  // prediction. Returns that error relative to the square of the shape.
  double widen(Eigen::Index mode, EuclideanShape& shape) const {
    const auto what = task(mode);
    const Eigen::MatrixXd weights = shape.process.weights(what.surface);
    const Eigen::VectorXd noise = measured_.noise.col(mode).cwiseAbs2();
    const double scale = shape.values.squaredNorm() / what.at_places.squaredNorm();
    const double expected =
        (scale * (weights * what.at_places - what.on_surface).rowwise().squaredNorm() +
         weights.cwiseAbs2() * noise)
            .mean();
    const double own = shape.process.at(what.surface, shape.values).deviation.cwiseAbs2().mean();
    if (own > 0.0) shape.widening = std::max(shape.widening, std::sqrt(expected / own));
    return expected / (scale * what.on_surface.rowwise().squaredNorm().mean());
  }

 private:
  const MeasuredShapes& measured_;
  const Simulation& simulation_;
  Places surface_;
  DynamicResidual prior_;
};

// Part of the surface that lies so far from all places that a process of this length tells it as
// (nearly) nothing, whatever the values: its correlation with each is below exp(−2).
double part_told_as_nothing(const Points& places, const Simulation& simulation, double length) {
  double area = 0.0;
  for (Eigen::Index i = 0; i < simulation.surface.count(); ++i) {
    const double nearest =
        (places.rowwise() - simulation.surface.position.row(i)).rowwise().norm().minCoeff();
    if (nearest > 2.0 * length) area += simulation.area(i);
  }
  return area / simulation.area.sum();
}

// Says of which modes a method tells most of the surface as nothing.
void note_nothing(const std::string& method, const Points& places, const Simulation& simulation,
                  const Eigen::VectorXd& length, FitSummary& summary) {
  constexpr double kMost = 0.5;
  std::string modes;
  for (Eigen::Index i = 0; i < length.size(); ++i) {
    if (part_told_as_nothing(places, simulation, length(i)) < kMost) continue;
    modes += (modes.empty() ? "" : ", ") + fmt::to_string(i + 1);
  }
  if (modes.empty()) return;
  summary.notes.push_back(
      fmt::format("mode {}: most of the surface lies more than two length scales from every place: "
                  "{} tells it as nothing there, which is no measurement; use dynamic_residual, or "
                  "more places",
                  modes, method));
}

std::unique_ptr<ModeField> field_of(const std::string& method, const MeasuredShapes& measured,
                                    const Simulation& simulation, const Settled& settled,
                                    const Expectation* expectation) {
  const auto direction = common_direction(method, measured.places);
  const auto m = measured.mode_count();
  std::vector<EuclideanShape> shapes;
  FitSummary summary;
  summary.notes = settled.notes;
  Eigen::VectorXd sigma(m);
  summary.log_evidence.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::VectorXd length = Eigen::VectorXd::Constant(1, settled.length(i));
    const auto k = static_cast<std::size_t>(i);
    const Trend trend = settled.is_rigid[k] ? trend_of(measured.places) : Trend{};
    shapes.push_back(euclidean_shape(measured, i, settled.kernel[k], length, trend));
    const double left = expectation == nullptr ? 0.0 : expectation->widen(i, shapes.back());
    if (left > kHardlySeen) {
      summary.notes.push_back(
          fmt::format("mode {}: these places leave {:.0f} % of its square unknown, by what the "
                      "simulation lets expect; move some off its nodal lines",
                      i + 1, 100.0 * std::min(left, 1.0)));
    }
    sigma(i) = shapes.back().process.prior().amplitude;
    summary.log_evidence(i) = shapes.back().log_evidence;
    if (shapes.back().process.jitter() > 0.0) {
      summary.notes.push_back(fmt::format(
          "mode {}: the covariance was singular; {:.1e} of sigma^2 was added to its diagonal",
          i + 1, shapes.back().process.jitter() / (sigma(i) * sigma(i))));
    }
  }
  note_nothing(method, measured.places.position, simulation, settled.length, summary);
  summary.parameters = {{"length_scale", "m", settled.length, settled.at_bound},
                        {"sigma", "", sigma, false}};
  return std::make_unique<EuclideanField>(std::move(shapes), direction, method, std::move(summary));
}

void note_bounds(const Learned& what, double frequency_hz, Settled& settled) {
  if (what.at_bound.empty()) return;
  settled.at_bound = true;
  settled.notes.push_back(
      fmt::format("the length scale of the simulation's mode at {:.6g} Hz, {:.4g} m, is at the end "
                  "of its range",
                  frequency_hz, what.parameters(0)));
}

// The thesis' rule: one length for all modes, that of the most complex mode in the band.
Settled one_length(const std::string& method, const Kernel& kernel, const MeasuredShapes& measured,
                   const Simulation& simulation) {
  const double most_hz = measured.frequency_hz.maxCoeff();
  const auto lengths = simulated_lengths(method, kernel, simulation, most_hz);
  const int complex = shortest(lengths);
  const auto& what = lengths.learned[static_cast<std::size_t>(complex)];
  auto settled = settled_with(kernel, measured.mode_count());
  settled.length.setConstant(what.parameters(0));
  note_bounds(what, lengths.frequency_hz(complex), settled);
  settled.notes.push_back(
      fmt::format("the most complex mode of the simulation in the band is at {:.6g} Hz",
                  lengths.frequency_hz(complex)));
  return settled;
}

// Each mode gets the length of the most similar mode of the simulation.
Settled length_per_mode(const std::string& method, const Kernel& kernel,
                        const MeasuredShapes& measured, const Simulation& simulation,
                        bool symmetric) {
  const double most_hz = Constants::length_band * measured.frequency_hz.maxCoeff();
  const auto lengths = simulated_lengths(method, kernel, simulation, most_hz);
  std::vector<Symmetry> symmetries;
  if (symmetric) symmetries = shape_symmetries(simulation, simulation.surface.direction.row(0));
  auto settled = settled_with(kernel, measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int mode = matching(lengths, measured, i);
    settled.is_rigid[k] = mode < 0;
    settled.length(i) = lengths.longest;
    if (mode < 0) continue;
    const auto& what = lengths.learned[static_cast<std::size_t>(mode)];
    settled.length(i) = what.parameters(0);
    note_bounds(what, lengths.frequency_hz(mode), settled);
    if (!symmetric) continue;
    const auto column = static_cast<std::size_t>(lengths.columns[static_cast<std::size_t>(mode)]);
    settled.kernel[k] = symmetrised(kernel, symmetries[column], Constants::asymmetric);
    settled.notes.push_back(fmt::format("mode {}: {} of the 8 symmetries of a square", i + 1,
                                        symmetries[column].operations.size()));
  }
  return settled;
}

std::unique_ptr<ModeField> thesis(const MeasuredShapes& measured, const Simulation& simulation) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const Expectation expectation(measured, simulation);
  return field_of("squared_exponential", measured, simulation,
                  one_length("squared_exponential", kernel, measured, simulation), &expectation);
}

template <const char* method, const char* family, bool symmetric = false>
std::unique_ptr<ModeField> per_mode(const MeasuredShapes& measured, const Simulation& simulation) {
  const Kernel kernel(kernel_family(family));
  const Expectation expectation(measured, simulation);
  return field_of(method, measured, simulation,
                  length_per_mode(method, kernel, measured, simulation, symmetric), &expectation);
}

// The best length for these places, if the shapes are as the simulation predicts.
std::unique_ptr<ModeField> matched(const MeasuredShapes& measured, const Simulation& simulation) {
  const std::string method = "squared_exponential_matched";
  (void)common_direction(method, simulation.surface);
  (void)common_direction(method, measured.places);
  const Kernel kernel(kernel_family("squared_exponential"));
  const Expectation expectation(measured, simulation);
  const auto lengths = length_range(measured.places.position);
  auto settled = settled_with(kernel, measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto best = expected_length(kernel, expectation.task(i));
    settled.length(i) = best.length;
    settled.at_bound |= best.at_bound;
    if (best.length > lengths.first) continue;  // the longest one is that of a plane
    settled.notes.push_back(fmt::format(
        "mode {}: no length scale lets these places resolve what the simulation expects there; "
        "expected error {:.2g} of its square",
        i + 1, best.error));
  }
  return field_of(method, measured, simulation, settled, &expectation);
}

std::unique_ptr<ModeField> by_evidence(const MeasuredShapes& measured,
                                       const Simulation& simulation) {
  const std::string method = "squared_exponential_evidence";
  (void)common_direction(method, measured.places);
  const Kernel kernel(kernel_family("squared_exponential"));
  Learning how;
  how.noise = measured.noise;
  const auto found = learned(kernel, measured.places.position, measured.values, how);
  auto settled = settled_with(kernel, measured.mode_count());
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto& one = found[static_cast<std::size_t>(i)];
    settled.length(i) = one.parameters(0);
    if (one.at_bound.empty()) continue;
    settled.at_bound = true;
    settled.notes.push_back(fmt::format(
        "mode {}: the likeliest length scale, {:.4g} m, is at the end of its range: the places do "
        "not resolve the shape, or it is a plane",
        i + 1, one.parameters(0)));
  }
  return field_of(method, measured, simulation, settled, nullptr);
}

constexpr char kSquaredPerMode[] = "squared_exponential_per_mode";
constexpr char kSquared[] = "squared_exponential";
constexpr char kSymmetrised[] = "squared_exponential_symmetrised";
constexpr char kMatern52[] = "matern_5_2";
constexpr char kMatern32[] = "matern_3_2";

}  // namespace

const Interpolator squared_exponential_interpolator{
    .name = "squared_exponential",
    .summary = "Gaussian process, one length scale: that of the simulation's most complex mode",
    .source = "thesis 5.4.2, 5.4.3",
    .uses_modes = true,
    .has_deviation = true,
    .fit = thesis,
};

const Interpolator squared_exponential_per_mode_interpolator{
    .name = kSquaredPerMode,
    .summary = "the same with the length scale of the mode it resembles",
    .source = "thesis 5.4.3, its first alternative",
    .uses_modes = true,
    .has_deviation = true,
    .fit = per_mode<kSquaredPerMode, kSquared>,
};

const Interpolator squared_exponential_symmetrised_interpolator{
    .name = kSymmetrised,
    .summary = "per mode, with the symmetries of a square that the mode it resembles keeps",
    .source = "Duvenaud, thesis, Cambridge 2014, 2.6",
    .uses_modes = true,
    .has_deviation = true,
    .fit = per_mode<kSymmetrised, kSquared, true>,
};

const Interpolator squared_exponential_matched_interpolator{
    .name = "squared_exponential_matched",
    .summary = "per mode, the length scale of least expected error at these very places",
    .source = "expected error under the dynamic-residual prior",
    .uses_modes = true,
    .has_deviation = true,
    .fit = matched,
};

const Interpolator squared_exponential_evidence_interpolator{
    .name = "squared_exponential_evidence",
    .summary = "the same with the length scale from the measured points alone",
    .source = "Rasmussen and Williams 2006, 5.4.1",
    .uses_modes = false,
    .has_deviation = true,
    .fit = by_evidence,
};

const Interpolator matern_5_2_interpolator{
    .name = kMatern52,
    .summary = "Gaussian process, Matern 5/2, length scale of the mode it resembles",
    .source = "Rasmussen and Williams 2006, 4.2.1",
    .uses_modes = true,
    .has_deviation = true,
    .fit = per_mode<kMatern52, kMatern52>,
};

const Interpolator matern_3_2_interpolator{
    .name = kMatern32,
    .summary = "Gaussian process, Matern 3/2, length scale of the mode it resembles",
    .source = "Rasmussen and Williams 2006, 4.2.1",
    .uses_modes = true,
    .has_deviation = true,
    .fit = per_mode<kMatern32, kMatern32>,
};

}  // namespace chladni::priors
