#include "identification/identified.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/interrupt.h"
#include "identification/compression.h"
#include "identification/delay_scan.h"
#include "identification/missing_mode.h"
#include "identification/residue_problem.h"
#include "identification/vector_fit.h"

namespace chladni::identification {
namespace {

constexpr double kWorthwhile = 25.0;     // significance of a pole, per channel
constexpr double kStartDamping = 0.005;  // of the poles at peaks
constexpr double kSettled = 0.05;        // relative change of what a vector fit leaves at its end
constexpr double kSecond = 0.2;          // least of a residue's further direction over its first
constexpr double kBroad = 10.0;          // damping over what is usual
constexpr double kSatellite = 0.01;      // worth of a pole over that of a mode near it
constexpr double kMostDamping = 0.4;     // of what is called a mode
constexpr double kEnoughExcess = 3.0;    // deviations of V above what noise leaves
constexpr double kLeastDecrease = 0.02;  // of the cost by a further mode, the noise not known
constexpr double kHardlyLess = 0.7;      // cost of a higher order over that of a lower one
constexpr double kNoiseLeft = 1.3;       // cost over what noise leaves at which to stop
constexpr int kFirstSteps = 12;          // before modes that are none are left out
constexpr Eigen::Index kSpareOrder = 5;
constexpr Eigen::Index kMany = 200;   // responses above which channels are combined
constexpr Eigen::Index kSketch = 14;  // combinations on each side to find poles from
constexpr int kPeakReach = 3;         // lines on each side that a peak tops

// Resonances that stand out [Hz], as a first guess of the poles: maxima of Σ |ω² G|², each response
// over its mean, by a factor above the median around them.
std::vector<double> peaks(const FitData& data) {
  const auto lines = data.line_count();
  const Eigen::ArrayXd acceleration = data.frequency_hz.array().pow(4);
  Eigen::ArrayXd all = Eigen::ArrayXd::Zero(lines);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd one = data.value.col(e).cwiseAbs2().array() * acceleration;
    if (one.maxCoeff() > 0.0) all += one / one.mean();
  }
  const Eigen::Index around = std::max<Eigen::Index>(20, lines / 60);
  std::vector<double> list;
  std::vector<double> window;
  for (Eigen::Index k = kPeakReach; k + kPeakReach < lines; ++k) {
    if (all(k) < all.segment(k - kPeakReach, 2 * kPeakReach + 1).maxCoeff()) continue;
    const auto first = std::max<Eigen::Index>(0, k - around);
    const auto last = std::min(lines, k + around);
    window.assign(all.data() + first, all.data() + last);
    std::nth_element(window.begin(), window.begin() + static_cast<long>(window.size() / 2),
                     window.end());
    if (all(k) > 3.0 * window[window.size() / 2]) list.push_back(data.frequency_hz(k));
  }
  return list;
}

double noise_level(const FitData& data, double cost) {
  const double level = 2.0 * cost / static_cast<double>(data.measured_count());
  return data.noise_known ? std::max(1.0, level) : std::max(level, 1e-300);
}

// Of a pole whose residue is more than noise.
double least_significance(const FitData& data, double cost) {
  return kWorthwhile * static_cast<double>(data.outputs + data.inputs) * noise_level(data, cost);
}

bool looks_like_a_mode(const std::complex<double>& pole, const FitData& data) {
  const double own = std::abs(pole) / (2.0 * M_PI);
  return -pole.real() < kMostDamping * std::abs(pole) && own > 0.5 * data.frequency_hz(0) &&
         own < 1.1 * data.frequency_hz(data.line_count() - 1);
}

// Of poles with their worth: damping as it is where most of the worth is.
double usual_damping(const Eigen::VectorXcd& poles, const Eigen::VectorXd& worth) {
  const Eigen::VectorXd log_ratio =
      (-poles.real().array() / poles.cwiseAbs().array()).max(1e-12).log();
  return std::exp(worth.dot(log_ratio) / worth.sum());
}

// What real data have beside a resonance (leakage, drift between hits, nonlinearity) draws poles of
// its own: near it, or broad ones below it. Where the noise is not known, a pole of a hundredth of
// another's worth is taken for such within three bandwidths of either or ten lines, and anywhere
// where it is damped ten times more than usual.
std::vector<Eigen::Index> without_satellites(const FitData& data, const ResidueProblem& problem,
                                             const Eigen::VectorXcd& poles,
                                             const std::vector<Eigen::Index>& all) {
  if (data.noise_stated || all.empty()) return all;
  const auto worth = problem.residues(all).significance;
  const Eigen::VectorXcd p = poles(all);
  const double usual = usual_damping(p, worth);
  const double lines = 20.0 * M_PI *
                       (data.frequency_hz(data.line_count() - 1) - data.frequency_hz(0)) /
                       static_cast<double>(data.line_count() - 1);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index a = 0; a < p.size(); ++a) {
    const bool broad = -p(a).real() > kBroad * usual * std::abs(p(a));
    bool alone = true;
    for (Eigen::Index b = 0; b < p.size(); ++b) {
      const double near = std::max(lines, -6.0 * std::min(p(a).real(), p(b).real()));
      const bool weak = worth(a) < kSatellite * worth(b);
      alone = alone && !(weak && (broad || std::abs(p(a).imag() - p(b).imag()) < near));
    }
    if (alone) kept.push_back(all[static_cast<std::size_t>(a)]);
  }
  return kept;
}

