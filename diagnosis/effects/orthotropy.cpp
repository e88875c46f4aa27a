#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> constants(const Structure& /*structure*/) {
  return {{.name = "along_u", .unit = "1", .is_size = true, .width = 0.2, .step = 1e-5},
          {.name = "shear", .unit = "1", .is_size = true, .width = 0.2, .step = 1e-5}};
}

Eigen::Index known(const Structure& structure) {
  return structure.directional.along_u.size() > 0 ? 1 : 0;
}

void stretch(State& state, const Structure& structure, Eigen::Index /*option*/, const VectorXd& x) {
  state.stiffness += x(0) * structure.directional.along_u + x(1) * structure.directional.shear;
}

std::vector<EffectStart> orthotropy_steps(const Scene& /*scene*/) {
  std::vector<EffectStart> starts{{0, VectorXd::Zero(2)}};
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (const double by : {-0.3, -0.15, -0.08, -0.04, -0.02, 0.02, 0.04, 0.08, 0.15, 0.3}) {
      starts.push_back({0, by * VectorXd::Unit(2, i)});
    }
  }
  return starts;
}

// A slender body along u has the modulus along u alone.
std::optional<double> implied(std::string_view name, const VectorXd& x) {
  if (name == "relative") return x(0);
  return std::nullopt;
}

}  // namespace

constinit const Effect orthotropy{
    .name = "orthotropy",
    .summary = "stiffer along one side than along the other: rolled, ribbed, fibred",
    .source = "K plus parts of it by elastic constant",
    .confusable = "a modulus or thickness that varies",
    .parameters = constants,
    .options = known,
    .channels = no_channels,
    .apply = stretch,
    .starts = orthotropy_steps,
    .implied = implied,
    .simpler = {{&youngs_modulus}},
    .tolerance = &Tolerances::orthotropy,
    .is_of_body = true,
    .in_study = {.table = InStudy::Table::materials,
                 .keys = {{.key = "symmetry", .how = StudyKey::How::computed},
                          {.key = "youngs_modulus", .how = StudyKey::How::computed},
                          {.key = "poissons_ratio", .how = StudyKey::How::computed},
                          {.key = "shear_modulus", .how = StudyKey::How::computed}}},
};

}  // namespace chladni::diagnosis
