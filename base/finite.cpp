#include "base/finite.h"

#include <fmt/format.h>

#include "base/error.h"

namespace chladni {

void refuse_infinite(const char* name, Eigen::Index bad, Eigen::Index size) {
  throw NumericalFailure(
      fmt::format("{}: {} of {} entries are infinite or no numbers; expected finite values (are "
                  "the data of a sound size?)",
                  name, bad, size));
}

}  // namespace chladni
