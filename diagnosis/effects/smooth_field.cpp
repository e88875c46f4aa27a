#include "diagnosis/body_fields.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWaveError = 0.02;  // Effect::error: variations of higher order than a square

std::vector<Parameter> coefficients(const Structure& structure) {
  std::vector<Parameter> all;
  for (const auto name : names_of_smooth_fields(structure.cells)) {
    all.push_back({.name = name, .unit = "1", .is_size = true, .width = 0.05, .step = 1e-5});
  }
  return all;
}

Index has_field_cells(const Structure& structure) { return structure.cells.count() > 2 ? 1 : 0; }
Index field_bends(const Structure& structure) {
  return structure.bending_power > 0.0 ? has_field_cells(structure) : 0;
}

std::function<void(State&)> stiffening(const Structure& structure, Index /*option*/,
                                       const VectorXd& x) {
  return [by = stiffened_smoothly(structure, x)](State& state) { state.stiffness += by; };
}

std::function<void(State&)> thickening(const Structure& structure, Index /*option*/,
                                       const VectorXd& x) {
  return [by = thickened_smoothly(structure, x)](State& state) {
    state.stiffness += by.stiffness;
    state.mass += by.mass;
  };
}

std::vector<EffectStart> flat(const Scene& scene) {
  const Index n = smooth_fields(scene.structure().cells).cols();
  std::vector<EffectStart> starts{{0, VectorXd::Zero(n)}};
  for (Index f = 0; f < n; ++f) {
    for (const double by : {-0.04, -0.01, 0.01, 0.04})
      starts.push_back({0, by * VectorXd::Unit(n, f)});
  }
  return starts;
}

constexpr InStudy waves(std::string_view of) {
  InStudy entry{.table = InStudy::Table::variation, .kind = of};
  for (const auto name : kSmoothFields) entry.keys.push_back({name, name, ""});
  return entry;
}

}  // namespace

constinit const Effect modulus_field{
    .name = "modulus_field",
    .summary = "Young's modulus varies smoothly over the body",
    .source = "sum of x_f K_f, Legendre polynomials over the body",
    .confusable = "thickness that varies (changes the mass too), orthotropy",
    .parameters = coefficients,
    .options = has_field_cells,
    .channels = no_channels,
    .apply = at_once<stiffening>,
    .starts = flat,
    .change = stiffening,
    .error = kWaveError,
    .simpler = {{&youngs_modulus}},
    .in_study = waves("stiffness"),
};
constinit const Effect thickness_field{
    .name = "thickness_field",
    .summary = "the thickness varies smoothly: a taper, a bow",
    .source = "K_c (1 + t)^3 but for shear, M_c (1 + t), Legendre polynomials",
    .confusable = "a modulus that varies (leaves the mass)",
    .parameters = coefficients,
    .options = field_bends,
    .channels = no_channels,
    .apply = at_once<thickening>,
    .starts = flat,
    .change = thickening,
    .error = kWaveError,
    .simpler = {{&thickness}},
    .tolerance = &Tolerances::thickness,
    .in_study = waves("thickness"),
};

}  // namespace chladni::diagnosis
