#include "simulators/rigs/real_rig.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>

#include "base/error.h"
#include "simulators/rigs/rig_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

// FNV-1a.
unsigned seed_of(const std::string& text, unsigned seed) {
  std::uint32_t hash = 2166136261U ^ seed;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  return hash;
}

const RealKind& kind_named(const std::string& name) {
  const auto found = std::ranges::find(all_real_kinds(), name, &RealKind::name);
  require(found != all_real_kinds().end(), fmt::format("no kind of hidden effect '{}'", name));
  return *found;
}

std::vector<std::string> names_of(bool outside) {
  std::vector<std::string> names;
  for (const auto& kind : all_real_kinds()) {
    if (kind.outside == outside) names.push_back(kind.name);
  }
  return names;
}

void hide(RigRecipe& recipe, RealRigCase& made, const std::string& kinds, unsigned seed,
          const RealRigOptions& options) {
  if (kinds == "none") return;
  RigDraw drawn{Dice(seed)};
  std::stringstream words(kinds);
  for (std::string name; std::getline(words, name, '+');) {
    const auto& kind = kind_named(name);
    const double own = drawn.dice.uniform();
    drawn.severity = options.severity < 0.0 ? own : options.severity;
    drawn.mass = options.mass;
    auto effect = kind.hide(recipe, drawn);
    effect.kind = name;
    made.outside = made.outside || kind.outside;
    made.truth.push_back(std::move(effect));
  }
}

