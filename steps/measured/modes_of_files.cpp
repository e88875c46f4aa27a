#include "steps/measured/modes_of_files.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/node_shapes.h"
#include "io/scan.h"

namespace chladni::steps {
namespace {

using diagnosis::MeasuredModes;
using Eigen::Index;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

MeasuredModes without_shapes(Index count) {
  MeasuredModes modes;
  modes.frequency_hz.setZero(count);
  modes.frequency_std.setZero(count);
  modes.damping_ratio.setConstant(count, kNone);
  modes.damping_std.setZero(count);
  modes.output_shapes.resize(0, count);
  modes.output_std.resize(0, count);
  modes.input_shapes.resize(0, count);
  modes.input_std.resize(0, count);
  return modes;
}

bool has_name(const std::vector<study::Channel>& channels, const std::string& name) {
  return std::ranges::any_of(channels, [&](const study::Channel& one) { return one.name == name; });
}

// The columns of the table that are called as channels of one side.
void take_columns(const io::ShapeTable& table, const std::vector<study::Channel>& channels,
                  std::vector<std::string>& names, Eigen::MatrixXcd& shapes,
                  Eigen::MatrixXd& deviation) {
  std::vector<Index> rows;
  for (std::size_t s = 0; s < table.channels.size(); ++s) {
    if (!has_name(channels, table.channels[s])) continue;
    rows.push_back(static_cast<Index>(s));
    names.push_back(table.channels[s]);
  }
  shapes = table.values(rows, Eigen::all).cast<std::complex<double>>();
  deviation = table.deviation(rows, Eigen::all);
}

void refuse_strangers(const io::ShapeTable& table, const study::Study& study,
                      const std::string& file) {
  for (const auto& name : table.channels) {
    const bool is_sensor = has_name(study.sensors, name);
    const bool is_actuator = has_name(study.actuators, name);
    require(
        is_sensor || is_actuator,
        fmt::format("{}: the column {} is no sensor or actuator of the study; it has {}", file,
                    io::shown(name),
                    study::channel_names(study).empty() ? "none"
                                                        : io::listed(study::channel_names(study))));
    require(!is_sensor || !is_actuator,
            fmt::format("{}: the column {} is a sensor and an actuator of the study; expected "
                        "different names",
                        file, io::shown(name)));
  }
}

/// A channel at a node of the file.
struct AtNode {
  std::string name;
  long long node = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

// A name such as "126z" states an axis, which is then the channel's, up to the sign.
void require_axis(const study::Channel& channel, const Eigen::Vector3d& named,
                  const std::string& file) {
  require(named.cross(channel.direction).norm() <= kObliqueChannel,
          fmt::format("{}: \"{}\" is along ({:.4g}, {:.4g}, {:.4g}) by its name and along ({:.4g}, "
                      "{:.4g}, {:.4g}) in the study; correct the study's direction, or give the "
                      "sensor another name and its node",
                      file, channel.name, named.x(), named.y(), named.z(), channel.direction.x(),
                      channel.direction.y(), channel.direction.z()));
}

std::vector<AtNode> found_in(const io::NodeShape& shape, const std::vector<study::Channel>& all,
                             const std::string& file) {
  std::vector<AtNode> found;
  for (const auto& channel : all) {
    if (channel.node && shape.motion.contains(*channel.node)) {
      found.push_back({channel.name, *channel.node, channel.direction});
      continue;
    }
    for (const auto& [node, motion] : shape.motion) {
      const auto direction = io::direction_in(channel.name, node);
      if (!direction.any()) continue;
      require_axis(channel, direction, file);
      const double along = direction.dot(channel.direction) < 0.0 ? -1.0 : 1.0;
      found.push_back({channel.name, node, along * direction});
      break;
    }
  }
  return found;
}

// A mode with the nodes of all of them: programs leave out nodes that a mode does not have.
io::NodeShape of_all_nodes(const std::vector<io::NodeShape>& modes) {
  auto all = modes.front();
  for (const auto& mode : modes) all.motion.insert(mode.motion.begin(), mode.motion.end());
  return all;
}

void note_missing(const std::vector<study::Channel>& sensors, const std::vector<AtNode>& found,
                  const std::string& file, stage::Work& work) {
  std::vector<std::string> missing;
  for (const auto& sensor : sensors) {
    const auto is_it = [&](const AtNode& one) { return one.name == sensor.name; };
    if (std::ranges::none_of(found, is_it)) missing.push_back("\"" + sensor.name + "\"");
  }
  if (missing.empty()) return;
  work.note(file + ": " + io::listed(missing) + (missing.size() == 1 ? " is" : " are") +
            " at no node of it: taken as not measured");
}

// The motion of a channel in each mode; NaN where a mode lacks the node.
Eigen::RowVectorXcd row_of(const std::vector<io::NodeShape>& modes, const AtNode& channel) {
  Eigen::RowVectorXcd row(static_cast<Index>(modes.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto found = modes[k].motion.find(channel.node);
    row(static_cast<Index>(k)) =
        found == modes[k].motion.end()
            ? std::complex<double>(kNone, kNone)
            : (channel.direction.cast<std::complex<double>>().transpose() * found->second).value();
  }
  return row;
}

}  // namespace

void warn_of_unstated(const io::ShapeTable& table, const std::string& file, stage::Work& work) {
  const Eigen::ArrayXX<bool> is_stated = table.deviation.array() > 0.0;
  Index count = 0;
  for (Index k = 0; k < is_stated.rows(); ++k) {
    if (!is_stated.row(k).any()) continue;
    count += (table.values.row(k).array().isFinite() && !is_stated.row(k)).count();
  }
  if (count == 0) return;
  work.warn(
      fmt::format("{}: values without a deviation at channels that have others: {}; "
                  "measurement.noise is taken for it. Empty their cells too if they are not known",
                  file, count));
}

MeasuredModes modes_of_table(const study::Study& study, stage::Work& work) {
  const auto file = study.measurement->modes_file.string();
  const auto table = io::read_shapes(study.measurement->modes_file, io::ShapesStated::partly);
  refuse_strangers(table, study, file);
  warn_of_unstated(table, file, work);
  auto modes = without_shapes(table.frequency_hz.size());
  modes.frequency_hz = table.frequency_hz;
  const auto positive = table.frequency_hz.array() > 0.0;
  modes.frequency_std =
      positive.select(table.frequency_std_hz.array() / table.frequency_hz.array(), 0.0);
  for (Index k = 0; k < table.damping_ratio.size(); ++k) {
    if (!(table.damping_ratio(k) > 0.0)) continue;
    modes.damping_ratio(k) = table.damping_ratio(k);
    modes.damping_std(k) = table.damping_std(k) / table.damping_ratio(k);
  }
  take_columns(table, study.sensors, modes.outputs, modes.output_shapes, modes.output_std);
  take_columns(table, study.actuators, modes.inputs, modes.input_shapes, modes.input_std);
  if (table.channels.empty()) work.note(file + ": frequencies without shapes");
  return modes;
}

MeasuredModes modes_of_uff(const study::Study& study, stage::Work& work) {
  const auto file = study.measurement->modes_file.string();
  const auto read = io::read_node_shapes(study.measurement->modes_file);
  for (const auto& note : read.notes) work.note(file + ": " + note);
  auto modes = without_shapes(static_cast<Index>(read.modes.size()));
  for (std::size_t k = 0; k < read.modes.size(); ++k) {
    const auto i = static_cast<Index>(k);
    modes.frequency_hz(i) = read.modes[k].frequency_hz;
    if (read.modes[k].damping_ratio > 0.0) modes.damping_ratio(i) = read.modes[k].damping_ratio;
  }
  const auto channels = found_in(of_all_nodes(read.modes), study.sensors, file);
  note_missing(study.sensors, channels, file, work);
  std::vector<Eigen::RowVectorXcd> rows;
  for (const auto& channel : channels) {
    auto row = row_of(read.modes, channel);
    if (row.isZero(0.0)) {
      work.note(file + ": \"" + channel.name + "\" is 0 in every mode: taken as not measured");
      continue;
    }
    modes.outputs.push_back(channel.name);
    rows.push_back(std::move(row));
  }
  require(!rows.empty(),
          file +
              ": no sensor of the study is at a node of the file, or all are 0; expected "
              "sensors with node = " +
              (read.modes.front().motion.empty()
                   ? "the node's number"
                   : fmt::to_string(read.modes.front().motion.begin()->first)));
  modes.output_shapes.resize(static_cast<Index>(rows.size()), modes.count());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    modes.output_shapes.row(static_cast<Index>(i)) = rows[i];
  }
  modes.output_std.setZero(modes.output_shapes.rows(), modes.count());
  return modes;
}

}  // namespace chladni::steps
