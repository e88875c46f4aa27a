#include "diagnosis/modes/another_body.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {

double of_another_body(const Structure& structure, const std::vector<Supposed>& causes,
                       const FrequencyErrors& errors) {
  double log_odds = std::log(kConstants.another_body);
  if (errors.determined > 0.0 && errors.level < kConstants.real_frequency) {
    log_odds -= errors.determined * std::log(kConstants.real_frequency / errors.level);
  }
  bool is_beyond = false;
  for (const auto& cause : causes) {
    if (!cause.effect->is_of_body) continue;
    Eigen::Index i = 0;
    for (const auto& parameter : cause.effect->parameters(structure)) {
      const double off = (cause.x(i++) - parameter.centre) / parameter.width;
      const double more = off * off - kConstants.usual_body * kConstants.usual_body;
      is_beyond = is_beyond || more > 0.0;
      log_odds += 0.5 * std::max(more, 0.0);
    }
  }
  return is_beyond ? 1.0 / (1.0 + std::exp(-log_odds)) : 0.0;
}

std::string another_body_in_words() {
  return "make sure that the study has the structure's material and dimensions: changes of the "
         "whole body as large as these are rather those of another body";
}

}  // namespace chladni::diagnosis
