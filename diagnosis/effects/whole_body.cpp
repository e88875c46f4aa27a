#include <cmath>

#include "diagnosis/body_fields.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> relative_scale(const Structure& /*structure*/) {
  return {{.name = "relative",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .width = 0.2,
           .step = 1e-5}};
}

void stiffen(State& state, const Structure& /*structure*/, Eigen::Index /*option*/,
             const VectorXd& x) {
  scale_stiffness(state, std::exp(x(0)));
}
void weigh(State& state, const Structure& /*structure*/, Eigen::Index /*option*/,
           const VectorXd& x) {
  scale_mass(state, std::exp(x(0)));
}
std::function<void(State&)> thickening(const Structure& structure, Eigen::Index /*option*/,
                                       const VectorXd& x) {
  const double t = std::exp(x(0));
  const double powered = std::pow(t, structure.bending_power);
  const Eigen::Index r = structure.mode_count();
  BodyChange other{Eigen::MatrixXd::Zero(r, r), Eigen::MatrixXd::Zero(r, r)};
  add_shear_and_turning(structure, VectorXd::Constant(structure.cells.count(), powered - t),
                        other.stiffness, other.mass);
  return [=](State& state) {
    scale_stiffness(state, powered);
    scale_mass(state, t);
    state.stiffness += other.stiffness;
    state.mass += other.mass;
  };
}

// Frequencies change by `power` x. The steps follow the width of the resonances, up to ±30 % in
// frequency. For matrices that are not diagonal the steps double, because each one is expensive.
std::vector<EffectStart> scale_steps(const Scene& scene, double power) {
  const auto& state = scene.state();
  const bool cheap = state.stiffness.isDiagonal(0.0) && state.mass.isDiagonal(0.0) &&
                     state.springs.size() == 0 && state.masses.size() == 0;
  const double step = scene.frequency_step() / power;
  std::vector<EffectStart> starts{{0, VectorXd::Zero(1)}};
  const double most = 0.3 / power;
  double by = step;
  while (by < most) {
    starts.push_back({0, VectorXd::Constant(1, by)});
    starts.push_back({0, VectorXd::Constant(1, -by)});
    by = cheap ? by + step : 2.0 * by;
  }
  return starts;
}
std::vector<EffectStart> by_half(const Scene& scene) { return scale_steps(scene, 0.5); }
std::vector<EffectStart> by_one(const Scene& scene) { return scale_steps(scene, 1.0); }

Eigen::Index body_bends(const Structure& structure) {
  return structure.bending_power > 0.0 ? 1 : 0;
}

constexpr InStudy scaled(InStudy::Table table, std::initializer_list<std::string_view> keys) {
  InStudy entry{.table = table};
  for (const auto key : keys) {
    entry.keys.push_back({key, "relative", "", StudyKey::How::times_one_plus});
  }
  return entry;
}

}  // namespace

constinit const Effect youngs_modulus{
    .name = "youngs_modulus",
    .summary = "the whole body is stiffer or softer",
    .source = "K (1 + e)",
    .confusable = "density with an overall gain; thickness: weigh the body",
    .parameters = relative_scale,
    .options = one_option,
    .channels = no_channels,
    .apply = stiffen,
    .starts = by_half,
    .tolerance = &Tolerances::modulus,
    .is_scale = true,
    .is_of_body = true,
    .in_study =
        scaled(InStudy::Table::materials, {"youngs_modulus", "shear_modulus", "c11", "c12", "c44"}),
};
constinit const Effect density{
    .name = "density",
    .summary = "the whole body is heavier or lighter",
    .source = "M (1 + r)",
    .confusable = "modulus with an overall gain: weigh the body",
    .parameters = relative_scale,
    .options = one_option,
    .channels = no_channels,
    .apply = weigh,
    .starts = by_half,
    .tolerance = &Tolerances::density,
    .is_scale = true,
    .is_of_body = true,
    .in_study = scaled(InStudy::Table::materials, {"density"}),
};
constinit const Effect thickness{
    .name = "thickness",
    .summary = "the whole body is thicker or thinner",
    .source = "K (1 + t)^3 but for shear, M (1 + t) of a body that bends",
    .confusable = "modulus and density together: measure it",
    .parameters = relative_scale,
    .options = body_bends,
    .channels = no_channels,
    .apply = at_once<thickening>,
    .starts = by_one,
    .change = thickening,
    .error = 0.005,
    .tolerance = &Tolerances::thickness,
    .is_scale = true,
    .is_of_body = true,
    .in_study = scaled(InStudy::Table::geometry,
                       {"thickness", "height", "face_sheet", "wafer.thickness", "bores.depth"}),
};

}  // namespace chladni::diagnosis
