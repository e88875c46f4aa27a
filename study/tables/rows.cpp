#include "study/tables/rows.h"

namespace chladni::study {

void read_band(TableReader& table, const std::string& name, const std::string& example,
               double& low_hz, double& high_hz) {
  const auto band = table.quantities(name, "Hz", 2, Sign::not_negative);
  if (!band) return;
  low_hz = (*band)(0);
  high_hz = (*band)(1);
  if (high_hz > low_hz) return;
  table.wrong(*table.find(name),
              table.name(name) + ": its end is not above its start; expected such as " + example);
}

}  // namespace chladni::study
