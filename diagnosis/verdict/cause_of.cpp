#include "diagnosis/verdict/cause_of.h"

#include <cmath>

namespace chladni::diagnosis {

Cause cause_of(const Structure& structure, const Supposed& supposed,
               const Eigen::VectorXd& variance) {
  Cause cause;
  cause.effect = supposed.effect->name;
  cause.channels = supposed.effect->channels(structure, supposed.option);
  const auto choice = choice_of(*supposed.effect, supposed.option);
  cause.option = choice.text;
  if (!choice.number.empty()) {
    cause.fixed.push_back({std::string(choice.number), "1", choice.value, 0.0});
  }
  cause.place = place_of(supposed, structure);
  Eigen::Index i = 0;
  for (const auto& parameter : supposed.effect->parameters(structure)) {
    cause.parameters.push_back(
        {std::string(parameter.name), std::string(parameter.unit), parameter.value(supposed.x(i)),
         parameter.value_per_coordinate(supposed.x(i)) * std::sqrt(variance(i)), parameter.role});
    ++i;
  }
  return cause;
}

}  // namespace chladni::diagnosis