double median_magnitude(const std::vector<Eigen::MatrixXcd>& value) {
  std::vector<double> all;
  for (const auto& g : value) {
    for (const auto& entry : g.reshaped()) all.push_back(std::abs(entry));
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  return *middle;
}

Eigen::MatrixXcd circular(Dice& dice, Index rows, Index cols) {
  Eigen::MatrixXcd value(rows, cols);
  value.real() = std::sqrt(0.5) * dice.normal(rows, cols);
  value.imag() = std::sqrt(0.5) * dice.normal(rows, cols);
  return value;
}

// Responses with noise, of which all sensors share a part.
void measure(RealRigCase& made, const RealRigOptions& options, Dice dice) {
  auto& measured = made.measured;
  const auto& channels = made.body.rig.channels;
  measured.outputs = measured_channels(channels.output_names, channels.outputs, "m");
  measured.inputs = measured_channels(channels.input_names, channels.inputs, "N");
  const double floor = options.floor_noise * median_magnitude(made.exact);
  const double own = std::sqrt(1.0 - options.shared_noise);
  const double shared = std::sqrt(options.shared_noise);
  for (const auto& g : made.exact) {
    const Eigen::ArrayXXd deviation =
        (std::pow(options.relative_noise, 2) * g.cwiseAbs2().array() + floor * floor).sqrt();
    const Eigen::MatrixXcd draws = own * circular(dice, g.rows(), g.cols()) +
                                   shared * circular(dice, 1, g.cols()).replicate(g.rows(), 1);
    measured.value.emplace_back((g.array() + deviation * draws.array()).matrix());
    measured.variance.emplace_back(deviation.square().matrix());
  }
}

// Shapes of one side with noise, times the factor of each mode.
void add_side(const Eigen::MatrixXcd& exact, const Eigen::VectorXcd& factor, double level,
              Dice& dice, Eigen::MatrixXcd& shapes, Eigen::MatrixXd& std) {
  const Eigen::VectorXd rms =
      exact.colwise().norm().transpose() / std::sqrt(static_cast<double>(exact.rows()));
  // Where a mode is hardly seen, the noise is that of the others.
  const double least = rms.size() == 0 ? 0.0 : 0.1 * rms.mean();
  const Eigen::VectorXd deviation = level * (rms.array().square() + least * least).sqrt();
  const Eigen::MatrixXcd draws = std::sqrt(2.0) * circular(dice, exact.rows(), exact.cols());
  shapes = (exact + draws * deviation.cast<Complex>().asDiagonal()) * factor.asDiagonal();
  std = Eigen::MatrixXd::Ones(exact.rows(), exact.cols()) *
        (deviation.array() * factor.array().abs()).matrix().asDiagonal();
}

// What an experimental modal analysis gives.
diagnosis::MeasuredModes analysed(const RealRigCase& made, const RigModes& modes,
                                  const RealRigOptions& options, Dice dice) {
  const auto& rig = made.body.rig;
  const auto seen = seen_modes(modes, rig.low_hz, rig.high_hz);
  const auto m = static_cast<Index>(seen.size());
  diagnosis::MeasuredModes all;
  all.outputs = rig.channels.output_names;
  all.inputs = rig.channels.input_names;
  all.scaled = options.scaled;
  const Eigen::VectorXcd pole = modes.pole(seen);
  const double drawn = dice.between(5e-3, 0.01);
  const double level = options.shape_noise < 0.0 ? drawn : options.shape_noise;
  all.frequency_hz = pole.cwiseAbs().array() / (2.0 * pi) *
                     (options.frequency_noise * dice.normal(m, 1).array()).exp();
  std::ranges::sort(all.frequency_hz);
  all.frequency_std = Eigen::VectorXd::Constant(m, options.frequency_noise);
  all.damping_ratio = -pole.real().array() / pole.cwiseAbs().array() *
                      (options.damping_noise * dice.normal(m, 1).array()).exp();
  all.damping_std = Eigen::VectorXd::Constant(m, options.damping_noise);
  // Any complex factor, whose inverse the other side has where the residues are known.
  Eigen::VectorXcd factor(m);
  Eigen::VectorXcd inverse(m);
  for (Index k = 0; k < m; ++k) {
    factor(k) = std::polar(std::exp(dice.normal()), dice.between(-pi, pi));
    inverse(k) = std::polar(std::exp(dice.normal()), dice.between(-pi, pi));
  }
  if (options.scaled) inverse = factor.cwiseInverse();
  const Eigen::MatrixXcd outputs = modes.outputs(Eigen::all, seen);
  const Eigen::MatrixXcd inputs = modes.inputs(Eigen::all, seen);
  add_side(outputs, factor, level, dice, all.output_shapes, all.output_std);
  add_side(inputs, inverse, level, dice, all.input_shapes, all.input_std);
  return all;
}

Eigen::VectorXd stacked(const RigModes& modes, Index k) {
  Eigen::VectorXd all(modes.outputs.rows() + modes.inputs.rows());
  all << modes.outputs.col(k).real(), modes.inputs.col(k).real();
  return all;
}

// The square of the distance of a shape from an old one, or from the span of several that are so
// near in frequency that they turn among themselves.
double shape_distance(const Eigen::VectorXd& now, const Eigen::MatrixXd& old) {
  if (old.cols() == 1) {
    return std::min((now - old.col(0)).squaredNorm(), (now + old.col(0)).squaredNorm());
  }
  const Eigen::VectorXd inside = old * old.colPivHouseholderQr().solve(now);
  return (now - inside).squaredNorm();
}

// The shape of mode k and of those that errors of frequency cannot tell from it, whether channels
// see them or not: the effect may turn what is not seen into what is.
Eigen::MatrixXd group_of(const RigModes& modes, Index k, double error) {
  constexpr double kApart = 4.0;
  Eigen::MatrixXd group(modes.outputs.rows() + modes.inputs.rows(), 0);
  for (Index l = 0; l < modes.pole.size(); ++l) {
    if (std::abs(std::log(std::abs(modes.pole(l)) / std::abs(modes.pole(k)))) > kApart * error) {
      continue;
    }
    group.conservativeResize(Eigen::NoChange, group.cols() + 1);
    group.rightCols(1) = stacked(modes, l);
  }
  return group;
}

// Those of the modes whose mean square is not far below the median: a string's own mode is seen a
// little, and nobody's model has it.
std::vector<Index> well_seen(const RigModes& modes, std::vector<Index> of) {
  constexpr double kPart = 0.1;
  std::vector<double> squares;
  for (const Index k : of) squares.push_back(stacked(modes, k).squaredNorm());
  std::ranges::sort(squares);
  const double least = squares.empty() ? 0.0 : kPart * squares[squares.size() / 2];
  std::erase_if(of, [&](Index k) { return stacked(modes, k).squaredNorm() < least; });
  return of;
}

// log10 of half the sum of squares by which the effect moves the modes, over the levels.
double clearness(const RigModes& before, const RigModes& after, const RealRigCase& made) {
  const auto& rig = made.body.rig;
  const double frequency = std::max(made.frequency_error, 1e-3);
  const double shape = std::max(made.shape_error, 5e-3);
  const auto from = well_seen(before, seen_modes(before, rig.low_hz, rig.high_hz));
  const auto to = seen_modes(after, 0.7 * rig.low_hz, 1.4 * rig.high_hz);
  double sum = 0.0;
  for (const Index k : from) {
    const auto old = group_of(before, k, frequency);
    const double mean = stacked(before, k).squaredNorm() / static_cast<double>(old.rows());
    double least = std::numeric_limits<double>::infinity();
    for (const Index l : to) {
      const double moved = std::log(std::abs(after.pole(l)) / std::abs(before.pole(k)));
      const double shapes = shape_distance(stacked(after, l), old) / (mean * shape * shape);
      least = std::min(least, std::pow(moved / frequency, 2) + shapes);
    }
    if (std::isfinite(least)) sum += least;
  }
  return std::log10(std::max(0.5 * sum, 1e-3));
}

// Gains of one side that are further than this from the side's median: four times what gains have.
void add_outlying_gains(const Eigen::VectorXd& gain, const std::vector<std::string>& names,
                        const std::string& kind, std::vector<HiddenEffect>& to) {
  constexpr double kOutlying = 0.08;
  Eigen::VectorXd sorted = gain;
  std::ranges::sort(sorted);
  const double median = 0.5 * (sorted(sorted.size() / 2) + sorted((sorted.size() - 1) / 2));
  for (Index i = 0; i < gain.size(); ++i) {
    const double off = gain(i) / median - 1.0;
    if (std::abs(off) < kOutlying) continue;
    to.push_back({kind, {{"relative", off}}, {}, {names[static_cast<std::size_t>(i)]}});
  }
}

// Channels of one side that are further than this from where they are believed to be: four times
// the usual error of a place.
void add_outlying_places(const Eigen::MatrixX2d& places, const Eigen::MatrixX2d& believed,
                         const std::vector<std::string>& names, const std::string& kind,
                         std::vector<HiddenEffect>& to) {
  constexpr double kOutlying = 4e-3;
  for (Index i = 0; i < places.rows(); ++i) {
    const Eigen::RowVector2d off = places.row(i) - believed.row(i);
    if (off.norm() < kOutlying) continue;
    to.push_back(
        {kind, {{"u", off.x()}, {"v", off.y()}}, {}, {names[static_cast<std::size_t>(i)]}});
  }
}

// What the rig has by itself and a catalogue names.
std::vector<HiddenEffect> present(const RigRecipe& own) {
  std::vector<HiddenEffect> all;
  for (const auto& one : own.resonators) {
    all.push_back(
        {"resonator", {{"mass", one.mass}, {"frequency", one.frequency_hz}}, one.place, {}});
  }
  const auto& channels = own.channels;
  add_outlying_gains(own.output_gain, channels.output_names, "sensor_gain", all);
  add_outlying_gains(own.input_gain, channels.input_names, "actuator_gain", all);
  const auto& believed = own.body.rig.channels;
  add_outlying_places(channels.outputs, believed.outputs, channels.output_names, "sensor_position",
                      all);
  add_outlying_places(channels.inputs, believed.inputs, channels.input_names, "actuator_position",
                      all);
  return all;
}

}  // namespace

