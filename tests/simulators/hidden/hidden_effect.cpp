#include "simulators/hidden/hidden_effect.h"
#include "simulators/tables/table_channels.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "base/error.h"
#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

Recipe believed(const HiddenOptions& options) {
  Recipe recipe;
  recipe.rig = rig_named(options.rig, options.degree);
  recipe.degree = options.degree;
  recipe.above_hz = options.above_hz;
  recipe.on_face = options.on_face;
  recipe.body = recipe.rig.body;
  recipe.channels = recipe.rig.channels;
  recipe.output_tilts = Eigen::MatrixX2d::Zero(recipe.channels.outputs.rows(), 2);
  recipe.input_tilts = Eigen::MatrixX2d::Zero(recipe.channels.inputs.rows(), 2);
  const auto p = recipe.channels.outputs.rows();
  const auto q = recipe.channels.inputs.rows();
  recipe.output_of.resize(static_cast<std::size_t>(p));
  recipe.input_of.resize(static_cast<std::size_t>(q));
  std::iota(recipe.output_of.begin(), recipe.output_of.end(), 0);
  std::iota(recipe.input_of.begin(), recipe.input_of.end(), 0);
  recipe.outputs.resize(static_cast<std::size_t>(p));
  recipe.inputs.resize(static_cast<std::size_t>(q));
  recipe.output_mix = Eigen::MatrixXd::Identity(p, p);
  recipe.input_mix = Eigen::MatrixXd::Identity(q, q);
  return recipe;
}

