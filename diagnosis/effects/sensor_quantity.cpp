#include <array>
#include <utility>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// A wrong reading of a sensor's record, and its effect: a power of s, or a factor.
struct Mistaken {
  std::string_view text;
  double by;
};

// The recorded quantity and the assumed one: they differ by one or two derivatives.
constexpr std::array<Mistaken, 4> kPowers{{
    {"velocity taken for displacement (or acceleration for velocity)", 1.0},
    {"acceleration taken for displacement", 2.0},
    {"displacement taken for velocity (or velocity for acceleration)", -1.0},
    {"displacement taken for acceleration", -2.0},
}};
// Numbers in the first unit, read as numbers in the second.
constexpr double kGravity = 9.80665;
constexpr double kTurn = 6.283185307179586;
constexpr std::array<Mistaken, 10> kFactors{{
    {"m/s^2 taken for g", kGravity},
    {"g taken for m/s^2", 1.0 / kGravity},
    {"mm taken for m (or um for mm)", 1e3},
    {"m taken for mm (or mm for um)", 1e-3},
    {"um taken for m", 1e6},
    {"m taken for um", 1e-6},
    {"mm taken for inch", 25.4},
    {"inch taken for mm", 1.0 / 25.4},
    {"rad/s taken for Hz", kTurn},
    {"Hz taken for rad/s", 1.0 / kTurn},
}};

template <const auto& kinds>
Choice chosen(Index option, std::string_view number) {
  const auto& kind = kinds[static_cast<std::size_t>(option) % kinds.size()];
  return {std::string(kind.text), number, kind.by};
}
Choice quantity(Index option) { return chosen<kPowers>(option, "derivative"); }
Choice unit(Index option) { return chosen<kFactors>(option, "factor"); }

// Each sensor by itself, then all of them together.
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
  on_paths<kPowers.size()>(
      state, option, [](Path& path, std::size_t kind) { path.derivative += kPowers[kind].by; });
}
void rescale(State& state, const Structure& /*structure*/, Index option,
             const Eigen::VectorXd& /*x*/) {
  on_paths<kFactors.size()>(state, option,
                            [](Path& path, std::size_t kind) { path.gain *= kFactors[kind].by; });
}

// Only for rows whose scale is wrong by a factor of two or more.
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

constinit const Effect sensor_quantity{
    .name = "sensor_quantity",
    .summary = "velocity or acceleration called displacement, or the reverse",
    .source = "a row times a power of s",
    .confusable = "unit, low-pass",
    .parameters = no_sizes,
    .options = choices<kPowers.size()>,
    .channels = whose<kPowers.size()>,
    .apply = differentiate,
    .starts = powers,
    .choice = quantity,
    .in_study = {.table = InStudy::Table::sensors,
                 .keys = {{.key = "quantity", .how = StudyKey::How::computed}}},
};
constinit const Effect sensor_unit{
    .name = "sensor_unit",
    .summary = "a unit taken for another: g for m/s^2, mm for m, inch for mm",
    .source = "a row times one of the factors between units",
    .confusable = "gain",
    .parameters = no_sizes,
    .options = choices<kFactors.size()>,
    .channels = whose<kFactors.size()>,
    .apply = rescale,
    .starts = units,
    .choice = unit,
    .is_gain = true,
    .in_study = {.table = InStudy::Table::sensors,
                 .keys = {{"gain", "factor", "", StudyKey::How::times}}},
};

}  // namespace chladni::diagnosis
