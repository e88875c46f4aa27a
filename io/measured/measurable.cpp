#include "io/measured/measurable.h"

#include <fmt/format.h>

namespace chladni::io {

std::string not_measurable(double number) {
  return fmt::format("found {:g}, expected a finite number of at most {:g}", number,
                     kLargestMeasured);
}

std::string no_frequency_of_mode(double hz) {
  return fmt::format("found {:g} Hz, expected 0, or a frequency from 1e-06 to 1e+12 Hz", hz);
}

}  // namespace chladni::io