double median_magnitude(const std::vector<Eigen::MatrixXcd>& value) {
  std::vector<double> all;
  for (const auto& g : value) {
    for (const auto& entry : g.reshaped()) all.push_back(std::abs(entry));
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

void measure(HiddenCase& made, const HiddenOptions& options, Dice& dice) {
  const double floor = options.floor_noise * median_magnitude(made.exact);
  const double relative = options.relative_noise * options.relative_noise;
  for (const auto& g : made.exact) {
    const Eigen::MatrixXd variance = (relative * g.cwiseAbs2().array() + floor * floor).matrix();
    const Eigen::MatrixXd deviation = (0.5 * variance).cwiseSqrt();
    Eigen::MatrixXcd noise(g.rows(), g.cols());
    noise.real() = deviation.cwiseProduct(dice.normal(g.rows(), g.cols()));
    noise.imag() = deviation.cwiseProduct(dice.normal(g.rows(), g.cols()));
    made.measured.value.emplace_back(g + noise);
    made.measured.variance.push_back(variance);
  }
}

const std::vector<HiddenKind>& all_hidden_kinds() {
  static const auto kinds = [] {
    auto all = body_kinds();
    all.insert(all.end(), channel_kinds().begin(), channel_kinds().end());
    all.insert(all.end(), kinds_outside().begin(), kinds_outside().end());
    return all;
  }();
  return kinds;
}

const HiddenKind& kind_of(const std::string& name) {
  for (const auto& kind : all_hidden_kinds()) {
    if (kind.name == name) return kind;
  }
  throw InvalidInput(fmt::format("no kind of hidden effect '{}'", name));
}

std::vector<std::string> names_of(bool outside) {
  std::vector<std::string> names;
  for (const auto& kind : all_hidden_kinds()) {
    if (kind.outside == outside) names.push_back(kind.name);
  }
  return names;
}

// A seed that also depends on the kinds, so that kinds do not draw the same numbers (FNV-1a).
unsigned seed_of(const std::vector<std::string>& kinds, unsigned seed) {
  std::uint32_t hash = 2166136261U ^ seed;
  for (const auto& kind : kinds) {
    for (const char letter : kind) {
      hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
    }
  }
  return hash;
}

// The responses with channels that are moved instead of tilted. A channel of height z with the tilt
// θ sees w − θ z ∂w where the body does not shear.
std::vector<Eigen::MatrixXcd> moved_instead(Recipe recipe, const Eigen::VectorXd& hz,
                                            const HiddenOptions& options) {
  if (recipe.output_tilts.isZero(0.0) && recipe.input_tilts.isZero(0.0)) return {};
  const auto cost = [&](std::vector<ChannelFilter>& filters, const Eigen::MatrixX2d& tilts) {
    for (Index i = 0; options.deviation > 0.0 && i < tilts.rows(); ++i) {
      filters[static_cast<std::size_t>(i)].gain /= std::sqrt(1.0 + tilts.row(i).squaredNorm());
    }
  };
  cost(recipe.outputs, recipe.output_tilts);
  cost(recipe.inputs, recipe.input_tilts);
  const double top = 0.5 * recipe.rig.body.thickness(0, 0);
  recipe.channels.outputs -= top * recipe.output_tilts;
  recipe.channels.inputs -= (recipe.rig.driven_from_below ? -top : top) * recipe.input_tilts;
  recipe.output_tilts.setZero();
  recipe.input_tilts.setZero();
  return responses(recipe, hz, options.damping_stays);
}

// Hides the kinds in the recipe and notes them in the truth.
void hide(Recipe& recipe, HiddenCase& made, const std::vector<std::string>& kinds, Drawn& drawn,
          double severity) {
  for (const auto& name : kinds) {
    const auto& kind = kind_of(name);
    require(recipe.rig.has(name),
            fmt::format("{} cannot be hidden in the rig '{}'", name, recipe.rig.name));
    const double own = drawn.dice.uniform();
    drawn.severity = severity < 0.0 ? own : severity;
    auto effect = kind.hide(recipe, drawn);
    effect.kind = kind.name;
    if (effect.place) drawn.taken_places.push_back(*effect.place);
    drawn.taken_channels.insert(drawn.taken_channels.end(), effect.channels.begin(),
                                effect.channels.end());
    made.outside = made.outside || kind.outside;
    made.truth.push_back(std::move(effect));
  }
}

}  // namespace

double Drawn::size(double low, double high) { return low * std::pow(high / low, severity); }

Eigen::Vector2d Drawn::place(double margin) {
  for (int attempt = 0;; ++attempt) {
    const double rim = margin * scale.length;
    const double x = dice.between(rim - half.x(), half.x() - rim);
    const double y = dice.between(rim - half.y(), half.y() - rim);
    const Eigen::Vector2d found(x, slender ? 0.0 : y);
    const bool free = std::ranges::none_of(
        taken_places, [&](const auto& one) { return (one - found).norm() < 0.12 * scale.length; });
    if (free || attempt > 200) return found;
  }
}

Eigen::Vector2d Drawn::direction() {
  const double angle = dice.between(0.0, 2.0 * std::numbers::pi);
  if (slender) return {angle < std::numbers::pi ? 1.0 : -1.0, 0.0};
  return {std::cos(angle), std::sin(angle)};
}

Index Drawn::channel(const std::vector<std::string>& names) {
  for (;;) {
    const Index found = dice.below(static_cast<Index>(names.size()));
    const auto& name = names[static_cast<std::size_t>(found)];
    if (std::find(taken_channels.begin(), taken_channels.end(), name) == taken_channels.end()) {
      return found;
    }
  }
}

const std::vector<std::string>& hidden_kinds() {
  static const auto names = names_of(false);
  return names;
}

const std::vector<std::string>& outside_kinds() {
  static const auto names = names_of(true);
  return names;
}

std::vector<std::string> hidden_pair(unsigned seed) {
  Dice dice(seed ^ 0x9e3779b9U);
  const auto& names = hidden_kinds();
  const auto drawn = [&] {
    return names[static_cast<std::size_t>(dice.below(static_cast<Index>(names.size())))];
  };
  // A swap of labels and another effect on the same labels could be described in two ways.
  const auto side = [](const std::string& name) {
    if (name.find("sensor") != std::string::npos) return 1;
    return name.find("actuator") != std::string::npos ? 2 : 0;
  };
  const auto clash = [&](const std::string& a, const std::string& b) {
    const bool labels = a.starts_with("swapped") || b.starts_with("swapped");
    return a == b || (labels && side(a) == side(b));
  };
  auto first = drawn();
  auto second = drawn();
  while (clash(first, second)) second = drawn();
  return {first, second};
}

const RitzModes& believed_modes(const std::string& rig, int degree) {
  static std::map<std::pair<std::string, int>, RitzModes> kept;
  const auto key = std::pair(rig, degree);
  auto found = kept.find(key);
  if (found == kept.end()) {
    found = kept.emplace(key, ritz_modes(rig_named(rig, degree).body)).first;
  }
  return found->second;
}

const RitzModes& believed_table(int degree) { return believed_modes("table", degree); }

HiddenCase hidden_case(const std::vector<std::string>& kinds, unsigned seed,
                       const HiddenOptions& options) {
  auto recipe = believed(options);
  const auto& rig = recipe.rig;
  const double low_hz = options.low_hz > 0.0 ? options.low_hz : rig.low_hz;
  const double high_hz = options.high_hz > 0.0 ? options.high_hz : rig.high_hz;
  require(options.lines > 1 && high_hz > low_hz,
          fmt::format("{} lines from {} to {} Hz: two or more, ascending, are expected",
                      options.lines, low_hz, high_hz));
  HiddenCase made;
  auto& measured = made.measured;
  measured.outputs = measured_channels(recipe.channels.output_names, recipe.channels.outputs, "m");
  measured.inputs = measured_channels(recipe.channels.input_names, recipe.channels.inputs, "N");
  measured.frequency_hz = Eigen::VectorXd::LinSpaced(options.lines, low_hz, high_hz);
  const auto nominal = responses(recipe, measured.frequency_hz, true);
  Drawn drawn{Dice(seed_of(kinds, seed)),
              0.0,
              rig.scale,
              0.5 * Eigen::Vector2d(rig.body.length, rig.body.width),
              rig.is_slender(),
              {},
              {}};
  // With other laws than the normal one, each case has its own rig.
  const bool one_rig = options.law == DeviationLaw::normal;
  Dice built((one_rig ? seed : seed_of(kinds, seed)) + 0x51ed270bU);
  deviate(recipe, built, options);
  hide(recipe, made, kinds, drawn, options.severity);
  const bool as_believed = kinds.empty() && options.deviation == 0.0;
  made.exact =
      as_believed ? nominal : responses(recipe, measured.frequency_hz, options.damping_stays);
  made.moved_instead = moved_instead(recipe, measured.frequency_hz, options);
  measure(made, options, drawn.dice);
  for (std::size_t k = 0; k < nominal.size(); ++k) {
    made.evidence_there +=
        ((made.exact[k] - nominal[k]).cwiseAbs2().array() / measured.variance[k].array()).sum();
  }
  return made;
}

}  // namespace chladni::simulators