// Whether a further mode looks like what data have beside a resonance: within a bandwidth of a mode
// that is there, or damped ten times more than they are at most.
bool is_satellite(const FitData& data, const ModalFit& fit, const std::complex<double>& pole) {
  if (data.noise_stated) return false;
  const double own = std::abs(pole) / (2.0 * M_PI);
  const double ratio = -pole.real() / std::abs(pole);
  double most = 0.0;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    const double width =
        2.0 * std::max(ratio * own, fit.model.damping_ratio(m) * fit.model.frequency_hz(m));
    if (std::abs(own - fit.model.frequency_hz(m)) < width) return true;
    most = std::max(most, fit.model.damping_ratio(m));
  }
  return ratio > kBroad * most;
}

// Leaves out the poles that are no modes and then, one after the other, those that are not worth
// their parameters.
Eigen::VectorXcd worthwhile(const FitData& data, const ResidueProblem& problem,
                            const Eigen::VectorXcd& poles, Eigen::Index modes) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    if (looks_like_a_mode(poles(i), data)) kept.push_back(i);
  }
  if (modes == 0) kept = without_satellites(data, problem, poles, kept);
  // What nothing but noise leaves is known with all poles in place.
  const double least = least_significance(data, problem.residues().cost);
  while (!kept.empty()) {
    Eigen::Index weakest = 0;
    const double worth = problem.residues(kept).significance.minCoeff(&weakest);
    const auto count = static_cast<Eigen::Index>(kept.size());
    if (modes > 0 ? count <= modes : worth >= least) break;
    kept.erase(kept.begin() + weakest);
  }
  return poles(kept);
}

