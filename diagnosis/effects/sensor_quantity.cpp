#include <array>
#include <utility>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

std::vector<Parameter> none(const Structure& /*structure*/) { return {}; }

// Powers of s between what is recorded and what it is called.
constexpr std::array<double, 4> kPowers{1.0, 2.0, -1.0, -2.0};
// Units that are taken for another: g for m/s², mm for m, inch for mm, rad/s for Hz, and back.
constexpr std::array<double, 10> kFactors{
    9.80665,           1.0 / 9.80665,          1e3, 1e-3, 1e6, 1e-6, 25.4, 1.0 / 25.4,
    6.283185307179586, 1.0 / 6.283185307179586};

// Every sensor by itself, then all of them together.
Index sensors_and_all(const Structure& structure) {
  return structure.output_count() > 1 ? structure.output_count() + 1 : 1;
}
template <std::size_t kinds>
Index choices(const Structure& structure) {
  return sensors_and_all(structure) * static_cast<Index>(kinds);
}
template <std::size_t kinds>
std::vector<std::string> whose(const Structure& structure, Index option) {
  const Index sensor = option / static_cast<Index>(kinds);
  if (sensor < structure.output_count()) {
    return {structure.outputs.names[static_cast<std::size_t>(sensor)]};
  }
  return structure.outputs.names;
}
template <std::size_t kinds, typename Change>
void on_paths(State& state, Index option, Change change) {
  const Index sensor = option / static_cast<Index>(kinds);
  const auto kind = static_cast<std::size_t>(option % static_cast<Index>(kinds));
  for (Index i = 0; i < state.output_count(); ++i) {
    if (sensor == state.output_count() || sensor == i) {
      change(state.output_paths[static_cast<std::size_t>(i)], kind);
    }
  }
}

void differentiate(State& state, const Structure& /*structure*/, Index option,
                   const Eigen::VectorXd& /*x*/) {
  on_paths<kPowers.size()>(state, option,
                           [](Path& path, std::size_t kind) { path.derivative += kPowers[kind]; });
}
void rescale(State& state, const Structure& /*structure*/, Index option,
             const Eigen::VectorXd& /*x*/) {
  on_paths<kFactors.size()>(state, option,
                            [](Path& path, std::size_t kind) { path.gain *= kFactors[kind]; });
}

// Only where the scale of a row is off by a factor of two or more.
std::vector<EffectStart> off_scale(const Scene& scene, Index kinds) {
  std::vector<EffectStart> starts;
  bool all = true;
  const auto add = [&](Index sensor) {
    for (Index kind = 0; kind < kinds; ++kind) starts.push_back({sensor * kinds + kind, {}});
  };
  for (Index i = 0; i < scene.structure().output_count(); ++i) {
    const double factor = scene.row_factor(i);
    const bool off = factor < 0.5 || factor > 2.0;
    all = all && off;
    if (off) add(i);
  }
  if (all && scene.structure().output_count() > 1) add(scene.structure().output_count());
  return starts;
}
std::vector<EffectStart> powers(const Scene& scene) {
  return off_scale(scene, static_cast<Index>(kPowers.size()));
}
std::vector<EffectStart> units(const Scene& scene) {
  return off_scale(scene, static_cast<Index>(kFactors.size()));
}

}  // namespace

const Effect sensor_quantity{"sensor_quantity",
                             "velocity or acceleration called displacement, or the reverse",
                             "a row times a power of s",
                             "unit, low-pass",
                             none,
                             choices<kPowers.size()>,
                             whose<kPowers.size()>,
                             differentiate,
                             powers};
const Effect sensor_unit{"sensor_unit",
                         "a unit taken for another: g for m/s^2, mm for m, inch for mm",
                         "a row times one of the factors between units",
                         "gain",
                         none,
                         choices<kFactors.size()>,
                         whose<kFactors.size()>,
                         rescale,
                         units};

}  // namespace chladni::diagnosis
