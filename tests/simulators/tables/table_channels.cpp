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

std::vector<modal::MeasuredChannel> measured_channels(const std::vector<std::string>& names,
                                                      const Eigen::MatrixX2d& places,
                                                      const std::string& unit) {
  std::vector<modal::MeasuredChannel> list(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto place = places.row(static_cast<Eigen::Index>(i));
    list[i].name = names[i];
    list[i].direction = Eigen::Vector3d::UnitZ();
    list[i].position = Eigen::Vector3d(place(0), place(1), 0.0);
    list[i].unit = unit;
  }
  return list;
}

}  // namespace chladni::simulators
