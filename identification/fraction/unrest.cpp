#include "identification/fraction/unrest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace chladni::identification {

double unrest_of(const std::vector<double>& costs, double least) {
  if (costs.empty()) return 1.0;
  const auto half = costs.begin() + std::ssize(costs) / 2;
  const bool finite =
      std::all_of(half, costs.end(), [](double cost) { return std::isfinite(cost); });
  if (!finite) return std::numeric_limits<double>::infinity();
  return *std::max_element(half, costs.end()) / least;
}

std::string unrest_note(double unrest) {
  const auto how = std::isfinite(unrest)
                       ? fmt::format(
                             "the last half of its errors reaches {:.2g} times the least, or "
                             "what noise leaves",
                             unrest)
                       : std::string("its last error is not finite, so that it ended there");
  return "the iteration of Sanathanan and Koerner does not settle: " + how +
         ". The last bits of the sums, which differ between machines, may decide from which one "
         "the "
         "fit goes on; compare another fraction_degree or number of iterations, or take method = "
         "\"likelihood\"";
}

}  // namespace chladni::identification
