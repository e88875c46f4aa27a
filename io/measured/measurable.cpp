#include "io/measured/measurable.h"

#include <fmt/format.h>

namespace chladni::io {

std::string not_measurable(double number) {
  return fmt::format("found {:g}, expected a finite number of at most {:g}", number,
                     kLargestMeasured);
}

}  // namespace chladni::io
