#include "modal/groups.h"

#include <fmt/format.h>

#include <string>

#include "base/error.h"

namespace chladni::modal {

std::vector<ModeGroup> groups(const Eigen::VectorXd& frequency_hz, double tolerance) {
  require(tolerance >= 0.0,
          "groups: the tolerance is " + fmt::to_string(tolerance) + ", expected 0 or more");
  require(frequency_hz.allFinite(), "groups: a frequency is not finite");
  std::vector<ModeGroup> found;
  for (Eigen::Index i = 0; i < frequency_hz.size(); ++i) {
    const double before = i > 0 ? frequency_hz(i - 1) : frequency_hz(i);
    require(frequency_hz(i) >= before, "groups: frequency " + fmt::to_string(i + 1) +
                                           " is below the one before it, expected ascending ones");
    if (i > 0 && frequency_hz(i) - before <= tolerance * before) {
      ++found.back().size;
    } else {
      found.push_back({i, 1});
    }
  }
  return found;
}

}  // namespace chladni::modal