const std::vector<std::string>& real_kinds() {
  static const auto names = names_of(false);
  return names;
}

const std::vector<std::string>& real_outside_kinds() {
  static const auto names = names_of(true);
  return names;
}

std::string real_pair(unsigned seed) {
  Dice dice(seed ^ 0x9e3779b9U);
  const auto& names = real_kinds();
  const auto drawn = [&] { return names[static_cast<std::size_t>(dice.below(std::ssize(names)))]; };
  const auto of_channel = [](const std::string& kind) {
    return kind.find("sensor") != std::string::npos;
  };
  for (;;) {
    const auto first = drawn();
    const auto second = drawn();
    if (first != second && !(of_channel(first) && of_channel(second))) return first + "+" + second;
  }
}

RealRigCase real_rig_case(const std::string& body, const std::string& kind, unsigned seed,
                          const RealRigOptions& options) {
  RealRigCase made;
  made.body = real_body(body);
  made.scaled = options.scaled;
  auto recipe = believed_recipe(made.body);
  add_nature(recipe, seed_of(body, seed), options);
  made.frequency_error = recipe.error.frequency;
  made.shape_error = recipe.error.shape;
  const auto own = recipe;
  made.present = present(own);
  hide(recipe, made, kind, seed_of(body + kind, seed), options);
  const auto modes = rig_modes(recipe, bare_modes(recipe.plate, made.body.outline));
  const auto& rig = made.body.rig;
  made.measured.frequency_hz = Eigen::VectorXd::LinSpaced(options.lines, rig.low_hz, rig.high_hz);
  made.exact = receptances(modes, made.measured.frequency_hz);
  const std::string anew = options.repetition == 0 ? "" : std::to_string(options.repetition);
  const unsigned noise = seed_of(body + kind + "noise" + anew, seed);
  measure(made, options, Dice(noise));
  made.modes = analysed(made, modes, options, Dice(noise + 1U));
  if (!made.truth.empty()) {
    const auto before = rig_modes(own, bare_modes(own.plate, made.body.outline));
    made.clear = clearness(before, modes, made);
  }
  return made;
}

}  // namespace chladni::simulators
