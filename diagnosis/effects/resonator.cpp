#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> oscillator_and_place(const Structure& structure) {
  const double typical_hz = first_hz(structure);
  auto parameters = oscillator_parameters(0.01 * structure.mass_kg, 2.0 * typical_hz, 1.2);
  parameters.push_back(place_u(structure));
  parameters.push_back(place_v(structure));
  return parameters;
}

void carry(State& state, const Structure& structure, Eigen::Index /*option*/, const VectorXd& x) {
  const auto [mass, damping, stiffness] = oscillator(x);
  Attached one = attached_at(structure, x(3), x(4));
  one.carried = true;
  one.mass = mass;
  one.damping = damping;
  one.stiffness = stiffness;
  state.attached.push_back(std::move(one));
}

// A resonator acts as a mass far below its frequency. Far above it, its mass stands still and it
// acts as a spring and a dashpot to ground.
std::optional<double> implied(std::string_view name, const VectorXd& x) {
  const auto [mass, damping, stiffness] = oscillator(x);
  if (name == "stiffness") return stiffness;
  if (name == "damping") return damping;
  return std::nullopt;
}

// A grid of masses and frequencies, at the places where a free complex number per line explains
// most.
std::vector<EffectStart> oscillators(const Scene& scene) {
  std::vector<VectorXd> sizes;
  const double low = std::max(scene.low_hz(), 1.0);
  const double ratio = std::pow(1.3 * scene.high_hz() / low, 1.0 / 40.0);
  for (double part = 3e-4; part < 0.2; part *= 5.0) {
    for (double f = low; f < 1.31 * scene.high_hz(); f *= ratio) {
      sizes.push_back(
          Eigen::Vector3d(std::log(part * scene.structure().mass_kg), std::log(f), std::log(0.02)));
    }
  }
  return at_peaks(scene, sizes, 3);
}

// The pole of a resonator is not visible if it brings less than this part of the gain: it lies
// outside the band or is heavily damped.
constexpr double kPoleUnseen = 0.01;

}  // namespace

constinit const Effect resonator{
    .name = "resonator",
    .summary = "a mass on a spring hangs on the body: bracket, cable, loose part",
    .source = "m s^2 (k + c s) / (m s^2 + c s + k) at a place, Woodbury: one more pole",
    .confusable =
        "frame mode; a mass where its frequency is far above the band, a spring "
        "where it is far below",
    .parameters = oscillator_and_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = carry,
    .starts = oscillators,
    .error = kHungError,
    .implied = implied,
    .simpler = {{&point_mass, kPoleUnseen},
                {&ground_spring, kPoleUnseen},
                {&ground_damper, kPoleUnseen}},
    .in_study = {.table = InStudy::Table::attachment,
                 .kind = "resonator",
                 .along_normal = true,
                 .keys = {{"mass", "mass", "kg"},
                          {"frequency", "frequency", "Hz"},
                          {.key = "damping_ratio", .how = StudyKey::How::computed}}},
};

}  // namespace chladni::diagnosis