// Poles of which the residue has a second direction that is no noise, alone within a bandwidth: two
// modes of one frequency.
std::vector<Eigen::Index> repeated(const FitData& data, const Eigen::VectorXcd& poles,
                                   const Residues& residues) {
  const double least = least_significance(data, residues.cost);
  const Eigen::ArrayXcd s = std::complex<double>(0.0, 2.0 * M_PI) * data.frequency_hz.array();
  std::vector<Eigen::Index> list;
  for (Eigen::Index m = 0; m < poles.size(); ++m) {
    const double width = -2.0 * poles(m).real();
    if (((poles.array() - poles(m)).abs() < width).count() > 1) continue;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(residues.of_pole[static_cast<std::size_t>(m)],
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto& sigma = svd.singularValues();
    if (sigma.size() < 2 || sigma(1) < kSecond * sigma(0)) continue;
    const Eigen::VectorXd square =
        (s * s + width * s + std::norm(poles(m))).abs2().inverse().matrix();
    const Eigen::VectorXd part =
        (sigma(1) * svd.matrixU().col(1) * svd.matrixV().col(1).transpose()).reshaped();
    const Eigen::VectorXd sums = data.weight.cwiseAbs2().transpose() * square;
    if (part.cwiseAbs2().dot(sums) > least) list.push_back(m);
  }
  return list;
}

double excess_of(const ModalFit& fit) {
  const double n = 2.0 * fit.expected_cost;
  return (2.0 * fit.cost - n) / std::sqrt(2.0 * n);
}

// Whether a fit with one mode more is worth it.
bool pays(const FitData& data, const ModalFit& before, const ModalFit& after) {
  const double level = noise_level(data, after.cost);
  const double parameters = static_cast<double>(after.parameter_count - before.parameter_count);
  const double needed = 0.5 * level * std::max(1.0, parameters) *
                        std::log(static_cast<double>(data.measured_count()));
  const double won = before.cost - after.cost;
  return won > needed && (data.noise_known || won > kLeastDecrease * before.cost);
}

// With the poles that look repeated twice, where that pays.
ModalFit first_fit(const FitData& data, const Start& start, const std::vector<Eigen::Index>& twice,
                   const FitOptions& options) {
  auto once = modal_fit(data, start, options);
  if (twice.empty()) return once;
  Start more = start;
  const auto n = start.pole.size();
  more.pole.conservativeResize(n + static_cast<Eigen::Index>(twice.size()));
  for (std::size_t t = 0; t < twice.size(); ++t) {
    more.pole(n + static_cast<Eigen::Index>(t)) = start.pole(twice[t]) * (1.0 + 1e-5);
  }
  auto fit = modal_fit(data, more, options);
  return pays(data, once, fit) ? fit : once;
}

Eigen::Index flexible_count(const ModalFit& fit) {
  return fit.model.mode_count() - fit.model.rigid_count;
}

// Once the poles are the likeliest, one that the others can do without was never a mode: it mended
// what the vector fit had left of its neighbours.
void drop_idle_modes(const FitData& data, const FitOptions& options, Identified& result) {
  while (flexible_count(result.fit) > 1) {
    const auto start = start_at(result.fit.model);
    const auto residues = ResidueProblem(data, start.pole, start.rigid_count > 0).residues();
    Eigen::Index weakest = 0;
    const double worth = residues.significance.minCoeff(&weakest);
    if (worth >= least_significance(data, residues.cost)) return;
    Start less = start;
    const auto after = start.pole.size() - weakest - 1;
    less.pole.segment(weakest, after) = start.pole.tail(after).eval();
    less.pole.conservativeResize(start.pole.size() - 1);
    auto fit = modal_fit(data, less, options);
    const bool taken = !pays(data, fit, result.fit);
    result.steps.push_back({flexible_count(fit), fit.cost, excess_of(fit), taken});
    if (!taken) return;
    result.fit = std::move(fit);
  }
}

void add_missing_modes(const FitData& data, const IdentificationOptions& options,
                       Identified& result) {
  const auto room = data.measured_count() / (2 * (data.outputs + data.inputs + 1));
  const auto most = options.modes > 0 ? options.modes : std::min(options.most_modes, room);
  while (flexible_count(result.fit) < most) {
    if (options.fit.keep_best && interrupted()) break;
    const bool wanted = options.modes > flexible_count(result.fit);
    if (!wanted && data.noise_known && excess_of(result.fit) < kEnoughExcess) break;
    auto start = start_at(result.fit.model);
    const auto candidate = missing_mode(data, result.fit);
    if (!wanted && is_satellite(data, result.fit, candidate.pole)) break;
    start.pole.conservativeResize(start.pole.size() + 1);
    start.pole(start.pole.size() - 1) = candidate.pole;
    auto fit = modal_fit(data, start, options.fit);
    const bool taken = wanted || pays(data, result.fit, fit);
    result.steps.push_back({flexible_count(fit), fit.cost, excess_of(fit), taken});
    if (!taken) break;
    result.fit = std::move(fit);
  }
}

// As damped as structures are; none where that would be more than the order.
Eigen::VectorXcd poles_at(const std::vector<double>& peaks, Eigen::Index order) {
  const auto n = static_cast<Eigen::Index>(peaks.size());
  if (n > order) return {};
  return std::complex<double>(-kStartDamping, 1.0) * 2.0 * M_PI *
         Eigen::Map<const Eigen::VectorXd>(peaks.data(), n).cast<std::complex<double>>();
}

// Vector fits of rising order until a higher one leaves hardly less.
struct Poles {
  Eigen::VectorXcd pole;
  ResidueProblem problem;
};
Poles start_poles(const FitData& data, const IdentificationOptions& options, Eigen::Index& order) {
  const bool rigid = options.rigid_count != 0;
  const auto room = std::max<Eigen::Index>(1, (data.line_count() - 4) / 3);
  const auto highest = std::min(options.most_modes + kSpareOrder, room);
  const auto seen = peaks(data);
  const auto guess = options.modes > 0 ? options.modes : static_cast<Eigen::Index>(seen.size());
  // As many again: a pair is one peak, and so is what one response has between two modes.
  const auto spare = std::max(kSpareOrder, guess);
  VectorFitOptions how{.order = std::min(guess + spare, highest), .rigid = rigid};
  how.enough = 1e-4;
  how.enough_value = kSettled;
  if (data.noise_known) {  // then what is left may not pass for a mode
    how.enough_value =
        std::min(kSettled, kWorthwhile * static_cast<double>(data.outputs + data.inputs) /
                               static_cast<double>(data.measured_count()));
  }
  how.start = poles_at(seen, how.order);
  std::optional<Poles> best;
  double least = std::numeric_limits<double>::infinity();
  for (; best == std::nullopt || how.order <= highest; how.order += 3 + how.order / 5) {
    tell(options.fit.progress, "finding poles");
    how.start = vector_fit(data, how);
    ResidueProblem problem(data, how.start, rigid);
    const double cost = problem.residues().cost;
    const bool better = cost < kHardlyLess * least;
    if (cost < least) {
      best.emplace(Poles{how.start, std::move(problem)});
      order = how.order;
      least = cost;
    }
    if (!better ||
        (data.noise_known && cost < kNoiseLeft * 0.5 * static_cast<double>(data.measured_count())))
      break;
  }
  return std::move(*best);
}

// How many directions of the 1/s² term stand out of the noise.
Eigen::Index rigid_rank(const FitData& data, const Residues& residues, Eigen::Index most) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(residues.rigid,
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  const double least = least_significance(data, residues.cost);
  Eigen::Index rank = 0;
  for (; rank < std::min(most, svd.singularValues().size()); ++rank) {
    const Eigen::MatrixXd part =
        svd.singularValues()(rank) * svd.matrixU().col(rank) * svd.matrixV().col(rank).transpose();
    if (part.cwiseAbs2().cwiseProduct(residues.rigid_worth).sum() < least) break;
  }
  return rank;
}

// The delay is taken out of the data before the poles are found again.
FitData without_delay(const FitData& data, const IdentificationOptions& options, double& delay) {
  if (!options.fit.delay) return data;
  Eigen::Index order = 0;
  const auto found = start_poles(data, options, order);
  const auto kept = worthwhile(data, found.problem, found.pole, options.modes);
  delay = scanned_delay(data, kept, options.rigid_count != 0);
  return undelayed(data, delay);
}

Identified from_all_responses(const FitData& measured, const IdentificationOptions& options) {
  Identified result;
  double delay = 0.0;
  const auto data = without_delay(measured, options, delay);
  const auto found = start_poles(data, options, result.start_order);
  Start start;
  start.rigid_count = options.rigid_count >= 0
                          ? options.rigid_count
                          : rigid_rank(data, found.problem.residues(), options.most_rigid);
  start.pole = worthwhile(data, found.problem, found.pole, options.modes);
  require(start.pole.size() + start.rigid_count > 0,
          "identification: no resonance stands out of the noise in the band");
  std::vector<Eigen::Index> twice;
  if (options.modes == 0) {
    const ResidueProblem kept(data, start.pole, start.rigid_count > 0);
    twice = repeated(data, start.pole, kept.residues());
  }
  FitOptions few = options.fit;
  if (data.noise_known) few.iterations = std::min(few.iterations, kFirstSteps);
  result.fit = first_fit(data, start, twice, few);
  result.steps.push_back(
      {flexible_count(result.fit), result.fit.cost, excess_of(result.fit), true});
  if (options.modes == 0 && data.noise_known) drop_idle_modes(data, few, result);
  if (data.noise_known && !result.fit.converged)
    result.fit = modal_fit(data, start_at(result.fit.model), options.fit);
  add_missing_modes(data, options, result);
  result.fit.delay_s += delay;
  return result;
}

// Poles from a few random combinations of the channels, then the fit of all directions that matter.
Identified from_compressed(const Compressed& small, const FitData& measured,
                           const IdentificationOptions& options) {
  const auto sketch = sketched(small.data, kSketch);
  auto result = from_all_responses(sketch, options);
  if (sketch.response_count() < small.data.response_count()) {
    const double delay = result.fit.delay_s;
    const auto data = options.fit.delay ? undelayed(small.data, delay) : small.data;
    result.fit = modal_fit(data, start_at(result.fit.model), options.fit);
    result.steps.push_back(
        {flexible_count(result.fit), result.fit.cost, excess_of(result.fit), true});
    add_missing_modes(data, options, result);
    result.fit.delay_s += delay;
  }
  result.fit = expanded(result.fit, small, measured);
  return result;
}

}  // namespace

Identified identified(const FitData& measured, const IdentificationOptions& options) {
  if (measured.response_count() > kMany) {
    if (const auto small = compressed(measured)) {
      return from_compressed(*small, measured, options);
    }
  }
  return from_all_responses(measured, options);
}

}  // namespace chladni::identification
