#include "simulators/tables/table_channels.h"

namespace chladni::simulators {

TableChannels table_channels() {
  TableChannels all;
  all.outputs.resize(4, 2);
  all.outputs << -0.25, 0.25, 0.25, 0.25, 0.25, -0.25, -0.25, -0.25;
  all.inputs.resize(13, 2);
  all.inputs << -0.18, 0.18, 0.18, 0.18, 0.18, -0.18, -0.18, -0.18, 0.0, 0.0, -0.12, 0.0, 0.12, 0.0,
      0.0, 0.12, 0.0, -0.12, -0.24, 0.0, 0.24, 0.0, 0.0, 0.24, 0.0, -0.24;
  for (int i = 1; i <= 4; ++i) all.output_names.push_back("s" + std::to_string(i));
  for (int i = 1; i <= 13; ++i) all.input_names.push_back("a" + std::to_string(i));
  return all;
}

}  // namespace chladni::simulators
